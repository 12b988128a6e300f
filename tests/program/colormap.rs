//! Colour maps as pictures show them, colour map files, and colours as texts.

use crate::support::Folder;

/// The cube seen along y, where x goes across 256 pixels: pixel i is at level i/255 of the map.
fn scene(folder: &Folder, widget: &str) {
    let text = crate::support::SLAB
        .replace(
            "kind = \"uniform\"\ncolor = [0.5, 1.0, 0.25]\nextinction = 1.0\nregion = { s = [-1.0, 2.0] }\n",
            &format!("kind = \"colormap\"\n{widget}\n"),
        )
        .replace("eye = [-3.0, 0.5, 0.5]", "eye = [0.5, -3.0, 0.5]")
        .replace("height = 2.0\nsize = [8, 8]", "height = 0.015625\nsize = [256, 4]")
        .replace("transfer-function\"", "transfer-function\"\ninputs = { volume = \"gradient\" }");
    folder.write("map.toml", text);
}

/// Opaque, so that a pixel has the colour at its place.
const OPAQUE: &str = "range = [0.001953125, 0.998046875]\nextinction = 1000.0\nopacity = \"constant\"\n";

/// The second row of the picture, 8-bit sRGB, as the CPU draws it.
fn row(folder: &Folder) -> Vec<[u8; 3]> {
    folder.voltet(&["run", "map.toml", "--quiet", "--set", "picture.engine=cpu"]).ok();
    row_of(folder)
}

fn row_of(folder: &Folder) -> Vec<[u8; 3]> {
    let (width, pixels) = folder.floats("slab.exr");
    let encoded = |v: f32| if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    let byte = |v: f32| (255.0 * encoded(v)).round() as u8;
    pixels[width..2 * width].iter().map(|p| [p[0], p[1], p[2]].map(byte)).collect()
}

/// The 256 colours of a map as matplotlib has them.
fn colors(name: &str) -> Vec<[u8; 3]> {
    let all = include_str!("../../crates/core/colormap/colors_256.txt");
    let line = all.lines().find_map(|line| line.strip_prefix(&format!("{name} "))).unwrap();
    let byte = |at: usize| u8::from_str_radix(&line[at..at + 2], 16).unwrap();
    (0..256).map(|i| [0, 2, 4].map(|k| byte(6 * i + k))).collect()
}

#[track_caller]
fn near(found: &[[u8; 3]], right: &[[u8; 3]], step: u8) {
    for (i, (found, right)) in found.iter().zip(right).enumerate() {
        assert!((0..3).all(|k| found[k].abs_diff(right[k]) <= step), "pixel {i}: {found:?}, not {right:?}");
    }
}

#[test]
fn a_picture_has_the_colours_of_the_map() {
    let folder = Folder::new();
    for name in ["viridis", "turbo", "batlow"] {
        scene(&folder, &format!("colormap = \"{name}\"\n{OPAQUE}"));
        near(&row(&folder), &colors(name), 1);
    }
}

#[cfg(feature = "gpu")]
#[test]
fn a_picture_of_a_device_has_the_colours_of_the_map() {
    let folder = Folder::new();
    for (name, more) in [("viridis", ""), ("turbo", "below = \"#000000\"\nabove = \"#ffffff\"")] {
        scene(&folder, &format!("colormap = \"{name}\"\n{OPAQUE}{more}"));
        let device = ["--set", "picture.engine=gpu", "--set", "picture.adapter=software"];
        let ran = folder.voltet(&[&["run", "map.toml", "--quiet"], &device[..]].concat());
        if ran.on_software_driver().is_none() {
            return;
        }
        near(&row_of(&folder), &colors(name), 1);
    }
}

#[test]
fn colours_turn_round_stand_in_bands_and_end_at_the_range() {
    let folder = Folder::new();
    let viridis = colors("viridis");
    scene(&folder, &format!("reversed = true\n{OPAQUE}"));
    near(&row(&folder), &viridis.iter().rev().copied().collect::<Vec<_>>(), 1);
    scene(&folder, &format!("steps = 4\n{OPAQUE}"));
    let bands: Vec<[u8; 3]> = (0..256).map(|i| viridis[85 * (i / 64)]).collect();
    near(&row(&folder), &bands, 1);
    // Below and above a quarter of the data on either side.
    let range = "range = [\"25 %\", \"75 %\"]\nextinction = 1000.0\nopacity = \"constant\"\n";
    scene(&folder, &format!("{range}below = \"#ff8000\"\nabove = [0.0, 1.0, 0.0]"));
    let found = row(&folder);
    near(&found[..63], &[[255, 128, 0]; 63], 1);
    near(&found[193..], &[[0, 255, 0]; 63], 1);
    near(&found[64..66], &[viridis[1], viridis[3]], 1);
    // About 0.75 the map is as long on both sides: from 0 to 1.5.
    let centred = "colormap = \"coolwarm\"\nrange = [0.0, 0.5]\ncentre = 0.75";
    scene(&folder, &format!("{centred}\nextinction = 1000.0\nopacity = \"constant\""));
    let coolwarm = colors("coolwarm");
    let two_thirds: Vec<[u8; 3]> = (0..256).map(|i| coolwarm[i * 2 / 3]).collect();
    near(&row(&folder), &two_thirds, 3);
}

#[test]
fn the_opacity_follows_the_curve() {
    let folder = Folder::new();
    let opacities = |opacity: &str| -> Vec<f64> {
        scene(&folder, &format!("range = [0.0, 1.0]\nextinction = 2.0\nopacity = {opacity}"));
        folder.voltet(&["run", "map.toml", "--quiet"]).ok();
        let (width, pixels) = folder.floats("slab.exr");
        pixels[width..2 * width].iter().map(|p| f64::from(p[3])).collect()
    };
    // One unit of length is two unit distances.
    let right = |share: f64| 1.0 - (-4.0 * share).exp();
    let at = |i: usize| (i as f64 + 0.5) / 256.0;
    type Share = fn(f64) -> f64;
    let cases: [(&str, Share); 7] = [
        ("\"ramp\"", |x| x),
        ("\"fall\"", |x| 1.0 - x),
        ("\"constant\"", |_| 1.0),
        ("\"ends\"", |x| (2.0 * x - 1.0).abs()),
        ("\"middle\"", |x| 1.0 - (2.0 * x - 1.0).abs()),
        ("\"peaks\"", |x| (1.0 - ((5.0 * x).fract() - 0.5).abs() / 0.1).max(0.0)),
        ("[[0, 0], [0.25, 0.1], [0.5, 0.1], [0.5, 1], [1, 0.5]]", |x| match x {
            x if x < 0.25 => 0.4 * x,
            x if x < 0.5 => 0.1,
            x => 1.5 - x,
        }),
    ];
    for (opacity, share) in cases {
        for (i, found) in opacities(opacity).into_iter().enumerate() {
            assert!((found - right(share(at(i)))).abs() < 1e-5, "{opacity} at {}: {found}", at(i));
        }
    }
}

/// ParaView's "Cool to Warm" as it exports it.
const JSON: &str = r#"[{ "ColorSpace": "Diverging", "Name": "Cool to Warm", "NanColor": [1, 1, 0],
"RGBPoints": [-3, 0.231373, 0.298039, 0.752941, 5, 0.705882, 0.0156863, 0.14902] }]"#;

#[test]
fn a_colour_map_file_has_the_colours_of_paraview() {
    let folder = Folder::new();
    folder.write("cool.json", JSON);
    let points =
        "<Point x=\"0\" o=\"0\" r=\"0\" g=\"0\" b=\"1\"/><Point x=\"2\" o=\"1\" r=\"1\" g=\"1\" b=\"0\"/>";
    folder.write("lab.xml", format!("<ColorMaps><ColorMap space=\"Lab\" name=\"m\">{points}<NaN r=\"0\" g=\"0\" b=\"0\"/></ColorMap></ColorMaps>"));
    // Of vtkColorTransferFunction, VTK 9.2, at 51, 127.5 and 204 of 255.
    for (file, right) in [
        ("cool.json", [[124, 159, 249], [221, 221, 221], [238, 133, 104]]),
        ("lab.xml", [[138, 68, 222], [202, 138, 170], [239, 208, 106]]),
    ] {
        scene(&folder, &format!("colormap = \"{file}\"\n{OPAQUE}"));
        let found = row(&folder);
        near(&[found[51], found[127], found[204]], &right, 2);
    }
    // The picture changes with the file.
    folder.write("lab.xml", "<ColorMap space=\"RGB\"><Point x=\"0\" r=\"0\" g=\"0\" b=\"0\"/><Point x=\"1\" r=\"1\" g=\"1\" b=\"1\"/></ColorMap>");
    let grey: Vec<[u8; 3]> = (0..=255).map(|i| [i; 3]).collect();
    near(&row(&folder), &grey, 1);
}

#[test]
fn what_is_no_colour_map_is_refused_with_what_would_be() {
    let folder = Folder::new();
    let point = "{\"RGBPoints\": [0, 0, 0, 0, 1, 1, 1, 1], \"ColorSpace\": \"HSV\"}";
    folder.write("hsv.json", point);
    folder.write("two.json", format!("[{point}, {point}]").replace("HSV", "RGB"));
    folder.write("listed.json", "[{\"IndexedColors\": [1, 0, 0]}]");
    folder.write("short.json", "[{\"RGBPoints\": [0, 0, 0]}]");
    folder.write("broken.json", "[{");
    folder.write("broken.xml", "<ColorMap space=\"RGB\"><Point x=\"0\" r=\"zero\"/></ColorMap>");
    for (widget, said) in [
        ("colormap = \"virdis\"", &["'viridis', the nearest name", ".json or .xml"][..]),
        ("colormap = \"missing.json\"", &["missing.json", "no such file"]),
        ("colormap = \"hsv.json\"", &["HSV", "RGB, Lab, Diverging", "hsv.json"]),
        ("colormap = \"two.json\"", &["found 2", "two.json"]),
        ("colormap = \"listed.json\"", &["categories"]),
        ("colormap = \"short.json\"", &["3 numbers", "four numbers a point"]),
        ("colormap = \"broken.json\"", &["no JSON", "broken.json"]),
        ("colormap = \"broken.xml\"", &["'r' of a <Point>", "broken.xml"]),
        ("range = [1.0, 0.0]", &["the range is empty", "reversed = true"]),
        ("opacity = \"rmap\"", &["'ramp', the nearest name", "list of rows"]),
        ("opacity = [[0, 2]]", &["out of range", "from 0 to 1"]),
        ("opacity = [[1, 0], [0, 1]]", &["do not rise"]),
        ("below = \"#12\"", &["is not a colour", "#rrggbb"]),
        ("below = [1.0, 0.0]", &["#rrggbb"]),
        ("steps = 1", &["from 2 to 256"]),
    ] {
        scene(&folder, widget);
        let ran = folder.voltet(&["run", "map.toml", "--quiet"]);
        assert_ne!(ran.code, 0, "{widget}");
        assert!(said.iter().all(|said| ran.stderr.contains(said)), "{widget}: {}", ran.stderr);
    }
}
