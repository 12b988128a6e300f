//! Sources of widgets: probes wired into a transfer function, histograms as files, bands and cells.

use super::support::{Folder, SLAB};

/// The slab with these nodes more, its transfer function fed by `widgets`.
fn slab(widgets: &str, nodes: &str) -> String {
    SLAB.replace("unit_distance = 0.5", &format!("unit_distance = 0.5\ninputs = {{ widgets = {widgets} }}"))
        + nodes
}

/// A probe of this region on the gradient.
fn probe(name: &str, keys: &str) -> String {
    format!("\n[nodes.{name}]\ntype = \"probe\"\n{keys}\ninputs = {{ volume = \"gradient\" }}\n")
}

const LEFT: &str = "box = { low = [0.0, 0.0, 0.0], high = [0.5, 1.0, 1.0] }";

#[test]
fn probes_and_widgets_by_hand_are_drawn_together() {
    let folder = Folder::new();
    // s = x and g = 1 everywhere: in the left half s is 0.25 ± 0.5/√12. The extinctions add up.
    let probes = probe("left", &format!("{LEFT}\nextinction = 0.5\ncolor = [0.5, 1.0, 0.25]"))
        + &probe("layer", "mask = { array = \"layer\", equals = 2 }\ncolor = [0.5, 1.0, 0.25]");
    folder.write("slab.toml", slab("[\"left\", \"layer\"]", &probes));
    folder.voltet(&["run", "slab.toml", "--report", "r.json"]).ok();
    let report = folder.report("r.json");
    let found = |name: &str| {
        let findings = report["findings"].as_array().unwrap();
        findings.iter().find(|finding| finding["node"] == name).unwrap()["figures"].clone()
    };
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let close = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found}, {wanted}");
    close(number(&found("left")["centre"][0]), 0.25);
    close(number(&found("left")["sigma"][0]), 0.5 / 12.0_f64.sqrt());
    close(number(&found("left")["volume"]), 0.5);
    // The last of three layers of cells.
    close(number(&found("layer")["centre"][0]), 5.0 / 6.0);
    close(number(&found("layer")["sigma"][0]), 1.0 / 3.0 / 12.0_f64.sqrt());
    let (_, pixels) = folder.floats("slab.exr");
    // ∫ over x of (1 + ½ exp(−(x − ¼)²/2σ²) + exp(−(x − 5/6)²/2σ²)) / 0.5, by Simpson's rule on 1000 pieces.
    let gauss = |x: f64, mean: f64, width: f64| (-(x - mean) * (x - mean) * 6.0 / (width * width)).exp();
    let density = |x: f64| (1.0 + 0.5 * gauss(x, 0.25, 0.5) + gauss(x, 5.0 / 6.0, 1.0 / 3.0)) / 0.5;
    let simpson = |i: i32| {
        density(f64::from(i) / 1000.0)
            * if i % 1000 == 0 {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            }
    };
    let depth = (0..=1000).map(simpson).sum::<f64>() / 3000.0;
    let opacity = pixels[4 * 8 + 4][3];
    // 32-bit rounding over a few segments.
    assert!((f64::from(opacity) - (1.0 - (-depth).exp())).abs() < 1e-6, "{opacity}, {depth}");
}

#[test]
fn a_probe_of_fields_asks_for_them_and_not_for_the_gradient() {
    let folder = Folder::new();
    let probes = probe("left", &format!("{LEFT}\nfields = [\"y\", \"x\"]"));
    folder.write("slab.toml", slab("\"left\"", &probes));
    let text = folder.voltet(&["explain", "slab.toml"]).ok().stdout;
    assert!(text.contains("array \"x\", array \"y\"") && text.contains("gradient: no gradient:"), "{text}");
    folder.voltet(&["run", "slab.toml", "--report", "r.json"]).ok();
    let figures = &folder.report("r.json")["findings"][0]["figures"];
    assert_eq!(figures["fields"], serde_json::json!(["y", "x"]));
    let mean = figures["centre"][0].as_f64().unwrap();
    assert!((mean - 0.5).abs() < 1e-12, "{mean}");
    // With s and g, and a mask, those are asked for instead.
    folder.write("slab.toml", slab("\"left\"", &probe("left", "mask = { array = \"layer\" }")));
    let text = folder.voltet(&["explain", "slab.toml"]).ok().stdout;
    assert!(text.contains("cell array \"layer\"") && text.contains(", gradient magnitude"), "{text}");
    // A probe alone is a transfer function too.
    let alone = slab("\"left\"", &probe("left", LEFT))
        .replace("transfer_function = \"look\"", "transfer_function = \"left\"");
    folder.write("alone.toml", alone);
    folder.voltet(&["run", "alone.toml"]).ok();
}

#[test]
fn mistakes_of_probes_are_shown() {
    let folder = Folder::new();
    for (keys, code, wanted) in [
        ("", 2, "the probe has no region"),
        ("box = { low = [0, 0, 0], high = [0, 1, 1] }", 2, "the box is empty"),
        (
            "points = [[0, 0, 0]]\nsphere = { centre = [0, 0, 0], radius = 1 }",
            2,
            "the probe has several regions",
        ),
        ("points = [[0, 0, 0]]\nfields = []", 2, "1 to 8 different names of point arrays"),
        ("sphere = { centre = [0, 0, 0], radius = 0 }", 2, "above 0"),
        ("box = { low = [3, 0, 0], high = [4, 1, 1] }", 1, "no cell reaches into the box"),
        ("sphere = { centre = [5, 0, 0], radius = 1 }", 1, "which reaches from [0, 0, 0] to [1, 1, 1]"),
        ("points = [[5, 0, 0]]", 1, "no cell holds any of the points"),
        ("mask = { array = \"layer\", equals = 7 }", 1, "the mask leaves no cell"),
        ("mask = { array = \"layers\" }", 1, "the file holds no array 'layers'"),
        ("mask = { array = \"x\" }", 1, "'x' is an array of the points, not of the cells"),
        ("points = [[0, 0, 0]]\nfields = [\"gradient\"]", 2, "'gradient:magnitude'"),
    ] {
        folder.write("slab.toml", slab("\"left\"", &probe("left", keys)));
        folder.voltet(&["run", "slab.toml", "--quiet"]).fails(code, &[wanted]);
    }
    // A length that cannot be converted.
    let other = "\n[nodes.other]\ntype = \"transfer-function\"\nunit_distance = 2.0\n";
    folder.write(
        "slab.toml",
        slab("\"other\"", other).replace("unit_distance = 0.5", "unit_distance = \"auto\""),
    );
    folder.voltet(&["run", "slab.toml"]).fails(2, &["a number here too"]);
}

#[test]
fn a_histogram_is_a_picture_and_a_table() {
    let folder = Folder::new();
    let text = SLAB.split("[nodes.look]").next().unwrap().to_string()
        + "[nodes.plane]\ntype = \"histogram\"\nbins = [4, 2]\ng = [0.0, 2.0]\ninputs = { volume = \"gradient\" }\n\
           [nodes.table]\ntype = \"report-writer\"\npath = \"h.csv\"\ninputs = { report = \"plane.report\" }\n\
           [nodes.all]\ntype = \"report-writer\"\npath = \"h.json\"\ninputs = { report = \"plane.report\" }\n\
           [nodes.file]\ntype = \"image-writer\"\npath = \"h.exr\"\ninputs = { image = \"plane.image\" }\n";
    folder.write("h.toml", &text);
    folder.voltet(&["run", "h.toml"]).ok();
    let table = std::fs::read_to_string(folder.join("h.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines[0], "s_low,s_high,g_low,g_high,volume");
    let rows: Vec<Vec<f64>> =
        lines[1..].iter().map(|line| line.split(',').map(|n| n.parse().unwrap()).collect()).collect();
    // s = x, g = 1: a quarter of the cube in each bin of s. The filter's g may lie just under or over the edge at 1.
    for i in 0..4 {
        let volume: f64 = rows.iter().filter(|row| row[0] == 0.25 * f64::from(i)).map(|row| row[4]).sum();
        assert!((volume - 0.25).abs() < 1e-12, "{table}");
    }
    let all = folder.json("h.json");
    assert!((all["volume"].as_f64().unwrap() - 1.0).abs() < 1e-12, "{all:#}");
    assert_eq!((all["volume_outside"].as_f64(), all["g"]["high"].as_f64()), (Some(0.0), Some(2.0)));
    let (width, pixels) = folder.floats("h.exr");
    assert_eq!((width, pixels.len()), (8, 8 * 4));
    assert!(pixels.iter().any(|pixel| pixel[3] == 1.0), "the picture is empty");
    folder.write("h.toml", text.replace("[0.0, 2.0]", "[2.0, 0.0]"));
    folder.voltet(&["run", "h.toml"]).fails(2, &["the range 'g' is empty", "smaller number first"]);
}

#[test]
fn bands_that_are_finer_than_the_cells_are_reported() {
    let folder = Folder::new();
    // Three cells along x, each a third of s: with a period of 0.1 each crosses 3.33 bands.
    let wave = "kind = \"sine-wave\"\nperiod = 0.1";
    folder.write(
        "slab.toml",
        SLAB.replace("kind = \"uniform\"", wave).replace("region = { s = [-1.0, 2.0] }", ""),
    );
    let text = folder.voltet(&["run", "slab.toml", "--report", "r.json"]).ok().stdout;
    assert!(
        text.contains("100.00 % cross more than one, where the picture is finer than the grid"),
        "{text}"
    );
    let bands = &folder.report("r.json")["findings"][0]["figures"]["bands"];
    assert_eq!((&bands["kind"], &bands["cells"]), (&"sine-wave".into(), &162.into()));
    for name in ["median", "percent_99", "most"] {
        assert!((bands[name].as_f64().unwrap() - 10.0 / 3.0).abs() < 1e-6, "{bands:#}");
    }
    let names = folder.names();
    let info = folder.voltet(&["info", "slab.toml"]).ok().stdout;
    assert!(info.starts_with("look on its data: bands of widget 0 (sine-wave): of 162 cells"), "{info}");
    assert_eq!(folder.names(), names, "info writes nothing");
    let info = folder.voltet(&["info", "slab.toml", "--set", "look.widgets.0.period=0.5"]).ok().stdout;
    assert!(info.contains("none crosses more than one"), "{info}");
    let explained = folder.voltet(&["explain", "slab.toml"]).ok().stdout;
    assert!(explained.contains("`voltet info`"), "{explained}");
    folder.write("plain.toml", SLAB);
    let info = folder.voltet(&["info", "plain.toml"]).ok().stdout;
    assert!(info.contains("no wave widgets"), "{info}");
    folder.voltet(&["info", "cube.vtu", "--set", "a.b=1"]).fails(2, &["--set changes a pipeline"]);
    folder.voltet(&["info", "slab.toml", "--time-step", "1"]).fails(2, &["are for data files"]);
}

#[test]
fn numbers_relative_to_data_are_told_by_run_and_info_and_placed_where_wrong() {
    let folder = Folder::new();
    let widget = "\n[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 1.0, 1.0]\nextinction = 1.0\n\
                  centre = [\"p25\", 1.0]\nsigma = [\"5 %\", inf]\n";
    let wired = SLAB
        .replace("unit_distance = 0.5", "unit_distance = 0.5\ninputs = { volume = \"gradient\" }")
        + widget;
    folder.write("slab.toml", &wired);
    folder.voltet(&["check", "slab.toml"]).ok();
    // Nothing is read to plan; s = x alone is asked for.
    let text = folder.voltet(&["explain", "slab.toml"]).ok().stdout;
    assert!(text.contains("Numbers relative to data are known with the data"), "{text}");
    for command in [&["run", "slab.toml"][..], &["info", "slab.toml"]] {
        let said = folder.voltet(command).ok().stdout;
        let wanted = "look: widget 1 (gaussian): centre = [0.2";
        assert!(said.contains(wanted) && said.contains("sigma = [0.05, inf]"), "{command:?}: {said}");
    }
    folder.write("unwired.toml", SLAB.to_string() + widget);
    let line = format!("unwired.toml:{}:", SLAB.lines().count() + 6);
    let wanted = ["no data are wired in: found \"p25\"", "inputs = { volume = \"NODE\" }", &line];
    folder.voltet(&["check", "unwired.toml"]).fails(2, &wanted);
    let percentile = folder.voltet(&["check", "slab.toml", "--set", "look.widgets.1.sigma.0=p5"]);
    percentile
        .fails(2, &["a percentile is a value of the data: found \"p5\"", "--set look.widgets.1.sigma.0=p5"]);
}
