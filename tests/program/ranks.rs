//! Several processes by MPI, started by mpirun: `cargo test --features mpi --test program ranks`.

use super::parts::SCENE;
use super::support::Folder;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use voltet_testing::files::pieces::write_pieces;

/// Runs the program by so many processes.
fn mpirun(folder: &Folder, count: usize, arguments: &[&str]) -> Output {
    launcher(folder, count, arguments)
        .output()
        .expect("mpirun is installed where the program is built with MPI")
}

/// The launcher of so many processes of the program.
fn launcher(folder: &Folder, count: usize, arguments: &[&str]) -> Command {
    let count = count.to_string();
    let program = folder.command(&[]).get_program().to_owned();
    // `MPIRUN` names that of another MPI.
    let mut launcher = Command::new(std::env::var_os("MPIRUN").unwrap_or_else(|| "mpirun".into()));
    // Names of Open MPI alone, which MPICH does not read.
    launcher.envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")]);
    launcher.env("OMPI_MCA_rmaps_base_oversubscribe", "1");
    launcher.args(["-n", &count]).arg(program).args(arguments).current_dir(folder.path());
    launcher
}

fn folder() -> Folder {
    let folder = Folder::new();
    write_pieces(folder.path(), "grid", 5, |[i, j, k]| (7 * i + 13 * j * j + 29 * k * i + k) % 5);
    folder.write("scene.toml", SCENE);
    folder
}

#[test]
fn processes_draw_the_picture_of_one() {
    let folder = folder();
    folder.voltet(&["run", "scene.toml", "--quiet", "--output", "one.exr"]).ok();
    let one = folder.floats("one.exr").1;
    // With seven some have nothing.
    for count in [2, 3, 4, 7] {
        let ran = mpirun(&folder, count, &["run", "scene.toml", "--output", "all.exr", "--report", "r.json"]);
        assert!(ran.status.success(), "{count}: {}", String::from_utf8_lossy(&ran.stderr));
        let all = folder.floats("all.exr").1;
        let differences = one.as_flattened().iter().zip(all.as_flattened()).map(|(a, b)| (a - b).abs());
        let largest = differences.fold(0.0, f32::max);
        assert!(largest < 1e-6, "{count}: {largest:e}");
        assert!(folder.report("r.json")["counts"]["bytes_sent"].as_u64().unwrap() > 0);
        // One of them speaks.
        let lines = String::from_utf8(ran.stdout).unwrap();
        assert_eq!(lines.lines().filter(|line| line.contains("cells")).count(), 1, "{lines}");
        std::fs::remove_file(folder.join("all.exr")).unwrap();
    }
}

/// The launcher of one MPI, told by its variables, and a program of another: each process is alone there.
#[test]
fn a_launcher_of_another_mpi_is_refused() {
    let folder = folder();
    let is_mpich = std::env::var("MPIRUN").is_ok_and(|name| name.contains("mpich"));
    let [count, rank] =
        if is_mpich { ["OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"] } else { ["PMI_SIZE", "PMI_RANK"] };
    // Of a grid in one piece processes exchange nothing.
    write_pieces(folder.path(), "whole", 1, |_| 0);
    folder.write("whole.toml", SCENE.replace("grid.pvtu", "whole.pvtu"));
    for (scene, number) in [("scene.toml", "0"), ("whole.toml", "0"), ("whole.toml", "1")] {
        let mut command = folder.command(&["run", scene, "--output", "all.exr"]);
        let ran = command.env(count, "2").env(rank, number).output().unwrap();
        let said = String::from_utf8_lossy(&ran.stderr);
        assert!(!ran.status.success() && !folder.join("all.exr").exists(), "{scene}: {said}");
        for words in [&format!("rank {number} of 2"), "another MPI", "rank 0 of 1", "mpicc"] {
            assert!(said.contains(words), "{scene}, {words}: {said}");
        }
    }
}

#[test]
fn a_process_that_fails_ends_all_and_says_why() {
    let folder = folder();
    std::fs::write(folder.join("grid_3.vtu"), "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece>")
        .unwrap();
    let ran = mpirun(&folder, 3, &["run", "scene.toml", "--output", "all.exr"]);
    assert!(!ran.status.success());
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(said.contains("rank ") && said.contains("grid_3.vtu"), "{said}");
    assert!(!folder.join("all.exr").exists());
}

#[test]
fn a_missing_piece_ends_all_with_its_name() {
    let folder = folder();
    std::fs::remove_file(folder.join("grid_4.vtu")).unwrap();
    let ran = mpirun(&folder, 2, &["run", "scene.toml", "--output", "all.exr"]);
    assert!(!ran.status.success());
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(said.contains("rank ") && said.contains("grid_4.vtu"), "{said}");
    assert_eq!(said.matches(" fails:").count(), 1, "one process says it: {said}");
}

/// The time within which processes end of which one has ended.
const PATIENCE: Duration = Duration::from_secs(30);

/// Waits for the end of a launcher, which is killed where it does not come.
fn end_of(mut launcher: Child) -> Option<std::process::ExitStatus> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(status) = launcher.try_wait().unwrap() {
            return Some(status);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    launcher.kill().unwrap();
    launcher.wait().unwrap();
    None
}

/// The number of the process that runs as a rank in a folder.
fn process_of(folder: &Path, rank: usize) -> Option<String> {
    let names = [format!("OMPI_COMM_WORLD_RANK={rank}"), format!("PMI_RANK={rank}")];
    std::fs::read_dir("/proc").unwrap().find_map(|entry| {
        let entry = entry.unwrap();
        let of_process = |name: &str| std::fs::read(entry.path().join(name)).ok();
        let is_here = std::fs::read_link(entry.path().join("cwd")).ok()? == folder.canonicalize().ok()?;
        let variables = of_process("environ")?;
        let is_rank =
            variables.split(|byte| *byte == 0).any(|own| names.iter().any(|name| own == name.as_bytes()));
        let is_program = of_process("cmdline")?.split(|byte| *byte == 0).next()?.ends_with(b"voltet");
        (is_here && is_rank && is_program).then(|| entry.file_name().into_string().ok())?
    })
}

#[test]
fn a_process_that_is_killed_ends_all_at_every_stage() {
    let folder = folder();
    // Each piece is read some times, and the picture takes long enough to be hit.
    let arguments = ["run", "scene.toml", "--size", "600x500", "--output", "all.exr"];
    let start = Instant::now();
    assert!(mpirun(&folder, 2, &arguments).status.success());
    let whole = start.elapsed();
    std::fs::remove_file(folder.join("all.exr")).unwrap();
    let mut killed = 0;
    for (stage, rank) in (0..8).zip([0, 1].into_iter().cycle()) {
        let mut command = launcher(&folder, 2, &arguments);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(whole * (2 * stage + 1) / 16);
        let process = process_of(folder.path(), rank);
        let was_killed = process.is_some_and(|process| {
            Command::new("kill").args(["-KILL", &process]).stderr(Stdio::null()).status().unwrap().success()
        });
        let status =
            end_of(child).unwrap_or_else(|| panic!("stage {stage}: the others wait for rank {rank}"));
        killed += u32::from(was_killed && !status.success());
        // What is there is whole.
        if folder.join("all.exr").exists() {
            assert_eq!(folder.floats("all.exr").1.len(), 600 * 500, "stage {stage}");
            std::fs::remove_file(folder.join("all.exr")).unwrap();
        }
    }
    assert!(killed >= 4, "of 8 processes {killed} were killed before they ended");
}

#[test]
fn a_full_disk_ends_all_and_says_where() {
    let folder = folder();
    std::fs::create_dir(folder.join("full")).unwrap();
    let script = "mount -t tmpfs -o size=4k none full && exec \"$@\"";
    let mut command = Command::new("unshare");
    command.args(["--mount", "--map-root-user", "sh", "-c", script, "sh"]);
    let inner = launcher(&folder, 2, &["run", "scene.toml", "--size", "400x300", "--output", "full/all.exr"]);
    command.arg(inner.get_program()).args(inner.get_args()).current_dir(folder.path());
    command.envs(inner.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let ran = command.output().unwrap();
    let said = String::from_utf8_lossy(&ran.stderr);
    if said.contains("unshare") || said.contains("mount:") {
        println!("SKIPPED: no file system can be mounted here ({})", said.lines().next().unwrap_or_default());
        return;
    }
    assert!(!ran.status.success());
    assert!(
        said.contains("rank 0 of 2") && said.contains("all.exr") && said.contains("no space left"),
        "{said}"
    );
}
