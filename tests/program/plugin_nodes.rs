//! A format, grid filters and an image filter of plug-ins, as their users meet them: the examples in C, held against what ships.

use crate::support::{Folder, SLAB};
use std::path::Path;
use voltet_testing::compilers;

const SCENE: &str = include_str!("../../examples/plugin_c/nodes.toml");
const WITH: [&str; 4] = ["--plugin", "reader.so", "--plugin", "filters.so"];

/// A folder with the examples, compiled, and a small picture of their pipeline; `None` where there is no compiler.
fn folder() -> Option<Folder> {
    let folder = Folder::new();
    for name in ["reader", "filters"] {
        let source = compilers::source(&format!("examples/plugin_c/{name}.c"));
        compilers::library(folder.path(), &format!("{name}.so"), &[source], &["-lm"])?;
    }
    std::fs::copy(compilers::source("examples/plugin_c/box.cells"), folder.join("box.cells")).unwrap();
    let scene = SCENE.replace("[320, 320]", "[40, 40]").replace("nodes.png", "nodes.exr");
    folder.write("scene.toml", scene.replace("type = \"renderer\"", "type = \"renderer\"\nengine = \"cpu\""));
    Some(folder)
}

/// The picture of the scene with these options; premultiplied linear RGBA.
fn picture(folder: &Folder, options: &[&str]) -> Vec<[f32; 4]> {
    let set = options.iter().flat_map(|option| ["--set", option]);
    let arguments: Vec<&str> = ["run", "scene.toml"].into_iter().chain(WITH).chain(set).collect();
    folder.voltet(&arguments).ok();
    folder.floats("nodes.exr").1
}

/// The numbers of the example file: points, cells, and of a step heat, motion and material.
struct Numbers {
    points: Vec<[f64; 3]>,
    cells: Vec<[usize; 8]>,
    heat: Vec<f64>,
    motion: Vec<[f64; 3]>,
    material: Vec<f64>,
}

fn numbers(path: &Path, step: usize) -> Numbers {
    let text = std::fs::read_to_string(path).unwrap();
    let body = text.split_once("material cells 1\n").unwrap().1;
    let mut all = body.split_whitespace().map(|word| word.parse::<f64>().unwrap());
    let mut next = || all.next().unwrap();
    let triples = |next: &mut dyn FnMut() -> f64| (0..125).map(|_| [next(), next(), next()]).collect();
    let points = triples(&mut next);
    let cell = |next: &mut dyn FnMut() -> f64| {
        assert_eq!((next(), next()), (12.0, 8.0));
        std::array::from_fn(|_| next() as usize)
    };
    let cells = (0..64).map(|_| cell(&mut next)).collect();
    let of_step = |next: &mut dyn FnMut() -> f64| {
        let heat: Vec<f64> = (0..125).map(|_| next()).collect();
        (heat, triples(next), (0..64).map(|_| next()).collect::<Vec<f64>>())
    };
    (0..step).for_each(|_| drop(of_step(&mut next)));
    let (heat, motion, material) = of_step(&mut next);
    Numbers { points, cells, heat, motion, material }
}

/// Numbers as a legacy VTK file.
fn vtk(numbers: &Numbers) -> String {
    let Numbers { points, cells, heat, motion, material } = numbers;
    let rows = |rows: &[[f64; 3]]| rows.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect::<String>();
    let list = |values: &[f64]| values.iter().map(|value| format!("{value}\n")).collect::<String>();
    let cell = |cell: &[usize; 8]| format!("8 {}\n", cell.map(|point| point.to_string()).join(" "));
    format!(
        "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 125 double\n{}CELLS 64 576\n{}CELL_TYPES \
         64\n{}POINT_DATA 125\nSCALARS heat double 1\nLOOKUP_TABLE default\n{}VECTORS motion double\n{}CELL_DATA 64\nSCALARS \
         material double 1\nLOOKUP_TABLE default\n{}",
        rows(points),
        cells.iter().map(cell).collect::<String>(),
        "12\n".repeat(64),
        list(heat),
        rows(motion),
        list(material)
    )
}

/// The scene without the filters, by the reader that ships.
fn plain(folder: &Folder, numbers: &Numbers) -> String {
    folder.write("box.vtk", vtk(numbers));
    let scene = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    let scene = scene
        .replace("type = \"simple-cells\"\npath = \"box.cells\"", "type = \"reader\"\npath = \"box.vtk\"");
    let scene = scene.replace("\ntime = 0.5", "").replace("volume = \"moved\"", "volume = \"grid\"");
    scene.replace("image = \"toned\"", "image = \"picture\"")
}

#[test]
fn a_format_of_ones_own_is_read_as_one_that_ships() {
    let Some(folder) = folder() else { return };
    let numbers = numbers(&folder.join("box.cells"), 1);
    folder.write("plain.toml", without_filters(&plain(&folder, &numbers)));
    let own = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    let own = own
        .replace("volume = \"moved\"", "volume = \"grid\"")
        .replace("image = \"toned\"", "image = \"picture\"");
    folder.write("own.toml", without_filters(&own));
    for options in [
        &[][..],
        &["grid.association=cell", "grid.scalar=material"],
        &["grid.scalar=material", "grid.cell_values=constant"],
        &["grid.scalar=motion:magnitude"],
    ] {
        let set: Vec<&str> = options.iter().flat_map(|option| ["--set", option]).collect();
        folder.voltet(&[&["run", "plain.toml"], &set[..]].concat()).ok();
        let wanted = folder.floats("nodes.exr").1;
        assert!(wanted.iter().any(|pixel| pixel[3] > 0.01), "the picture shows something");
        for own_process in [&[][..], &["--plugin-process"]] {
            folder.voltet(&[&["run", "own.toml"], &WITH[..], &set, own_process].concat()).ok();
            assert!(folder.floats("nodes.exr").1 == wanted, "{options:?} {own_process:?}");
        }
    }
    // Another step is another picture, by its number or its time; the parameter of its own is heard.
    let of = |options: &[&str]| {
        let set: Vec<&str> = options.iter().flat_map(|option| ["--set", option]).collect();
        folder.voltet(&[&["run", "own.toml"], &WITH[..], &set].concat()).ok();
        folder.floats("nodes.exr").1
    };
    let first = of(&["grid.time=0.1"]);
    assert!(first != of(&[]) && first != of(&["grid.time=0.1", "grid.scale=1.5"]));
    let fails = |option: &str, wanted: &[&str]| {
        folder.voltet(&[&["run", "own.toml"], &WITH[..], &["--set", option]].concat()).fails(1, wanted);
    };
    fails("grid.time=0.6", &["the time lies outside the series: found 0.6", "0 to 0.5", "box.cells"]);
    fails("grid.scalar=cold", &["the file holds no array 'cold'", "box.cells"]);
    let left = folder.voltet(&[&["explain", "own.toml"], &WITH[..]].concat()).ok().stdout;
    assert!(left.contains("grid: no arrays motion, material: nothing looks at them"), "{left}");
    folder.voltet(&[&["run", "own.toml", "--exhaustive"], &WITH[..]].concat()).ok();
}

#[test]
fn the_node_reader_hands_a_file_to_the_plug_in_that_knows_it() {
    let Some(folder) = folder() else { return };
    let own = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    folder.write("own.toml", own.replace("simple-cells", "reader"));
    let wanted = picture(&folder, &[]);
    folder.voltet(&[&["check", "own.toml"], &WITH[..]].concat()).ok();
    folder.voltet(&[&["run", "own.toml"], &WITH[..]].concat()).ok();
    assert!(folder.floats("nodes.exr").1 == wanted, "the picture is that of the type's own name");
    let said = folder.voltet(&["info", "nodes.exr"]).ok().stdout;
    assert!(said.contains("plug-in (grid): simple cells in C 1.0.0"), "{said}");
    folder
        .voltet(&["run", "nodes.exr", "--set", "file.path=again.exr", WITH[0], WITH[1], WITH[2], WITH[3]])
        .ok();
    assert!(folder.floats("again.exr").1 == wanted);
    let run = |set: &str| folder.voltet(&[&["run", "own.toml", "--set", set], &WITH[..]].concat());
    run("grid.blocks=[\"a\"]").fails(2, &["unknown parameter 'blocks'", "scale"]);
    run("grid.scale=1.25").fails(2, &["unknown parameter 'scale'", "node 'grid'"]);
    run("grid.path=gone.cells").fails(1, &["the data file cannot be opened", "gone.cells"]);
    // Without the plug-in the file is of no format.
    let unread = own.replace("simple-cells", "reader");
    folder.write(
        "unread.toml",
        without_filters(&unread).replace("\"toned\"", "\"picture\"").replace("\"moved\"", "\"grid\""),
    );
    let ran = folder.voltet(&["run", "unread.toml"]);
    ran.fails(1, &["the format of the file is not known", "the format of a plug-in (--plugin)", "box.cells"]);
    // A file of a format that ships stays the node's own, whatever a plug-in makes of its name.
    let source = std::fs::read_to_string(compilers::source("examples/plugin_c/reader.c")).unwrap();
    let greedy = source.replace("{\"cells\"}", "{\"vtk\"}").replace(".magic_length = 7", ".magic_length = 0");
    folder.write("greedy.c", greedy);
    compilers::library(folder.path(), "greedy.so", &[folder.join("greedy.c")], &[]);
    folder.write("plain.toml", without_filters(&plain(&folder, &numbers(&folder.join("box.cells"), 1))));
    folder.voltet(&["run", "plain.toml"]).ok();
    let wanted = folder.floats("nodes.exr").1;
    folder.voltet(&["info", "box.vtk", "--plugin", "greedy.so"]).fails(1, &["the header is not 'cells 1'"]);
    folder.voltet(&["run", "plain.toml", "--plugin", "greedy.so"]).ok();
    assert!(folder.floats("nodes.exr").1 == wanted);
}

/// The file of plug-ins is read for a file of a format that does not ship, and for no other.
#[test]
fn the_users_own_file_of_plug_ins_serves_the_node_reader() {
    let Some(folder) = folder() else { return };
    let configuration = folder.join("configuration");
    std::fs::create_dir_all(configuration.join("voltet")).unwrap();
    let list = configuration.join("voltet/plugins.toml");
    let home = ("XDG_CONFIG_HOME", configuration.to_str().unwrap());
    let scene = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    let scene = scene.replace("\"moved\"", "\"grid\"").replace("\"toned\"", "\"picture\"");
    folder.write("own.toml", without_filters(&scene).replace("type = \"simple-cells\"", "type = \"reader\""));
    std::fs::write(&list, format!("plugins = ['{}']\n", folder.join("reader.so").display())).unwrap();
    folder.voltet_where(home, &["run", "own.toml"]).ok();
    std::fs::write(&list, "plug = []\n").unwrap();
    folder.voltet_where(home, &["run", "own.toml"]).fails(2, &["unknown key 'plug'"]);
    folder.write("box.vtk", vtk(&numbers(&folder.join("box.cells"), 1)));
    folder.voltet_where(home, &["check", "own.toml", "--set", "grid.path=box.vtk"]).ok();
}

/// Asserts that a reader gives what that in C gives, and that damaged files are messages: pairs of what is replaced in a file, by
/// what, and the message.
fn reads_what_the_reader_in_c_does(name: &str, plugin: &str, sources: &[&str], damages: &[[&str; 3]]) {
    let Some(folder) = folder() else { return };
    let sources: Vec<_> = sources.iter().map(|source| compilers::source(source)).collect();
    if compilers::library(folder.path(), "own.so", &sources, &[]).is_none() {
        return;
    }
    let scene = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    folder.write("own.toml", scene.replace("simple-cells", name));
    let with = ["run", "own.toml", "--plugin", "own.so", "--plugin", "filters.so", "--set"];
    for option in ["grid.scale=1.5", "grid.time=0", "grid.scalar=material"] {
        let wanted = picture(&folder, &[option]);
        for own_process in [&[][..], &["--plugin-process"]] {
            folder.voltet(&[&with[..], &[option], own_process].concat()).ok();
            assert!(folder.floats("nodes.exr").1 == wanted, "{option} {own_process:?}");
        }
    }
    let info = |file: &str| folder.voltet(&["info", file, "--plugin", "own.so"]);
    let shown = info("box.cells").ok().stdout;
    for text in ["2 time steps, times 0 to 0.5", "material  Float64  [0, 1]"] {
        assert!(shown.contains(text), "{shown}");
    }
    let text = std::fs::read_to_string(folder.join("box.cells")).unwrap();
    for [from, to, wanted] in damages {
        assert!(text.contains(from));
        folder.write("damaged.cells", text.replacen(from, to, 1));
        info("damaged.cells").fails(1, &[wanted, "says: found", name, plugin, "damaged.cells"]);
    }
    folder.write("damaged.cells", &text[..text.len() / 2]);
    info("damaged.cells").fails(1, &["says: found", name, "damaged.cells"]);
}

#[test]
fn a_reader_in_fortran_reads_what_one_in_c_does() {
    let sources = [
        "include/voltet_plugin.f90",
        "include/voltet_reader.f90",
        "examples/plugin_fortran/reader.f90",
        "include/voltet_plugin_fortran.c",
    ];
    let damages = [
        ["points 125", "points many", "Bad integer"],
        ["steps 2", "steps -2", "there are no or more than 1024 steps"],
        ["cells 64 512", "cells 64 500", "the cells have more points than the header says"],
        ["12 8 ", "12 9 ", ""],
    ];
    reads_what_the_reader_in_c_does("fortran-cells", "simple cells in Fortran", &sources, &damages);
}

#[test]
fn a_reader_in_cpp_reads_what_one_in_c_does() {
    let damages = [
        ["points 125", "points many", "the header is not 'cells 1', points, cells, steps, arrays"],
        ["arrays 3", "arrays 4097", "there are more than 4096 arrays"],
        ["cells 64 512", "cells 64 500", "the cells have more points than the header says"],
        ["12 8 ", "12 x ", "a cell is missing"],
    ];
    let sources = ["examples/plugin_cpp/reader.cpp"];
    reads_what_the_reader_in_c_does("cpp-cells", "simple cells in C++", &sources, &damages);
}

fn without_filters(scene: &str) -> String {
    let mut kept = String::new();
    for part in scene.split("[nodes.") {
        let is_filter = ["kept]", "moved]", "toned]"].iter().any(|name| part.starts_with(name));
        if !is_filter {
            kept += if kept.is_empty() { "" } else { "[nodes." };
            kept += part;
        }
    }
    kept
}

#[test]
fn info_and_help_know_it() {
    let Some(folder) = folder() else { return };
    let shown = folder.voltet(&[&["info", "box.cells"], &WITH[..]].concat()).ok().stdout;
    for text in [
        "simple cells, text",
        "125 points, 64 cells",
        "heat      Float64",
        "cell   material  Float64  [0, 1]",
        "2 time steps, times 0 to 0.5",
        "type = \"simple-cells\"",
    ] {
        assert!(shown.contains(text), "'{text}' is not in\n{shown}");
    }
    // Told by how it begins, whatever its name; the suggested pipeline runs.
    std::fs::rename(folder.join("box.cells"), folder.join("box.txt")).unwrap();
    let shown = folder.voltet(&[&["info", "box.txt"], &WITH[..]].concat()).ok().stdout;
    folder.write("suggested.toml", shown.split_once("A pipeline to start with\n").unwrap().1);
    let small = ["--set", "view.size=[8,8]"];
    folder.voltet(&[&["run", "suggested.toml"], &small[..], &WITH[..]].concat()).ok();
    let start = ["start", "box.txt", "--scalar", "motion", "-o", "start.toml"];
    folder.voltet(&[&start[..], &WITH[..]].concat()).ok();
    folder.voltet(&[&["run", "start.toml"], &small[..], &WITH[..]].concat()).ok();
    folder.voltet(&["info", "box.txt"]).fails(1, &["the format of the file is not known", "'cells 1"]);
    let help = folder.voltet(&[&["nodes", "simple-cells"], &WITH[..]].concat()).ok().stdout;
    for text in
        ["the file, .cells", "scale (number above 0; default: 1.0)", "time_step (whole number 0 or more"]
    {
        assert!(help.contains(text), "'{text}' is not in\n{help}");
    }
    let help = folder.voltet(&[&["nodes"], &WITH[..]].concat()).ok().stdout;
    for name in ["simple-cells", "c-threshold", "c-warp", "c-tone"] {
        assert!(help.lines().any(|line| line.starts_with(name)), "{help}");
    }
    folder.voltet(&["check", "scene.toml", "--plugin", "filters.so"]).fails(
        2,
        &[
            "unknown node type 'simple-cells'",
            "plug-in 'filters in C' (filters.so) with c-threshold, c-warp, c-tone",
        ],
    );
    let own = ["--set", "kept.least=1e400"];
    folder.voltet(&[&["check", "scene.toml"], &WITH[..], &own].concat()).fails(2, &["'least' is"]);
}

/// Cells whose corners all have a heat within the range, of the tetrahedra that a hexahedron is split into, make the same picture
/// as a file that holds no others: by the scalar of an axis along which hexahedra are not split.
#[test]
fn a_grid_filter_that_leaves_cells_out_and_one_that_moves_points_give_the_grid_that_a_file_would() {
    let Some(folder) = folder() else { return };
    let mut numbers = numbers(&folder.join("box.cells"), 0);
    // The first step's heat is x.
    assert!(numbers.heat.iter().zip(&numbers.points).all(|(heat, point)| *heat == point[0]));
    let options = ["grid.time=0", "kept.least=0.25", "kept.most=0.75", "toned.power=1", "moved.factor=2"];
    let own = picture(&folder, &options);
    for (point, motion) in numbers.points.iter_mut().zip(&numbers.motion) {
        (0..3).for_each(|k| point[k] += 2.0 * motion[k]);
    }
    numbers.cells.retain(|cell| cell.iter().all(|&point| (0.25..=0.75).contains(&numbers.heat[point])));
    assert_eq!(numbers.cells.len(), 32);
    numbers.material.truncate(32);
    let scene = without_filters(&plain(&folder, &numbers));
    let text =
        vtk(&numbers).replace("CELLS 64 576", "CELLS 32 288").replace("CELL_TYPES 64", "CELL_TYPES 32");
    let text = text.replace(&"12\n".repeat(64), &"12\n".repeat(32)).replace("CELL_DATA 64", "CELL_DATA 32");
    folder.write("box.vtk", text);
    folder.write("plain.toml", scene);
    folder.voltet(&["run", "plain.toml"]).ok();
    let wanted = folder.floats("nodes.exr").1;
    assert!(wanted.iter().any(|pixel| pixel[3] > 0.01), "the picture shows something");
    let difference = own.iter().flatten().zip(wanted.iter().flatten()).map(|(a, b)| (a - b).abs());
    let difference = difference.fold(0.0, f32::max);
    // The diagonals along which a warped side is cut depend on the order of the points' numbers, which is kept.
    assert!(difference == 0.0, "{difference:e}");
    // What a filter makes can be asked of it behind it, and not of the file: how far points moved.
    let scene = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    let writer = "[nodes.out]\ntype = \"grid-writer\"\npath = \"out.vtu\"\npoint_arrays = [\"way\"]\ninputs = { volume = ";
    folder.write("scene.toml", format!("{scene}\n{writer}\"moved\" }}\n"));
    folder.voltet(&[&["run", "scene.toml"], &WITH[..]].concat()).ok();
    let written = folder.voltet(&["info", "out.vtu"]).ok().stdout;
    assert!(written.contains("point  way "), "{written}");
    folder.write("scene.toml", scene.replace("by = \"motion\"", "by = \"way\""));
    let ran = folder.voltet(&[&["run", "scene.toml"], &WITH[..]].concat());
    ran.fails(1, &["the file holds no array 'way'", "box.cells"]);
}

#[test]
fn an_image_filter_computes_its_formula_and_the_picture_says_who_drew() {
    let Some(folder) = folder() else { return };
    let as_it_is = picture(&folder, &["toned.power=1"]);
    let toned = picture(&folder, &["toned.power=2.5"]);
    let wanted = as_it_is.iter().map(|&[r, g, b, a]| {
        let of = |c: f32| {
            if a > 0.0 { (f64::from(a) * (f64::from(c) / f64::from(a)).powf(2.5)) as f32 } else { 0.0 }
        };
        [of(r), of(g), of(b), a]
    });
    // The same operations in 64 bits, rounded once.
    let worst = wanted.zip(&toned).flat_map(|(a, b)| (0..4).map(move |k| (a[k] - b[k]).abs()));
    let worst = worst.fold(0.0, f32::max);
    assert!(worst < 1e-6, "{worst:e}");
    assert!(as_it_is.iter().zip(&toned).any(|(a, b)| (a[0] - b[0]).abs() > 0.01), "the power is heard");
    let said = folder.voltet(&["info", "nodes.exr"]).ok().stdout;
    for node in ["grid): simple cells in C 1.0.0", "kept): filters in C 1.0.0", "toned): filters in C 1.0.0"]
    {
        assert!(said.contains(&format!("plug-in ({node}")), "{said}");
    }
    let again = ["run", "nodes.exr", "--set", "file.path=again.exr"];
    folder.voltet(&[&again[..], &WITH[..]].concat()).ok();
    assert_eq!(folder.floats("again.exr").1, toned);
    // Compiled again, with another version: the picture is drawn, with a warning.
    let source = std::fs::read_to_string(compilers::source("examples/plugin_c/filters.c")).unwrap();
    folder.write("other.c", source.replace("\"1.0.0\"", "\"2.0\""));
    compilers::library(folder.path(), "filters.so", &[folder.join("other.c")], &["-lm"]);
    let ran = folder.voltet(&[&again[..], &WITH[..]].concat()).ok();
    assert!(ran.stderr.contains("warning: the picture was drawn with another plug-in"), "{}", ran.stderr);
}

/// A library that was compiled against the header of version 1.1, whose structs are shorter, computes what it did.
#[test]
fn a_plugin_of_an_older_minor_version_computes() {
    let folder = Folder::new();
    let text = |path: &str| std::fs::read_to_string(compilers::source(path)).unwrap();
    // Light shows the gradient.
    let inputs = "transfer_function = \"look\", camera = \"view\" }";
    let lit = format!("{inputs}\nlight = {{ direction = [-1.0, 0.0, 0.0] }}");
    folder.write("slab.toml", SLAB.replace(inputs, &lit).replace("\"least-squares\"", "\"faulty\""));
    let source = text("tests/plugins/faulty.c");
    let mut pictures = Vec::new();
    for header in ["include/voltet_plugin.h", "tests/plugins/voltet_plugin_1_1.h"] {
        // A header beside the source comes before the program's own.
        folder.write("voltet_plugin.h", text(header));
        folder.write("filter.c", &source);
        let options = ["-D_DEFAULT_SOURCE"];
        if compilers::library(folder.path(), "filter.so", &[folder.join("filter.c")], &options).is_none() {
            return;
        }
        folder.voltet(&["run", "slab.toml", "--plugin", "filter.so"]).ok();
        pictures.push(folder.floats("slab.exr").1);
    }
    assert_eq!(pictures[0], pictures[1]);
}
