//! What `annotation` writes over a picture: colours read back from it, names, and errors.

use super::graph;
use super::relative::series;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::colormap::Colormap;
use voltet_core::picture::Picture;
use voltet_graph::{NoObserver, RunReport};

const VIRIDIS: &str = "kind = \"colormap\"\nextinction = 1.0\nrange = [100.0, 200.0]";

const ALL: &str = "transfer_function = \"look\", volume = \"gradient\", camera = \"view\"";

/// The run of a pipeline with these parameters and wires of the annotation, and this widget.
fn run_in(
    folder: &Path,
    grid: &str,
    camera: &str,
    widget: &str,
    lines: &str,
    wires: &str,
) -> Result<RunReport> {
    let text = format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\n{grid}\n\
         [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid\" }}\n\
         [nodes.look]\ntype = \"transfer-function\"\n[[nodes.look.widgets]]\n{widget}\n\
         [nodes.view]\ntype = \"camera\"\n{camera}\n\
         [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
         inputs = {{ volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}\n\
         [nodes.figure]\ntype = \"annotation\"\n{lines}\ninputs = {{ image = \"picture\", {wires} }}\n\
         [nodes.file]\ntype = \"image-writer\"\npath = \"figure.png\"\ninputs = {{ image = \"figure\" }}\n"
    );
    voltet_nodes::session().run(&graph(&text, folder)?, &NoObserver)
}

const WAVELET: &str = "type = \"wavelet\"\nresolution = [4, 4, 4]";

/// Seen from where the data are not in the picture.
const AWAY: &str = "eye = [100, 0, 0]\ntarget = [200, 0, 0]\nsize = [400, 300]";

fn run(camera: &str, widget: &str, lines: &str, wires: &str) -> Result<RunReport> {
    run_in(tempfile::tempdir().unwrap().path(), WAVELET, camera, widget, lines, wires)
}

fn figure(report: &RunReport) -> Arc<Picture> {
    report.pictures.iter().find(|(node, _)| node == "figure").unwrap().1.clone()
}

/// Colours from the top of a bar to its bottom: its middle column, between the lines of its frame.
fn bar(picture: &Picture) -> Vec<[f32; 4]> {
    // The frame's lines are grey and the background is clear.
    let is_coloured = |pixel: [f32; 4]| pixel[3] > 0.999 && (pixel[0] - pixel[2]).abs() > 0.02;
    let count =
        |column: &usize| (0..picture.height).filter(|row| is_coloured(picture.pixel(*column, *row))).count();
    let columns: Vec<usize> = (0..picture.width).filter(|column| count(column) > 20).collect();
    let middle = columns[columns.len() / 2];
    (0..picture.height).map(|row| picture.pixel(middle, row)).filter(|pixel| is_coloured(*pixel)).collect()
}

#[test]
fn a_bar_has_the_colours_of_the_map() {
    for (lines, wires) in
        [("", ALL), ("theme = \"light\"\nbar = \"left\"\nscale = 0.7", "transfer_function = \"look\"")]
    {
        let found = bar(&figure(&run(AWAY, VIRIDIS, lines, wires).unwrap()));
        assert!(found.len() > 100, "{}", found.len());
        // The first row and the last lie half below the frame.
        for (row, pixel) in found.iter().enumerate().skip(1).take(found.len() - 2) {
            let level = 1.0 - (row as f64 + 0.5) / found.len() as f64;
            let wanted = Colormap::Viridis.color(level);
            // A row at an end that is hidden moves each value by less than a hundredth of the map.
            let off = (0..3).map(|k| (f64::from(pixel[k]) - wanted[k]).abs()).fold(0.0, f64::max);
            assert!(off < 0.03, "{level}: {pixel:?}, {wanted:?}");
        }
    }
}

#[test]
fn a_stated_range_and_widgets_without_ends_are_shown() {
    // Half of the bar is beyond the map, which keeps its last colour.
    let found = bar(&figure(&run(AWAY, VIRIDIS, "bar_range = [150, 250]", ALL).unwrap()));
    let top = Colormap::Viridis.color(1.0);
    let at = |share: f64| found[(share * found.len() as f64) as usize];
    assert!((0..3).all(|k| (f64::from(at(0.3)[k]) - top[k]).abs() < 1e-3), "{:?}", at(0.3));
    let band = "kind = \"uniform\"\ncolor = [1, 0, 0]\nextinction = 1\nregion = { s = [100, 150] }";
    let found = bar(&figure(&run(AWAY, band, "bar_range = [50, 250]", ALL).unwrap()));
    // A quarter of the bar is in the band, and the rest is clear.
    let whole = bar(&figure(&run(AWAY, band, "bar_range = [100, 150]", ALL).unwrap()));
    assert!(found.iter().all(|pixel| *pixel == [1.0, 0.0, 0.0, 1.0]), "{found:?}");
    assert!((found.len() as f64 / whole.len() as f64 - 0.25).abs() < 0.02, "{} {}", found.len(), whole.len());
}

/// Columns of a level bar from left to right: its middle row.
#[test]
fn a_level_bar_has_the_colours_of_the_map() {
    for place in ["bottom", "top"] {
        let lines = format!("bar = \"{place}\"\ntitle = \"of the middle\"");
        let report = run(AWAY, VIRIDIS, &lines, ALL).unwrap();
        assert!(!report.warnings.iter().any(|warning| warning.contains("no room")), "{:?}", report.warnings);
        let figure = figure(&report);
        let is_coloured = |pixel: &[f32; 4]| pixel[3] > 0.999 && (pixel[0] - pixel[2]).abs() > 0.02;
        let rows = figure.rgba.chunks(figure.width);
        let rows: Vec<(usize, Vec<[f32; 4]>)> = rows
            .map(|row| row.iter().copied().filter(is_coloured).collect::<Vec<_>>())
            .enumerate()
            .filter(|(_, found)| found.len() > 100)
            .collect();
        let (middle, found) = &rows[rows.len() / 2];
        assert_eq!(*middle > figure.height / 2, place == "bottom");
        // The first column and the last lie half below the frame.
        for (column, pixel) in found.iter().enumerate().skip(1).take(found.len() - 2) {
            let level = (column as f64 + 0.5) / found.len() as f64;
            let wanted = Colormap::Viridis.color(level);
            // A column at an end that is hidden moves each value by less than a hundredth of the map.
            let off = (0..3).map(|k| (f64::from(pixel[k]) - wanted[k]).abs()).fold(0.0, f64::max);
            assert!(off < 0.03, "{level}: {pixel:?}, {wanted:?}");
        }
    }
}

#[test]
fn the_unit_of_the_file_stands_at_the_bar() {
    let grid = |unit: &str| {
        format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>\
             <DataArray type=\"Float64\" Name=\"p\" format=\"ascii\">100 120 150 200 {unit}</DataArray></PointData><Points>\
             <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\
             <Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray><DataArray \
             type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" \
             format=\"ascii\">10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
        )
    };
    let folder = tempfile::tempdir().unwrap();
    let key = "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">kPa</InformationKey>";
    std::fs::write(folder.path().join("with.vtu"), grid(key)).unwrap();
    std::fs::write(folder.path().join("without.vtu"), grid("")).unwrap();
    let picture = |name: &str, lines: &str| {
        let reader = format!("type = \"reader\"\npath = \"{name}.vtu\"");
        figure(&run_in(folder.path(), &reader, AWAY, VIRIDIS, lines, ALL).unwrap()).rgba.clone()
    };
    let stated = picture("without", "unit = \"kPa\"");
    assert!(picture("with", "") == stated);
    assert!(picture("without", "") != stated);
    assert!(picture("with", "unit = \"bar\"") == picture("without", "unit = \"bar\""));
}

/// Premultiplied: no colour is above its opacity. What is not written over stays.
#[test]
fn letters_are_composited_over_the_picture() {
    let widget =
        "kind = \"gaussian\"\ncolor = [0.2, 1, 0.4]\nextinction = 0.2\ncentre = [150, 20]\nsigma = [60, 40]";
    for size in ["[400, 300]", "[3840, 2160]"] {
        let camera = format!(
            "view = \"isometric\"\nheight = \"auto\"\nzoom = 0.75\nsize = {size}\ninputs = {{ volume = \"grid\" }}"
        );
        let lines = "title = \"{scalar}\"\ntext = \"of the middle\"\naxes = \"box\"\nscale_bar = true\nunit = \"K\"\nlength_unit = \"m\"";
        let report = run(&camera, widget, lines, ALL).unwrap();
        assert_eq!(report.warnings, Vec::<String>::new(), "{size}");
        let figure = figure(&report);
        let is_sound = |pixel: &[f32; 4]| {
            pixel.iter().all(|x| (0.0..=pixel[3] + 1e-5).contains(x)) && pixel[3] <= 1.0 + 1e-5
        };
        assert!(figure.rgba.iter().all(is_sound));
        let picture = &report.pictures.iter().find(|(node, _)| node == "picture").unwrap().1;
        let kept = figure.rgba.iter().zip(&picture.rgba).filter(|(a, b)| a == b).count();
        let share = kept as f64 / figure.rgba.len() as f64;
        assert!((0.5..0.99).contains(&share), "{share}");
        let border = |k: usize| k.is_multiple_of(figure.width) || k < figure.width;
        assert!((0..figure.rgba.len()).filter(|k| border(*k)).all(|k| figure.rgba[k] == picture.rgba[k]));
    }
}

#[test]
fn a_gradient_is_computed_for_a_plane_alone() {
    let computed = |widget: &str, lines: &str| {
        let report = run(AWAY, widget, lines, ALL).unwrap();
        report.counts.get("gradients_computed").copied().unwrap_or(0)
    };
    assert_eq!(computed(VIRIDIS, "axes = \"box\""), 0);
    assert_eq!(
        computed(
            "kind = \"triangular-gaussian\"\ncolor = [1, 0, 0]\nextinction = 1\ncentre = 150\nsigma = 0.3",
            ""
        ),
        1
    );
}

#[test]
fn names_in_braces_stand_for_the_data() {
    let folder = tempfile::tempdir().unwrap();
    series(folder.path());
    let grid = "type = \"reader\"\npath = \"all.pvd\"\nscalar = \"a\"\ntime_step = 2";
    let drawn = |title: &str| {
        let report =
            run_in(folder.path(), grid, AWAY, VIRIDIS, &format!("bar = \"none\"\ntitle = \"{title}\""), ALL);
        figure(&report.unwrap())
    };
    assert_eq!(drawn("{file}: {scalar} at {time} s"), drawn("all.pvd: a at 2 s"));
    assert_ne!(drawn("{time}"), drawn("1"));
    let error = run(AWAY, VIRIDIS, "title = \"{time}\"", ALL).unwrap_err().to_string();
    assert!(error.contains("the time of the data is not known"), "{error}");
}

#[test]
fn what_cannot_be_shown_is_an_error_that_says_what_would_be_right() {
    let nd = "kind = \"gaussian-nd\"\ncolor = [1, 1, 1]\nextinction = 1\nfields = [\"b\"]\ncentre = [0]\nsigma = [1]";
    let on_plane =
        "kind = \"triangular-gaussian\"\ncolor = [1, 0, 0]\nextinction = 1\ncentre = 150\nsigma = 0.3";
    let endless = "kind = \"uniform\"\ncolor = [1, 0, 0]\nextinction = 1\nregion = { s = [100, inf] }";
    let only = |port: &str, node: &str| format!("{port} = \"{node}\"");
    for (widget, lines, wires, wanted) in [
        (VIRIDIS, "title = \"{tim}\"", ALL.to_string(), "{time}, {file} or {scalar}"),
        (VIRIDIS, "bar_range = [2, 1]", ALL.into(), "the smaller number first"),
        (VIRIDIS, "axes = \"box\"", only("camera", "view"), "'axes' needs the input 'volume'"),
        (VIRIDIS, "axes = \"directions\"", only("volume", "grid"), "'axes' needs the input 'camera'"),
        (VIRIDIS, "bar = \"left\"", only("volume", "grid"), "'bar' needs the input 'transfer_function'"),
        (VIRIDIS, "title = \"{scalar}\"", only("camera", "view"), "'title' needs the input 'volume'"),
        (VIRIDIS, "scale_bar = true", ALL.into(), "height in place of fov_y at the camera"),
        (on_plane, "", only("transfer_function", "look"), "a node of type \"gradient-magnitude\""),
        (endless, "", only("transfer_function", "look"), "bar_range = [low, high]"),
        (nd, "", only("transfer_function", "look"), "bar = \"none\""),
    ] {
        let error = run(AWAY, widget, lines, &wires).unwrap_err().to_string();
        assert!(error.contains(wanted), "{lines} {wires}: {error}");
    }
}

#[test]
fn what_has_no_room_and_letters_that_lack_are_warnings() {
    let small = AWAY.replace("[400, 300]", "[60, 40]");
    let report =
        run(&small, VIRIDIS, "title = \"A title that is long\"\naxes = \"directions\"", ALL).unwrap();
    let warning = report.warnings.join("\n");
    for part in ["60 × 40", "the title", "the scale of the colours", "the directions"] {
        assert!(warning.contains(part), "{part}: {warning}");
    }
    let report = run(AWAY, VIRIDIS, "title = \"T 温\"", ALL).unwrap();
    assert!(report.warnings.join("\n").contains("no letters '温'"), "{:?}", report.warnings);
}
