//! Logarithmic axes of a transfer function: numbers of widgets, and what cannot stand on them.

use super::graph;
use super::relative::{WIRED, data, pixels, run, scene};
use std::path::Path;
use voltet_nodes::session;

/// s over twelve decades along x.
fn decades() -> String {
    data(|[x, y, _]| 10f64.powf(2.0 * x - 6.0 + 0.3 * y))
}

/// Pictures of looks at twelve decades.
fn pictures<const N: usize>(looks: [&str; N]) -> [Vec<[f32; 4]>; N] {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtk"), decades()).unwrap();
    looks.map(|look| pixels(&run(&mut session(), &scene("a.vtk", "a", WIRED, look), folder.path())).to_vec())
}

fn difference(one: &[[f32; 4]], other: &[[f32; 4]]) -> f32 {
    let pairs = one.as_flattened().iter().zip(other.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

const BOX: &str = "[[nodes.look.widgets]]\nkind = \"uniform\"\ncolor = [1.0, 0.5, 0.1]\nextinction = 0.5\n";

/// A box of values is the same on every axis: a segment is in it from value to value.
#[test]
fn a_box_is_the_same_on_every_scale() {
    let region = "region = { s = [1e-3, 1e4], g = [0.0, 1e5] }\n";
    let [linear, log, symlog] = pictures([
        &format!("{BOX}{region}"),
        &format!("s_scale = \"log\"\ng_scale = \"log\"\n{BOX}{region}"),
        &format!("s_scale = \"symlog\"\ns_linear_below = 1e-5\n{BOX}{region}"),
    ]);
    assert!(linear.iter().filter(|pixel| pixel[3] > 0.05).count() > 200);
    // Shares of a segment in 32 bits.
    for other in [log, symlog] {
        let most = difference(&linear, &other);
        assert!(most < 2e-6, "{most:e}");
    }
}

/// Shares of the range are shares of decades, and every decade of twelve has its colour.
#[test]
fn shares_of_a_range_are_shares_of_decades() {
    let map = |range: &str, scale: &str| {
        format!(
            "{scale}[[nodes.look.widgets]]\nkind = \"colormap\"\nopacity = \"peaks\"\nextinction = 2.0\n{range}"
        )
    };
    let log = "s_scale = \"log\"\n";
    // From 1e-6 to 10^7.8.
    let [relative, absolute, linear] = pictures([
        &map("", log),
        &map(&format!("range = [1e-6, {:?}]\n", 10f64.powf(7.8)), log),
        &map("", ""),
    ]);
    let most = difference(&relative, &absolute);
    // The end of the range is a rounded power of ten, and the flanks of the peaks are steep.
    assert!(most < 1e-5, "{most:e}");
    let shown = |picture: &[[f32; 4]]| picture.iter().filter(|pixel| pixel[3] > 0.05).count();
    assert!(shown(&relative) > 3 * shown(&linear), "{} {}", shown(&relative), shown(&linear));
}

#[test]
fn what_cannot_stand_on_an_axis_is_named() {
    let folder = Path::new(".");
    let gaussian = |centre: &str| {
        format!(
            "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1, 1, 1]\nextinction = 1.0\ncentre = {centre}\nsigma = [1, inf]\n"
        )
    };
    let triangular = "s_scale = \"log\"\n[[nodes.look.widgets]]\nkind = \"triangular-gaussian\"\ncolor = [1, 1, 1]\nextinction = 1.0\ncentre = 1.0\nsigma = 1.0\n";
    for (look, words) in [
        (
            format!("s_scale = \"log\"\n{}", gaussian("[-2.0, 1.0]")),
            vec!["'centre' has no place", "-2", "number > 0", "symlog"],
        ),
        (
            format!("s_scale = \"symlog\"\n{}", gaussian("[1, 1]")),
            vec!["needs 's_linear_below'", "s_linear_below ="],
        ),
        (
            format!("g_linear_below = 3.0\n{}", gaussian("[1, 1]")),
            vec!["'g_linear_below' belongs to \"symlog\"", "3"],
        ),
        (triangular.to_string(), vec!["triangular Gaussian", "linear axes"]),
    ] {
        let Err(error) = graph(&scene("a.vtk", "a", WIRED, &look), folder) else {
            panic!("accepted: {look}")
        };
        let message = error.to_string();
        for word in words {
            assert!(message.contains(word), "'{word}' is not in: {message}");
        }
    }
}
