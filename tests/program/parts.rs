//! Grids larger than the memory that they may take.

use super::support::Folder;
use voltet_testing::files::pieces::{SIDE, write_pieces};

pub const SCENE: &str = r#"[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = "grid.pvtu"
scalar = "t"

[nodes.look]
type = "transfer-function"
inputs = { volume = "grid" }

[[nodes.look.widgets]]
kind = "uniform"
region = { s = ["p60", "100%"] }
extinction = 9.0
color = [1.0, 0.4, 0.1]

[nodes.view]
type = "camera"
view = "isometric"
inputs = { volume = "grid" }
size = [48, 40]

[nodes.picture]
type = "renderer"
inputs = { volume = "grid", transfer_function = "look", camera = "view" }

[nodes.out]
type = "image-writer"
path = "picture.exr"
inputs = { image = "picture" }
"#;

#[test]
fn a_grid_is_drawn_in_parts_where_memory_is_little() {
    let folder = Folder::new();
    write_pieces(folder.path(), "grid", 4, |[i, _, _]| i * 4 / SIDE);
    folder.write("scene.toml", SCENE);
    folder.voltet(&["run", "scene.toml", "--quiet"]).ok();
    let whole = folder.floats("picture.exr").1;
    let ran = folder.voltet(&["run", "scene.toml", "--memory", "10 kB", "--report", "r.json"]).ok();
    assert!(ran.stdout.contains("cells"), "{}", ran.stdout);
    assert!(folder.report("r.json")["counts"]["ray_stretches"].as_u64().unwrap() > 0);
    let parts = folder.floats("picture.exr").1;
    let differences = whole.as_flattened().iter().zip(parts.as_flattened()).map(|(a, b)| (a - b).abs());
    assert!(differences.fold(0.0, f32::max) < 1e-6);
    // Where it fits, it is drawn whole.
    folder.voltet(&["run", "scene.toml", "--memory", "1GiB", "--report", "r.json"]).ok();
    assert!(folder.report("r.json")["counts"]["ray_stretches"].is_null());
    folder.voltet(&["run", "scene.toml", "--memory", "much"]).fails(2, &["4GiB"]);
}

/// Without MPI: several processes would write one picture, unless each has its own share of several.
#[test]
#[cfg(not(feature = "mpi"))]
fn several_processes_need_mpi_or_a_share_each() {
    let folder = super::series::series(2);
    let run = |name: &str, further: &[&str]| {
        folder.voltet_where((name, "3"), &[&["run", "p.toml", "--steps", "all"], further].concat())
    };
    run("OMPI_COMM_WORLD_SIZE", &[]).fails(2, &["built without MPI", "--part"]);
    run("OMPI_COMM_WORLD_SIZE", &["--part", "1/2"]).ok();
    // Slurm starts programs without MPI, too.
    run("SLURM_STEP_NUM_TASKS", &[]).ok();
}
