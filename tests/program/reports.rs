//! Report of a run: skipped work, and work that is not done twice.

use super::support::{Folder, SLAB};
use voltet::Document;
use voltet::graph::NoObserver;

#[test]
fn the_report_has_times_counts_and_what_was_left_out() {
    let folder = Folder::new();
    let cpu = "picture.engine=\"cpu\"";
    folder.voltet(&["run", "slab.toml", "--report", "report.json", "--quiet", "--set", cpu]).ok();
    let whole = folder.json("report.json");
    assert!(cfg!(not(target_os = "linux")) || whole["peak_memory_bytes"].as_u64().unwrap() > 1 << 20);
    assert_eq!(whole["versions"]["voltet"], env!("CARGO_PKG_VERSION"));
    let report = folder.report("report.json");
    assert_eq!(report["engine"], "cpu");
    assert_eq!(report["engine_reason"], "the pipeline asks for it");
    assert_eq!(report["counts"]["cells_total"], 162);
    assert_eq!(report["counts"]["cells_culled"], 0);
    assert_eq!(report["counts"]["pixels_disordered"], 0);
    assert!(report["counts"]["segments"].as_u64().unwrap() >= 16 * 3, "{report:#}");
    assert!(report["counts"]["cells_projected"].as_u64().unwrap() > 0);
    assert!(report["seconds"].as_f64().unwrap() > 0.0);
    let nodes = report["nodes"].as_array().unwrap();
    let names: Vec<&str> = nodes.iter().map(|node| node["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["grid", "gradient", "look", "view", "picture", "file"]);
    assert!(nodes.iter().all(|node| node["seconds"].as_f64().unwrap() > 0.0 && node["reused"] == false));
    assert!(nodes[4]["stages"]["composite"].as_f64().unwrap() > 0.0);
    let left_out: Vec<String> = (report["left_out"].as_array().unwrap().iter())
        .map(|left| format!("{}: {}", left["node"].as_str().unwrap(), left["what"].as_str().unwrap()))
        .collect();
    assert!(left_out.contains(&"gradient: gradient".into()), "{left_out:?}");
    assert!(left_out.contains(&"picture: visibility order".into()), "{left_out:?}");
    assert!(
        left_out.iter().any(|left| left.starts_with("grid: arrays") && left.contains("ones")),
        "{left_out:?}"
    );
}

#[test]
fn a_gradient_that_is_looked_at_is_not_left_out() {
    let folder = Folder::new();
    let region = "look.widgets.0.region={ g = [0.5, 2.0] }";
    folder.voltet(&["run", "slab.toml", "--report", "report.json", "--set", region]).ok();
    let report = folder.report("report.json");
    let what: Vec<&str> =
        report["left_out"].as_array().unwrap().iter().map(|left| left["what"].as_str().unwrap()).collect();
    assert!(what.contains(&"gradient vectors") && !what.contains(&"gradient"), "{what:?}");
}

#[test]
fn several_files_make_one_report_and_share_what_they_read() {
    let folder = Folder::new();
    folder.write(
        "again.toml",
        SLAB.replace("slab.exr", "again.exr").replace("extinction = 1.0", "extinction = 2.0"),
    );
    folder.voltet(&["run", "slab.toml", "again.toml", "--report", "report.json"]).ok();
    let report = folder.json("report.json");
    let reused = |run: usize, node: usize| report["runs"][run]["nodes"][node]["reused"].as_bool().unwrap();
    assert_eq!(
        (0..6).map(|node| reused(1, node)).collect::<Vec<_>>(),
        [true, true, false, true, false, false]
    );
    assert!((0..6).all(|node| !reused(0, node)));
}

#[test]
fn a_changed_parameter_repeats_only_what_depends_on_it() {
    let folder = Folder::new();
    let registry = voltet::registry().unwrap();
    let mut session = voltet::nodes::session();
    let mut repeated = |options: &[&str]| {
        let options: Vec<String> = options.iter().map(|option| option.to_string()).collect();
        let document = Document::open(&folder.join("slab.toml"), &options, &registry).unwrap();
        let report = session.run(&document.graph, &NoObserver).unwrap();
        report.nodes.into_iter().filter(|node| !node.reused).map(|node| node.name).collect::<Vec<_>>()
    };
    let (color, size) = ("look.widgets.0.color=[1, 0, 0]", "view.size=[4, 4]");
    assert_eq!(repeated(&[]), ["grid", "gradient", "look", "view", "picture", "file"]);
    assert_eq!(repeated(&[]), Vec::<String>::new());
    assert_eq!(repeated(&[color]), ["look", "picture", "file"]);
    assert_eq!(repeated(&[color, size]), ["view", "picture", "file"]);
    // The gradient was not asked for so far; the grid serves again.
    let region = "look.widgets.0.region={ g = [0.5, 2.0] }";
    assert_eq!(repeated(&[color, size, region]), ["gradient", "look", "picture", "file"]);
    assert_eq!(repeated(&[color, size, region, "file.path=b.exr"]), ["file"]);
    // A picture that is gone is written again, data that changed are read again.
    std::fs::remove_file(folder.join("b.exr")).unwrap();
    assert_eq!(repeated(&[color, size, region, "file.path=b.exr"]), ["file"]);
    folder.write("cube.vtu", super::support::cube(2));
    assert_eq!(repeated(&[color, size, region, "file.path=b.exr"]), ["grid", "gradient", "picture", "file"]);
    // A picture carries its pipeline.
    folder.write("slab.toml", SLAB.replace("An even slab", "A slab"));
    assert_eq!(repeated(&[color, size, region, "file.path=b.exr"]), ["file"]);
    let without = [color, size, region, "file.path=b.exr", "file.provenance=false"];
    assert_eq!(repeated(&without), ["file"]);
    folder.write("slab.toml", SLAB);
    assert_eq!(repeated(&without), Vec::<String>::new());
}
