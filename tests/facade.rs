//! The library's front: its pictures are those of pipelines, bit for bit, and data are in the caller's numbering.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use voltet::graph::{Demand, NoObserver};
use voltet::optics::engine::Compositor;
use voltet::prelude::*;
use voltet::{Error, RendererOptions};

/// Points, cell types, offsets, connectivity and values.
type Arrays = (Vec<[f64; 3]>, Vec<u8>, Vec<i64>, Vec<u32>, Vec<f64>);

/// Two hexahedra above each other and a point that no cell uses between their points, with s = x + 2 y² + z³.
fn arrays() -> Arrays {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for z in [0.0, 0.8, 2.0] {
        points.extend([[0.0, 0.0, z], [1.0, 0.1, z], [1.2, 1.0, z], [0.0, 1.1, z]]);
        if z == 0.8 {
            points.push([50.0, 50.0, 50.0]);
        }
    }
    let values = points.iter().map(|[x, y, z]| x + 2.0 * y * y + z * z * z).collect();
    let connectivity = vec![0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 9, 10, 11, 12];
    (points, vec![12, 12], vec![0, 8, 16], connectivity, values)
}

fn grid() -> Grid {
    let (points, types, offsets, connectivity, values) = arrays();
    Grid::from_vtk_arrays(points, &types, &offsets, &connectivity).unwrap().point_data("s", values).unwrap()
}

/// A pipeline with these widgets and keys of its renderer; its grid is that of a file, or is given.
fn pipeline(path: Option<&str>, widgets: &str, renderer: &str, [low, high]: [[f64; 3]; 2]) -> String {
    let source = match path {
        Some(path) => format!("type = \"reader\"\npath = '{path}'\n"),
        None => "type = \"given-grid\"\n".into(),
    };
    format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\n{source}scalar = \"s\"\n\
         [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid\" }}\n\
         [nodes.look]\ntype = \"transfer-function\"\n{widgets}\n\
         [nodes.view]\ntype = \"camera\"\neye = {low:?}\ntarget = {high:?}\nfov_y = 40.0\nsize = [48, 36]\n\
         [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n{renderer}\n\
         inputs = {{ volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}\n"
    )
}

fn scene(volume: Volume, transfer_function: TransferFunction, [eye, target]: [[f64; 3]; 2]) -> Scene {
    Scene::new(volume, transfer_function, Camera::look_at(eye, target).fov_y(40.0).size(48, 36))
}

#[test]
fn a_picture_of_arrays_is_that_of_the_pipeline() -> Result<()> {
    let view = [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]];
    let widgets = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [2.0, 3.0]\nsigma = [0.7, 2.5]\n\
                   color = [1.0, 0.48, 0.06]\nextinction = 9.0\n\
                   [[nodes.look.widgets]]\nkind = \"triangle-wave\"\nperiod = 1.5\nangle = 20.0\nband_width = 0.4\n\
                   color = [0.1, 0.3, 1.0]\nextinction = 2.0\n\
                   [[nodes.look.widgets]]\nkind = \"piecewise-linear\"\n\
                   points = [[0.0, 0.0, 1.0, 0.0, 0.0], [4.0, 0.5, 1.0, 0.0, 1.5]]\n";
    let transfer_function = TransferFunction::new()
        .with(Gaussian::at(2.0, 3.0).sigma(0.7, 2.5).color([1.0, 0.48, 0.06]).extinction(9.0))
        .with(Band::triangle(1.5).angle(20.0).width(0.4).color([0.1, 0.3, 1.0]).extinction(2.0))
        .with(Piecewise::new().point(0.0, [0.0, 1.0, 0.0], 0.0).point(4.0, [0.5, 1.0, 0.0], 1.5));
    let mut lit = Shading::default();
    lit.silhouette = Some(0.5);
    lit.light = Some(Light { direction: [1.0, -2.0, 0.5].into(), ambient: 0.3, diffuse: 0.7 });
    let light = "silhouette = 0.5\nlight = { direction = [1.0, -2.0, 0.5] }\n";
    let renderer = Renderer::on(Engine::Cpu)?;
    let plain = scene(Volume::new(grid(), "s")?, transfer_function, view);
    for (scene, keys) in [(plain.clone(), ""), (plain.shading(lit), light)] {
        let mut pipeline =
            Pipeline::parse(&pipeline(None, widgets, keys, view), "")?.with_grid("grid", grid())?;
        let expected = pipeline.render("picture")?;
        assert!(expected.pixels().iter().any(|pixel| pixel[3] > 0.1));
        // Twice: the second picture is one of a volume that is prepared.
        for _ in 0..2 {
            assert_eq!(renderer.render(&scene)?, expected);
        }
        let mut options = RenderOptions::default();
        options.exhaustive = true;
        // Cells that add next to nothing change the last bits of 32.
        let exhaustive = renderer.render_with(&scene, &options)?.image;
        let pairs = exhaustive.pixels().as_flattened().iter().zip(expected.pixels().as_flattened());
        assert!(pairs.fold(0.0, |worst: f32, (a, b)| worst.max((a - b).abs())) < 1e-6);
        options.exhaustive = false;
        let depths = vec![f32::INFINITY; 48 * 36];
        options.depth_limit = Some(&depths);
        assert_eq!(renderer.render_with(&scene, &options)?.image, expected);
    }
    Ok(())
}

/// Two colours need an exact order, which is not blended: the picture is that of tiles, and a warning says so.
#[test]
fn a_compositor_that_does_not_make_the_order_is_warned_of() -> Result<()> {
    let mut options = RendererOptions::default();
    (options.engine, options.adapter) = (Engine::Gpu, Some("software".into()));
    let renderer = match Renderer::with(options) {
        Ok(renderer) => renderer,
        Err(why) => {
            voltet_testing::skipped_without_device(why);
            return Ok(());
        }
    };
    let transfer_function = TransferFunction::new()
        .with(Gaussian::at(2.0, 3.0).sigma(0.7, 2.5).color([1.0, 0.48, 0.06]).extinction(9.0))
        .with(Band::triangle(1.5).angle(20.0).width(0.4).color([0.1, 0.3, 1.0]).extinction(2.0));
    let scene = scene(Volume::new(grid(), "s")?, transfer_function, [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]]);
    let mut options = RenderOptions::default();
    let tiles = renderer.render_with(&scene, &options)?;
    options.compositor = Some(Compositor::Raster);
    let instead = renderer.render_with(&scene, &options)?;
    assert_eq!(instead.image, tiles.image);
    assert!(tiles.warnings.is_empty(), "{:?}", tiles.warnings);
    assert!(
        matches!(&instead.warnings[..], [said] if said.contains("drawn by tiles")),
        "{:?}",
        instead.warnings
    );
    Ok(())
}

#[test]
fn a_picture_of_a_file_is_that_of_the_pipeline() -> Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/lab/testing/files/every_type.vtu");
    let widgets = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [40.0, 0.0]\nsigma = [20.0, inf]\nextinction = 0.5\n\
                   color = [1.0, 1.0, 1.0]\n";
    let transfer_function =
        TransferFunction::new().with(Gaussian::at(40.0, 0.0).sigma(20.0, f64::INFINITY).extinction(0.5));
    let volume = Volume::new(Grid::read(path)?, "s")?;
    let [low, high] = volume.bounds();
    let target = 0.5 * (low + high);
    let view = [(target + 1.5 * (high - low)).to_array(), target.to_array()];
    let expected = Pipeline::parse(&pipeline(Some(path), widgets, "", view), "")?.render("picture")?;
    assert!(expected.pixels().iter().any(|pixel| pixel[3] > 0.1));
    assert_eq!(Renderer::on(Engine::Cpu)?.render(&scene(volume, transfer_function, view))?, expected);
    Ok(())
}

#[test]
fn auto_renders_on_a_machine_without_a_device_and_threads_change_no_bit() -> Result<()> {
    let view = [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]];
    let volume = Volume::new(grid(), "s")?;
    let transfer_function = TransferFunction::ramp(Colormap::Viridis, volume.range(), 3.0);
    let scene = scene(volume, transfer_function, view);
    let mut options = RendererOptions::default();
    options.engine = Engine::Cpu;
    options.threads = Some(1);
    let one = Renderer::with(options)?.render(&scene)?;
    assert_eq!(Renderer::on(Engine::Cpu)?.render(&scene)?, one);
    assert_eq!(Renderer::new()?.render(&scene)?.pixels().len(), one.pixels().len());
    Ok(())
}

#[test]
fn an_image_is_saved_by_its_ending() -> Result<()> {
    let view = [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]];
    let volume = Volume::new(grid(), "s")?;
    let transfer_function = TransferFunction::ramp(Colormap::Viridis, volume.range(), 3.0);
    let image = Renderer::on(Engine::Cpu)?.render(&scene(volume, transfer_function, view))?;
    let folder = tempfile::tempdir().unwrap();
    let [png, exr, other] = ["a.png", "a.EXR", "a.gif"].map(|name| folder.path().join(name));
    image.save(&png)?;
    image.save(&exr)?;
    let read = image::open(&png).unwrap().into_rgb8();
    assert_eq!(read.as_raw()[..], image.srgb8([0.0; 3]).concat());
    let read = image::load_from_memory(&std::fs::read(&exr).unwrap()).unwrap().into_rgba32f();
    assert_eq!(read.as_raw()[..], image.pixels().concat());
    assert!(image.save(&other).unwrap_err().to_string().contains(".png or .exr"));
    Ok(())
}

#[test]
fn what_does_not_fit_is_refused_where_it_is_given() {
    let (points, types, offsets, connectivity, values) = arrays();
    let refused = |outcome: Result<Grid>, message: &str| {
        let error: Error = outcome.unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    };
    refused(Grid::from_vtk_arrays(points[..5].to_vec(), &types, &offsets, &connectivity), "does not exist");
    refused(Grid::from_vtk_arrays(points.clone(), &types, &[0, 8], &connectivity), "offsets");
    refused(Grid::from_vtk_arrays(points.clone(), &types, &[0, 9, 8], &connectivity), "offsets[2]");
    refused(grid().point_data("t", values[1..].to_vec()), "wrong number of values");
    refused(grid().cell_data("s", vec![0.0; 2]), "the same name");
    refused(grid().ghost_cells(vec![1]), "ghost flags");
    refused(Grid::read("no such file.vtu"), "no such file.vtu");
    for name in ["t", "s:magnitude:0"] {
        Volume::new(grid(), name).unwrap_err();
    }
    let scene = Scene::new(
        Volume::new(grid(), "s").unwrap(),
        TransferFunction::new().with(Gaussian::at(0.0, 0.0).extinction(f64::NAN)),
        Camera::look_at([0.0, 0.0, 5.0], [0.0; 3]),
    );
    let error = Renderer::on(Engine::Cpu).unwrap().render(&scene).unwrap_err();
    assert!(error.to_string().contains("widgets[0]"), "{error}");
}

#[test]
fn a_pipeline_is_changed_and_run() -> Result<()> {
    let view = [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]];
    let widgets = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [2.0, 0.0]\nsigma = [0.7, inf]\ncolor = [1.0, 0.5, 0.0]\n\
                   extinction = 9.0\n";
    let mut pipeline = Pipeline::parse(&pipeline(None, widgets, "", view), "")?.with_grid("grid", grid())?;
    let camera = Camera::framing([[0.0; 3].into(), [1.2, 1.1, 2.0].into()]).size(20, 10);
    pipeline.set_camera(None, &camera)?;
    assert_eq!(pipeline.render_plan(Some("picture"))?.size, [20, 10]);
    let image = pipeline.render("picture")?;
    // Angles and zoom are the former camera's.
    pipeline.set("view.azimuth=30")?;
    assert_ne!(pipeline.render("picture")?, image);
    pipeline.set_camera(None, &camera)?;
    assert_eq!(pipeline.render("picture")?, image);
    assert_eq!([image.width(), image.height()], [20, 10]);
    assert_eq!(pipeline.run(&NoObserver)?, [("picture".to_string(), image)]);
    assert!(pipeline.report().unwrap().contains("given-grid"));
    assert!(pipeline.set("look.model=constant").is_err());
    pipeline.set("picture.silhouette=1")?;
    Ok(())
}

/// Unnamed, a picture is the one that no other node writes over; of two that stand side by side one must be named.
#[test]
fn the_picture_that_is_not_named_is_the_last() {
    let annotated = std::fs::read_to_string("pipelines/annotated.toml").unwrap();
    let histogram = "[nodes.distribution]\ntype = \"histogram\"\ninputs = { volume = \"grid\" }\n";
    let node = |text: &str| Pipeline::parse(text, "pipelines").unwrap().picture_node(None);
    assert_eq!(node(&annotated).unwrap(), "figure");
    assert_eq!(
        node(&annotated.replace("image = \"picture\",", "image = \"picture.image\",")).unwrap(),
        "figure"
    );
    let error = node(&format!("{annotated}\n{histogram}")).unwrap_err().to_string();
    assert!(error.contains("several nodes that give a picture") && error.contains("figure"), "{error}");
}

/// A value that is not finite leaves cells out where its array is requested, and nowhere else, in whichever order pictures are drawn.
#[test]
fn values_that_are_not_requested_leave_nothing_out() -> Result<()> {
    let view = [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]];
    let widgets = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [2.0, 0.0]\nsigma = [0.7, inf]\ncolor = [1.0, 0.5, 0.0]\n\
                   extinction = 9.0\n";
    let of_mask = "[[nodes.look.widgets]]\nkind = \"gaussian-nd\"\nfields = [\"mask\"]\ncentre = [1.0]\nsigma = [9.0]\n\
                   color = [1.0, 0.5, 0.0]\nextinction = 9.0\n";
    let masked = |first: f64| {
        let mut values = vec![1.0; 13];
        values[0] = first;
        grid().point_data("mask", values)
    };
    let drawn = |widgets: &str, grid: Grid| {
        let text = pipeline(None, widgets, "", view);
        Pipeline::parse(&text, "")?.with_grid("grid", grid)?.render("picture")
    };
    let plain = drawn(widgets, grid())?;
    let gaps = drawn(of_mask, masked(f64::NAN)?)?;
    assert_ne!(gaps, drawn(of_mask, masked(1.0)?)?);
    let mut both =
        Pipeline::parse(&pipeline(None, widgets, "", view), "")?.with_grid("grid", masked(f64::NAN)?)?;
    let text = |widgets: &str| widgets.replace("[[nodes.look.widgets]]", "[[widgets]]");
    for (widgets, expected) in [(widgets, &plain), (of_mask, &gaps), (widgets, &plain)] {
        both.set_node("look", &text(widgets))?;
        assert!(both.render("picture")? == *expected, "{widgets}");
        assert_eq!(both.warnings().unwrap().iter().any(|text| text.contains("finite")), *expected == gaps);
    }
    Ok(())
}

/// Points of two pieces are one where the arrays of a picture are equal, whatever jumps between the pieces beside them.
#[test]
fn an_array_that_is_not_requested_parts_no_points() -> Result<()> {
    let view = [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]];
    let widgets = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [2.0, 3.0]\nsigma = [0.7, 2.5]\n\
                   color = [1.0, 0.5, 0.0]\nextinction = 9.0\n";
    let (points, _, _, connectivity, values) = arrays();
    let piece = |corners: &[u32], rank: Option<f64>| {
        let corners = corners.iter().map(|corner| *corner as usize);
        let own: Vec<[f64; 3]> = corners.clone().map(|corner| points[corner]).collect();
        let s: Vec<f64> = corners.map(|corner| values[corner]).collect();
        let grid =
            Grid::from_vtk_arrays(own, &[12], &[0, 8], &[0, 1, 2, 3, 4, 5, 6, 7])?.point_data("s", s)?;
        rank.map_or(Ok(grid.clone()), |rank| grid.point_data("rank", vec![rank; 8]))
    };
    let drawn = |ranks: [Option<f64>; 2]| {
        let (below, above) = connectivity.split_at(8);
        let grid = Grid::from_pieces([piece(below, ranks[0])?, piece(above, ranks[1])?])?;
        Pipeline::parse(&pipeline(None, widgets, "", view), "")?.with_grid("grid", grid)?.render("picture")
    };
    let plain = Pipeline::parse(&pipeline(None, widgets, "", view), "")?.with_grid("grid", grid())?;
    assert!(drawn([None; 2])? == { plain }.render("picture")?);
    assert!(drawn([Some(0.0), Some(1.0)])? == drawn([None; 2])?);
    // Pieces that do not fit together are an error, whatever is not finite in the array that one lacks.
    for rank in [1.0, f64::NAN] {
        let error = drawn([Some(rank), None]).unwrap_err().to_string();
        assert!(error.contains("lacks the array 'rank'"), "{error}");
    }
    Ok(())
}

#[test]
fn a_node_that_is_none_is_named() -> Result<()> {
    let view = [[-3.0, -2.5, 3.0], [0.5, 0.5, 1.0]];
    let mut pipeline = Pipeline::parse(&pipeline(None, "", "", view), "")?.with_grid("grid", grid())?;
    let error =
        pipeline.value(("nosuch", "volume"), &Demand::default(), &NoObserver).err().unwrap().to_string();
    assert!(
        error.contains("no node 'nosuch'") && error.contains("gradient") && !error.contains("program"),
        "{error}"
    );
    Ok(())
}
