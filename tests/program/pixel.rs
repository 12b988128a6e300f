//! `voltet pixel`: one pixel cell by cell.

use super::support::{Folder, SLAB};
use serde_json::Value;
use voltet_testing::pictures::integrators::NAMES;

/// The slab with a ramp of the scalar, which every integrator serves, on the CPU.
fn ramp(folder: &Folder) {
    let even = SLAB.find("kind = \"uniform\"").unwrap()..SLAB.find("[nodes.view]").unwrap();
    let points = "kind = \"piecewise-linear\"\npoints = [[0.0, 1.0, 0.5, 0.25, 0.5], [0.4, 0.2, 0.6, 1.0, 3.0], \
                  [1.0, 0.1, 1.0, 0.1, 0.0]]\n\n";
    let text = format!("{}{points}{}", &SLAB[..even.start], &SLAB[even.end..]);
    folder.write("ramp.toml", text.replace("type = \"renderer\"", "type = \"renderer\"\nengine = \"cpu\""));
}

fn json(folder: &Folder, arguments: &[&str]) -> Value {
    let ran = folder.voltet(&[&["pixel"], arguments, &["--json", "-"]].concat()).ok();
    serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{}: {}", ran.command, ran.stdout))
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list = value.as_array().unwrap_or_else(|| panic!("{value}"));
    std::array::from_fn(|k| list[k].as_f64().unwrap())
}

fn said<'a>(found: &'a Value, name: &str) -> &'a Value {
    found["integrators"].as_array().unwrap().iter().find(|said| said["integrator"] == name).unwrap()
}

/// What is said of a run is said of what measures its picture, too.
#[test]
fn warnings_of_what_feeds_the_picture_are_shown() {
    let folder = Folder::new();
    for command in
        [&["pixel", "slab.toml", "4", "3"][..], &["time", "slab.toml", "--frames", "1", "--engine", "cpu"]]
    {
        let ran = folder.voltet(&[command, &["--set", "look.widgets=[]"]].concat()).ok();
        let said = ran.stderr.matches("warning: look: the transfer function has no widgets").count();
        assert_eq!(said, 1, "{}: {}", ran.command, ran.stderr);
    }
}

#[test]
fn a_pixel_of_the_slab_is_its_cells_added_up() {
    let folder = Folder::new();
    let found = json(&folder, &["slab.toml", "4", "3"]);
    let cells = found["cells"].as_array().unwrap();
    assert!(cells.len() >= 3, "{found:#}");
    assert!(
        cells.iter().all(|cell| cell["cell_type"] == "hexahedron" && cell["cell"].as_u64().unwrap() < 27)
    );
    let length: f64 = cells.iter().map(|cell| cell["length"].as_f64().unwrap()).sum();
    assert!((length - 1.0).abs() < 1e-12 && (cells[0]["entry"].as_f64().unwrap() - 3.0).abs() < 1e-12);
    assert!((cells[0]["at_entry"]["s"].as_f64().unwrap()).abs() < 1e-12);
    assert_eq!(cells[0]["widgets"][0]["kind"], "uniform");
    assert_eq!(cells[0]["widgets"][0]["share"], 1.0);
    let mut sum = [0.0; 4];
    for cell in cells {
        let adds: [f64; 4] = numbers(&cell["adds"]);
        (0..4).for_each(|c| sum[c] += adds[c]);
    }
    let opacity = 1.0 - (-2.0f64).exp();
    let exact = [0.5, 1.0, 0.25, 1.0].map(|c| c * opacity);
    for (c, exact) in exact.into_iter().enumerate() {
        assert!((sum[c] - exact).abs() < 1e-12, "{sum:?}");
        assert!((numbers::<4>(&found["referee_rgba"])[c] - exact).abs() < 1e-12);
    }
    assert!(found["drawn"]["difference"].as_f64().unwrap() < 1e-6, "{}", found["drawn"]);
    assert_eq!(folder.names(), ["cube.vtu", "slab.toml"], "no picture is written");
}

/// Rounding of 32 bits over a few segments, as at any pixel of an ordinary picture.
const ROUNDING: f64 = 1e-5;

#[test]
fn each_integrator_says_what_it_draws() {
    let folder = Folder::new();
    ramp(&folder);
    for name in NAMES {
        let set = format!("picture.integrator={name}");
        // Few pieces and small tables: what an integrator gets wrong is more than rounding.
        let sets = ["--set", &set, "--set", "picture.segments=2", "--set", "picture.table_size=16"];
        let found = json(&folder, &[&["ramp.toml", "3", "4"], &sets[..]].concat());
        let own = said(&found, name);
        assert_eq!(own["pipeline"], true);
        let (own, drawn) = (numbers::<4>(&own["rgba"]), numbers::<4>(&found["drawn"]["rgba"]));
        for c in 0..4 {
            assert!((own[c] - drawn[c]).abs() < ROUNDING, "{name}: {own:?}, drawn {drawn:?}");
        }
        let most = found["drawn"]["difference"].as_f64().unwrap();
        let coarse = ["segments", "riemann", "pre-integrated", "pre-integrated-cylindrical"].contains(&name);
        assert_eq!(coarse, most > 10.0 * ROUNDING, "{name}: {most}");
    }
    let found = json(&folder, &["ramp.toml", "3", "4"]);
    assert!(said(&found, "reference")["difference"].as_f64().unwrap() < 1e-12);
    let found = json(&folder, &["slab.toml", "3", "4"]);
    assert!(said(&found, "vertex-sampled")["why_not"].as_str().unwrap().contains("by themselves"));
}

#[test]
fn stages_eyes_inside_and_several_rays_are_traced_too() {
    let folder = Folder::new();
    ramp(&folder);
    let stages = "type = \"composite\"\ninputs = { projection = \"cover\", transfer_function = \"look\" }\n\
                  [nodes.cells]\ntype = \"cull\"\ninputs = { volume = \"gradient\", transfer_function = \"look\", camera = \
                  \"view\" }\n[nodes.order]\ntype = \"sort\"\ninputs = { cells = \"cells\", camera = \"view\" }\n\
                  [nodes.cover]\ntype = \"project\"\ninputs = { cells = \"order\", camera = \"view\" }\n";
    let start = SLAB.find("type = \"renderer\"").unwrap();
    let end = SLAB.find("[nodes.file]").unwrap();
    folder.write("stages.toml", format!("{}{stages}\n{}", &SLAB[..start], &SLAB[end..]));
    let (one, other) = (json(&folder, &["slab.toml", "2", "5"]), json(&folder, &["stages.toml", "2", "5"]));
    assert_eq!(one["cells"], other["cells"]);
    assert_eq!(other["drawn"]["engine"].as_str().unwrap().split(',').next(), Some("cpu"));
    let inside = ["--set", "view.eye=[0.4, 0.45, 0.55]"];
    let found = json(&folder, &[&["ramp.toml", "4", "4"], &inside[..]].concat());
    assert_eq!(found["cells"][0]["entry"], 0.0);
    assert!(found["drawn"]["difference"].as_f64().unwrap() < ROUNDING);
    let rays = ["--set", "view.samples=4", "--set", "view.eye=[-3.0, 1.5, 1.0]"];
    let of = |sample| json(&folder, &[&["ramp.toml", "4", "4", "--sample", sample], &rays[..]].concat());
    let all = ["0", "1", "2", "3"].map(of);
    for c in 0..4 {
        let mean = all.iter().map(|one| numbers::<4>(&one["ray_rgba"])[c]).sum::<f64>() / 4.0;
        assert!((numbers::<4>(&all[0]["referee_rgba"])[c] - mean).abs() < 1e-15);
    }
    assert_ne!(all[0]["ray_rgba"], all[3]["ray_rgba"]);
    assert!(all[0]["drawn"]["difference"].as_f64().unwrap() < ROUNDING);
    let wrong = ["pixel", "slab.toml", "4", "4", "--sample", "1"];
    folder.voltet(&wrong).fails(2, &["no such ray", "--sample 1", "0 to 0"]);
}

#[test]
fn light_and_silhouettes_are_part_of_it() {
    let folder = Folder::new();
    ramp(&folder);
    let surface = [
        "--set",
        "picture.light={direction = [1, 1, 0], ambient = 0.2}",
        "--set",
        "picture.silhouette=2",
        "--set",
        "view.eye=[-2.0, -1.0, 1.5]",
    ];
    let found = json(&folder, &[&["ramp.toml", "4", "4"], &surface[..]].concat());
    let cell = &found["cells"][0];
    // The gradient is (1, 0, 0), at 45° to the light.
    assert!((cell["light"].as_f64().unwrap() - (0.2 + 0.7 * 0.5f64.sqrt())).abs() < 1e-6, "{cell}");
    let silhouette = cell["silhouette"].as_f64().unwrap();
    assert!(silhouette > 0.01 && silhouette < 0.9, "{cell}");
    assert!(found["drawn"]["difference"].as_f64().unwrap() < ROUNDING, "{}", found["drawn"]);
    assert!(said(&found, "analytic")["difference"].as_f64().unwrap() < 1e-9);
    let text = folder.voltet(&[&["pixel", "ramp.toml", "4", "4"], &surface[..]].concat()).ok().stdout;
    assert!(text.contains("silhouette") && text.contains("light"), "{text}");
}

#[test]
fn what_shows_nothing_says_why() {
    let folder = Folder::new();
    for (sets, wanted) in [
        (
            &["view.eye=[-3.0, 9.0, 0.5]", "view.target=[0.5, 9.0, 0.5]"][..],
            "the ray meets no cell of the grid",
        ),
        (&["view.near=7"], "cells on the ray lie before the near plane"),
        (&["look.widgets.0.region={ s = [5.0, 6.0] }"], "no widget takes any of these values"),
        (&["look.widgets.0.extinction=0"], "no widget takes any of these values"),
        (
            &["look.widgets.0.extinction=1e-9"],
            "where the widgets hardly absorb: an optical depth of 2.000e-9",
        ),
    ] {
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let text = folder.voltet(&[&["pixel", "slab.toml", "4", "4"], &sets[..]].concat()).ok().stdout;
        assert!(text.contains("nothing to be seen: ") && text.contains(wanted), "{text}");
    }
    let outside = ["pixel", "slab.toml", "8", "-1"];
    folder.voltet(&outside).fails(2, &["outside the picture", "X 8, Y -1", "X 0 to 7, Y 0 to 7"]);
}

#[test]
fn long_rays_show_what_adds_most_and_files_hold_everything() {
    let folder = Folder::new();
    folder.write("cube.vtu", super::support::cube(20));
    let files = ["--csv", "p.csv", "--json", "p.json", "--plot", "p.svg"];
    let ran = folder.voltet(&[&["pixel", "slab.toml", "4", "3"], &files[..]].concat()).ok();
    let found = folder.json("p.json");
    let count = found["cells"].as_array().unwrap().len();
    assert!(count > 24, "{count}");
    let left = format!("{} cells that add less are left out", count - 24);
    assert!(ran.stdout.contains(&left) && ran.stdout.contains("--all"), "{}", ran.stdout);
    let all = folder.voltet(&["pixel", "slab.toml", "4", "3", "--all"]).ok().stdout;
    assert!(
        !all.contains("left out") && all.lines().count() == ran.stdout.lines().count() + count - 25,
        "{all}"
    );
    let csv = std::fs::read_to_string(folder.join("p.csv")).unwrap();
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = head.iter().position(|name| *name == "adds_opacity").unwrap();
    let sum: f64 = lines.map(|line| line.split(',').nth(column).unwrap().parse::<f64>().unwrap()).sum();
    assert!((sum - numbers::<4>(&found["referee_rgba"])[3]).abs() < 1e-12);
    let svg = std::fs::read_to_string(folder.join("p.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.matches("<title>tetrahedron").count() == count, "{}", svg.len());
    folder.voltet(&["pixel", "slab.toml", "4", "3", "--plot", "p.png"]).fails(2, &["p.png", "ends in .svg"]);
    let onto = ["pixel", "slab.toml", "4", "3", "--json", "cube.vtu"];
    folder.voltet(&onto).fails(2, &["overwrite what the call reads", "--json cube.vtu"]);
}

#[test]
fn pictures_and_several_nodes_are_taken() {
    let folder = Folder::new();
    folder.voltet(&["run", "slab.toml"]).ok();
    let (one, other) = (json(&folder, &["slab.toml", "4", "4"]), json(&folder, &["slab.exr", "4", "4"]));
    assert_eq!(one, other);
    let more = "[nodes.second]\ntype = \"renderer\"\nintegrator = \"reference\"\ninputs = { volume = \"gradient\", \
                transfer_function = \"look\", camera = \"view\" }\n[nodes.more]\ntype = \"image-writer\"\npath = \
                \"more.png\"\ninputs = { image = \"second\" }\n";
    folder.write("two.toml", format!("{SLAB}{more}"));
    folder.voltet(&["pixel", "two.toml", "4", "4"]).fails(2, &["several nodes", "picture, second", "--node"]);
    let found = json(&folder, &["two.toml", "4", "4", "--node", "second"]);
    assert_eq!(found["drawn"]["engine"], "reference");
    assert_eq!(found["cells"], one["cells"]);
}
