//! Plug-ins that end the program, print, damage memory or change their inputs: what is drawn is right, or the exit code says that it is
//! not and the last line names the plug-in.
#![cfg(target_os = "linux")]

use crate::plugin_node_scene::scene;
use crate::support::{Folder, SLAB};
use std::io::{BufRead, BufReader};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::Stdio;
use std::time::{Duration, Instant};
use voltet_testing::compilers;

unsafe extern "C" {
    fn signal(signal: i32, action: usize) -> usize;
    fn kill(process: i32, signal: i32) -> i32;
}

// As Linux numbers them on x86-64 and AArch64.
const SIGABRT: i32 = 6;
const SIGKILL: i32 = 9;
const SIGUSR1: i32 = 10;
const SIGTERM: i32 = 15;
const SIGCHLD: i32 = 17;
const SIG_IGN: usize = 1;

const WHOSE: &str = "the gradient filter 'faulty' of the plug-in 'faulty' (filter.so)";

/// A pipeline that looks at the gradient by a filter of `faulty.c`.
fn slab(fault: &str) -> String {
    let scene = "transfer_function = \"look\", camera = \"view\" }";
    let lit = format!("{scene}\nlight = {{ direction = [-1.0, 0.0, 0.0] }}");
    let method = format!("method = \"faulty\"\nfault = \"{fault}\"");
    SLAB.replace("method = \"least-squares\"", &method).replace(scene, &lit)
}

/// A folder with `filter.so` of this fault, and pipelines without fault and by least squares; `None` where there is no compiler.
fn folder(fault: u32) -> Option<Folder> {
    let folder = Folder::new();
    folder.write("slab.toml", slab("none"));
    let plain = slab("none").replace("method = \"faulty\"\nfault = \"none\"", "method = \"least-squares\"");
    folder.write("plain.toml", plain.replace("slab.exr", "plain.exr"));
    let source = compilers::source("tests/plugins/faulty.c");
    let options = [&format!("-DFAULT={fault}")[..], "-D_DEFAULT_SOURCE"];
    compilers::library(folder.path(), "filter.so", &[source], &options)?;
    Some(folder)
}

/// What `look` finds, tried until it does; `None` after a time that no machine needs.
fn by_deadline<T>(mut look: impl FnMut() -> Option<T>) -> Option<T> {
    let start = Instant::now();
    loop {
        let found = look();
        if found.is_some() || start.elapsed() > Duration::from_secs(300) {
            return found;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

const LOADED: [&str; 4] = ["run", "slab.toml", "--plugin", "filter.so"];

fn with_fault<'a>(set: &'a str, rest: &[&'a str]) -> Vec<&'a str> {
    [&LOADED[..], &["--set", set], rest].concat()
}

#[test]
fn an_end_without_a_word_is_an_error_that_names_the_plugin() {
    let Some(folder) = folder(0) else { return };
    for fault in ["quiet exit", "exec"] {
        let set = format!("gradient.fault={fault}");
        let ran = folder.voltet(&with_fault(&set, &[]));
        ran.fails(1, &["an end of the program with exit code 0", &format!("in {WHOSE}"), "--plugin-process"]);
        let ran = folder.voltet(&with_fault(&set, &["--plugin-process"]));
        ran.fails(1, &[&format!("{WHOSE} did not answer")]);
    }
    folder.voltet(&with_fault("gradient.fault=thread ended", &[])).fails(1, &[WHOSE, "ended the thread"]);
    let quick = ["--beside", "", "--levels", "4,8", "--timed", "4", "--rounds", "1"];
    let test = ["gradient-test", "faulty", "--plugin", "filter.so", "--set", "fault=quiet exit"];
    folder.voltet(&[&test[..], &quick].concat()).fails(1, &[&format!("in {WHOSE}")]);
    // After the program's own end the exit code is that of the program.
    folder.voltet(&with_fault("gradient.fault=quiet exit at exit", &[])).ok();
    let options = ["--set", "file.path=no/folder.exr"];
    let ran = folder.voltet(&with_fault("gradient.fault=quiet exit at exit", &options));
    assert_eq!(ran.code, 1, "{}", ran.stderr);
}

#[test]
fn an_end_while_it_is_loaded_is_an_error_of_every_command() {
    let Some(folder) = folder(39) else { return };
    let with = ["--plugin", "filter.so"];
    let commands: [&[&str]; 6] = [
        &["run", "slab.toml"],
        &["check", "slab.toml"],
        &["explain", "slab.toml"],
        &["nodes"],
        &["gradient-test", "faulty"],
        &["info", "cube.vtu"],
    ];
    for command in commands {
        let ran = folder.voltet(&[command, &with].concat());
        ran.fails(1, &["exit code 0", "while it was loaded of the plug-in 'filter.so' (filter.so)"]);
    }
}

#[test]
fn readers_and_filters_of_grids_and_images_are_named_too() {
    let folder = Folder::new();
    folder.write("scene.toml", scene("faulty", 16));
    folder.write("any.faulty", "whatever");
    let source = compilers::source("tests/plugins/faulty_nodes.c");
    let options = ["-D_DEFAULT_SOURCE"];
    if compilers::library(folder.path(), "faulty.so", &[source], &options).is_none() {
        return;
    }
    let loaded = ["run", "scene.toml", "--plugin", "faulty.so", "--set"];
    for (node, whose) in [
        ("grid", "the reader 'faulty-reader'"),
        ("moved", "the grid filter 'faulty-grid'"),
        ("toned", "the image filter 'faulty-image'"),
    ] {
        let set = format!("{node}.fault=quiet exit");
        let whole = format!("in {whose} of the plug-in 'faulty nodes' (faulty.so)");
        folder.voltet(&[&loaded[..], &[&set]].concat()).fails(1, &["exit code 0", &whole]);
    }
    // The picture alone is on the standard output.
    for path in ["-", "/dev/stdout"] {
        let options = ["toned.fault=prints", "--output", path, "--set", "file.format=png", "--quiet"];
        let printed = folder.command(&[&loaded[..], &options].concat()).output().unwrap();
        assert!(printed.status.success() && printed.stdout.starts_with(b"\x89PNG"));
        assert!(printed.stdout.ends_with(b"IEND\xaeB`\x82"));
        assert!(String::from_utf8_lossy(&printed.stderr).contains("a plug-in prints"));
    }
}

#[test]
fn a_crash_after_the_work_of_a_plugin_names_it_last() {
    let Some(folder) = folder(0) else { return };
    let ran = folder.command(&with_fault("gradient.fault=abort at exit", &[])).output().unwrap();
    let said = String::from_utf8(ran.stderr).unwrap();
    for part in ["a crash (SIGABRT", "after work of a plug-in, which may have damaged memory", WHOSE] {
        assert!(said.contains(part), "{said}");
    }
    // Once, and the program ends as without a plug-in: with an image of memory, where the system keeps any.
    assert!(!said.contains("an end of the program"), "{said}");
    assert_eq!(ran.status.signal(), Some(SIGABRT));
}

/// What the processes share is not among it.
#[test]
fn an_overrun_of_all_memory_names_the_plugin() {
    let Some(folder) = folder(0) else { return };
    let ran = folder.command(&with_fault("gradient.fault=overrun", &[])).output().unwrap();
    let said = String::from_utf8(ran.stderr).unwrap();
    assert!(!ran.status.success() && said.contains(&format!("in {WHOSE}")), "{said}");
}

/// Nodes of several pipelines share the grid that was read.
#[test]
fn what_a_plugin_wrote_into_the_grid_is_put_back_for_other_pipelines() {
    let Some(folder) = folder(0) else { return };
    folder.voltet(&["run", "plain.toml"]).ok();
    let right = folder.floats("plain.exr").1;
    for (fault, input) in [("points", "the points"), ("cells", "the cells")] {
        std::fs::remove_file(folder.join("plain.exr")).unwrap();
        folder.write("slab.toml", slab(fault));
        let ran = folder.voltet(&[&LOADED[..], &["plain.toml"]].concat());
        ran.fails(1, &["it wrote into", input, WHOSE]);
        assert_eq!(folder.floats("plain.exr").1, right, "{fault}");
    }
}

/// The way in which threads round, the current folder, permissions of new files and limits of resources are the program's.
#[test]
fn what_a_plugin_sets_for_itself_holds_for_nobody_else() {
    let Some(folder) = folder(0) else { return };
    folder.voltet(&LOADED).ok();
    let right = folder.floats("slab.exr").1;
    let mode = || std::fs::metadata(folder.join("slab.exr")).unwrap().permissions();
    let usual = mode();
    for fault in ["rounds", "elsewhere", "private files", "small files"] {
        std::fs::remove_file(folder.join("slab.exr")).unwrap();
        folder.voltet(&with_fault(&format!("gradient.fault={fault}"), &[])).ok();
        assert_eq!(mode(), usual, "{fault}");
        assert_eq!(folder.floats("slab.exr").1, right, "{fault}");
    }
}

/// Neither a signal to the program nor the program's own end leaves the process that works behind, and the program ends as that does.
#[test]
fn the_process_that_works_ends_with_the_one_that_the_user_knows() {
    let Some(folder) = folder(0) else { return };
    let cancelled = "a plug-in stopped";
    for (signal, wanted, says) in [
        (SIGKILL, (None, Some(SIGKILL)), ""),
        // It cancels the call, which ends by itself.
        (SIGTERM, (Some(1), None), cancelled),
        (SIGUSR1, (None, Some(SIGUSR1)), ""),
    ] {
        let mut command = folder.command(&with_fault("gradient.fault=patient", &[]));
        let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        assert!(lines.any(|line| line.contains("a plug-in waits")), "it runs");
        // SAFETY: a child of this process that was not waited for.
        assert_eq!(unsafe { kill(child.id() as i32, signal) }, 0);
        // The output ends only when both processes have closed it.
        let rest: String = lines.map(|line| line + "\n").collect();
        let ended = child.wait().unwrap();
        assert_eq!((ended.code(), ended.signal()), wanted, "{signal}: {rest}");
        assert!(rest.contains(says) && !rest.contains("an end of the program"), "{signal}: {rest}");
    }
}

/// Some parents leave SIGCHLD ignored: the system then keeps no ends of children.
#[test]
fn where_ends_of_children_are_ignored_the_program_ends_all_the_same() {
    let Some(folder) = folder(0) else { return };
    for (fault, wanted) in [("none", 0), ("quiet exit", 1), ("exit", 1)] {
        let set = format!("gradient.fault={fault}");
        let mut command = folder.command(&with_fault(&set, &["--quiet"]));
        // SAFETY: `signal` may be called between fork and exec.
        unsafe {
            command.pre_exec(|| {
                signal(SIGCHLD, SIG_IGN);
                Ok(())
            })
        };
        let mut child = command.stderr(Stdio::null()).spawn().unwrap();
        let code = by_deadline(|| child.try_wait().unwrap()).unwrap_or_else(|| {
            child.kill().unwrap();
            panic!("the program does not end ({fault})")
        });
        assert_eq!(code.code(), Some(wanted), "{fault}");
    }
}

/// Threads of a library that is loaded before the program begins.
#[test]
fn a_program_that_cannot_be_supervised_says_so() {
    let Some(folder) = folder(0) else { return };
    let source = "#include <pthread.h>\n#include <unistd.h>\n\
        static void *wait(void *user) { for (;;) pause(); return user; }\n\
        __attribute__((constructor)) static void begin(void) { pthread_t t; pthread_create(&t, NULL, wait, NULL); }\n";
    folder.write("thread.c", source);
    compilers::library(folder.path(), "thread.so", &[folder.join("thread.c")], &["-pthread"]).unwrap();
    let run = |options: &[&str]| {
        let preloaded = ("LD_PRELOAD", folder.join("thread.so"));
        let mut command = folder.command(&[&LOADED[..], options].concat());
        String::from_utf8(command.env(preloaded.0, preloaded.1).output().unwrap().stderr).unwrap()
    };
    let said = run(&[]);
    let warning = "warning: nothing supervises the plug-ins";
    assert!(
        said.contains(warning) && said.contains("other threads") && said.contains("--plugin-process"),
        "{said}"
    );
    assert!(!run(&["--plugin-process"]).contains(warning));
    assert!(!folder.voltet(&LOADED).ok().stderr.contains(warning));
}

#[test]
fn an_end_of_memory_in_the_program_is_no_call_of_exit_of_the_plugin() {
    let Some(folder) = folder(0) else { return };
    let ran = folder.voltet(&with_fault("gradient.fault=memory ends", &[]));
    let ran = ran.fails(1, &["memory ends: found no room"]);
    assert!(!ran.stderr.contains("call of exit"), "{}", ran.stderr);
}

#[test]
fn the_file_that_was_hashed_is_the_one_that_is_loaded() {
    let Some(folder) = folder(0) else { return };
    let path = folder.join("filter.so");
    let hashed = voltet_plugins::PluginFile::read(&path).unwrap();
    let other = compilers::source("examples/plugin_c/least_squares.c");
    compilers::library(folder.path(), "filter.so", &[other], &[]).unwrap();
    let loaded = voltet_plugins::load_file(&hashed).unwrap().plugin.unwrap();
    assert_eq!((&*loaded.name, loaded.fingerprint_text()), ("faulty", hashed.fingerprint()));
    let program = env!("CARGO_BIN_EXE_voltet").into();
    let apart = voltet_plugins::load_apart(&hashed, program).map(drop).unwrap_err().to_string();
    assert!(apart.contains("its file has changed"), "{apart}");
    // One that looks for others beside itself is loaded from its file, if that is still the same.
    let build = |fault: &str| {
        let options = [fault, "-D_DEFAULT_SOURCE", "-Wl,-rpath,$ORIGIN"];
        compilers::library(
            folder.path(),
            "bound.so",
            &[compilers::source("tests/plugins/faulty.c")],
            &options,
        )
        .unwrap();
        voltet_plugins::PluginFile::read(&folder.join("bound.so")).unwrap()
    };
    let hashed = build("-DFAULT=0");
    build("-DFAULT=1");
    let changed = voltet_plugins::load_file(&hashed).map(drop).unwrap_err().to_string();
    assert!(changed.contains("its file has changed since it was checked"), "{changed}");
    let loaded = voltet_plugins::load_file(&build("-DFAULT=0")).unwrap().plugin.unwrap();
    assert_eq!(loaded.name, "faulty");
}

#[test]
fn pipes_are_refused_and_files_that_all_may_change_are_warned_of() {
    use std::os::unix::fs::PermissionsExt;
    let Some(folder) = folder(0) else { return };
    let made = std::process::Command::new("mkfifo").arg(folder.join("pipe.so")).status().unwrap();
    assert!(made.success());
    folder.voltet(&["nodes", "--plugin", "pipe.so"]).fails(2, &["cannot be read: found a pipe or a device"]);
    let path = folder.join("filter.so");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o666)).unwrap();
    let ran = folder.voltet(&LOADED).ok();
    assert!(
        ran.stderr.contains("every user of this machine may change the plug-in 'filter.so'"),
        "{}",
        ran.stderr
    );
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o644)).unwrap();
    assert!(!folder.voltet(&LOADED).ok().stderr.contains("may change"));
}

#[test]
fn paths_of_the_users_file_begin_in_the_home_folder_and_relative_variables_are_ignored() {
    let Some(folder) = folder(0) else { return };
    let configuration = folder.join(".config/voltet");
    std::fs::create_dir_all(&configuration).unwrap();
    let run = |text: &str, variables: &[(&str, &str)]| {
        std::fs::write(configuration.join("plugins.toml"), text).unwrap();
        let mut command = folder.command(&["check", "slab.toml"]);
        command.env("XDG_CONFIG_HOME", ".config").env("HOME", folder.path());
        let output = command.envs(variables.iter().copied()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    // The relative variable names no folder: that of the home counts.
    let (code, said) = run("plugins = ['~/filter.so']\n", &[]);
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = run("plugins = ['~other/filter.so']\n", &[]);
    assert!(code == Some(2) && said.contains("home folders of other users are not looked up"), "{said}");
    // Nor does a relative home: no file is found, and so no filter. Others may write into the folder of temporary files.
    let shared = folder.join("tmp");
    std::fs::create_dir_all(shared.join("voltet")).unwrap();
    std::fs::write(shared.join("voltet/plugins.toml"), "plugins = ['../../filter.so']\n").unwrap();
    let variables = [("HOME", "."), ("TMPDIR", shared.to_str().unwrap())];
    let (code, said) = run("plugins = ['~/filter.so']\n", &variables);
    assert!(code == Some(2) && said.contains("unknown gradient filter 'faulty'"), "{said}");
}
