//! `voltet time`.

use crate::support::Folder;

/// Two nodes that draw: one colour, which needs no order, and two.
const SCENE: &str = include_str!("../../lab/bench/scenes/wavelet.toml");

const SMALL: [&str; 6] = ["--set", "grid.resolution=[4,4,4]", "--size", "24x16,8x8", "--frames", "2"];

#[test]
fn every_node_that_draws_is_timed_at_every_size() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let out = folder.voltet(&[&["time", "scene.toml", "--engine", "cpu"], &SMALL[..]].concat()).ok().stdout;
    let rows: Vec<&str> = out.lines().filter(|line| line.contains(" cpu ")).collect();
    // One Gaussian once a size, the others in two orders.
    assert_eq!(rows.len(), (1 + 2 + 2) * 2, "{out}");
    assert!(rows[0].starts_with("| one_gaussian | 24 × 16 | cpu | not needed | **"), "{out}");
    let columns = |line: &str| line.matches('|').count();
    let table: Vec<&str> = out.lines().filter(|line| line.starts_with('|')).collect();
    assert!(table.iter().all(|line| columns(line) == columns(table[0])), "{out}");
    assert!(!folder.join("one_gaussian.png").exists());
}

#[test]
#[cfg(feature = "gpu")]
fn what_a_device_does_not_draw_stands_in_its_row() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let narrow = ["--set", "four_gaussians_look.widgets.0.sigma=[1e-6, 1.0]", "--patience", "0"];
    let gpu = ["time", "scene.toml", "--engine", "gpu", "--adapter", "software"];
    let Some(ran) = folder.voltet(&[&gpu[..], &SMALL, &narrow].concat()).on_software_driver() else { return };
    let out = ran.stdout;
    assert!(out.contains("device: "), "{out}");
    assert!(out.lines().any(|line| line.contains("scalar_alone") && line.contains("**")), "{out}");
    // Its frames follow each other in flight, too.
    let drawn = out.lines().filter(|line| line.contains("**"));
    let in_flight = drawn.map(|line| line.split('|').nth(7).unwrap().trim().parse::<f64>());
    assert!(
        in_flight.clone().count() > 0 && in_flight.into_iter().all(|ms| ms.is_ok_and(|ms| ms > 0.0)),
        "{out}"
    );
    assert!(out.lines().any(|line| line.contains("four_gaussians") && line.contains("narrower")), "{out}");
}

#[test]
fn what_cannot_be_timed_is_said() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    folder.voltet(&["time", "scene.toml", "--size", "24"]).fails(2, &["--size", "WIDTHxHEIGHT"]);
    folder.voltet(&["time", "scene.toml", "--frames", "0"]).fails(2, &["--frames"]);
    folder.voltet(&["time", "scene.toml", "--patience", "-1"]).fails(2, &["--patience"]);
    folder.voltet(&["time", "gone.toml"]).fails(2, &["gone.toml"]);
    let histogram = include_str!("../../pipelines/histogram.toml");
    folder.write("none.toml", histogram);
    folder.voltet(&["time", "none.toml"]).fails(2, &["nothing to time"]);
}
