//! The node `multi-gradient` and the widgets that look at its array.

use super::support::{Folder, SLAB};

/// The cube seen along x by a triangular Gaussian over fields, of an array that a node between computes.
fn pipeline(fields: &str, widget: &str) -> String {
    let node = format!(
        "[nodes.changes]\ntype = \"multi-gradient\"\n{fields}\ninputs = {{ volume = \"gradient\" }}\n\n[nodes.look]"
    );
    let widget = format!(
        "[[nodes.look.widgets]]\ncolor = [0.5, 1.0, 0.25]\nextinction = 4.0\n{widget}\n\n[nodes.view]"
    );
    let (head, rest) = SLAB.split_once("[[nodes.look.widgets]]").unwrap();
    let (_, tail) = rest.split_once("[nodes.view]").unwrap();
    let tail = tail.replace("volume = \"gradient\"", "volume = \"changes\"");
    head.replace("[nodes.look]", &node) + &widget + &tail
}

const OVER_X: &str = "kind = \"triangular-gaussian-nd\"\nfields = [\"x\"]\ncentre = [0.4]\nsigma = [0.2]";

#[test]
fn one_field_is_the_triangular_gaussian_over_s_and_g() {
    let folder = Folder::new();
    let plane = "kind = \"triangular-gaussian\"\ncentre = 0.4\nsigma = 0.2";
    folder.write("plane.toml", pipeline("fields = [\"x\"]", plane));
    folder.write("field.toml", pipeline("fields = [\"x\"]", OVER_X));
    folder.voltet(&["run", "plane.toml", "--set", "file.path=plane.exr"]).ok();
    folder.voltet(&["run", "field.toml", "--set", "file.path=field.exr"]).ok();
    let ((_, plane), (_, field)) = (folder.floats("plane.exr"), folder.floats("field.exr"));
    assert!(plane.iter().any(|pixel| pixel[3] > 0.5));
    for (a, b) in plane.iter().flatten().zip(field.iter().flatten()) {
        // The same numbers, scaled by ranges of their own before they are rounded to 32 bits.
        assert!((a - b).abs() <= 2e-6, "{a} {b}");
    }
}

#[test]
fn two_fields_widen_by_the_steeper_of_them() {
    let folder = Folder::new();
    // Rows (1, 0, 0) and (0, 2, 0): a magnitude of 2 everywhere; y is ignored but by it.
    let fields = "fields = [\"x\", \"y\"]\nscale = [1.0, 0.5]\nname = \"m\"\nmethod = \"cell-average\"";
    let widget = "kind = \"triangular-gaussian-nd\"\nfields = [\"x\", \"y\"]\nmagnitude = \"m\"\n\
                  centre = [0.5, 0.5]\nsigma = [0.1, inf]";
    folder.write("two.toml", pipeline(fields, widget));
    folder.voltet(&["run", "two.toml", "--set", "file.path=two.exr", "--report", "two.json"]).ok();
    let (width, pixels) = folder.floats("two.exr");
    // ∫ exp(−((x − ½)/0.2)²) dx over the cube is 0.2 √π erf 2.5, times 4 per 0.5.
    let depth: f64 = 8.0 * 0.2 * std::f64::consts::PI.sqrt() * 0.999_593_047_982_555;
    let opacity = 1.0 - (-depth).exp();
    let middle = f64::from(pixels[4 * width + 4][3]);
    assert!((middle - opacity).abs() <= 2e-6, "{middle} for {opacity}");
    let report = folder.report("two.json");
    assert_eq!(report["counts"]["gradients_computed"], 2, "{report:#}");
}

#[test]
fn what_no_widget_looks_at_is_not_computed() {
    let folder = Folder::new();
    let fields = "fields = [\"x\", \"y\"]\nscale = [1.0, 1.0]";
    let uniform = "kind = \"uniform\"\nregion = { s = [-1.0, 2.0] }";
    folder.write("even.toml", pipeline(fields, uniform));
    let ran = folder.voltet(&["explain", "even.toml"]).ok();
    assert!(ran.stdout.contains("multi-gradient: no widget looks at it"), "{}", ran.stdout);
    folder.voltet(&["run", "even.toml", "--set", "file.path=even.exr", "--report", "even.json"]).ok();
    let counts = &folder.report("even.json")["counts"];
    assert_eq!(
        (&counts["gradients_computed"], &counts["arrays_decoded"]),
        (&0.into(), &1.into()),
        "{counts}"
    );
    folder.voltet(&["run", "--exhaustive", "even.toml", "--set", "file.path=all.exr"]).ok();
}

#[test]
fn mistakes_are_named() {
    let folder = Folder::new();
    for (fields, wanted) in [
        ("fields = [\"x\", \"y\"]", "fields of several units have no common gradient"),
        ("fields = [\"x\", \"y\"]\nscale = [1.0]", "'scale' has the wrong length"),
        ("fields = []", "there is no field"),
        ("fields = [\"x\"]\nname = \"x\"", "the array needs a name of its own"),
        (
            "fields = [\"x\", \"y\"]\nscale = [1.0, 1.0]\nmethod = \"array\"\narray = \"gradient\"",
            "an array holds the gradient of one field",
        ),
    ] {
        folder.write("wrong.toml", pipeline(fields, OVER_X));
        folder.voltet(&["check", "wrong.toml"]).fails(2, &[wanted]);
    }
    // Without the node nobody makes the array.
    let lone = pipeline("fields = [\"x\"]", OVER_X).replace("volume = \"changes\"", "volume = \"gradient\"");
    folder.write("lone.toml", lone);
    let ran = folder.voltet(&["run", "lone.toml"]);
    assert_ne!(ran.code, 0);
    assert!(ran.stderr.contains("multi-gradient"), "{}", ran.stderr);
}
