//! Memory: what `info` says is what a run takes, and where it ends the program ends with an error.
#![cfg(target_os = "linux")]

use super::support::{Folder, cube};

/// Tolerance between promised memory and the peak that the system counted: cells that no pixel centre sees are promised and
/// not taken, what threads set aside is taken and not promised. A busy machine changes neither: the peak counts pages that the
/// process itself has touched.
const SHARE: f64 = 0.25;

/// Number of threads, fixed, since their stacks are not promised.
const THREADS: (&str, &str) = ("RAYON_NUM_THREADS", "2");

/// A grid by formula, of as many cells as one likes.
const WAVELET: &str = r#"[pipeline]
format = 1

[nodes.grid]
type = "wavelet"
resolution = [100, 100, 100]

[nodes.look]
type = "transfer-function"

[[nodes.look.widgets]]
kind = "uniform"
extinction = 1.0
color = [1.0, 1.0, 1.0]
region = { s = [-1000.0, 1000.0] }

[nodes.view]
type = "camera"
eye = [-50, 0, 0]
target = [0, 0, 0]
size = [64, 64]

[nodes.picture]
type = "renderer"
engine = "cpu"
inputs = { volume = "grid", transfer_function = "look", camera = "view" }

[nodes.file]
type = "image-writer"
path = "wavelet.png"
inputs = { image = "picture" }
"#;

#[test]
fn info_promises_what_runs_take() {
    let folder = Folder::new();
    folder.write("cube.vtu", cube(48));
    let text = folder.voltet(&["info", "cube.vtu"]).ok().stdout;
    let (_, after) = text.split_once("a run takes about ").unwrap();
    let promised: Vec<f64> =
        after.split(" MiB").take(3).map(|t| t.rsplit(' ').next().unwrap().parse().unwrap()).collect();
    let (_, pipeline) = text.split_once("A pipeline to start with\n").unwrap();
    folder.write("first.toml", pipeline);
    let gradient =
        "[nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = { grid = \"grid\" }\n\n[nodes.look]";
    let lit = pipeline
        .replace("[nodes.look]", gradient)
        .replace("volume = \"grid\"", "volume = \"gradient\"")
        .replace("[nodes.view]", "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1, 1, 1]\nextinction = 1\ncentre = [0.5, 1.0]\nsigma = [1.0, 1.0]\n\n[nodes.view]")
        .replace("type = \"renderer\"", "type = \"renderer\"\nlight = { direction = [0, 0, 1] }");
    folder.write("lit.toml", lit);
    let taken = |file: &str, sets: &[&str]| {
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let size = ["--set", "view.size=[1024, 1024]", "--set", "picture.engine=cpu"];
        let arguments = [&["run", file, "--report", "r.json"], &size[..], &sets].concat();
        assert!(folder.command(&arguments).env(THREADS.0, THREADS.1).status().unwrap().success());
        folder.json("r.json")["peak_memory_bytes"].as_f64().unwrap() / f64::from(1 << 20)
    };
    // Nothing but reading: every cell is culled.
    let reading = taken("first.toml", &["look.widgets=[]", "view.size=[8, 8]"]);
    for (what, promised, taken) in [
        ("reading", promised[0], reading),
        ("drawing", promised[1], taken("first.toml", &[])),
        ("lit", promised[2], taken("lit.toml", &[])),
    ] {
        assert!(
            (promised / taken - 1.0).abs() <= SHARE,
            "{what}: promised {promised} MiB, taken {taken:.0} MiB"
        );
    }
}

/// Runs the wavelet with an address space of so many MiB.
fn limited(folder: &Folder, mebibytes: usize, threads: &str, set: &str) -> std::process::Output {
    let program = env!("CARGO_BIN_EXE_voltet");
    let line = format!("ulimit -v {} && exec {program} run wavelet.toml --set '{set}'", mebibytes * 1024);
    let mut shell = std::process::Command::new("sh");
    // Else the C library reserves 64 MiB of addresses for each of many threads that is there early, and the last may find none.
    if threads != THREADS.1 {
        shell.env("MALLOC_ARENA_MAX", "1");
    }
    shell.args(["-c", &line]).env(THREADS.0, threads).current_dir(folder.path()).output().unwrap()
}

#[test]
fn where_memory_ends_the_run_is_refused_or_ends_with_one_line() {
    let folder = Folder::new();
    folder.write("wavelet.toml", WAVELET);
    let before = folder.names();
    for (threads, set, wanted) in [
        // 6 million cells are there; drawing them takes more than is left.
        (THREADS.1, "view.size=[64, 64]", "found drawing 6000000 cells takes about "),
        // 100 million cells are never made.
        (THREADS.1, "grid.resolution=[256, 256, 256]", "error: memory ends: found no room for "),
        // It ends for several threads at once: the run ends by the first.
        ("16", "grid.resolution=[256, 256, 256]", "error: memory ends: found no room for "),
        // Their stacks are more than there is.
        ("600", "view.size=[64, 64]", "error: no threads can be had to work with: found "),
    ] {
        let output = limited(&folder, 500, threads, set);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(
            said.contains(wanted) && said.contains(" = help: expected ") && said.contains("more memory"),
            "{said}"
        );
        assert_eq!(said.matches("error:").count(), 1, "{said}");
        assert_eq!(folder.names(), before);
    }
}
