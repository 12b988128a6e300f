//! The pictures that ship against the 64-bit reference, which shares no formula with the engine.
//!
//! `cargo test --test accuracy -- --nocapture` prints the differences.

use std::path::Path;
use std::process::Command;

/// Small, because the reference integrates every segment by quadrature.
const SIZE: &str = "view.size=[64,48]";

/// Largest difference allowed of a premultiplied channel. The engine works in 32 bits, and a pixel here sums up to some
/// hundred segments: rounding and the quadrature where widgets overlap give 3.2e-5 (measured). 2e-4 is a twentieth of a step of an 8-bit picture.
const LARGEST: f32 = 2e-4;

/// `engine`: none for an adapter that is not there, said loudly; a failure if the environment variable
/// `VOLTET_REQUIRE_GPU` is 1.
fn draw(pipeline: &str, integrator: &str, engine: &str, folder: &Path) -> Option<Vec<f32>> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines").join(pipeline);
    let picture = folder.join(format!("{pipeline}.{integrator}.{engine}.exr"));
    let output = Command::new(env!("CARGO_BIN_EXE_voltet"))
        .args(["run", "--quiet"])
        .arg(source)
        .args(["--set", SIZE, "--set", &format!("picture.integrator={integrator}")])
        .args(["--set", &format!("picture.engine={engine}")])
        .args(["--set", &format!("file.path={}", picture.display())])
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr);
    if engine == "gpu" && said.contains("no hardware adapter") {
        voltet_testing::skipped_without_device(said);
        return None;
    }
    assert!(output.status.success(), "{pipeline}: {said}");
    Some(image::open(&picture).expect("the program wrote a picture").to_rgba32f().into_raw())
}

fn compare(pipeline: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let reference = draw(pipeline, "reference", "cpu", folder.path()).expect("the CPU is there");
    let engines: &[&str] = if cfg!(feature = "gpu") { &["cpu", "gpu"] } else { &["cpu"] };
    for engine in engines {
        let Some(ours) = draw(pipeline, "analytic", engine, folder.path()) else { continue };
        assert!(ours.iter().all(|value| value.is_finite()), "{pipeline}: a value is not finite");
        let differences = ours.iter().zip(&reference).map(|(a, b)| (a - b).abs());
        let largest = differences.clone().fold(0.0, f32::max);
        let mean = differences.sum::<f32>() / ours.len() as f32;
        println!("{pipeline}, {engine}: largest difference of a channel {largest:.1e}, mean {mean:.1e}");
        assert!(largest <= LARGEST, "{pipeline}, {engine}: {largest:e} is more than {LARGEST:e}");
    }
}

#[test]
fn bivariate_widgets() {
    compare("quickstart.toml");
}

#[test]
fn piecewise_linear() {
    compare("quickstart_1d.toml");
}

#[test]
fn narrow_gaussians() {
    compare("isotherms.toml");
}

#[test]
fn widgets_of_probes() {
    compare("probe.toml");
}

#[test]
fn eye_inside_the_grid() {
    compare("inside.toml");
}
