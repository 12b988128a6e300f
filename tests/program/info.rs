//! `voltet info` on data that is unusual: what it suggests runs, and names are safe to show.

use super::support::{Folder, cube};

/// The pipeline that `info` suggests, run.
#[track_caller]
fn suggested_runs(folder: &Folder, arguments: &[&str], wanted: &[&str]) {
    let text = folder.voltet(&[&["info"], arguments].concat()).ok().stdout;
    let (_, pipeline) = text.split_once("A pipeline to start with\n").unwrap_or_else(|| panic!("{text}"));
    wanted.iter().for_each(|wanted| assert!(pipeline.contains(wanted), "'{wanted}' is not in\n{pipeline}"));
    folder.write("suggested.toml", pipeline);
    folder.voltet(&["run", "suggested.toml"]).ok();
}

#[test]
fn the_step_that_was_asked_for_is_suggested() {
    let folder = Folder::new();
    let mut steps = String::new();
    for step in 0..3 {
        folder.write(&format!("{step}.vtu"), cube(step + 1));
        steps += &format!("<DataSet timestep=\"{step}\" file=\"{step}.vtu\"/>");
    }
    let series = format!("<VTKFile type=\"Collection\"><Collection>{steps}</Collection></VTKFile>");
    folder.write("series.pvd", series);
    suggested_runs(&folder, &["series.pvd", "--time-step", "2"], &["time_step = 2"]);
    let ran = folder.voltet(&["run", "suggested.toml"]).ok();
    assert!(ran.stdout.contains("162 cells"), "27 hexahedra: {}", ran.stdout);
}

#[test]
fn a_cell_array_in_the_shadow_of_a_point_array_is_suggested_as_one() {
    let folder = Folder::new();
    // The points' array of that name has one value everywhere, and so have all others.
    let text = cube(3).replace("Name=\"layer\"", "Name=\"ones\"");
    let (points, cells) = text.split_once("</PointData>").unwrap();
    let only = points.find("<DataArray type=\"Float64\" Name=\"ones\"").unwrap();
    let head = points.find("<PointData>").unwrap() + "<PointData>".len();
    folder.write("cube.vtu", format!("{}{}</PointData>{cells}", &points[..head], &points[only..]));
    suggested_runs(&folder, &["cube.vtu"], &["scalar = \"ones\"", "association = \"cell\""]);
}

#[test]
fn data_without_volume_is_told_so_and_nothing_is_suggested() {
    let folder = Folder::new();
    let flat = cube(1).replace("0 1 3 2 4 5 7 6", "0 1 2 3").replace(">8<", ">4<").replace(">12<", ">8<");
    folder.write("flat.vtu", flat);
    let text = folder.voltet(&["info", "flat.vtu"]).ok().stdout;
    assert!(text.contains("No cell has a volume: nothing to draw."), "{text}");
    assert!(!text.contains("[pipeline]") && !text.contains("a run takes"), "{text}");
}

#[test]
fn names_with_control_characters_are_shown_escaped() {
    let folder = Folder::new();
    let name = "x\u{1b}[2J\u{7}\u{202e}";
    folder.write("cube.vtu", cube(2).replace("Name=\"x\"", &format!("Name=\"{name}\"")));
    let shown = "x\\u{1b}[2J\\u{7}\\u{202e}";
    let described = folder.voltet(&["info", "cube.vtu"]).ok().stdout;
    assert!(described.contains(&format!("point  {shown} ")), "{described}");
    let unknown = folder.voltet(&["run", "slab.toml"]).fails(1, &[shown]);
    folder.write(
        "named.toml",
        format!(
            "{}\n[nodes.grid2]\ntype = \"reader\"\npath = \"\u{9b}\u{202e}.vtu\"\n",
            super::support::SLAB
        ),
    );
    let pointed = folder.voltet(&["check", "named.toml"]);
    let path = "no such \u{1b}]0;title\u{7}.toml";
    let missing = folder.voltet(&["run", path]).fails(2, &["no such \\u{1b}]0;title\\u{7}.toml"]);
    for text in [described, unknown.stderr, pointed.stdout, pointed.stderr, missing.stderr] {
        assert!(!text.chars().any(|c| c.is_control() && c != '\n' || c == '\u{202e}'), "{text:?}");
    }
}

#[test]
fn a_refinement_that_nobody_can_hold_is_refused_with_its_number() {
    let folder = Folder::new();
    let study = |levels| folder.voltet(&["study", "slab.toml", "--refine", levels, "--frames", "1"]);
    // 162 · 8²⁰ by hand; 162 · 8⁶ = 42,467,328 is the last below 100 million.
    study("20").fails(
        2,
        &["found 1.9e20 cells of 162, refined 20 times", "at most 100000000 cells: --refine 6 or less"],
    );
    study("7").fails(2, &["found 339738624 cells of 162, refined 7 times", "--refine 6 or less"]);
    assert_eq!(folder.names(), ["cube.vtu", "slab.toml"], "before anything is drawn");
}

#[test]
fn programs_are_told_the_same() {
    let folder = Folder::new();
    folder.write("cube.vtu", cube(2));
    let text = folder.voltet(&["info", "cube.vtu", "--json"]).ok().stdout;
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        found["cells_by_type"],
        serde_json::json!([{ "vtk_type": 12, "name": "hexahedron", "count": 8 }])
    );
    assert_eq!(found["bounds"], serde_json::json!([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]));
    let names: Vec<&str> =
        found["arrays"].as_array().unwrap().iter().filter_map(|a| a["name"].as_str()).collect();
    assert!(names.contains(&"x") && names.contains(&"layer"), "{names:?}");
    let lit = found["memory_bytes"]["drawing_with_gradient_and_light"].as_u64().unwrap();
    assert!(lit > found["memory_bytes"]["drawing"].as_u64().unwrap());
    folder.write("scene.toml", "");
    folder.voltet(&["info", "scene.toml", "--json"]).fails(2, &["--json is for data files"]);
}

#[test]
fn blocks_are_a_tree_and_none_of_them_is_suggested_as_a_quantity() {
    let folder = Folder::new();
    folder.write("a.vtu", cube(2));
    folder.write("b.vtu", cube(3));
    let leaf = |name: &str, file: &str| format!("<DataSet index=\"0\" name=\"{name}\" file=\"{file}.vtu\"/>");
    let tree = format!(
        "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><Block index=\"0\" name=\"fluid\">{}{}</Block>{}\
         </vtkMultiBlockDataSet></VTKFile>",
        leaf("rotor", "a"),
        leaf("stator", "b"),
        leaf("solid", "a")
    );
    folder.write("machine.vtm", tree);
    let text = folder.voltet(&["info", "machine.vtm"]).ok().stdout;
    for line in
        ["3 blocks", "35  fluid/  2 blocks", "8    rotor  hexahedra", "8  solid  hexahedra", "cell   block"]
    {
        assert!(text.contains(line), "'{line}' is not in\n{text}");
    }
    let json = folder.voltet(&["info", "machine.vtm", "--json"]).ok().stdout;
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    let rotor = serde_json::json!({
        "name": "fluid/rotor", "cells": 8, "cells_by_type": [{ "vtk_type": 12, "name": "hexahedron", "count": 8 }]
    });
    assert_eq!(found["blocks"][0], rotor);
    suggested_runs(&folder, &["machine.vtm"], &["machine.vtm"]);
    assert!(!folder.voltet(&["info", "machine.vtm"]).ok().stdout.contains("scalar = \"block\""));
}
