//! Several pictures of one pipeline: time steps, files, values and ways of the camera, names of their files, and films.

use crate::support::{Folder, SLAB, cube_of};
use std::sync::atomic::{AtomicUsize, Ordering};
use voltet::Document;
use voltet::graph::{NoObserver, Observer};
use voltet::series::selection::{FrameSelection, Steps};
use voltet::series::steps::StepSelection;

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
fn two_series_step_together_unless_one_names_its_step() {
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
    // A reader that names its step stays there: T + T of step 0 is 4 x at step 2.
    folder.voltet(&["run", "two.toml", "--steps", "2", "--set", "other.time_step=0", "-o", "fixed.exr"]).ok();
    assert_eq!(folder.floats("fixed.exr"), folder.floats("four.exr"));
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
    assert_eq!([&steps[2]["outcome"], &steps[3]["outcome"]], ["failed", "drawn"]);
    assert!(steps[2]["run"].is_null() && steps[2]["error"].as_str().unwrap().contains("s2.vtu"), "{steps}");
    assert_eq!(steps[3]["run"]["files"][0], "p_0003.exr");
}

/// A pipeline whose widget stands at a share of the range of T.
pub fn relative(folder: &Folder) {
    let scene = std::fs::read_to_string(folder.join("p.toml")).unwrap();
    let scene = scene.replace("centre = [1.5, 0.0]", "centre = [\"50 %\", 0.0]");
    folder.write(
        "p.toml",
        scene.replace("unit_distance = 0.5", "unit_distance = 0.5\ninputs = { volume = \"gradient\" }"),
    );
}

/// T of step n goes from 0 to n + 1, so the middle of all 20 steps is at 10, of a sample too, and of step 3 by itself at 2.
#[test]
fn one_transfer_function_serves_the_whole_series_unless_steps_are_asked_for() {
    let folder = series(20);
    relative(&folder);
    let run = |arguments: &[&str]| {
        folder.voltet(&[&["run", "p.toml", "--steps", "3"], arguments].concat()).ok().stdout
    };
    let sample = run(&["-o", "sample.exr"]);
    assert!(sample.contains("centre = [10.0, 0.0] (over 8 of 20 time steps)"), "{sample}");
    let all = run(&["--ranges", "all", "-o", "all.exr"]);
    assert!(all.contains("centre = [10.0, 0.0] (over 20 time steps)"), "{all}");
    let step = run(&["--ranges", "step", "-o", "step.exr"]);
    assert!(step.contains("centre = [2.0, 0.0] (over the volume)"), "{step}");
    assert_eq!(folder.floats("sample.exr"), folder.floats("all.exr"));
    assert_ne!(folder.floats("sample.exr"), folder.floats("step.exr"));
    let own = folder.voltet(&["run", "p.toml", "--set", "grid.time_step=3", "-o", "own.exr"]).ok();
    assert!(own.stdout.contains("over the volume"), "{}", own.stdout);
    assert_eq!(folder.floats("own.exr"), folder.floats("step.exr"));
    // What the file says stays.
    let stated = run(&["--set", "look.relative_to=step", "-o", "stated.exr"]);
    assert!(stated.contains("over the volume"), "{stated}");
    // The sample is read once for all steps that are drawn, and its numbers are said once.
    let several = folder.voltet(&["run", "p.toml", "--steps", "0:9", "--report", "r.json"]).ok().stdout;
    assert_eq!(several.matches("over 8 of 20 time steps").count(), 2, "{several}");
    let steps = &folder.json("r.json")["runs"][0]["steps"];
    let read = |step: usize| steps[step]["run"]["counts"]["steps_read"].clone();
    assert_eq!([read(0), read(1), read(9)], [8, 0, 0]);
}

/// Counts the steps of series that nodes look at beside their own.
struct CountsSteps(AtomicUsize);

impl Observer for CountsSteps {
    fn progress(&self, _: &str, stage: &str, _: f64) {
        if stage.starts_with("step ") {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }
}

#[test]
fn surfaces_thresholds_and_views_follow_the_whole_series_too() {
    let folder = series(3);
    let scene = "[pipeline]\nformat = 1\n\n[nodes.grid]\ntype = \"reader\"\npath = \"run.pvd\"\nscalar = \"T\"\n\n\
        [nodes.kept]\ntype = \"threshold\"\nrange = [\"0 %\", \"50 %\"]\nkeep = \"any\"\ninputs = { volume = \"grid\" }\n\n\
        [nodes.cut]\ntype = \"slice\"\ninputs = { volume = \"kept\" }\n\n[nodes.look]\ntype = \"transfer-function\"\n\n\
        [nodes.view]\ntype = \"camera\"\nview = \"+z\"\nsize = [16, 12]\ninputs = { volume = \"grid\" }\n\n\
        [nodes.picture]\ntype = \"renderer\"\ninputs = { volume = \"kept\", transfer_function = \"look\", camera = \"view\", surfaces = [\"cut\"] }\n\n\
        [nodes.file]\ntype = \"image-writer\"\npath = \"p.exr\"\ninputs = { image = \"picture\" }\n";
    folder.write("p.toml", scene);
    let ran = folder.voltet(&["run", "p.toml", "--steps", "1", "--ranges", "sample"]).ok();
    // T goes to 1, 2 and 3: together from 0 to 3.
    assert!(ran.stdout.contains("kept: threshold: range = [0.0, 1.5] (over 3 time steps)"), "{}", ran.stdout);
    // Of step 2 the cells up to T = 3 are kept, for they have points at 1.5.
    assert!(ran.stdout.contains("cut: surface: range = [0.0, 3.0] (over 3 time steps)"), "{}", ran.stdout);
    // The threshold's own numbers are found once, not again at each step that the slice looks at: three nodes read three steps.
    let registry = voltet::nodes::registry().unwrap();
    let options = ["kept", "cut", "view"].map(|node| format!("{node}.relative_to=sample"));
    let document = Document::open(&folder.join("p.toml"), &options, &registry).unwrap();
    let observer = CountsSteps(AtomicUsize::new(0));
    voltet::nodes::session().run(&document.graph, &observer).unwrap();
    assert_eq!(observer.0.into_inner(), 9);
    let carried = std::fs::read(folder.join("p.exr")).unwrap();
    let carried = String::from_utf8_lossy(&carried).into_owned();
    assert_eq!(carried.matches("relative_to = \"sample\"").count(), 3, "threshold, slice and camera");
}

/// Data that move from step to step: what is cut goes through the middle of each step, and no note says that of it which is true of the series.
#[test]
fn what_is_cut_goes_through_the_middle_of_each_step() {
    let folder = Folder::new();
    let mut steps = String::new();
    for step in 0..2 {
        let values: Vec<String> = (0..27).map(|i| (i % 3 + step).to_string()).collect();
        let extent = "0 2 0 2 0 2";
        let data = format!(
            "<VTKFile type=\"ImageData\" version=\"1.0\"><ImageData WholeExtent=\"{extent}\" Origin=\"{}0 0 0\" Spacing=\"1 1 1\">\
             <Piece Extent=\"{extent}\"><PointData><DataArray type=\"Float64\" Name=\"T\" format=\"ascii\">{}</DataArray></PointData>\
             </Piece></ImageData></VTKFile>",
            step,
            values.join(" ")
        );
        folder.write(&format!("s{step}.vti"), data);
        steps += &format!("<DataSet timestep=\"{step}\" file=\"s{step}.vti\"/>");
    }
    folder
        .write("run.pvd", format!("<VTKFile type=\"Collection\"><Collection>{steps}</Collection></VTKFile>"));
    let scene = "[pipeline]\nformat = 1\n\n[nodes.grid]\ntype = \"reader\"\npath = \"run.pvd\"\nscalar = \"T\"\n\n\
        [nodes.kept]\ntype = \"threshold\"\nclip = [{ kind = \"plane\", invert = true }]\nkeep = \"any\"\ninputs = { volume = \"grid\" }\n\n\
        [nodes.cut]\ntype = \"slice\"\ninputs = { volume = \"grid\" }\n\n[nodes.look]\ntype = \"transfer-function\"\n\n\
        [nodes.view]\ntype = \"camera\"\nview = \"+z\"\nsize = [16, 12]\ninputs = { volume = \"grid\" }\n\n\
        [nodes.picture]\ntype = \"renderer\"\nclip = [{ kind = \"plane\" }]\n\
        inputs = { volume = \"kept\", transfer_function = \"look\", camera = \"view\", surfaces = [\"cut\"] }\n\n\
        [nodes.file]\ntype = \"image-writer\"\npath = \"p.exr\"\ninputs = { image = \"picture\" }\n";
    folder.write("p.toml", scene);
    // Of what is kept, the half below the middle, the clip takes half again.
    for (step, middle, of_kept) in [("0", "1.0", "0.5"), ("1", "11.0", "10.5")] {
        let said = folder.voltet(&["run", "p.toml", "--steps", step]).ok().stdout;
        for (node, x) in [("kept: threshold", middle), ("picture: clip", of_kept), ("cut: surface", middle)] {
            let origin = format!("origin = [{x}, 1.0, 1.0]");
            let line = said.lines().find(|line| line.contains(node) && line.contains(&origin));
            assert!(line.is_some_and(|line| line.ends_with("(over the bounds)")), "{node} {origin}: {said}");
        }
        assert!(said.contains("cut: surface: range = [0.0, 3.0] (over 2 time steps)"), "{said}");
    }
}

#[test]
fn pictures_that_are_there_are_not_drawn_again_until_something_changes() {
    let folder = series(3);
    relative(&folder);
    let run = |arguments: &[&str]| {
        folder.voltet(&[&["run", "p.toml", "--steps", "all", "--resume"], arguments].concat()).ok().stdout
    };
    let kept = |text: &str| text.matches("there already").count();
    assert_eq!(kept(&run(&[])), 0);
    assert_eq!(kept(&run(&[])), 3);
    std::fs::remove_file(folder.join("p_0001.exr")).unwrap();
    let again = run(&["--report", "r.json"]);
    assert_eq!(kept(&again), 2, "{again}");
    let outcomes: Vec<String> =
        (0..3).map(|k| folder.json("r.json")["runs"][0]["steps"][k]["outcome"].to_string()).collect();
    assert_eq!(outcomes, ["\"kept\"", "\"drawn\"", "\"kept\""]);
    assert_eq!(kept(&run(&["--set", "view.samples=2"])), 0, "another pipeline");
    assert_eq!(kept(&run(&["--set", "view.samples=2"])), 3);
    // Other data of one step: it changes the numbers of all, which are relative to the series.
    std::thread::sleep(std::time::Duration::from_millis(20));
    folder.write("s1.vtu", cube_of(2, "T", |x| 9.0 * x));
    assert_eq!(kept(&run(&["--set", "view.samples=2"])), 0);
    assert_eq!(kept(&run(&["--set", "view.samples=2", "--ranges", "step"])), 0);
    std::thread::sleep(std::time::Duration::from_millis(20));
    folder.write("s1.vtu", cube_of(2, "T", |x| 19.0 * x));
    assert_eq!(kept(&run(&["--set", "view.samples=2", "--ranges", "step"])), 2, "each step by itself");
}

#[test]
fn a_broken_picture_is_drawn_again() {
    let folder = series(2);
    folder.voltet(&["run", "p.toml", "--steps", "all"]).ok();
    let whole = std::fs::read(folder.join("p_0001.exr")).unwrap();
    folder.write("p_0001.exr", &whole[..40]);
    let ran = folder.voltet(&["run", "p.toml", "--steps", "all", "--resume"]).ok().stdout;
    assert_eq!(ran.matches("there already").count(), 1, "{ran}");
    assert_eq!(std::fs::read(folder.join("p_0001.exr")).unwrap(), whole);
}

/// A step may lack an array, as the first of a solver's often does; a mistake of the pipeline is said once.
#[test]
fn a_step_without_the_array_is_passed_over_and_a_mistake_of_all_is_said_once() {
    let folder = series(4);
    folder.write("s0.vtu", cube_of(2, "other", |x| x));
    let ran = folder
        .voltet(&["run", "p.toml", "--steps", "all"])
        .fails(1, &["step 0", "'T'", "1 of 4 frames failed"]);
    assert_eq!(pictures(&folder).len(), 3, "{}", ran.stderr);
    let mistake = "look.widgets.0.centre=[\"50 %\", 0.0]";
    let ran = folder.voltet(&["run", "p.toml", "--steps", "all", "--set", mistake, "-o", "n.exr"]);
    let ran =
        ran.fails(1, &["no data are wired in", "step 1, time 0.1: fails as step 0", "4 of 4 frames failed"]);
    assert_eq!(ran.stderr.matches("no data are wired in").count(), 1, "{}", ran.stderr);
}

/// The first steps may lack an array, and the last ones have it.
#[test]
fn good_steps_after_bad_ones_are_drawn_and_a_film_waits_for_all() {
    let folder = series(4);
    folder.write("s0.vtu", cube_of(2, "other", |x| x));
    folder.write("s1.vtu", cube_of(2, "other", |x| x));
    let arguments = ["run", "p.toml", "--steps", "all", "-o", "p.png", "--film", "a.gif", "--resume"];
    folder.write("a.gif", "the former film");
    let wanted = ["2 of 4 frames failed", "the film is not made", "--resume --film a.gif"];
    folder.voltet(&arguments).fails(1, &wanted);
    assert_eq!(pictures(&folder), ["p_0002.png", "p_0003.png"]);
    assert_eq!(std::fs::read(folder.join("a.gif")).unwrap(), b"the former film");
    folder.write("s0.vtu", cube_of(2, "T", |x| x));
    folder.write("s1.vtu", cube_of(2, "T", |x| x));
    let ran = folder.voltet(&arguments).ok();
    assert!(ran.stdout.contains("a.gif: a film of 4 frames"), "{}", ran.stdout);
}

#[test]
fn outputs_of_all_frames_and_pipelines_are_files_of_their_own() {
    let folder = series(3);
    folder.write("q.toml", std::fs::read_to_string(folder.join("p.toml")).unwrap());
    let before = folder.names();
    let refused = |arguments: &[&str], wanted: &[&str]| {
        folder.voltet(&[&["run"], arguments].concat()).fails(2, wanted);
        assert_eq!(folder.names(), before, "{arguments:?}");
    };
    let two = "two outputs of this call are one file";
    refused(&["p.toml", "q.toml", "--steps", "1:2"], &["p_0001.exr"]);
    refused(&["p.toml", "--steps", "all", "--report", "p_0002.exr"], &[two, "p_0002.exr", "--report"]);
    let sweep = ["p.toml", "--sweep", "view.height=[2.0, 3.0]"];
    refused(&[&sweep[..], &["--report", "p_sheet.png"]].concat(), &[two, "p_sheet.png"]);
    refused(&[&sweep[..], &["--film", "p_sheet.png"]].concat(), &["p_sheet.png"]);
    let read = "this output would overwrite what the call reads";
    refused(&["p.toml", "--for", "s*.vtu", "--report", "s2.vtu"], &[read, "s2.vtu"]);
}

#[test]
fn what_frames_set_by_themselves_is_not_swept() {
    let folder = series(2);
    let refused = |sweep: &str, wanted: &str| {
        let turn = ["--set", "view.orbit=360.0"];
        let ran = folder.voltet(&[&["run", "p.toml", "--sweep", sweep][..], &turn].concat());
        ran.fails(2, &["is not swept", wanted]);
    };
    refused("grid.path=[\"s0.vtu\", \"s1.vtu\"]", "--for");
    refused("grid.time_step=[0, 1]", "--steps");
    refused("grid.time=[0.0, 0.1]", "--times");
    refused("view.phase=[0.0, 0.5]", "--frames");
    let writer = std::fs::read_to_string(folder.join("p.toml")).unwrap();
    let writer = writer.split("[nodes.").find(|part| part.contains("\"image-writer\"")).unwrap();
    let writer = writer.split(']').next().unwrap();
    refused(&format!("{writer}.path=[\"a.exr\", \"b.exr\"]"), "{sweep}");
}

#[test]
fn parts_share_the_frames_and_leave_none_out() {
    let folder = series(5);
    let mut drawn = Vec::new();
    for part in ["1/3", "2/3", "3/3"] {
        folder.voltet(&["run", "p.toml", "-q", "--steps", "all", "--part", part]).ok();
        let new: Vec<String> = pictures(&folder).into_iter().filter(|name| !drawn.contains(name)).collect();
        assert!(new.len() == 2 || part == "3/3", "{part}: {new:?}");
        drawn.extend(new);
    }
    assert_eq!(pictures(&folder).len(), 5);
    let ran = folder.voltet(&["run", "p.toml", "--steps", "0:1", "--part", "3/3"]).ok();
    assert!(ran.stderr.contains("no frame in this part: p.toml"), "{}", ran.stderr);
    folder.voltet(&["run", "p.toml", "--steps", "all", "--part", "4/3"]).fails(2, &["NUMBER/COUNT"]);
}

#[test]
fn files_take_turns_in_the_reader_in_the_order_of_their_numbers() {
    let folder = series(3);
    folder.write("s10.vtu", cube_of(2, "T", |x| x));
    let ran = folder.voltet(&["run", "p.toml", "--for", "s*.vtu", "-o", "of_{stem}.exr"]).ok();
    assert_eq!(pictures(&folder), ["of_s0.exr", "of_s1.exr", "of_s10.exr", "of_s2.exr"]);
    assert!(ran.stdout.contains("4/4 s10: of_s10.exr"), "{}", ran.stdout);
    assert_eq!(folder.floats("of_s0.exr"), folder.floats("of_s10.exr"));
    folder.voltet(&["run", "p.toml", "-q", "--for", "s0.vtu", "--for", "s2.vtu"]).ok();
    assert_eq!(folder.floats("p_s2.exr"), folder.floats("of_s2.exr"));
    for (case, factor) in [("case_1", 1.0), ("case_2", 3.0)] {
        std::fs::create_dir(folder.join(case)).unwrap();
        folder.write(&format!("{case}/out.vtu"), cube_of(2, "T", |x| factor * x));
    }
    folder.voltet(&["run", "p.toml", "-q", "--for", "case_*/out.vtu"]).ok();
    assert_eq!(folder.floats("p_case_1_out.exr"), folder.floats("of_s0.exr"));
    assert_eq!(folder.floats("p_case_2_out.exr"), folder.floats("of_s2.exr"));
    folder
        .voltet(&["run", "p.toml", "--for", "none*.vtu"])
        .fails(2, &["no file has such a name", "none*.vtu"]);
}

#[test]
fn values_are_swept_each_with_each_and_stand_on_a_sheet() {
    let folder = series(1);
    let sweeps =
        ["--sweep", "look.widgets.0.extinction=[1.0, 4.0]", "--sweep", "view.height=[2.0, 3.0, 4.0]"];
    let size = ["--size", "96x64", "-o", "p.png"];
    let ran = folder.voltet(&[&["run", "p.toml"][..], &sweeps, &size].concat()).ok();
    assert!(ran.stdout.contains("5/6 extinction = 4.0, height = 3.0: p_0004.png"), "{}", ran.stdout);
    assert!(ran.stdout.contains("p_sheet.png: a sheet of 6 pictures"), "{}", ran.stdout);
    let one = [
        "run",
        "p.toml",
        "-q",
        "--set",
        "look.widgets.0.extinction=4.0",
        "--set",
        "view.height=3.0",
        "--size",
        "96x64",
        "-o",
        "one.png",
    ];
    folder.voltet(&one).ok();
    let [one, four, sheet] = ["one.png", "p_0004.png", "p_sheet.png"]
        .map(|name| image::open(folder.join(name)).unwrap().into_rgb8());
    assert_eq!(one, four);
    assert!(sheet.width() >= 3 * 96 && sheet.height() >= 2 * 64, "{:?}", sheet.dimensions());
    // The picture stands in the sheet as it is: in the second row, in its middle.
    let column: Vec<_> = (0..64).map(|y| *four.get_pixel(48, y)).collect();
    let found = (0..sheet.height() - 64)
        .any(|top| (0..64).all(|y| *sheet.get_pixel(sheet.width() / 2, top + y) == column[y as usize]));
    assert!(found, "the column of the picture is in the sheet");
    let ran =
        folder.voltet(&[&["run", "p.toml", "--part", "1/2"][..], &sweeps, &["-o", "r.png"]].concat()).ok();
    assert!(ran.stderr.contains("no sheet is made of a part"), "{}", ran.stderr);
    assert!(folder.join("r_0000.png").exists() && !folder.join("r_sheet.png").exists());
    folder.voltet(&["run", "p.toml", "--sweep", "look.widgets.0.none=[1]"]).fails(2, &["none"]);
    folder.voltet(&["run", "p.toml", "--sweep", "look.model=1"]).fails(2, &["node.param=[VALUE, VALUE, …]"]);
}

#[test]
fn films_are_made_of_the_pictures() {
    let folder = series(4);
    let run = |arguments: &[&str]| {
        folder.voltet(
            &[&["run", "p.toml", "--steps", "all", "-o", "p.png", "--size", "15x10"], arguments].concat(),
        )
    };
    let ran = run(&["--film", "a.gif", "--fps", "10"]).ok();
    assert!(ran.stdout.contains("a.gif: a film of 4 frames, 0.40 s"), "{}", ran.stdout);
    run(&["--film", "a.png", "--resume"]).ok();
    use image::AnimationDecoder;
    let film = std::fs::File::open(folder.join("a.png")).unwrap();
    let film = image::codecs::png::PngDecoder::new(std::io::BufReader::new(film)).unwrap().apng().unwrap();
    let frames = film.into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 4);
    for (step, frame) in frames.iter().enumerate() {
        let own = image::open(folder.join(&format!("p_000{step}.png"))).unwrap().into_rgba8();
        assert_eq!(*frame.buffer(), own, "step {step}");
    }
    run(&["--film", "b.gif", "--fps", "60"]).fails(2, &["GIF", "50"]);
    run(&["--film", "a.avi"]).fails(2, &["format of the film", ".mp4"]);
    run(&["--film", "p_0001.png"]).fails(2, &["the film is one of its pictures", "p_0001.png"]);
    let none = ("PATH", "/none");
    let arguments = ["run", "p.toml", "-q", "--steps", "all", "-o", "f.png", "--film", "a.mp4"];
    let ran = folder.voltet_where(none, &arguments).fails(
        1,
        &["ffmpeg cannot be run", "-f rawvideo", "libx264", "-o f.png --film a.mp4 --resume` makes the film"],
    );
    assert!(folder.join("f_0003.png").exists() && !folder.join("a.mp4").exists(), "{}", ran.stderr);
}

/// A program of that name that takes the frames, in place of the true one, which machines of tests lack.
#[cfg(unix)]
#[test]
fn frames_of_even_size_go_to_ffmpeg() {
    use std::os::unix::fs::PermissionsExt;
    let folder = series(3);
    folder.write("ffmpeg", "#!/bin/sh\necho \"$@\" > said.txt\nfor last; do :; done\ncat > \"$last\"\n");
    std::fs::set_permissions(folder.join("ffmpeg"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap());
    let arguments = ["run", "p.toml", "--steps", "all", "-o", "p.png", "--size", "15x10", "--film", "a.mp4"];
    let ran = folder.voltet_where(("PATH", &path), &arguments).ok();
    assert!(ran.stdout.contains("padded with the background from 15 × 10 to even 16 × 10"), "{}", ran.stdout);
    assert_eq!(std::fs::read(folder.join("a.mp4")).unwrap().len(), 3 * 16 * 10 * 3);
    let said = std::fs::read_to_string(folder.join("said.txt")).unwrap();
    assert!(
        said.contains("-s 16x10 -r 25")
            && said.contains("-pix_fmt yuv420p")
            && said.trim().ends_with("a.mp4"),
        "{said}"
    );
    // More words than a pipe holds, and a film that is not whole: the former one stays, and nothing lies beside it.
    let names = folder.names();
    let wordy = "#!/bin/sh\nfor last; do :; done\necho half > \"$last\"\nhead -c 300000 /dev/zero | tr '\\0' x >&2\ncat > /dev/null\n\
                 echo 'Unknown encoder' >&2\nexit 1\n";
    folder.write("ffmpeg", wordy);
    folder
        .voltet_where(("PATH", &path), &arguments)
        .fails(1, &["ffmpeg did not make the film", "Unknown encoder"]);
    assert_eq!(folder.names(), names);
    assert_eq!(std::fs::read(folder.join("a.mp4")).unwrap().len(), 3 * 16 * 10 * 3);
    // One that closes its input early made no film either.
    folder.write("ffmpeg", "#!/bin/sh\nexit 0\n");
    folder.voltet_where(("PATH", &path), &arguments).fails(1, &["ffmpeg did not make the film"]);
    assert_eq!(folder.names(), names);
}

#[test]
fn a_camera_goes_its_way_over_the_frames() {
    let folder = series(4);
    let run = |arguments: &[&str]| folder.voltet(&[&["run", "p.toml", "-q"], arguments].concat());
    // A whole turn in 4 pictures: 0, 90, 180 and 270 degrees.
    run(&["--set", "view.orbit=360.0", "--frames", "4", "-o", "o.exr"]).ok();
    for (number, azimuth) in [(0, 0), (1, 90), (3, 270)] {
        let turn = format!("view.azimuth={azimuth}.0");
        run(&["--set", &turn, "-o", "one.exr"]).ok();
        let ((_, one), (_, of_way)) =
            (folder.floats("one.exr"), folder.floats(&format!("o_000{number}.exr")));
        // The turn is rounded at another place: 32-bit floats of the picture.
        let off =
            one.iter().flatten().zip(of_way.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-5, "{azimuth} degrees: {off}");
    }
    assert_ne!(folder.floats("o_0000.exr"), folder.floats("o_0001.exr"));
    // With steps the camera goes on from step to step, from the first key to the last.
    let keys = "view.keys=[[0.0, -3.0, 0.5, 0.5, 0.5, 0.5, 0.5], [1.0, 0.5, -3.0, 0.5, 0.5, 0.5, 0.5]]";
    let scene = std::fs::read_to_string(folder.join("p.toml")).unwrap();
    let without = scene.replace("eye = [-3.0, 0.5, 0.5]\ntarget = [0.5, 0.5, 0.5]\n", "");
    folder.write("p.toml", &without);
    run(&["--set", keys, "--steps", "0,3", "-o", "k.exr"]).ok();
    folder.write("p.toml", scene.replace("[-3.0, 0.5, 0.5]", "[0.5, -3.0, 0.5]"));
    run(&["--set", "grid.time_step=3", "-o", "end.exr"]).ok();
    assert_eq!(folder.floats("k_0003.exr"), folder.floats("end.exr"));
    run(&["--frames", "3"]).fails(2, &["no camera has one", "orbit"]);
    run(&["--set", keys, "--frames", "3"]).fails(2, &["'keys' and 'eye' exclude each other"]);
}

/// A run of 200 steps in one session, with numbers relative to the series: what is held after the second is held after the last.
#[test]
fn a_session_holds_no_more_after_many_steps() {
    let folder = series(200);
    relative(&folder);
    let registry = voltet::nodes::registry().unwrap();
    let document = Document::open(&folder.join("p.toml"), &[], &registry).unwrap();
    let steps = Some(Steps::Numbers(StepSelection::all()));
    let selection = FrameSelection { steps, ..FrameSelection::default() };
    let frames = voltet::series::frames(&document, &selection, &registry).unwrap();
    assert_eq!(frames.len(), 200);
    let mut session = voltet::nodes::session();
    let mut held = Vec::new();
    for frame in &frames {
        let own = document.changed(&frame.changes, &registry).unwrap();
        session.run(&own.graph, &NoObserver).unwrap();
        held.push(session.held_counts());
    }
    assert!(held[1].iter().all(|&count| count > 0), "{:?}", held[1]);
    assert_eq!(held[199], held[1]);
    assert!(held.iter().all(|counts| *counts == held[1] || *counts == held[0]), "{held:?}");
}

/// Values between steps go by time, so two readers must have the same times.
#[test]
fn values_between_steps_of_series_with_other_times_are_refused() {
    let folder = series(3);
    let others = std::fs::read_to_string(folder.join("run.pvd"))
        .unwrap()
        .replace("timestep=\"0.2\"", "timestep=\"7.0\"");
    folder.write("other.pvd", others);
    let mut scene = std::fs::read_to_string(folder.join("p.toml")).unwrap();
    scene += "\n[nodes.other]\ntype = \"reader\"\npath = \"other.pvd\"\nscalar = \"T\"\n\n[nodes.copy]\ntype = \"grid-writer\"\n\
              path = \"copy.vtu\"\ninputs = { volume = \"other\" }\n";
    folder.write("two.toml", &scene);
    let reader = scene.lines().find_map(|line| line.strip_prefix("[nodes.")?.strip_suffix(']')).unwrap();
    let linear = format!("{reader}.between_steps=linear");
    let command = ["run", "two.toml", "--times", "0.05", "--set", &linear];
    folder.voltet(&command).fails(2, &["series of different times", "'other'"]);
}
