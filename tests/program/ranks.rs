//! Several processes by MPI, started by mpirun: `cargo test --features mpi --test program ranks`.

use super::parts::SCENE;
use super::support::Folder;
use std::process::{Command, Output};
use voltet_testing::files::pieces::write_pieces;

/// Runs the program by so many processes.
fn mpirun(folder: &Folder, count: usize, arguments: &[&str]) -> Output {
    let count = count.to_string();
    let program = folder.command(&[]).get_program().to_owned();
    let mut launcher = Command::new("mpirun");
    // Names of Open MPI alone, which MPICH does not read.
    launcher.envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")]);
    launcher.env("OMPI_MCA_rmaps_base_oversubscribe", "1");
    launcher.args(["-n", &count]).arg(program).args(arguments).current_dir(folder.path());
    launcher.output().expect("mpirun is installed where the program is built with MPI")
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
    for count in [2, 3, 7] {
        let ran = mpirun(&folder, count, &["run", "scene.toml", "--output", "all.exr", "--report", "r.json"]);
        assert!(ran.status.success(), "{count}: {}", String::from_utf8_lossy(&ran.stderr));
        let all = folder.floats("all.exr").1;
        let differences = one.as_flattened().iter().zip(all.as_flattened()).map(|(a, b)| (a - b).abs());
        let largest = differences.fold(0.0, f32::max);
        assert!(largest < 1e-5, "{count}: {largest:e}");
        assert!(folder.report("r.json")["counts"]["bytes_sent"].as_u64().unwrap() > 0);
        // One of them speaks.
        let lines = String::from_utf8(ran.stdout).unwrap();
        assert_eq!(lines.lines().filter(|line| line.contains("cells")).count(), 1, "{lines}");
        std::fs::remove_file(folder.join("all.exr")).unwrap();
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
