//! Outputs: existing files are kept until new ones are whole, devices and pipes are written as they are, "-" is the standard
//! output, and what is stopped leaves nothing behind.
#![cfg(unix)]

use super::support::{Folder, cube};
use std::io::Read;
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longer than it takes on any machine to end, and far less than what is stopped would take: hours, or for ever.
const PATIENCE: Duration = Duration::from_secs(600);

/// First bytes of a PNG file and of an OpenEXR file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
const EXR: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

fn pipe(folder: &Folder, name: &str) {
    assert!(Command::new("mkfifo").arg(folder.join(name)).status().unwrap().success());
}

#[test]
fn pipes_are_written_and_not_replaced() {
    let folder = Folder::new();
    pipe(&folder, "pipe");
    symlink("pipe", folder.join("to the pipe")).unwrap();
    let path = folder.join("pipe");
    let reader = std::thread::spawn(move || {
        let mut all = [Vec::new(), Vec::new()];
        all.iter_mut().for_each(|all| drop(std::fs::File::open(&path).unwrap().read_to_end(all)));
        all
    });
    folder.voltet(&["run", "slab.toml", "--set", "file.path=to the pipe", "--set", "file.format=exr"]).ok();
    folder.voltet(&["run", "slab.toml", "--report", "pipe", "--quiet"]).ok();
    let [picture, report] = reader.join().unwrap();
    folder.voltet(&["run", "slab.toml"]).ok();
    let floats = image::load_from_memory(&picture).unwrap().into_rgba32f();
    assert_eq!(floats, image::open(folder.join("slab.exr")).unwrap().into_rgba32f());
    assert_eq!(serde_json::from_slice::<serde_json::Value>(&report).unwrap()["runs"][0]["file"], "slab.toml");
    assert_eq!(folder.names(), ["cube.vtu", "pipe", "slab.exr", "slab.toml", "to the pipe"]);
}

#[test]
fn a_device_that_is_full_is_an_error_and_stays() {
    if cfg!(target_os = "linux") {
        let folder = Folder::new();
        let wanted = ["'/dev/full' cannot be written", "no space left"];
        folder.voltet(&["run", "slab.toml", "--report", "/dev/full"]).fails(1, &wanted);
        folder.voltet(&["run", "slab.toml", "--set", "file.path=/dev/full"]).fails(1, &wanted);
        assert!(!std::fs::metadata("/dev/full").unwrap().is_file());
    }
}

#[test]
fn links_are_followed_and_stay() {
    let folder = Folder::new();
    std::fs::create_dir(folder.join("pictures")).unwrap();
    symlink("pictures/there.exr", folder.join("slab.exr")).unwrap();
    // Twice: the file that the link leads to is not there at first.
    for _ in 0..2 {
        folder.voltet(&["run", "slab.toml"]).ok();
        assert!(std::fs::symlink_metadata(folder.join("slab.exr")).unwrap().is_symlink());
        assert!(std::fs::read(folder.join("pictures/there.exr")).unwrap().starts_with(EXR));
    }
    assert_eq!(std::fs::read_dir(folder.join("pictures")).unwrap().count(), 1, "nothing is left beside");
    assert_eq!(folder.names(), ["cube.vtu", "pictures", "slab.exr", "slab.toml"]);
}

#[test]
fn a_file_that_is_there_keeps_its_permissions_and_owner() {
    let folder = Folder::new();
    folder.voltet(&["run", "slab.toml", "--report", "report.json"]).ok();
    for (name, mode) in [("slab.exr", 0o600), ("report.json", 0o664)] {
        std::fs::set_permissions(folder.join(name), PermissionsExt::from_mode(mode)).unwrap();
    }
    // Who may not give files away has no other owner's file to keep.
    let given = std::os::unix::fs::chown(folder.join("slab.exr"), Some(4321), Some(4322)).is_ok();
    let before = |name| std::fs::metadata(folder.join(name)).unwrap();
    let inodes = ["slab.exr", "report.json"].map(|name| before(name).ino());
    folder.voltet(&["run", "slab.toml", "--report", "report.json"]).ok();
    for (name, mode, inode) in [("slab.exr", 0o600, inodes[0]), ("report.json", 0o664, inodes[1])] {
        let now = before(name);
        assert_eq!(now.mode() & 0o7777, mode, "{name}");
        assert_ne!(now.ino(), inode, "written anew, beside");
    }
    if given {
        assert_eq!((before("slab.exr").uid(), before("slab.exr").gid()), (4321, 4322));
    }
}

#[test]
fn a_read_only_file_is_refused_whoever_asks() {
    let folder = Folder::new();
    for name in ["slab.exr", "report.json"] {
        folder.write(name, "precious");
        std::fs::set_permissions(folder.join(name), PermissionsExt::from_mode(0o444)).unwrap();
    }
    let read_only = |name: &str| format!("'{name}' is read-only and is left as it is");
    folder.voltet(&["run", "slab.toml"]).fails(1, &[&read_only("slab.exr"), "node 'file'", ":39:8"]);
    let aside = ["run", "slab.toml", "--set", "file.path=other.exr", "--report", "report.json"];
    folder.voltet(&aside).fails(1, &[&read_only("report.json")]);
    for name in ["slab.exr", "report.json"] {
        assert_eq!(std::fs::read(folder.join(name)).unwrap(), b"precious");
    }
    assert_eq!(folder.names(), ["cube.vtu", "report.json", "slab.exr", "slab.toml"], "nothing ran");
}

#[test]
fn the_standard_output_carries_one_thing_alone() {
    let folder = Folder::new();
    let ran = folder.voltet(&["run", "slab.toml", "--report", "-"]).ok();
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(report["runs"][0]["counts"]["cells_total"], 162);
    assert!(ran.stderr.starts_with("slab.exr: 162 cells"), "{}", ran.stderr);
    for (set, magic) in [("file.format=auto", PNG), ("file.format=png", PNG), ("file.format=exr", EXR)] {
        let sets = ["run", "slab.toml", "--set", "file.path=-", "--set", set];
        let output = folder.command(&sets).output().unwrap();
        assert!(output.status.success() && output.stdout.starts_with(magic), "{set}");
        assert_eq!(image::load_from_memory(&output.stdout).unwrap().width(), 8);
        assert!(output.stderr.starts_with(b"the standard output: 162 cells"), "{output:?}");
    }
    let both = ["run", "slab.toml", "--report", "-", "--set", "file.path=-"];
    folder
        .voltet(&both)
        .fails(2, &["two outputs of this call are one file", "'-', which 'path' of the node 'file'"]);
    let often = ["run", "slab.toml", "--exhaustive", "--set", "file.path=-"];
    folder.voltet(&often).fails(2, &["several times"]);
    folder.voltet(&["run", "slab.toml", "--set", "file.path=./-", "--set", "file.format=png"]).ok();
    assert_eq!(folder.names(), ["-", "cube.vtu", "slab.exr", "slab.toml"]);
}

#[test]
fn nobody_who_reads_is_no_error_and_a_full_output_is_one() {
    let folder = Folder::new();
    for arguments in [&["nodes", "--markdown"][..], &["info", "cube.vtu"], &["run", "slab.toml"], &["--help"]]
    {
        let mut program =
            folder.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(program.stdout.take());
        let output = program.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {output:?}");
        assert!(output.stderr.is_empty(), "{arguments:?}: {output:?}");
        if cfg!(target_os = "linux") {
            let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
            let output = folder.command(arguments).stdout(full).output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
            assert!(
                said.contains("error: the standard output cannot be written: found no space left"),
                "{said}"
            );
            assert_eq!(said.matches("error:").count(), 1, "{said}");
        }
    }
}

/// Progress of a run at which it is stopped.
#[derive(Clone, Copy)]
enum Come {
    /// It computes, and has for a second of its own time.
    Computes,
    /// It waits for somebody who reads.
    Waits,
}

/// Returns once a run has come so far, as Linux tells of its threads; elsewhere after a time that is long enough.
fn wait_until(come: Come, id: u32) {
    if !cfg!(target_os = "linux") {
        return std::thread::sleep(Duration::from_millis(1500));
    }
    let start = Instant::now();
    let mut quiet = 0;
    while quiet < 10 {
        assert!(start.elapsed() < PATIENCE, "the run never comes so far");
        std::thread::sleep(Duration::from_millis(20));
        let tasks = std::fs::read_dir(format!("/proc/{id}/task")).expect("the run is still on its way");
        // Behind the name in brackets: the state, then ten numbers, then ticks of a hundredth of a second.
        let stat = |task: std::io::Result<std::fs::DirEntry>| {
            std::fs::read_to_string(task.ok()?.path().join("stat")).ok()
        };
        let stats: Vec<String> = tasks.filter_map(stat).collect();
        let fields = stats.iter().filter_map(|stat| stat.rsplit_once(") ")).map(|(_, rest)| rest.split(' '));
        quiet = match come {
            Come::Computes => {
                let ticks = |mut fields: std::str::Split<char>| fields.nth(11)?.parse::<u64>().ok();
                if fields.filter_map(ticks).sum::<u64>() >= 100 { 10 } else { 0 }
            }
            // Threads that have something to do are not asleep, however busy the machine is.
            Come::Waits if fields.map(|mut fields| fields.next()).all(|state| state == Some("S")) => {
                quiet + 1
            }
            Come::Waits => 0,
        };
    }
}

/// Starts a run, sends the signal once the program has come so far, and asserts that it ends soon and leaves nothing.
#[track_caller]
fn stopped(signal: &str, arguments: &[&str], come: Come) {
    let folder = Folder::new();
    folder.write("cube.vtu", cube(24));
    pipe(&folder, "pipe");
    let before = folder.names();
    let mut program =
        folder.command(arguments).stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    wait_until(come, program.id());
    assert!(program.try_wait().unwrap().is_none(), "the run is still on its way");
    let sent = Command::new("kill").args([signal, &program.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let start = Instant::now();
    while program.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < PATIENCE, "{signal} does not stop {arguments:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(program.wait().unwrap().code(), Some(1), "{signal} {arguments:?}");
    assert_eq!(folder.names(), before, "{signal} {arguments:?}");
}

#[test]
fn a_signal_ends_the_work_and_the_wait_for_a_reader_and_leaves_nothing() {
    let drawing =
        ["run", "slab.toml", "--set", "picture.integrator=reference", "--set", "view.size=[4000, 4000]"];
    let waiting = ["run", "slab.toml", "--set", "file.path=pipe", "--set", "file.format=exr"];
    // More than a pipe holds, also compressed.
    let printing = [
        "run",
        "slab.toml",
        "--set",
        "file.path=-",
        "--set",
        "file.format=exr",
        "--set",
        "view.size=[3000, 3000]",
    ];
    for signal in ["-TERM", "-INT", "-HUP"] {
        stopped(signal, &waiting, Come::Waits);
        // All signals have one handler: a short series sends one to the runs that take long.
        if signal == "-TERM" || voltet_testing::whole_series() {
            stopped(signal, &drawing, Come::Computes);
            stopped(signal, &printing, Come::Waits);
        }
    }
}
