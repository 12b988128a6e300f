//! The engine that a pipeline asks for, what is taken, and what is said about it.

use super::support::{Folder, SLAB};
use voltet::Document;
use voltet::graph::NoObserver;
use voltet::lanes::LaneSet;

/// The device's picture, in the same file as the CPU's. `None` without an adapter, said loudly; a failure if the
/// environment variable `VOLTET_REQUIRE_GPU` is 1.
fn run_on_device(folder: &Folder) -> Option<serde_json::Value> {
    let (gpu, tiles) = ("picture.engine=\"gpu\"", "picture.compositor=\"tiles\"");
    let arguments = ["run", "slab.toml", "--report", "report.json", "--quiet", "--set", gpu, "--set", tiles];
    let ran = folder.voltet(&arguments);
    if ran.code == 0 {
        return Some(folder.report("report.json"));
    }
    assert!(ran.stderr.contains("no hardware adapter"), "{}", ran.stderr);
    voltet_testing::skipped_without_device(&ran.stderr);
    None
}

#[test]
fn the_device_draws_what_the_cpu_draws_and_is_named() {
    let folder = Folder::new();
    let cpu = "picture.engine=\"cpu\"";
    folder.voltet(&["run", "slab.toml", "--quiet", "--set", cpu]).ok();
    let (_, expected) = folder.floats("slab.exr");
    let Some(report) = run_on_device(&folder) else { return };
    assert_eq!(report["engine"], "gpu");
    assert!(report["adapter"].as_str().is_some_and(|name| !name.is_empty()), "{report:#}");
    assert_eq!(report["counts"]["cells_total"], 162);
    assert!(report["counts"]["segments"].as_u64().is_some_and(|n| n >= 16 * 3), "{report:#}");
    // One uniform widget: no other kind, no light, no sampling is part of the shader.
    let left_out = report["left_out"].as_array().unwrap().iter();
    let parts: Vec<&str> =
        left_out.filter_map(|left| left["what"].as_str()?.strip_prefix("shader parts ")).collect();
    let [parts] = parts.as_slice() else { panic!("{report:#}") };
    for part in ["gaussian", "wave", "light", "table", "adaptive", "piecewise_linear"] {
        assert!(parts.split(", ").any(|left| left == part), "'{part}' is not in {parts}");
    }
    for part in ["widgets", "compositor", "passes"] {
        assert!(!parts.split(", ").any(|left| left == part), "'{part}' is in {parts}");
    }
    let (_, found) = folder.floats("slab.exr");
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        // Rounding of a dozen 32-bit segments.
        assert!((a - b).abs() < 2e-6, "{a} for {b}");
    }
}

#[test]
fn auto_says_which_engine_it_took_and_why() {
    let folder = Folder::new();
    folder.voltet(&["run", "slab.toml", "--report", "report.json", "--quiet"]).ok();
    let report = folder.report("report.json");
    let reason = report["engine_reason"].as_str().unwrap();
    match report["engine"].as_str().unwrap() {
        "gpu" => assert!(reason.contains("fastest kind"), "{reason}"),
        "cpu" => assert!(reason.contains("no hardware adapter: found"), "{reason}"),
        other => panic!("{other}"),
    }
}

#[test]
fn an_adapter_that_is_not_there_is_an_error_with_its_line() {
    let folder = Folder::new();
    let text = std::fs::read_to_string(folder.join("slab.toml")).unwrap();
    let wish = "type = \"gpu-renderer\"\nadapter = \"no such thing\"";
    folder.write("slab.toml", text.replace("type = \"renderer\"", wish));
    let ran = folder.voltet(&["run", "slab.toml"]);
    ran.fails(1, &["no adapter is called \"no such thing\"", "slab.toml:35:11"]);
}

/// A moved camera uploads and compiles nothing; another colour neither; another kind of widget compiles its text.
#[test]
fn the_grid_and_the_pipelines_stay_on_the_device() {
    let folder = Folder::new();
    if run_on_device(&folder).is_none() {
        return;
    }
    let registry = voltet::registry().unwrap();
    let mut session = voltet::nodes::session();
    let mut work = |options: &[&str]| {
        let options: Vec<String> = ["picture.engine=\"gpu\"", "picture.compositor=\"tiles\""]
            .iter()
            .chain(options)
            .map(|option| option.to_string())
            .collect();
        let document = Document::open(&folder.join("slab.toml"), &options, &registry).unwrap();
        let counts = session.run(&document.graph, &NoObserver).unwrap().counts;
        (counts["uploads"], counts["shader_builds"] > 0)
    };
    // Points, cells and the scalar.
    assert_eq!(work(&[]), (3, true));
    let moved = "view.eye=[-3.0, 0.6, 0.4]";
    assert_eq!(work(&[moved]), (0, false));
    assert_eq!(work(&[moved, "look.widgets.0.color=[1, 0, 0]"]), (0, false));
    let other = "look.widgets.0={ kind = \"gaussian\", color = [1, 0, 0], extinction = 1, centre = [0.5, 0.0], sigma = [0.1, inf] }";
    assert_eq!(work(&[moved, other]), (0, true));
}

/// Compositor in the report, with these settings of the picture; `None` without an adapter.
fn composited(folder: &Folder, settings: &[&str]) -> Option<serde_json::Value> {
    let mut arguments = vec!["run", "slab.toml", "--report", "report.json", "--quiet"];
    for setting in [&["picture.engine=\"gpu\"", "picture.adapter=\"software\""], settings].concat() {
        arguments.extend(["--set", setting]);
    }
    folder.voltet(&arguments).on_software_driver()?;
    Some(folder.report("report.json"))
}

/// One colour needs no order: each compositor draws the picture of the CPU, and `auto` is the standard one.
#[test]
fn each_compositor_draws_the_picture_of_the_cpu() {
    let folder = Folder::new();
    let cpu = "picture.engine=\"cpu\"";
    folder.voltet(&["run", "slab.toml", "--quiet", "--set", cpu]).ok();
    let (_, expected) = folder.floats("slab.exr");
    let why = "the pipeline asks for it";
    for wish in ["tiles", "raster"].into_iter().chain(cfg!(feature = "papers").then_some("triangles")) {
        let Some(report) = composited(&folder, &[&format!("picture.compositor=\"{wish}\"")]) else { return };
        assert_eq!((&report["compositor"], &report["compositor_reason"]), (&wish.into(), &why.into()));
        assert_eq!(report["counts"]["segments"].is_null(), wish != "tiles", "{report:#}");
        assert_eq!(report["counts"]["pixels_disordered"], 0);
        let (_, found) = folder.floats("slab.exr");
        for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
            // Rounding of a dozen 32-bit segments.
            assert!((a - b).abs() < 2e-6, "{wish}: {a} for {b}");
        }
    }
    let report = composited(&folder, &[]).unwrap();
    assert_eq!(
        (&report["compositor"], &report["compositor_reason"]),
        (&"tiles".into(), &"it is the standard one".into())
    );
}

/// Two emitters need an order: tiles are taken for the exact one, also where what blends is asked for, which is said. What the order
/// of centroids gets wrong is not counted by what blends.
#[test]
fn an_exact_order_is_drawn_by_tiles() {
    let folder = Folder::new();
    let glow = "look.model=\"constant-emitter\"";
    let Some(report) = composited(&folder, &[glow]) else { return };
    let exact = (&"tiles".into(), &"each pixel needs its exact order".into());
    assert_eq!((&report["compositor"], &report["compositor_reason"]), exact);
    let asks = |report: &serde_json::Value, wish: &str| {
        let warnings = report["warnings"].as_array().unwrap().iter();
        let said = format!("drawn by tiles, in place of compositor = \"{wish}\"");
        warnings.filter_map(|warning| warning.as_str()).any(|warning| warning.contains(&said))
    };
    for wish in ["raster"].into_iter().chain(cfg!(feature = "papers").then_some("triangles")) {
        let compositor = format!("picture.compositor=\"{wish}\"");
        let report = composited(&folder, &[glow, &compositor]).unwrap();
        assert_eq!((&report["compositor"], &report["compositor_reason"]), exact);
        assert!(asks(&report, wish), "{report:#}");
        let report = composited(&folder, &[glow, &compositor, "picture.order=\"centroid\""]).unwrap();
        assert_eq!(report["compositor"], wish);
        assert!(report["counts"]["pixels_disordered"].is_null() && !asks(&report, wish), "{report:#}");
    }
}

/// A scene that no device supports is refused before any data are read, with the line that states it; `auto` takes another engine.
#[test]
fn an_integrator_that_the_named_engine_lacks_is_refused_by_check() {
    let folder = Folder::new();
    let reference = ["check", "slab.toml", "--set", "picture.integrator=reference"];
    folder.voltet(&reference).ok();
    let gpu = [&reference[..], &["--set", "picture.engine=gpu"]].concat();
    folder
        .voltet(&gpu)
        .fails(2, &["no shader", "reference", "engine = \"cpu\", or one of the integrators analytic"]);
    let explained = folder.voltet(&["explain", "slab.toml", "--set", "picture.integrator=reference"]).ok();
    let wanted = "reference (the integrator reference has an engine of its own)";
    assert!(explained.stdout.contains(wanted), "{}", explained.stdout);
}

/// A widget that draws nothing does not change the one colour: on no engine does it require an order of the pixels' segments, and it
/// leaves the picture as it is.
#[test]
fn an_undrawn_widget_of_another_colour_asks_no_engine_for_an_order() {
    let folder = Folder::new();
    let undrawn = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 0.0, 0.0]\nextinction = 0.0\n\
                   centre = [0.5, 0.0]\nsigma = [0.3, inf]\n\n[nodes.view]";
    folder.write("both.toml", SLAB.replace("[nodes.view]", undrawn));
    for engine in voltet::nodes::drawing::ENGINES {
        let engine = format!("picture.engine=\"{}\"", engine.name);
        let draw = |file: &str, extinction: &str| {
            let extinction = format!("look.widgets.{extinction}");
            let settings = [&engine, "picture.adapter=\"software\"", "file.path=\"slab.exr\"", &extinction];
            let mut arguments = vec!["run", file, "--report", "report.json", "--quiet"];
            settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
            folder.voltet(&arguments).on_software_driver()?;
            Some((folder.floats("slab.exr").1, folder.report("report.json")))
        };
        let needs_order = |report: &serde_json::Value| {
            let counted = |name: &str| report["counts"][name].as_u64().is_some_and(|count| count > 0);
            // Rays that go from cell to cell have it, whether it is needed or not.
            let left_out = report["left_out"].as_array().unwrap();
            let is_left_out = left_out.iter().any(|left| left["what"] == "visibility order");
            counted("tiles_sorted")
                || (counted("cells_cast") && !is_left_out)
                || report["compositor_reason"] == "each pixel needs its exact order"
        };
        let Some((alone, _)) = draw("slab.toml", "0.extinction=1.0") else { continue };
        let (behind, report) = draw("both.toml", "1.extinction=0.0").unwrap();
        assert!(!needs_order(&report), "{engine}: {report:#}");
        for (a, b) in behind.iter().flatten().zip(alone.iter().flatten()) {
            // A compiler may fuse the sums of another text otherwise.
            assert!((a - b).abs() < 1e-6, "{engine}: {a} for {b}");
        }
        assert!(alone.iter().any(|pixel| pixel[3] > 0.8), "{engine}: the slab is not seen");
        // Drawn, it does.
        let (_, report) = draw("both.toml", "1.extinction=1.0").unwrap();
        assert!(needs_order(&report), "{engine}: {report:#}");
    }
}

/// The environment chooses the vector lanes of the native engine; what it does not know is no choice.
#[test]
fn vector_lanes_that_are_misspelt_are_refused() {
    let folder = Folder::new();
    let run = ["run", "slab.toml", "--report", "r.json", "--quiet", "--set", "picture.engine=\"cpu\""];
    let misspelt = folder.voltet_where(("VOLTET_LANES", "avx-2"), &run);
    let names = LaneSet::ALL.map(LaneSet::name).join(", ");
    misspelt.fails(2, &["VOLTET_LANES", "found avx-2", &names]);
    assert!(!folder.join("slab.exr").exists());
    folder.voltet_where(("VOLTET_LANES", "portable"), &run).ok();
    assert!(folder.report("r.json")["adapter"].as_str().unwrap().starts_with("portable, "));
}
