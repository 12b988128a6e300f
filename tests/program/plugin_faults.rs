//! Plug-ins that do what they must not: each is one clear message that names the plug-in, and the program goes on where it can.

use crate::support::{Folder, SLAB, cube_of};
use std::time::{Duration, Instant};
use voltet_testing::compilers;

/// A pipeline that looks at the gradient of x by a filter of `faulty.c`.
fn slab(fault: &str) -> String {
    let method = format!("method = \"faulty\"\nfault = \"{fault}\"");
    let scene = "transfer_function = \"look\", camera = \"view\" }";
    let lit = format!("{scene}\nlight = {{ direction = [-1.0, 0.0, 0.0] }}");
    SLAB.replace("method = \"least-squares\"", &method).replace(scene, &lit)
}

/// A folder with `filter.so` of this fault; `None` where there is no compiler.
fn folder(fault: u32) -> Option<Folder> {
    let folder = Folder::new();
    folder.write("cube.vtu", cube_of(3, "x", |x| 2.0 * x));
    folder.write("slab.toml", slab("none"));
    library(&folder, fault)?;
    Some(folder)
}

#[test]
fn a_test_of_a_filter_names_the_inputs_that_it_wrote_to() {
    let Some(folder) = folder(0) else { return };
    let test = ["gradient-test", "faulty", "--plugin", "filter.so", "--set", "fault=scalar"];
    let quick = ["--beside", "", "--levels", "4,8", "--timed", "4", "--rounds", "1"];
    let ran = folder.voltet(&[&test[..], &quick].concat());
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let said = "plug-in 'faulty' (filter.so) is refused: found it wrote into the values of the scalar";
    assert!(ran.stdout.contains(said), "{}\n{}", ran.stdout, ran.stderr);
}

fn library(folder: &Folder, fault: u32) -> Option<()> {
    let source = compilers::source("tests/plugins/faulty.c");
    let options = [&format!("-DFAULT={fault}")[..], "-D_DEFAULT_SOURCE"];
    compilers::library(folder.path(), "filter.so", &[source], &options).map(drop)
}

const LOADED: [&str; 3] = ["run", "--plugin", "filter.so"];

#[test]
fn what_a_plugin_declares_wrongly_is_said_when_it_is_loaded() {
    let Some(folder) = folder(0) else { return };
    folder.voltet(&["run", "slab.toml", "--plugin", "filter.so"]).ok();
    let faults: [(u32, &[&str]); 37] = [
        (1, &["1000000 filters, 1 to 256 can be"]),
        (2, &["it says that it has 0 filters"]),
        (3, &["filter 1: voltet_gradient_filter is a null pointer"]),
        (4, &["its init gave nothing, and no reason"]),
        (5, &["it says: the licence has run out"]),
        (6, &["voltet_plugin says that its size is 8 bytes, in place of 24"]),
        (7, &["the name of the plug-in is a null pointer"]),
        (8, &["the name of the plug-in is no UTF-8 at byte 3"]),
        (9, &["the name of the filter is longer than 64 bytes: \"aaaaaaaa"]),
        (10, &["the name of the filter is 'Two Words', and may have lower-case letters"]),
        (11, &["two of its filters are called 'faulty'"]),
        (12, &["of the filter 'faulty', the function 'gradient' is a null pointer"]),
        (13, &["there are 65 parameters, at most 64 can be"]),
        (14, &["parameter 0: voltet_parameter is a null pointer"]),
        (15, &["parameter 1: voltet_parameter says that its size is 48 bytes"]),
        (16, &["parameter 'fault': its type is 99, which this version does not know"]),
        (17, &["of the standard value of the gradient filter 'faulty', 'number' is out of range: found 7"]),
        (18, &["parameter 'number': no number is in its range, from 2 to 1"]),
        (19, &["of the standard value of the gradient filter 'faulty', 'word' does not know this word"]),
        (20, &["parameter 'word': there are two words 'none'"]),
        (21, &["parameter 'word': 'words' is a null pointer"]),
        (22, &["there are 1073741824 words, 1 to 64 can be"]),
        (23, &["the gradient filter 'faulty' declares 'fault' twice"]),
        (24, &["the gradient filter 'faulty' declares 'inputs' twice"]),
        (25, &["parameter 'fault': the help is empty"]),
        (26, &["the help has control characters"]),
        (27, &["'needs' has flags that this version does not know: 0x100000"]),
        (28, &["there is a gradient filter 'least-squares' already"]),
        (29, &["of the filter 'faulty', the summary points to memory that is not there"]),
        (
            30,
            &[
                "crash (SIGABRT",
                "while it was loaded of the plug-in 'filter.so' (filter.so)",
                "--plugin-process",
            ],
        ),
        (31, &["a function of its factory is a null pointer"]),
        (32, &["'words' points to memory that is not there"]),
        (33, &["it has no gradient filters, readers, grid filters or image filters"]),
        (34, &["its interface is version 2.3.1, and this program's 1.x"]),
        (35, &["voltet_entry says that its size is 20 bytes, in place of 40"]),
        (36, &["the function 'init' of its entry is a null pointer"]),
        (37, &["it does not export the symbol 'voltet_plugin_entry'"]),
    ];
    for (fault, wanted) in faults {
        library(&folder, fault);
        let code = if fault == 30 { 1 } else { 2 };
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml"]].concat());
        ran.fails(code, &[wanted, &["filter.so"]].concat());
    }
}

#[test]
fn files_that_are_no_plugin_are_refused_before_they_are_loaded() {
    let Some(folder) = folder(0) else { return };
    let whole = std::fs::read(folder.join("filter.so")).unwrap();
    let changed = |at: usize, byte: u8| {
        let mut bytes = whole.clone();
        bytes[at] = byte;
        bytes
    };
    for (bytes, wanted) in [
        (b"int main;".to_vec(), "the file is no shared library"),
        (Vec::new(), "the file is empty"),
        (whole[..40].to_vec(), "its header is not whole"),
        (whole[..whole.len() / 4].to_vec(), "the file is cut off"),
        (changed(18, 40), "it is a library for another processor"),
        (changed(16, 1), "not a shared library"),
        (changed(54, 1), "its header contradicts itself"),
    ] {
        if cfg!(target_os = "linux") {
            folder.write("filter.so", bytes);
            folder
                .voltet(&[&LOADED[..], &["slab.toml"]].concat())
                .fails(2, &["the plug-in cannot be loaded", wanted, "filter.so"]);
        }
    }
    folder.voltet(&["nodes", "--plugin", "."]).fails(2, &["the plug-in cannot be read"]);
}

/// Asserts the message of a run with this fault, equal in this process and in one of its own.
fn said(fault: &str, wanted: &[&str]) {
    let Some(folder) = folder(0) else { return };
    folder.write("slab.toml", slab(fault));
    let before = folder.names();
    for own_process in [&[][..], &["--plugin-process"]] {
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml"], own_process].concat());
        let named = ["the gradient filter 'faulty' of the plug-in 'faulty' (filter.so)"];
        ran.fails(1, &[wanted, &named].concat());
        assert_eq!(folder.names(), before, "nothing was written");
    }
}

#[test]
fn what_a_filter_gives_wrongly_is_said() {
    said("error", &["says: found cell 12 has no volume", "node 'gradient'"]);
    said("mute", &["failed and did not say why: found code 77"]);
    said("stopped", &["stopped, and nobody asked it to"]);
    said("beyond", &["wrote beyond the end of the gradient", "3 numbers for each of the 64 points"]);
    said("a block beyond", &["wrote beyond the end of the gradient"]);
    for (fault, input) in [
        ("points", "the points, which it must leave as they are (element 2 of 64)"),
        ("cells", "the cells"),
        ("scalar", "the values of the scalar"),
        ("neighbours", "the neighbours of points"),
        ("cells of points", "the cells of points, which it must leave as they are (element 64 of 65)"),
        ("values", "the values of its parameters, which it must leave as they are (element 2 of 3)"),
    ] {
        said(fault, &["is refused: found it wrote into", input, "node 'gradient'"]);
    }
    for fault in ["nan", "infinite", "huge"] {
        said(fault, &["gave a vector that is not finite", "at point 1"]);
    }
}

#[test]
fn points_without_a_vector_are_counted() {
    let Some(folder) = folder(0) else { return };
    folder.write(
        "slab.toml",
        slab("none").replace("method = \"faulty\"\nfault = \"none\"", "method = \"faulty-few\""),
    );
    for own_process in [&[][..], &["--plugin-process"]] {
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml"], own_process].concat());
        ran.fails(
            1,
            &[
                "'faulty-few' of the plug-in 'faulty' (filter.so) did not give every point a vector",
                "2 without, the first of them point 62",
            ],
        );
    }
}

#[test]
fn what_it_says_of_itself_is_bounded_and_what_it_prints_is_not_taken_for_the_gradient() {
    let Some(folder) = folder(0) else { return };
    for (fault, own_process) in
        [("notes", &[][..]), ("notes", &["--plugin-process"]), ("prints", &["--plugin-process"])]
    {
        folder.write("slab.toml", slab(fault));
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml"], own_process].concat()).ok();
        assert!(ran.stderr.len() < 40 * 4400, "{}", ran.stderr.len());
        assert!(!ran.stderr.contains('\u{1}'));
        assert_eq!(ran.stderr.contains("at 1 point\n"), fault == "notes", "{}", ran.stderr);
    }
}

#[test]
fn parameters_that_exclude_each_other_are_refused_by_the_plugins_own_check() {
    let Some(folder) = folder(0) else { return };
    folder.write("slab.toml", slab("refused"));
    for own_process in [&[][..], &["--plugin-process"]] {
        let ran = folder.voltet(&[&["check", "slab.toml", "--plugin", "filter.so"], own_process].concat());
        ran.fails(2, &["says: found 'fault' must not be refused", "plug-in 'faulty' (filter.so)"]);
    }
}

#[cfg(unix)]
#[test]
fn a_crash_is_said_to_be_the_plugins_and_stays_in_a_process_of_its_own() {
    let Some(folder) = folder(0) else { return };
    for (fault, here, there) in [
        ("crash", "SIGSEGV", "signal 11 (SIGSEGV)"),
        ("abort", "SIGABRT", "signal 6 (SIGABRT)"),
        // Rust's own handler, which is still there then, ends the process by SIGABRT where the address lies in its guard page.
        ("deep", "SIGSEGV", "signal "),
    ] {
        folder.write("slab.toml", slab(fault));
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml"]].concat());
        let whose = "in the gradient filter 'faulty' of the plug-in 'faulty' (filter.so)";
        ran.fails(1, &[here, whose, "--plugin-process"]);
        // The other file is run all the same.
        folder.write("other.toml", SLAB.replace("slab.exr", "other.exr"));
        let files = ["slab.toml", "other.toml", "--plugin-process"];
        let ran = folder.voltet(&[&LOADED[..], &files].concat());
        ran.fails(1, &[&format!("'faulty' of the plug-in 'faulty' (filter.so) crashed with {there}")]);
        assert!(folder.names().contains(&"other.exr".into()) && !folder.names().contains(&"slab.exr".into()));
        std::fs::remove_file(folder.join("other.exr")).unwrap();
    }
    for fault in ["exit", "exit in a loop"] {
        folder.write("slab.toml", slab(fault));
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml"]].concat());
        let whose = "a call of exit in the gradient filter 'faulty' of the plug-in 'faulty' (filter.so)";
        ran.fails(1, &[whose, "--plugin-process"]);
    }
    folder.write("slab.toml", slab("exit"));
    folder
        .voltet(&[&LOADED[..], &["slab.toml", "--plugin-process"]].concat())
        .fails(1, &["(filter.so) did not answer"]);
    library(&folder, 38);
    folder
        .voltet(&[&LOADED[..], &["slab.toml"]].concat())
        .fails(1, &["a call of exit while it was loaded of the plug-in 'filter.so' (filter.so)"]);
    library(&folder, 30);
    let ran = folder.voltet(&[&LOADED[..], &["slab.toml", "--plugin-process"]].concat());
    ran.fails(
        2,
        &["the plug-in cannot be loaded: found its process crashed with signal 6 (SIGABRT)", "filter.so"],
    );
}

#[cfg(unix)]
#[test]
fn an_exception_that_leaves_a_plugin_is_said_to_be_its() {
    let folder = Folder::new();
    let method = "method = \"throwing\"";
    folder.write("slab.toml", slab("").replace("method = \"faulty\"\nfault = \"\"", method));
    let source = compilers::source("tests/plugins/throws.cpp");
    let build = |place: u32| {
        let option = format!("-DWHERE={place}");
        compilers::library(folder.path(), "filter.so", std::slice::from_ref(&source), &[&option])
    };
    for (place, in_filter) in [(1, true), (2, true), (3, false)] {
        if build(place).is_none() {
            return;
        }
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml"]].concat());
        let whose = if in_filter { "in the gradient filter 'throwing'" } else { "while it was loaded" };
        ran.fails(1, &["a crash (SIGABRT, it gave up, by an exception perhaps)", whose, "(filter.so)"]);
        let ran = folder.voltet(&[&LOADED[..], &["slab.toml", "--plugin-process"]].concat());
        ran.fails(if in_filter { 1 } else { 2 }, &["crashed with signal 6 (SIGABRT)", "filter.so"]);
    }
    build(4);
    let ran = folder.voltet(&[&LOADED[..], &["slab.toml"]].concat());
    ran.fails(1, &["a call of exit in the gradient filter 'throwing' of the plug-in 'throwing' (filter.so)"]);
}

/// Starts a run, stops it after a while, and gives its message with the seconds that stopping took.
#[cfg(unix)]
fn stopped(folder: &Folder, options: &[&str]) -> (String, f64) {
    let mut command = folder.command(&[&LOADED[..], &["slab.toml"], options].concat());
    let child =
        command.stderr(std::process::Stdio::piped()).stdout(std::process::Stdio::null()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    let start = Instant::now();
    let stop = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(stop.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    (String::from_utf8(output.stderr).unwrap(), start.elapsed().as_secs_f64())
}

#[cfg(unix)]
#[test]
fn a_filter_that_never_ends_is_given_up() {
    let Some(folder) = folder(0) else { return };
    folder.write("slab.toml", slab("patient"));
    let (said, seconds) = stopped(&folder, &[]);
    assert!(said.contains("the run was stopped") && seconds < 2.5, "{seconds} s: {said}");
    folder.write("slab.toml", slab("endless"));
    let (said, _) = stopped(&folder, &[]);
    for text in [
        "was asked to stop and goes on",
        "plug-in 'faulty' (filter.so)",
        "only the end of the program ends it",
    ] {
        assert!(said.contains(text), "{said}");
    }
    // The second Ctrl-C ends it at once.
    let mut command = folder.command(&[&LOADED[..], &["slab.toml"]].concat());
    let mut child = command.stderr(std::process::Stdio::null()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    let start = Instant::now();
    for _ in 0..2 {
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        std::thread::sleep(Duration::from_millis(300));
    }
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert!(start.elapsed() < Duration::from_millis(2500), "{:?}", start.elapsed());
    let (said, seconds) = stopped(&folder, &["--plugin-process"]);
    assert!(said.contains("the run was stopped") && seconds < 2.5, "{seconds} s: {said}");
}
