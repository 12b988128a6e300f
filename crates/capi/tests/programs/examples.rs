//! The examples draw what `voltet run` draws, bit for bit.

use crate::library::{Installed, succeed};
use crate::truth;
use std::path::Path;
use std::process::Command;
use voltet_testing::compilers;

/// Draws the example's own grid, and the same from a pipeline file.
#[track_caller]
fn draws_what_the_program_draws(installed: &Installed, program: &Path) {
    let [ppm, rgba, scene] = ["box.ppm", "box.rgba", "box.toml"].map(|name| installed.path(name));
    truth::write_box(&installed.path("box.vtk"));
    std::fs::write(&scene, truth::BOX).unwrap();
    let truth = truth::picture(truth::BOX, scene.parent().unwrap());
    assert_eq!(truth.len(), 160 * 120 * 16);
    // That the program wrote it, and that the library does not.
    std::fs::remove_file(installed.path("box.exr")).unwrap();
    // Something is seen: the middle shows the inner shell.
    assert!(f32::from_ne_bytes(*truth[16 * (60 * 160 + 80)..].first_chunk().unwrap()) > 0.1);

    succeed(program, &[Path::new("own"), &ppm, &rgba]);
    assert!(
        std::fs::read(&rgba).unwrap() == truth,
        "the grid in memory is drawn as another picture than the file"
    );
    std::fs::remove_file(&rgba).unwrap();
    succeed(program, &[Path::new("file"), &scene, &ppm, &rgba]);
    assert!(
        std::fs::read(&rgba).unwrap() == truth,
        "the pipeline is drawn as another picture than by the program"
    );
    let read = std::fs::read(&ppm).unwrap();
    assert!(read.starts_with(b"P6\n160 120\n255\n") && read.len() == 15 + 160 * 120 * 3);
    assert!(!installed.path("box.exr").exists(), "the pipeline's writer wrote");
}

#[test]
fn the_example_in_c_draws_what_the_program_draws() {
    let installed = Installed::new();
    let Some(program) = installed.program(&["examples/renderer_c/picture.c"]) else { return };
    draws_what_the_program_draws(&installed, &program);
}

#[test]
fn the_static_library_serves_with_the_libraries_that_are_listed() {
    let installed = Installed::new();
    let Some(program) = installed.static_program(&["examples/renderer_c/picture.c"]) else { return };
    draws_what_the_program_draws(&installed, &program);
}

#[test]
fn the_example_in_fortran_draws_what_the_program_draws() {
    let installed = Installed::new();
    let sources = ["include/voltet.f90", "examples/renderer_fortran/picture.f90"];
    let Some(program) = installed.program(&sources) else { return };
    draws_what_the_program_draws(&installed, &program);
}

/// The page's commands as they stand, in a copy of what they need.
#[test]
fn the_commands_of_the_page_do_what_it_says() {
    if !["cc", "gfortran", "pkg-config"].into_iter().all(is_there) {
        return eprintln!("\n*** SKIPPED: cc, gfortran and pkg-config are not all there ***\n");
    }
    let installed = Installed::new();
    for name in ["pipelines", "include", "examples", "data", "scripts", "crates", "Cargo.toml"] {
        std::os::unix::fs::symlink(compilers::source(name), installed.path(name)).unwrap();
    }
    let page = std::fs::read_to_string(compilers::source("docs/src/how-to/c.md")).unwrap();
    let blocks: Vec<&str> =
        page.split("```sh\n").skip(1).filter_map(|block| block.split("```").next()).collect();
    assert_eq!(blocks.len(), 4);
    let output = Command::new("bash")
        .args(["-euo", "pipefail", "-c", &blocks.concat()])
        .current_dir(installed.path(""))
        .env("PREFIX", installed.path("prefix"))
        // These libraries are built already.
        .env("VOLTET_BUILT", installed.path("built"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let picture = |name: &str| std::fs::read(installed.path(name)).unwrap();
    assert!(picture("own.ppm").len() > 160 * 120 * 3);
    assert_eq!(picture("own.ppm"), picture("own_fortran.ppm"));
    assert_eq!(picture("own.ppm"), picture("own_static.ppm"));
    assert!(picture("quickstart.ppm").starts_with(b"P6\n800 600\n255\n"));
}

/// True if there is such a program; where compilers are required, their absence fails the other tests.
fn is_there(name: &str) -> bool {
    Command::new(name).arg("--version").output().is_ok()
}
