//! Several pictures of one pipeline: time steps, and names of their files.

use crate::support::{Folder, SLAB, cube_of};

/// A series of five steps at the times 0, 0.1, …, in which T grows, and a pipeline that draws T by fixed values.
pub fn series(count: usize) -> Folder {
    let folder = Folder::new();
    let mut steps = String::new();
    for step in 0..count {
        folder.write(&format!("s{step}.vtu"), cube_of(2, "T", |x| x * (1.0 + step as f64)));
        steps += &format!("<DataSet timestep=\"{:.1}\" file=\"s{step}.vtu\"/>", 0.1 * step as f64);
    }
    let pvd = format!("<VTKFile type=\"Collection\"><Collection>{steps}</Collection></VTKFile>");
    folder.write("run.pvd", pvd);
    let widget = "kind = \"gaussian\"\ncolor = [1.0, 0.5, 0.2]\nextinction = 3.0\ncentre = [1.5, 0.0]\nsigma = [0.5, inf]\n";
    let scene = SLAB
        .replace("cube.vtu\"\nscalar = \"x\"", "run.pvd\"\nscalar = \"T\"")
        .replace("slab.exr", "p.exr")
        .replace(
            "kind = \"uniform\"\ncolor = [0.5, 1.0, 0.25]\nextinction = 1.0\nregion = { s = [-1.0, 2.0] }\n",
            widget,
        );
    folder.write("p.toml", scene);
    folder
}

/// The pictures of the folder, sorted.
fn pictures(folder: &Folder) -> Vec<String> {
    folder.names().into_iter().filter(|name| name.ends_with(".exr") || name.ends_with(".png")).collect()
}

#[test]
fn a_step_of_several_is_the_step_by_itself_bit_for_bit() {
    let folder = series(5);
    let ran = folder.voltet(&["run", "p.toml", "--steps", "0:4:2"]).ok();
    assert!(ran.stdout.contains("2/3 step 2, time 0.2: p_0002.exr: "), "{}", ran.stdout);
    assert_eq!(pictures(&folder), ["p_0000.exr", "p_0002.exr", "p_0004.exr"]);
    for step in ["0", "2", "4"] {
        let (own, name) = (format!("grid.time_step={step}"), format!("own{step}.exr"));
        folder.voltet(&["run", "p.toml", "--set", &own, "-o", &name]).ok();
        assert_eq!(folder.floats(&name), folder.floats(&format!("p_000{step}.exr")), "step {step}");
    }
    assert_ne!(folder.floats("own0.exr"), folder.floats("own4.exr"), "steps differ");
    // The picture of a step draws that step again.
    folder.voltet(&["run", "p_0002.exr", "-o", "again.exr"]).ok();
    assert_eq!(folder.floats("again.exr"), folder.floats("p_0002.exr"));
    folder.voltet(&["run", "p.toml", "-q", "--steps", "-1", "-o", "last_{step}_{time:.2}.exr"]).ok();
    assert_eq!(folder.floats("last_4_0.40.exr"), folder.floats("own4.exr"));
}

#[test]
fn steps_are_named_by_number_by_time_and_by_the_file() {
    let folder = series(5);
    let drawn = |arguments: &[&str], wanted: &[&str]| {
        pictures(&folder).iter().for_each(|name| std::fs::remove_file(folder.join(name)).unwrap());
        folder.voltet(&[&["run", "p.toml", "-q"], arguments].concat()).ok();
        assert_eq!(pictures(&folder), wanted, "{arguments:?}");
    };
    drawn(&["--steps", "3,-5"], &["p_0000.exr", "p_0003.exr"]);
    drawn(
        &["--steps", "all", "-o", "{stem}{step:02}.png"],
        &["run00.png", "run01.png", "run02.png", "run03.png", "run04.png"],
    );
    drawn(&["--times", "0.1:0.3", "-o", "t{time}.png"], &["t0.1.png", "t0.2.png", "t0.3.png"]);
    drawn(
        &["--set", "grid.time_step=all", "--size", "2x2"],
        &["p_0000.exr", "p_0001.exr", "p_0002.exr", "p_0003.exr", "p_0004.exr"],
    );
    // Without --steps the marks say what the file names.
    drawn(&["--set", "grid.time=0.21", "-o", "{step}_{time}_{other}.exr"], &["2_0.2_{other}.exr"]);
    // A time that the file names gives way to steps.
    drawn(&["--set", "grid.time=0.21", "--steps", "1,3", "-o", "n{frame}.exr"], &["n0.exr", "n1.exr"]);
}

#[test]
fn wrong_steps_and_names_are_refused_before_anything_is_drawn() {
    let folder = series(3);
    let before = folder.names();
    let refused = |arguments: &[&str], wanted: &[&str]| {
        folder.voltet(&[&["run", "p.toml"], arguments].concat()).fails(2, wanted);
        assert_eq!(folder.names(), before, "{arguments:?}");
    };
    refused(&["--steps", "3"], &["no such time step", "found 3", "0 to 2"]);
    refused(&["--steps", "1:x"], &["FIRST:LAST"]);
    refused(&["--times", "5"], &["no step at these times", "times from 0 to 0.2"]);
    refused(&["--steps", "all", "-o", "-"], &["several files", "standard output"]);
    refused(
        &["--steps", "all", "-o", "{time:.0}.exr"],
        &["two frames would be written to one file", "step 1, time 0.1"],
    );
    refused(&["--steps", "all", "--exhaustive"], &["--exhaustive", "several"]);
    refused(
        &["--set", "grid.path=cube.vtu", "--set", "grid.scalar=x", "-o", "{time}.exr"],
        &["{time}", "no times"],
    );
    refused(&["--steps", "all", "-o", "s{step}.vtu"], &["picture's format"]);
}

#[test]
fn two_series_step_together_and_must_be_of_one_length() {
    let folder = series(3);
    let second = "\n[nodes.other]\ntype = \"reader\"\npath = \"run.pvd\"\nscalar = \"T\"\n\n[nodes.sum]\ntype = \"calculator\"\n\
                  expression = \"T + other.T\"\ninputs = { grid = \"grid\", other = \"other\" }\n";
    let scene = std::fs::read_to_string(folder.join("p.toml")).unwrap();
    let two = scene.replace("inputs = { grid = \"grid\" }", "inputs = { grid = \"sum\" }") + second;
    folder.write("two.toml", &two);
    folder.voltet(&["run", "two.toml", "--steps", "all"]).ok();
    // T + T of step 1 is T of step 3, of which there is none: 2 · 2 x = 4 x.
    folder.write("s3.vtu", cube_of(2, "T", |x| 4.0 * x));
    folder.voltet(&["run", "p.toml", "--set", "grid.path=s3.vtu", "-o", "four.exr"]).ok();
    assert_eq!(folder.floats("p_0001.exr"), folder.floats("four.exr"));
    let short = "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"s0.vtu\"/>\
                 <DataSet timestep=\"1\" file=\"s1.vtu\"/></Collection></VTKFile>";
    folder.write("short.pvd", short);
    folder
        .voltet(&["run", "two.toml", "--steps", "all", "--set", "other.path=short.pvd"])
        .fails(2, &["different numbers of steps", "'grid'", "'other'"]);
}

#[test]
fn a_broken_step_is_named_and_the_others_are_drawn() {
    let folder = series(4);
    folder.write("s2.vtu", "<VTKFile");
    let ran = folder.voltet(&["run", "p.toml", "--steps", "all", "--report", "r.json"]);
    ran.fails(1, &["step 2, time 0.2", "1 of 4 frames failed: step 2"]);
    assert_eq!(pictures(&folder), ["p_0000.exr", "p_0001.exr", "p_0003.exr"]);
    let steps = &folder.json("r.json")["runs"][0]["steps"];
    assert_eq!(steps.as_array().unwrap().len(), 4);
    assert_eq!(steps[3]["step"], 3);
    assert!(steps[2]["run"].is_null() && steps[2]["error"].as_str().unwrap().contains("s2.vtu"), "{steps}");
    assert_eq!(steps[3]["run"]["files"][0], "p_0003.exr");
}
