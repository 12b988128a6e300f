//! Pictures and reports say what they were made from, and a picture is drawn again.

use super::support::{Folder, SLAB};
use serde_json::Value;

fn again(folder: &Folder, picture: &str, sets: &[&str]) {
    let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
    folder.voltet(&[&["run", picture], &sets[..]].concat()).ok();
}

fn carried(folder: &Folder, picture: &str) -> Value {
    serde_json::from_str(&folder.voltet(&["info", picture, "--json"]).ok().stdout).unwrap()
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

#[test]
fn a_picture_is_drawn_again_from_itself_with_what_was_set() {
    let folder = Folder::new();
    folder.write("slab.toml", SLAB.replace("title =", "# what for\ntitle ="));
    for ending in ["png", "exr"] {
        let (first, second) = (format!("first.{ending}"), format!("second.{ending}"));
        let to = format!("file.path={first}");
        let sets = [
            to.as_str(),
            "view.size=[12, 9]",
            "look.widgets.0.extinction=0.25",
            "look.widgets.0.color.1=0.5",
        ];
        again(&folder, "slab.toml", &sets);
        std::fs::rename(folder.join("slab.toml"), folder.join("away")).unwrap();
        again(&folder, &first, &[&format!("file.path={second}")]);
        let pixels = |name: &str| image::open(folder.join(name)).unwrap();
        assert_eq!(pixels(&first), pixels(&second));
        assert_eq!((pixels(&second).width(), pixels(&second).height()), (12, 9));
        let pipeline = carried(&folder, &first)["pipeline"].as_str().unwrap().to_string();
        assert!(pipeline.contains("# what for") && pipeline.contains("extinction = 0.25"), "{pipeline}");
        std::fs::rename(folder.join("away"), folder.join("slab.toml")).unwrap();
        // Nothing in it is of the moment.
        let before = bytes(&folder, &first);
        again(&folder, "slab.toml", &sets);
        assert!(before == bytes(&folder, &first));
    }
}

#[test]
fn a_picture_says_what_it_was_drawn_from_as_the_report_does() {
    let folder = Folder::new();
    folder.voltet(&["run", "slab.toml", "--report", "r.json", "--set", "look.unit_distance=auto"]).ok();
    let carried = carried(&folder, "slab.exr");
    assert_eq!(carried["program"], concat!("voltet ", env!("CARGO_PKG_VERSION")));
    assert_eq!(carried["title"], "An even slab");
    let data = &carried["data"][0];
    assert_eq!(
        (&data["node"], &data["parameter"], &data["path"]),
        (&"grid".into(), &"path".into(), &"cube.vtu".into())
    );
    assert_eq!(data["bytes"], bytes(&folder, "cube.vtu").len());
    let date = data["modified"].as_str().unwrap();
    // With nanoseconds, but for the file of one in a thousand million.
    assert!([20, 30].contains(&date.len()) && date.starts_with("20") && date.ends_with('Z'), "{date}");
    let camera = &carried["cameras"][0];
    assert_eq!(camera["node"], "view");
    assert_eq!(camera["eye"], serde_json::json!([-3.0, 0.5, 0.5]));
    assert_eq!((&camera["height"], &camera["size"]), (&2.0.into(), &serde_json::json!([8, 8])));
    // A hundredth of the diagonal of the unit cube.
    let unit = carried["units"]["unit_distances"][0]["length"].as_f64().unwrap();
    assert!((unit - 0.03f64.sqrt() / 10.0).abs() < 1e-15, "{unit}");
    let report = folder.json("r.json");
    assert_eq!(report["runs"][0]["provenance"], carried);
    assert_eq!(report["versions"]["voltet"], env!("CARGO_PKG_VERSION"));
    assert_eq!(report["runs"].as_array().unwrap().len(), 1);
}

/// A series tells the file of its step, with its size.
#[test]
fn what_is_read_beside_a_named_file_is_said() {
    let folder = Folder::new();
    let steps = "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"cube.vtu\"/>\
                 <DataSet timestep=\"1\" file=\"gone.vtu\"/></Collection></VTKFile>";
    std::fs::write(folder.join("all.pvd"), steps).unwrap();
    folder.voltet(&["run", "slab.toml", "--set", "grid.path=all.pvd"]).ok();
    let data = &carried(&folder, "slab.exr")["data"];
    assert_eq!((data.as_array().unwrap().len(), &data[0]["path"]), (1, &"all.pvd".into()));
    let beside = &data[0]["beside"];
    assert_eq!(
        (&beside["files"], &beside["bytes"], &beside["names"]),
        (&1.into(), &bytes(&folder, "cube.vtu").len().into(), &serde_json::json!(["cube.vtu"]))
    );
    let said = folder.voltet(&["info", "slab.exr"]).ok();
    assert!(
        said.stdout.contains("and 1 file beside it, ") && said.stdout.contains(": cube.vtu\n"),
        "{}",
        said.stdout
    );
}

#[test]
fn a_picture_in_another_folder_finds_its_data_from_there() {
    let folder = Folder::new();
    for name in ["in", "out", "later"] {
        std::fs::create_dir(folder.join(name)).unwrap();
    }
    std::fs::rename(folder.join("slab.toml"), folder.join("in/slab.toml")).unwrap();
    let set = ["grid.path=../cube.vtu", "file.path=../out/a.exr"];
    again(&folder, "in/slab.toml", &set);
    let pipeline = carried(&folder, "out/a.exr")["pipeline"].as_str().unwrap().to_string();
    assert!(
        pipeline.contains("path = \"../cube.vtu\"") && pipeline.contains("path = \"a.exr\""),
        "{pipeline}"
    );
    // Its own file is what it would write.
    let wanted =
        ["overwrite what the call reads", "out/a.exr", "picture to draw again", "--set file.path=OTHER"];
    let before = bytes(&folder, "out/a.exr");
    folder.voltet(&["run", "out/a.exr"]).fails(2, &wanted);
    assert!(before == bytes(&folder, "out/a.exr"));
    // Beside other folders in the same relation it finds the data; elsewhere it says what it misses.
    std::fs::rename(folder.join("out/a.exr"), folder.join("later/b.exr")).unwrap();
    folder.voltet(&["run", "later/b.exr"]).ok();
    assert!(folder.floats("later/a.exr").1 == folder.floats("later/b.exr").1);
    std::fs::rename(folder.join("later/b.exr"), folder.join("b.exr")).unwrap();
    let wanted = ["data file", "cube.vtu", "bytes, of 20", "--set grid.path=FILE"];
    folder.voltet(&["run", "b.exr"]).fails(2, &wanted);
    again(&folder, "b.exr", &["grid.path=cube.vtu"]);
    assert!(folder.floats("later/a.exr").1 == folder.floats("a.exr").1);
}

#[test]
fn names_of_folders_that_nobody_gave_are_not_told() {
    let folder = Folder::new();
    std::fs::create_dir(folder.join("private")).unwrap();
    std::fs::rename(folder.join("slab.toml"), folder.join("private/slab.toml")).unwrap();
    std::fs::rename(folder.join("cube.vtu"), folder.join("private/cube.vtu")).unwrap();
    let absolute = format!("file.path={}", folder.join("a.exr").display());
    again(&folder, "private/slab.toml", &[&absolute]);
    assert!(carried(&folder, "a.exr")["pipeline"].as_str().unwrap().contains("path = \"cube.vtu\""));
    // Below the pipeline's own folder there is nothing to tell.
    std::fs::create_dir(folder.join("private/below")).unwrap();
    let absolute = format!("file.path={}", folder.join("private/below/a.exr").display());
    again(&folder, "private/slab.toml", &[&absolute]);
    assert!(
        carried(&folder, "private/below/a.exr")["pipeline"].as_str().unwrap().contains("\"../cube.vtu\"")
    );
}

#[test]
fn a_picture_without_it_has_the_same_pixels_and_is_refused_as_a_pipeline() {
    let folder = Folder::new();
    for ending in ["png", "exr"] {
        let (with, without) = (format!("with.{ending}"), format!("without.{ending}"));
        again(&folder, "slab.toml", &[&format!("file.path={with}")]);
        again(&folder, "slab.toml", &[&format!("file.path={without}"), "file.provenance=false"]);
        let pixels = |name: &str| image::open(folder.join(name)).unwrap();
        assert_eq!(pixels(&with), pixels(&without));
        for needle in ["cube.vtu", "voltet"] {
            let holds =
                |name: &str| bytes(&folder, name).windows(needle.len()).any(|at| at == needle.as_bytes());
            assert!(holds(&with) && !holds(&without), "{needle}");
        }
        for command in ["run", "check", "explain", "info"] {
            folder
                .voltet(&[command, &without])
                .fails(2, &["carries no pipeline", &without, "provenance = true"]);
        }
        folder.write("cut", &bytes(&folder, &with)[..60]);
        folder.voltet(&["run", "cut"]).fails(2, &["cannot be read as"]);
    }
}

/// The chunks of a PNG file before its pixels.
fn chunks(png: &[u8]) -> Vec<(String, Vec<u8>)> {
    let (mut at, mut chunks) = (8, Vec::new());
    loop {
        let length = u32::from_be_bytes(png[at..at + 4].try_into().unwrap()) as usize;
        let name = String::from_utf8(png[at + 4..at + 8].to_vec()).unwrap();
        if name == "IDAT" {
            return chunks;
        }
        chunks.push((name, png[at + 8..at + 8 + length].to_vec()));
        at += 12 + length;
    }
}

#[test]
fn pictures_say_which_colours_they_hold() {
    let folder = Folder::new();
    for provenance in ["true", "false"] {
        let set = format!("file.provenance={provenance}");
        again(&folder, "slab.toml", &[&set, "file.path=a.png"]);
        let chunks = chunks(&bytes(&folder, "a.png"));
        let of = |name: &str| &chunks.iter().find(|(known, _)| known == name).unwrap().1;
        // The values that the specification gives for sRGB: gamma 45455, white, red, green, blue in hundred-thousandths.
        assert_eq!(of("sRGB"), &[1]);
        assert_eq!(of("gAMA")[..], 45_455u32.to_be_bytes());
        let places = [31_270u32, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000];
        assert_eq!(of("cHRM")[..], places.map(u32::to_be_bytes).concat());
        assert!(chunks.iter().all(|(name, _)| name != "tIME"));
        again(&folder, "slab.toml", &[&set]);
        let exr = bytes(&folder, "slab.exr");
        let name = b"chromaticities\0chromaticities\0";
        let at = exr.windows(name.len()).position(|at| at == name).unwrap() + name.len() + 4;
        // Red, green, blue, white.
        let places = [0.64f32, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
        assert_eq!(exr[at..at + 32], places.map(f32::to_le_bytes).concat());
    }
}

#[test]
fn what_a_picture_carries_is_bounded() {
    let folder = Folder::new();
    folder.write("long.toml", format!("{SLAB}\n#{}\n", " ".repeat(1 << 20)));
    let ran = folder.voltet(&["run", "long.toml", "--set", "file.path=a.png"]).ok();
    assert!(
        ran.stderr.contains("does not carry its pipeline") && ran.stderr.contains("1048576"),
        "{}",
        ran.stderr
    );
    assert!(bytes(&folder, "a.png").len() < 4096);
    folder.voltet(&["run", "a.png"]).fails(2, &["carries no pipeline"]);
}

#[test]
fn every_command_takes_a_picture_and_data_that_changed_are_noticed() {
    let folder = Folder::new();
    again(&folder, "slab.toml", &["file.path=a.png"]);
    let other = ["--set", "file.path=b.png"];
    folder.voltet(&["check", "a.png"]).fails(2, &["overwrite what the call reads"]);
    assert!(folder.voltet(&[&["check", "a.png"], &other[..]].concat()).ok().stdout.contains("in order"));
    assert!(folder.voltet(&["explain", "a.png"]).ok().stdout.contains("Runs, in this order"));
    let text = folder.voltet(&["info", "a.png"]).ok().stdout;
    for wanted in
        ["An even slab", "cube.vtu", "eye [-3.0, 0.5, 0.5]", "unit distance (look): 0.5", "[nodes.grid]"]
    {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
    folder.voltet(&["info", "a.png", "--set", "view.size=[1, 1]"]).fails(2, &["--set", "not for pictures"]);
    let apply = ["study", "a.png", "--apply", "--max-error", "1", "--engine", "cpu", "--quiet"];
    folder.voltet(&apply).fails(2, &["--apply", "picture"]);
    folder.write("cube.vtu", super::support::cube(2));
    let ran = folder.voltet(&[&["run", "a.png"], &other[..]].concat()).ok();
    assert!(ran.stderr.contains("other data") && ran.stderr.contains("bytes"), "{}", ran.stderr);
}
