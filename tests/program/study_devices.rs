//! `voltet study` on a device: rows of its own, what it does not draw, and its keys written back.

use super::study::{scene, stages};
use super::support::{Folder, Ran};
use serde_json::Value;
use voltet::nodes::drawing::ENGINES;
use voltet_study::work_precision::RendererVariant;

const STUDY: [&str; 6] = ["study", "scene.toml", "--frames", "2", "--cache", "cache"];

fn folder(text: &str) -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", text);
    folder
}

/// A study with the software driver; `None` where there is none.
fn study(folder: &Folder, more: &[&str]) -> Option<(Ran, Value)> {
    let ran = folder.voltet(&[&STUDY, more].concat()).on_software_driver()?;
    Some((ran, folder.json("scene.study/study.json")))
}

fn rows<'a>(json: &'a Value, engine: &str) -> Vec<&'a Value> {
    json["rows"].as_array().unwrap().iter().filter(|row| row["setting"]["engine"] == engine).collect()
}

#[test]
fn a_device_has_rows_of_its_own_beside_the_native_engine() {
    let folder = folder(&scene());
    let more = ["--adapter", "software", "--only", "analytic,segments"];
    let Some((ran, json)) = study(&folder, &more) else { return };
    let (native, device) = (rows(&json, "cpu"), rows(&json, "gpu"));
    let of = |name: &str| device.iter().filter(|row| row["setting"]["compositor"] == name).count();
    // Exact and mix in two orders; seven numbers of pieces and three further tables. What blends has the centroids' order alone.
    let triangles = if cfg!(feature = "papers") { 12 } else { 0 };
    assert_eq!([native.len(), of("tiles"), of("raster"), of("triangles")], [14, 14, 12, triangles]);
    let is_exact = |row: &&&Value| row["setting"]["order"] == "exact";
    assert!(device.iter().filter(is_exact).all(|row| row["setting"]["compositor"] == "tiles"));
    let adapter = json["adapter"].as_str().unwrap();
    assert!(adapter.contains("software"), "{adapter}");
    for row in &device {
        assert_eq!(row["setting"]["adapter"], adapter);
        let time = |what: &str| row["cost"][what]["median_ms"].as_f64().unwrap();
        assert!(time("set_up") > 0.0 && time("frame") > 0.0, "{row:#}");
        // What is set up stays for the next picture.
        assert_eq!(time("picture"), time("frame"));
        // Stages are timed by the device or absent, never 0.
        for stage in ["cull", "project", "composite"] {
            let times = &row["cost"][stage];
            assert!(times.is_null() || times["median_ms"].as_f64().unwrap() > 0.0, "{row:#}");
        }
        let counted = row["setting"]["compositor"] == "tiles";
        assert_eq!(counted, row["cost"]["segments"].as_u64().is_some_and(|count| count > 0), "{row:#}");
        assert_eq!(row["of_file"], false, "auto takes no software");
    }
    let error = |row: &Value| row["errors"]["maximum"].as_f64().unwrap();
    // What pictures of ordinary scenes are held to on both engines.
    let exact = device.iter().find(|row| row["setting"]["integrator"] == "analytic").unwrap();
    assert!(error(exact) < 2e-4, "{exact:#}");
    assert_eq!(native.iter().filter(|row| row["of_file"] == true).count(), 1);
    assert_eq!(json["convergence"].as_array().unwrap().len(), RendererVariant::all().count());

    let csv = std::fs::read_to_string(folder.join("scene.study/study.csv")).unwrap();
    assert!(csv.starts_with("engine,compositor,adapter,integrator,"), "{csv}");
    assert!(csv.lines().any(|line| line.starts_with(&format!("gpu,tiles,\"{adapter}\",analytic,"))), "{csv}");
    assert!(image::open(folder.join("scene.study/differences/analytic_gpu_tiles.png")).is_ok());
    let page = std::fs::read_to_string(folder.join("scene.study/study.html")).unwrap();
    for text in [
        "on gpu tiles",
        "on gpu raster",
        "set-up included on the CPU, not on the device",
        "a program on the CPU",
    ] {
        assert!(page.contains(text), "'{text}' is not on the page");
    }
    assert_eq!(page.contains("on gpu triangles"), cfg!(feature = "papers"));
    for text in
        ["segments, 4 pieces, table 256, gpu tiles", "order of segments on gpu tiles: observed", "software"]
    {
        assert!(ran.stdout.contains(text), "'{text}' is not in\n{}", ran.stdout);
    }
    // The reference knows no engine.
    let (again, _) =
        study(&folder, &["--engine", "gpu", "--adapter", "software", "--only", "analytic"]).unwrap();
    assert!(again.stdout.contains("kept from before"), "{}", again.stdout);
}

#[test]
fn a_setting_that_the_device_does_not_hold_is_said_and_the_others_are_measured() {
    // Over 100,000 widths of a Gaussian in a cell.
    let narrow = scene().replace("sigma = [0.08, inf]", "sigma = [1e-7, inf]");
    let folder = folder(&narrow);
    let more = ["--adapter", "software", "--only", "analytic,riemann"];
    let Some((ran, json)) = study(&folder, &more) else { return };
    let refused = json["refused"].as_array().unwrap();
    assert!(
        !refused.is_empty() && refused.iter().all(|one| one["setting"]["integrator"] == "analytic"),
        "{json:#}"
    );
    assert!(rows(&json, "gpu").iter().any(|row| row["setting"]["integrator"] == "riemann"));
    assert_eq!(
        json["rows"].as_array().unwrap().len() + refused.len(),
        json["settings"].as_u64().unwrap() as usize
    );
    assert_eq!(json["stopped"], false);
    assert!(ran.stdout.contains("the device does not draw analytic, gpu tiles; "), "{}", ran.stdout);
    // All that was asked for is refused.
    let only = ["--engine", "gpu", "--adapter", "software", "--only", "analytic"];
    folder.voltet(&[&STUDY[..], &only].concat()).fails(1, &["narrower than 32 bits resolve", "widths"]);
}

/// The keys that a study of the closed forms on one engine writes.
fn applied(text: &str, more: &[&str]) -> Option<Vec<String>> {
    let folder = folder(text);
    study(&folder, &[&["--only", "analytic", "--max-error", "0.5", "--apply"], more].concat())?;
    folder.voltet(&["check", "scene.toml"]).ok();
    let found = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    // Which of the four is fastest is a matter of chance.
    let chance = |line: &&str| ["overlap", "order"].iter().any(|key| line.starts_with(&format!("{key} =")));
    let new = found.lines().filter(|line| !text.lines().any(|known| known == *line) && !chance(line));
    Some(new.map(str::to_string).collect())
}

#[test]
fn the_engine_is_written_back_where_the_file_comes_to_another() {
    let on_device = ["--engine", "gpu", "--adapter", "software"];
    let Some(new) = applied(&scene(), &on_device) else { return };
    let one = voltet::optics::engine::Compositor::ALL.len() == 1;
    let keys = |lines: &[String]| -> Vec<String> {
        let compositor = |line: &&String| !line.starts_with("compositor =");
        assert!(one || lines.iter().any(|line| line.starts_with("compositor =")), "{lines:?}");
        lines.iter().filter(compositor).cloned().collect()
    };
    let integrator = "integrator = \"analytic\"";
    assert_eq!(keys(&new), [integrator, "engine = \"gpu\"", "adapter = \"software\""]);
    let named = scene().replace("type = \"renderer\"", "type = \"gpu-renderer\"\nadapter = \"software\"");
    assert_eq!(keys(&applied(&named, &["--engine", "gpu"]).unwrap()), [integrator]);
    // On the native engine: nothing for `auto`, which takes it here; else a word; a node of another type.
    let native = ["--engine", "cpu"];
    let device = scene().replace("type = \"renderer\"", "type = \"renderer\"\nengine = \"gpu\"");
    assert_eq!(applied(&device, &native).unwrap(), ["engine = \"cpu\"", integrator]);
    let found = applied(&named, &native).unwrap();
    assert_eq!(found, ["type = \"renderer\"", integrator, "engine = \"cpu\""]);
}

#[test]
fn what_no_device_can_do_is_said() {
    let folder = folder(&scene());
    let fails = |more: &[&str], code, wanted: &[&str]| {
        folder.voltet(&[&STUDY, more].concat()).fails(code, wanted);
    };
    fails(
        &["--engine", "cpu", "--adapter", "software"],
        2,
        &["--adapter", "software", "--engine gpu or all"],
    );
    fails(&["--adapter", "no such thing"], 1, &["no adapter is called \"no such thing\""]);
    let words: Vec<&str> = ENGINES.iter().map(|engine| engine.name).chain(["all"]).collect();
    fails(&["--engine", "gpus"], 2, &["gpus", &words.join(", ")]);
    folder.write("scene.toml", stages());
    fails(&["--engine", "gpu"], 2, &["stages", "\"renderer\""]);
    let ran = folder.voltet(&[&STUDY[..], &["--only", "analytic"]].concat()).ok();
    assert!(ran.stdout.contains("not measured: the device: the stages of the pipeline"), "{}", ran.stdout);
}
