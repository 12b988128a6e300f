//! The examples, compiled and run: each draws what `voltet` draws of its mesh.

use crate::library::{PIPELINE, folder, library, picture, real};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use voltet_testing::compilers;

/// A folder in which Catalyst finds the implementation.
fn installed(folder: &Path) -> PathBuf {
    // Tests stand beside the libraries that were built for them.
    let built = std::env::current_exe().unwrap().parent().unwrap().join("libcatalyst_voltet.so");
    std::os::unix::fs::symlink(built, folder.join("libcatalyst-voltet.so")).unwrap();
    folder.into()
}

/// A program that is linked with libcatalyst; `None` without a compiler.
#[track_caller]
fn program(folder: &Path, source: &str) -> Option<PathBuf> {
    let library = library()?;
    let headers = match real() {
        Some(path) => path.parent().unwrap().join("../include/catalyst-2.0"),
        None => compilers::source("crates/catalyst/tests/c"),
    };
    let [headers, library, beside] =
        [headers.as_path(), library, library.parent().unwrap()].map(|path| path.to_str().unwrap());
    let options = ["-O2", "-I", headers, library, &format!("-Wl,-rpath,{beside}")];
    compilers::program(folder, "heat", &[compilers::source(source)], &options)
}

fn run(program: &Path, words: &[&str]) -> Output {
    Command::new(program).args(words).output().unwrap()
}

#[test]
fn the_solvers_are_drawn_while_they_run() {
    let mut pictures = Vec::new();
    for source in ["examples/catalyst_cpp/heat.cpp", "examples/catalyst_fortran/heat.F90"] {
        let folder = folder(PIPELINE);
        let own = folder.path();
        // Without one compiler the other's pictures are looked at.
        let Some(program) = program(own, source) else { continue };
        let scene = own.join("scene.toml");
        let words = [installed(own).to_str().unwrap().to_string(), scene.to_str().unwrap().to_string()];
        let output = run(&program, &words.each_ref().map(String::as_str));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.is_empty(), "{source}: {said}");
        for name in ["000.exr", "010.exr", "020.exr"] {
            pictures.push(picture(&own.join(name)));
        }
    }
    assert!(pictures.iter().all(|picture| picture.rgba.iter().any(|pixel| pixel[3] > 0.05)));
    // The heat spreads: each step has another picture.
    for steps in pictures.chunks(3) {
        assert!(steps[0].rgba != steps[1].rgba && steps[1].rgba != steps[2].rgba);
    }
}

#[test]
fn a_mistake_ends_the_example_with_one_message() {
    let folder = folder(PIPELINE);
    let own = folder.path();
    let Some(program) = program(own, "examples/catalyst_cpp/heat.cpp") else { return };
    let scene = own.join("scene.toml");
    let words = [installed(own).to_str().unwrap().to_string(), scene.to_str().unwrap().to_string()];
    let output = run(&program, &[&words[0], &words[1], "1", "picture.engin=cpu"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.starts_with("voltet: catalyst_initialize: unknown parameter 'engin'"), "{said}");
    assert!(said.ends_with("catalyst_initialize: status 100\n") && said.lines().count() == 2, "{said}");
}

/// One of several processes that a launcher has started, and no MPI that runs: each would write the same files.
#[test]
fn a_launched_process_without_mpi_is_refused() {
    let folder = folder(PIPELINE);
    let own = folder.path();
    let Some(program) = program(own, "examples/catalyst_cpp/heat.cpp") else { return };
    let output = Command::new(program)
        .args([installed(own), own.join("scene.toml")])
        .env("OMPI_COMM_WORLD_SIZE", "4")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let what = if cfg!(feature = "mpi") { "MPI has not been started" } else { "built without MPI" };
    assert!(said.contains(what) && said.contains("found 4 processes"), "{said}");
    assert_eq!(output.status.code(), Some(1), "{said}");
}

/// The examples under `mpirun`: the picture of several processes is that of one.
#[cfg(feature = "mpi")]
#[test]
fn several_processes_of_mpi_draw_the_picture_of_one() {
    // Numbers of the whole mesh.
    let pipeline =
        PIPELINE.replace("[0.5, 1.0]", "[\"60%\", \"30%\"]").replace("[0.3, 1.5]", "[\"15%\", \"40%\"]");
    // `MPICXX`, `MPIFORT` and `MPIRUN` name those of another MPI.
    let named = |variable: &str, name: &str| std::env::var_os(variable).unwrap_or_else(|| name.into());
    let solvers = [
        (named("MPICXX", "mpicxx"), "examples/catalyst_cpp/heat.cpp"),
        (named("MPIFORT", "mpifort"), "examples/catalyst_fortran/heat.F90"),
    ];
    for (compiler, source) in solvers {
        let mut pictures = Vec::new();
        for count in [1, 2, 3] {
            let folder = folder(&pipeline);
            let own = folder.path();
            let library = library().expect("a compiler");
            let headers = match real() {
                Some(path) => path.parent().unwrap().join("../include/catalyst-2.0"),
                None => compilers::source("crates/catalyst/tests/c"),
            };
            let heat = own.join("heat");
            let compiled = Command::new(&compiler)
                .args(["-O2", "-DHEAT_MPI", "-I"])
                .arg(headers)
                .arg(compilers::source(source))
                .arg(library)
                .arg(format!("-Wl,-rpath,{}", library.parent().unwrap().display()))
                .arg("-o")
                .arg(&heat)
                .current_dir(own)
                .output()
                .unwrap();
            assert!(compiled.status.success(), "{source}: {}", String::from_utf8_lossy(&compiled.stderr));
            let output = Command::new(named("MPIRUN", "mpirun"))
                .args(["-n", &count.to_string()])
                .arg(&heat)
                .args([installed(own), own.join("scene.toml")])
                .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
                .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
                .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
                .output()
                .unwrap();
            assert!(output.status.success(), "{source}: {}", String::from_utf8_lossy(&output.stderr));
            pictures.push(picture(&own.join("010.exr")));
        }
        assert!(pictures[0].rgba.iter().any(|pixel| pixel[3] > 0.05), "something is seen");
        for (count, found) in pictures.iter().enumerate() {
            let both = found.rgba.iter().flatten().zip(pictures[0].rgba.iter().flatten());
            let largest = both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            println!("{source}, {} processes: largest difference {largest:e}", count + 1);
            assert!(largest <= crate::ranks::SAME, "{source}, {} processes: {largest}", count + 1);
        }
    }
}
