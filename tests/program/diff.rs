//! Differences of pictures whose truth is a formula.

use super::support::{Folder, Ran};

/// The slab in each of these files, with the extinction that its name begins with.
fn slabs(files: &[&str]) -> Folder {
    let folder = Folder::new();
    for file in files {
        let extinction = format!("look.widgets.0.extinction={}", file.split('.').next().unwrap());
        folder.voltet(&["run", "slab.toml", "--quiet", "--set", &extinction, "--output", file]).ok();
    }
    folder
}

/// The number behind these words.
fn number(ran: &Ran, words: &str) -> f64 {
    let line = ran
        .stdout
        .lines()
        .find_map(|line| line.strip_prefix(words))
        .unwrap_or_else(|| panic!("{}", ran.stdout));
    line.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn differences_are_those_of_the_formula() {
    let folder = slabs(&["1.exr", "2.exr"]);
    let ran = folder.voltet(&["diff", "1.exr", "2.exr"]).ok();
    assert!(
        ran.stdout.starts_with("1.exr and 2.exr: 8 × 8 pixels, premultiplied linear RGBA\n"),
        "{}",
        ran.stdout
    );
    // Opacities 1 − e^(−2) and 1 − e^(−4), in a quarter of the pixels, of the colour (0.5, 1, 0.25).
    let difference = (-2f64).exp() - (-4f64).exp();
    let rms = difference * ((0.25 + 1.0 + 0.0625 + 1.0) / 16.0f64).sqrt();
    for (words, wanted) in [("maximum", difference), ("99.9 % within", difference), ("rms", rms)] {
        // Four digits are printed.
        assert!((number(&ran, words) / wanted - 1.0).abs() < 5e-4, "{words}: {}", ran.stdout);
    }
    assert!(ran.stdout.contains("16 pixels over 1 / 255"), "{}", ran.stdout);
    let flip = number(&ran, "FLIP, mean");
    assert!(flip > 0.0 && flip < 1.0);
    let same = folder.voltet(&["diff", "1.exr", "1.exr", "--limit", "0"]).ok();
    assert_eq!(["maximum", "rms", "FLIP, mean"].map(|words| number(&same, words)), [0.0; 3]);
}

#[test]
fn files_of_integers_differ_from_floats_by_their_rounding() {
    let folder = slabs(&["1.exr", "1.png"]);
    // A picture without alpha lies over black, so that opacity counts nothing: half a step of sRGB at its steepest place here, where
    // 255 steps of code are 2.3 of linear light.
    let ran = folder.voltet(&["diff", "1.exr", "1.png", "--limit", "1/255"]).ok();
    assert!(
        ran.stdout.contains("linear RGB over the background, since a picture has no alpha"),
        "{}",
        ran.stdout
    );
    let largest = number(&ran, "maximum");
    assert!(largest > 1e-6 && largest < 0.5 * 2.3 / 255.0, "{largest}");
    let ran = folder.voltet(&["diff", "1.exr", "1.png", "--limit", "1e-6"]);
    assert_eq!(ran.code, 1);
    assert!(ran.stderr.contains("the pictures differ by more than 0.000001"), "{}", ran.stderr);
    // Over white it is another picture.
    let ran = folder.voltet(&["diff", "1.exr", "1.png", "--limit", "1/255", "--background", "1,1,1"]);
    assert_eq!((ran.code, number(&ran, "maximum")), (1, 1.0));
}

#[test]
fn the_difference_is_drawn_and_what_cannot_be_compared_is_refused() {
    let folder = slabs(&["1.exr", "2.exr"]);
    folder.voltet(&["diff", "1.exr", "2.exr", "--output", "difference.exr"]).ok();
    let (_, pixels) = folder.floats("difference.exr");
    assert!(pixels[0] != pixels[8 * 4 + 4] && pixels[8 * 4 + 4][3] == 1.0);
    folder.voltet(&["run", "slab.toml", "--quiet", "--size", "4x4", "-o", "small.exr"]).ok();
    for (arguments, wanted) in [
        (&["1.exr", "small.exr"][..], "the pictures have different sizes: found 8 × 8 and 4 × 4 pixels"),
        (&["1.exr", "none.exr"], "the picture cannot be read"),
        (&["1.exr", "slab.toml"], "expected a picture (.png"),
        (&["1.exr", "2.exr", "-o", "./1.exr"], "the output would overwrite a picture that is compared"),
        (&["1.exr", "2.exr", "-o", "a.gif"], "the picture's format is not known"),
    ] {
        folder.voltet(&[&["diff"], arguments].concat()).fails(2, &[wanted]);
    }
    let ran = folder.voltet(&["diff", "1.exr", "2.exr", "--limit", "1/0"]);
    assert!(ran.code == 2 && ran.stderr.contains("a fraction such as 1/255"), "{}", ran.stderr);
}

/// With alpha the file is the picture, over every background.
#[test]
fn files_with_alpha_hold_the_opacity_and_say_what_they_do_not_hold() {
    let folder = slabs(&["1.exr"]);
    for (file, bits, limit) in
        [("a.png", 8, "3/255"), ("a.png", 16, "3/65535"), ("a.tif", 16, "3/65535"), ("a.webp", 8, "3/255")]
    {
        let bits = format!("file.bits={bits}");
        let set = ["--set", "file.alpha=true", "--set", &bits, "--output", file];
        let ran = folder.voltet(&[&["run", "slab.toml"], &set[..]].concat()).ok();
        assert_eq!(ran.stderr.contains("holds no texts"), file != "a.png", "{}", ran.stderr);
        let ran = folder.voltet(&["diff", "1.exr", file, "--limit", limit]).ok();
        assert!(ran.stdout.contains("premultiplied linear RGBA"), "{}", ran.stdout);
    }
    let ran = folder.voltet(&["run", "slab.toml", "--set", "file.alpha=true", "--output", "a.jpg"]).ok();
    for what in ["jpeg holds no alpha: the picture lies over the background", "jpeg holds no texts"] {
        assert!(ran.stderr.contains(what), "{}", ran.stderr);
    }
    folder
        .voltet(&["run", "slab.toml", "--set", "file.bits=12"])
        .fails(2, &["no format has so many bits: found 12"]);
    folder.voltet(&["run", "a.jpg"]).fails(2, &["the picture carries no pipeline"]);
}
