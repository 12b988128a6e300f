//! `slice-image`: the values at every pixel, by a colour map and by a transfer function; what it asks for and says.

use crate::threshold::{BEGIN, folder, taken};
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_graph::{Demand, RunReport, Value};

/// The picture of a slice, 60 by 60 pixels over 6 by 6 in space about the middle of the box of side 5.
fn made(slice: &str, view: &str, looks: &str) -> Result<(Picture, RunReport)> {
    let wired = if looks.is_empty() { "" } else { ", transfer_function = \"look\"" };
    let text = format!(
        "{BEGIN}{looks}[nodes.view]\ntype = \"camera\"\nsize = [60, 60]\n{view}\n\
         [nodes.slice]\ntype = \"slice-image\"\ninputs = {{ volume = \"gradient\", camera = \"view\"{wired} }}\n{slice}\n\
         [nodes.taker]\ntype = \"taker\"\ninputs = {{ image = \"slice\" }}\n"
    );
    let (values, report) = taken(&text, folder().path(), &Demand::default())?;
    let [Value::Image(picture)] = &values[..] else { panic!("{values:?}") };
    Ok((Picture::clone(picture), report))
}

const STRAIGHT: &str = "eye = [9, 2.5, 2.5]\ntarget = [0, 2.5, 2.5]\nheight = 6.0";

/// Place of a pixel of [`STRAIGHT`] in the plane: y and z.
fn place(i: usize, j: usize) -> [f64; 2] {
    [2.5 + (i as f64 - 29.5) / 10.0, 2.5 - (j as f64 - 29.5) / 10.0]
}

fn is_inside([y, z]: [f64; 2]) -> bool {
    [y, z].iter().all(|x| (0.0..=5.0).contains(x))
}

#[test]
fn a_colour_map_shows_the_values() {
    // At x = 1, s = 2 - 3 y + z + 20, drawn as grey from black at 7 to white at 27.
    let map = "<ColorMaps><ColorMap space=\"RGB\"><Point x=\"0\" o=\"1\" r=\"0\" g=\"0\" b=\"0\"/>\
               <Point x=\"1\" o=\"1\" r=\"1\" g=\"1\" b=\"1\"/></ColorMap></ColorMaps>";
    let file = tempfile::NamedTempFile::with_suffix(".xml").unwrap();
    std::fs::write(file.path(), map).unwrap();
    let slice = format!("origin = [1, 0, 0]\nrange = [7, 27]\ncolormap = {:?}", file.path());
    let (picture, report) = made(&slice, STRAIGHT, "").unwrap();
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    let mut last = [0.0, 0.0];
    let mut greys: Vec<[f64; 2]> = Vec::new();
    for (i, j) in (0..60).flat_map(|j| (0..60).map(move |i| (i, j))) {
        let [r, g, b, opacity] = picture.pixel(i, j);
        let [y, z] = place(i, j);
        assert_eq!(opacity, f32::from(is_inside([y, z])), "{y}, {z}");
        assert!(r == g && g == b);
        if is_inside([y, z]) {
            greys.push([22.0 - 3.0 * y + z, r.into()]);
        }
    }
    // Equal values have one grey, and larger ones no darker one.
    greys.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for [s, grey] in greys {
        assert!(
            grey >= last[1] - 1e-6 && (s > last[0] + 1e-9 || (grey - last[1]).abs() < 1e-6),
            "{s}: {grey}"
        );
        last = [s, grey];
    }
}

/// The surface of the node `slice`, drawn by the renderer in a volume of which nothing is seen, is the same picture.
#[test]
fn the_picture_is_that_of_the_surface() {
    for (slice, view) in [
        ("origin = [1.05, 0, 0]\ncolormap = \"coolwarm\"", STRAIGHT),
        (
            "normal = [1, 2, -0.5]\nsteps = 7",
            "direction = [0.4, 1, 0.2]\nsamples = 4\nheight = \"auto\"\ninputs = { volume = \"grid\" }",
        ),
    ] {
        let (picture, _) = made(slice, view, "").unwrap();
        let text = format!(
            "{BEGIN}[nodes.look]\ntype = \"transfer-function\"\nunit_distance = 1.0\n\
             [nodes.view]\ntype = \"camera\"\nsize = [60, 60]\n{view}\n\
             [nodes.slice]\ntype = \"slice\"\ninputs = {{ volume = \"gradient\" }}\n{slice}\n\
             [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\ninputs = {{ volume = \"gradient\", \
             transfer_function = \"look\", camera = \"view\", surfaces = \"slice\" }}\n\
             [nodes.taker]\ntype = \"taker\"\ninputs = {{ image = \"picture\" }}\n"
        );
        let (values, _) = taken(&text, folder().path(), &Demand::default()).unwrap();
        let [Value::Image(drawn)] = &values[..] else { panic!("{values:?}") };
        let pixels = picture.rgba.iter().zip(&drawn.rgba);
        let apart = pixels.clone().map(|(a, b)| (0..4).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max));
        // Both are pictures of 32 bits.
        let apart = apart.fold(0.0, f32::max);
        assert!(apart < 1e-6, "{slice}: {apart}");
        assert!(pixels.filter(|(a, _)| a[3] == 1.0).count() > 900);
    }
}

const LOOK: &str = "[nodes.look]\ntype = \"transfer-function\"\nunit_distance = 2.0\n\
    [[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [18.0, 3.7]\nsigma = [6.0, 1.0]\ncolor = [1, 0.5, 0.1]\n\
    extinction = 0.4\n\
    [[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [12.0, 3.7]\nsigma = [3.0, 1.0]\ncolor = [0, 0, 2]\n\
    extinction = 1.5\n";

#[test]
fn a_transfer_function_shows_the_light_of_a_slab() {
    for (keys, thickness) in [("", 1.0), ("thickness = 0.5", 0.25)] {
        let (picture, _) = made(&format!("origin = [1, 0, 0]\n{keys}"), STRAIGHT, LOOK).unwrap();
        for (i, j) in (0..60).flat_map(|j| (0..60).map(move |i| (i, j))) {
            let [y, z] = place(i, j);
            let s = 22.0 - 3.0 * y + z;
            let g = 14_f64.sqrt();
            let depth = |centre: f64, sigma: f64, extinction: f64| {
                let [u, v] = [(s - centre) / sigma, g - 3.7];
                thickness * extinction * (-0.5 * (u * u + v * v)).exp()
            };
            let depths = [depth(18.0, 6.0, 0.4), depth(12.0, 3.0, 1.5)];
            let total = depths[0] + depths[1];
            let opacity = if is_inside([y, z]) { 1.0 - (-total).exp() } else { 0.0 };
            let colors = [[1.0, 0.5, 0.1], [0.0, 0.0, 2.0]];
            let mixed = [0, 1, 2].map(|k| (0..2).map(|w| colors[w][k] * depths[w] / total).sum::<f64>());
            let found = picture.pixel(i, j).map(f64::from);
            let expected = [mixed[0] * opacity, mixed[1] * opacity, mixed[2] * opacity, opacity];
            // Pictures are of 32 bits; the gradient is found to 1e-12.
            let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-6, "{found:?} for {expected:?} at {y}, {z}");
        }
    }
}

#[test]
fn an_oblique_plane_is_faced_by_the_camera() {
    let view = "direction = [1, 2, -0.5]\nheight = \"auto\"\ninputs = { volume = \"grid\" }";
    let slice = "normal = [1, 2, -0.5]\ncolor_by = \"g\"\nrange = [0, 10]";
    let (picture, _) = made(slice, view, "").unwrap();
    let seen = picture.rgba.iter().filter(|pixel| pixel[3] == 1.0).count();
    assert!(seen > 900, "{seen}");
    // g is the same everywhere.
    let colors = picture.rgba.iter().filter(|pixel| pixel[3] == 1.0);
    let first = picture.pixel(30, 30);
    assert!(colors.flat_map(|pixel| pixel.iter().zip(first)).all(|(a, b)| (a - b).abs() < 1e-6));
}

#[test]
fn what_is_wrong_or_empty_is_said() {
    let (picture, report) = made("origin = [8, 0, 0]", STRAIGHT, "").unwrap();
    assert!(picture.rgba.iter().all(|pixel| *pixel == [0.0; 4]));
    let said = "slice: the slice is empty: no cell reaches the plane: points lie from -8.0 to -3.0 of it";
    assert_eq!(report.warnings, [said]);
    let plain = "eye = [9, 2.5, 2.5]\ntarget = [0, 2.5, 2.5]";
    for (slice, view, looks, said) in [
        ("", plain, "", "drawn by parallel rays"),
        ("normal = [0, 0, 1]", STRAIGHT, "", "looks along the plane"),
        ("normal = [0, 0, 0]", STRAIGHT, "", "no direction"),
        ("range = [2, 1]", STRAIGHT, "", "the range is empty"),
        ("thickness = 1.0", STRAIGHT, "", "a colour map has no thickness"),
        ("thickness = 0.0", STRAIGHT, LOOK, "'thickness' is out of range"),
        ("color_by = \"g\"", STRAIGHT, LOOK, "exclude each other"),
        ("color_by = \"temperature\"", STRAIGHT, "", "'temperature'"),
        ("", "direction = [0, 0, 0]", "", "the direction has no length"),
        ("", "direction = [0, 0, 1]\nview = \"+x\"", "", "exclude each other"),
        ("", "direction = [0, 0, 1]\neye = [1, 2, 3]", "", "'direction' and 'eye' exclude each other"),
        ("", "direction = [0, 0, 1]", "", "no data are wired in"),
    ] {
        let error = made(slice, view, looks).expect_err(slice).to_string();
        assert!(error.contains(said), "{slice} {view}: {error}");
    }
}
