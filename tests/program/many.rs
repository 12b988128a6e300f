//! Many pipelines in one call, one after the other and several at a time.

use crate::series::series;
use crate::support::{Folder, SLAB, cube_of};

/// A text without times, which differ from run to run.
fn without_times(text: &str) -> String {
    let is_time = |word: &&str| {
        let number = word.strip_suffix(" s").unwrap_or_default();
        !number.is_empty() && number.parse::<f64>().is_ok()
    };
    let line = |line: &str| line.split(", ").filter(|word| !is_time(word)).collect::<Vec<_>>().join(", ");
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Pipelines `p0.toml` to `p5.toml` over two files in turn.
fn pipelines(folder: &Folder) -> Vec<String> {
    folder.write("one.vtu", cube_of(3, "x", |x| x));
    folder.write("two.vtu", cube_of(3, "x", |x| 1.0 - x));
    let scene = |number: usize| {
        let data = ["one.vtu", "two.vtu"][number % 2];
        let scene = SLAB.replace("cube.vtu", data).replace("slab.exr", &format!("p{number}.exr"));
        scene.replace("size = [8, 8]", &format!("size = [{}, 8]", 8 + number))
    };
    let names = (0..6).map(|number| {
        let name = format!("p{number}.toml");
        folder.write(&name, scene(number));
        name
    });
    names.collect()
}

#[test]
fn a_broken_pipeline_is_named_and_the_others_are_drawn_in_an_order_that_stays() {
    let folder = Folder::new();
    let names = pipelines(&folder);
    folder.write("p1.toml", SLAB.replace("type = \"camera\"", "type = \"camara\""));
    folder.write("p4.toml", SLAB.replace("scalar = \"x\"", "scalar = \"none\"").replace("slab", "p4"));
    let run = |jobs: &str| {
        let arguments = ["run", "--jobs", jobs].into_iter().chain(names.iter().map(String::as_str));
        let ran = folder.voltet(&arguments.collect::<Vec<_>>());
        let drawn: Vec<String> = folder.names().into_iter().filter(|name| name.ends_with(".exr")).collect();
        assert_eq!(drawn, ["p0.exr", "p2.exr", "p3.exr", "p5.exr"]);
        drawn.iter().for_each(|name| std::fs::remove_file(folder.join(name)).unwrap());
        assert_eq!((ran.code, ran.errors()), (2, 2), "{}", ran.stderr);
        for wanted in ["camara", "'none'", "2 of 6 pipelines failed: p1.toml; p4.toml"] {
            assert!(ran.stderr.contains(wanted), "{wanted}: {}", ran.stderr);
        }
        (without_times(&ran.stdout), ran.stderr)
    };
    let one = run("1");
    assert!(one.0.starts_with("p0.exr: ") && one.0.contains("\np5.exr: "), "{}", one.0);
    for jobs in ["2", "5"] {
        assert_eq!(run(jobs), one, "{jobs}");
    }
    // The only file that is given is wrong: nothing else can be done.
    folder.voltet(&["run", "p1.toml"]).fails(2, &["camara"]);
}

#[test]
fn a_file_is_read_once_whichever_pipelines_name_it() {
    let folder = Folder::new();
    let names = pipelines(&folder);
    for jobs in ["1", "3"] {
        let options = ["run", "-q", "--jobs", jobs, "--report", "r.json"];
        folder.voltet(&options.into_iter().chain(names.iter().map(String::as_str)).collect::<Vec<_>>()).ok();
        let report = folder.json("r.json");
        let runs = report["runs"].as_array().unwrap();
        assert_eq!(runs.len(), 6);
        let files: Vec<&str> = runs.iter().map(|run| run["file"].as_str().unwrap()).collect();
        assert_eq!(files, names, "in the order in which they are given");
        let worked = |node: &str| {
            let nodes = runs.iter().flat_map(|run| run["nodes"].as_array().unwrap());
            nodes.filter(|own| own["type"] == node && own["reused"] == false).count()
        };
        assert_eq!([worked("reader"), worked("renderer")], [2, 6], "{jobs}");
    }
}

#[test]
fn frames_several_at_a_time_are_those_one_after_the_other() {
    let folder = series(9);
    folder.write("s4.vtu", "<VTKFile");
    let run = |jobs: &str, name: &str| {
        let arguments = ["run", "p.toml", "--steps", "all", "--jobs", jobs, "-o", name, "--report", "r.json"];
        let ran = folder.voltet(&arguments).fails(1, &["step 4", "1 of 9 frames failed"]);
        let steps = folder.json("r.json")["runs"][0]["steps"].clone();
        let outcomes: Vec<String> = steps
            .as_array()
            .unwrap()
            .iter()
            .map(|step| format!("{} {}", step["step"], step["outcome"]))
            .collect();
        (without_times(&ran.stdout).replace(name.trim_end_matches(".exr"), ""), ran.stderr, outcomes)
    };
    let one = run("1", "one.exr");
    assert_eq!(one.2[4], "4 \"failed\"");
    assert_eq!(run("4", "several.exr"), one);
    for step in [0, 3, 8] {
        let [one, several] = ["one", "several"].map(|name| folder.floats(&format!("{name}_000{step}.exr")));
        assert_eq!(one, several, "{step}");
    }
}

#[test]
fn several_at_a_time_are_files() {
    let folder = series(2);
    let jobs = ["run", "p.toml", "--jobs", "2"];
    folder.voltet(&[&jobs[..], &["-o", "-"]].concat()).fails(2, &["standard output", "--jobs 2"]);
    folder.voltet(&[&jobs[..], &["--exhaustive"]].concat()).fails(2, &["--exhaustive"]);
    folder.voltet(&["run", "p.toml", "--jobs", "0"]).fails(2, &["--jobs"]);
}
