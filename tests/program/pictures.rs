//! Pictures whose truth is a formula.

use super::support::{Folder, SLAB};

/// 32-bit floats and one exponential: a few units in the last place.
const TOLERANCE: f32 = 2e-6;

/// Asserts that the picture is the slab: colour and opacity in the middle half, nothing outside.
#[track_caller]
fn assert_slab(folder: &Folder, name: &str) {
    let (width, pixels) = folder.floats(name);
    assert_eq!((width, pixels.len()), (8, 64));
    let opacity = 1.0 - (-2.0f32).exp();
    for (at, pixel) in pixels.iter().enumerate() {
        let (i, j) = (at % 8, at / 8);
        let inside = (2..6).contains(&i) && (2..6).contains(&j);
        let expected = if inside { [0.5 * opacity, opacity, 0.25 * opacity, opacity] } else { [0.0; 4] };
        for (found, expected) in pixel.iter().zip(expected) {
            assert!((found - expected).abs() <= TOLERANCE, "pixel ({i}, {j}): {pixel:?}");
        }
    }
}

#[test]
fn an_even_slab_has_the_opacity_of_the_formula() {
    let folder = Folder::new();
    let ran = folder.voltet(&["run", "slab.toml"]).ok();
    assert_slab(&folder, "slab.exr");
    assert!(ran.stdout.starts_with("slab.exr: 162 cells"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "");
    assert_eq!(folder.names(), ["cube.vtu", "slab.exr", "slab.toml"]);
}

#[test]
fn size_and_output_are_short_for_parameters_and_the_output_is_relative_to_the_working_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.join("scenes")).unwrap();
    folder.write("scenes/slab.toml", SLAB.replace("cube.vtu", "../cube.vtu"));
    folder.voltet(&["run", "scenes/slab.toml", "--size", "12x6", "--output", "out.exr"]).ok();
    let (width, pixels) = folder.floats("out.exr");
    assert_eq!((width, pixels.len()), (12, 72));
    assert_eq!(folder.names(), ["cube.vtu", "out.exr", "scenes", "slab.toml"]);
    // The picture carries what the options made of the file.
    let again = folder.voltet(&["run", "out.exr", "-o", "scenes/again.exr"]).ok();
    assert_eq!(folder.floats("scenes/again.exr"), (width, pixels));
    assert!(again.stdout.starts_with("scenes/again.exr: 162 cells"), "{}", again.stdout);
    // An option in full goes before.
    folder
        .voltet(&["run", "slab.toml", "--size", "12x6", "--set", "view.size=[3,2]", "-o", "small.exr"])
        .ok();
    assert_eq!(folder.floats("small.exr").1.len(), 6);
    let camera = SLAB.split("\n\n").find(|part| part.starts_with("[nodes.view]")).unwrap();
    folder.write("two.toml", format!("{SLAB}\n{}", camera.replace("nodes.view", "nodes.other")));
    folder.voltet(&["run", "two.toml", "--size", "12x6"]).fails(
        2,
        &[
            "--size is given, and the pipeline has several nodes of type camera: found view, other",
            "--set view.size=…",
        ],
    );
    folder.write("none.toml", SLAB.split("[nodes.file]").next().unwrap());
    folder
        .voltet(&["run", "none.toml", "-o", "out.exr"])
        .fails(2, &["--output is given, and the pipeline has no image-writer", "none.toml"]);
    folder.voltet(&["run", "slab.toml", "scenes/slab.toml", "-o", "one.exr"]).fails(2, &["one.exr"]);
}

#[test]
fn the_stages_as_nodes_draw_what_the_renderer_draws() {
    let folder = Folder::new();
    let stages = SLAB.replace(
        "type = \"renderer\"\ninputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }",
        "type = \"composite\"\ninputs = { projection = \"cover\", transfer_function = \"look\" }\n\n\
         [nodes.cover]\ntype = \"project\"\ninputs = { cells = \"order\", camera = \"view\" }\n\n\
         [nodes.order]\ntype = \"sort\"\ninputs = { cells = \"cells\", camera = \"view\" }\n\n\
         [nodes.cells]\ntype = \"cull\"\n\
         inputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }",
    );
    folder.write("stages.toml", stages);
    folder.voltet(&["run", "slab.toml", "--quiet"]).ok();
    folder.voltet(&["run", "stages.toml", "--set", "file.path=stages.exr"]).ok();
    assert_eq!(folder.floats("stages.exr"), folder.floats("slab.exr"));
}

#[test]
fn an_order_that_is_not_exact_is_warned_of() {
    let folder = Folder::new();
    // Two colours, so that the order matters.
    let second =
        "[[nodes.look.widgets]]\nkind = \"piecewise-linear\"\npoints = [[0, 1, 0, 0, 1], [1, 0, 0, 1, 1]]\n";
    folder.write("two.toml", SLAB.replace("[nodes.view]", &format!("{second}\n[nodes.view]")));
    // From behind: the grid's own order is back to front.
    let draw = |order: &str| {
        let order = format!("picture.order={order}");
        folder.voltet(&["run", "two.toml", "--set", "view.eye=[4, 0.5, 0.5]", "--set", &order]).ok().stderr
    };
    assert!(!draw("exact").contains("warning"));
    let (_, exact) = folder.floats("slab.exr");
    assert!(!draw("auto").contains("warning"));
    assert_eq!(folder.floats("slab.exr").1, exact);
    let said = draw("none");
    assert!(
        said.contains("warning: picture: 16 pixels were composited in an order that is not exact"),
        "{said}"
    );
    assert_ne!(folder.floats("slab.exr").1, exact);
}

#[test]
fn the_referee_draws_the_same() {
    let folder = Folder::new();
    folder.voltet(&["run", "slab.toml", "--set", "picture.integrator=reference"]).ok();
    assert_slab(&folder, "slab.exr");
}

#[test]
fn a_bivariate_widget_sees_the_gradient_of_every_method() {
    // The scalar is x, so g is 1 everywhere, and the widget is at its peak.
    let widget = "kind = \"gaussian\"\ncentre = [0.0, 1.0]\nsigma = [inf, 1e-3]";
    let folder = Folder::new();
    let bivariate = SLAB.replace("kind = \"uniform\"", widget).replace("region = { s = [-1.0, 2.0] }\n", "");
    folder.write("bivariate.toml", bivariate);
    for method in ["least-squares", "quadratic-fit", "volume-weighted", "cell-average"] {
        folder.voltet(&["run", "bivariate.toml", "--set", &format!("gradient.method={method}")]).ok();
        assert_slab(&folder, "slab.exr");
    }
    let array = ["--set", "gradient.method=array", "--set", "gradient.array=gradient"];
    folder.voltet(&[&["run", "bivariate.toml"], &array[..]].concat()).ok();
    assert_slab(&folder, "slab.exr");
}

#[test]
fn a_unit_distance_left_to_the_data_is_a_hundredth_of_its_diagonal() {
    let folder = Folder::new();
    // The extinction of the slab, 2 per world unit, over √3 / 100.
    let extinction = format!("look.widgets.0.extinction={}", 2.0 * 3f64.sqrt() / 100.0);
    folder.voltet(&["run", "slab.toml", "--set", "look.unit_distance=auto", "--set", &extinction]).ok();
    assert_slab(&folder, "slab.exr");
}

#[test]
fn a_png_lies_over_its_background() {
    let folder = Folder::new();
    let arguments = ["run", "slab.toml", "--set", "file.path=slab.PNG", "--set", "file.background=[1, 0, 0]"];
    folder.voltet(&arguments).ok();
    let image = image::open(folder.join("slab.PNG")).unwrap().into_rgb8();
    assert_eq!(image.get_pixel(0, 0).0, [255, 0, 0]);
    // Linear 0.5 A + 1 − A, A and A / 4 with A = 1 − e⁻², encoded by hand.
    let srgb = |v: f64| ((1.055 * v.powf(1.0 / 2.4) - 0.055) * 255.0).round() as u8;
    let opacity = 1.0 - (-2f64).exp();
    let expected = [1.0 - 0.5 * opacity, opacity, 0.25 * opacity].map(srgb);
    assert_eq!(image.get_pixel(4, 4).0, expected);
}

#[test]
fn cell_values_can_be_drawn_as_they_are() {
    let folder = Folder::new();
    // Only the middle layer of three, a third of the way: opacity 1 − e^(−2/3).
    let arguments = ["--set", "grid.scalar=layer", "--set", "grid.cell_values=constant"];
    let region = ["--set", "look.widgets.0.region={ s = [0.5, 1.5] }"];
    folder.voltet(&[&["run", "slab.toml"], &arguments[..], &region[..]].concat()).ok();
    let (_, pixels) = folder.floats("slab.exr");
    let expected = 1.0 - (-2.0f32 / 3.0).exp();
    assert!((pixels[4 * 8 + 4][3] - expected).abs() <= TOLERANCE, "{:?}", pixels[4 * 8 + 4]);
}

#[test]
fn a_picture_without_widgets_is_empty_and_says_so() {
    let folder = Folder::new();
    let ran = folder.voltet(&["run", "slab.toml", "--set", "look.widgets=[]"]).ok();
    assert!(ran.stderr.contains("warning: look: the transfer function has no widgets"), "{}", ran.stderr);
    assert!(folder.floats("slab.exr").1.iter().all(|pixel| *pixel == [0.0; 4]));
}

#[test]
fn a_painted_table_is_decoded_from_srgb() {
    let folder = Folder::new();
    // Mid grey in sRGB, opaque: the same extinction everywhere.
    image::RgbaImage::from_pixel(3, 2, image::Rgba([188, 255, 0, 255]))
        .save(folder.join("table.png"))
        .unwrap();
    let table = "kind = \"table\"\nimage = \"table.png\"\ns = [-1.0, 2.0]\ng = [0.0, 2.0]";
    let text = SLAB.replace("kind = \"uniform\"", table).replace("region = { s = [-1.0, 2.0] }\n", "");
    folder.write("table.toml", text.replace("color = [0.5, 1.0, 0.25]\n", ""));
    folder.voltet(&["run", "table.toml"]).ok();
    let opacity = 1.0 - (-2.0f32).exp();
    let grey = ((188.0f32 / 255.0 + 0.055) / 1.055).powf(2.4);
    let (_, pixels) = folder.floats("slab.exr");
    for (found, expected) in pixels[4 * 8 + 4].iter().zip([grey * opacity, opacity, 0.0, opacity]) {
        // The texels are 32-bit floats, interpolated twice.
        assert!((found - expected).abs() <= 1e-5, "{:?}", pixels[4 * 8 + 4]);
    }
    let missing = ["run", "table.toml", "--set", "look.widgets.0.image=tabel.png"];
    folder
        .voltet(&missing)
        .fails(1, &["picture of a table widget cannot be read", "tabel.png", "node 'look'"]);
}
