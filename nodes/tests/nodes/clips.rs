//! Clips and slices whose places are not stated, or are shares of the bounds: they cut through the middle of the data, wherever these lie.

use crate::threshold::{picture_of, taken};
use std::fmt::Write;
use std::path::Path;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_graph::Demand;

/// A box of 5³ cells of these sides from a corner on.
fn folder(corner: [f64; 3], sides: [f64; 3]) -> tempfile::TempDir {
    let ([x, y, z], [a, b, c]) = (corner, sides);
    let mut text = format!(
        "# vtk DataFile Version 3.0\ntext\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 6 6 6\nORIGIN {x:?} {y:?} {z:?}\n\
         SPACING {a:?} {b:?} {c:?}\nPOINT_DATA 216\nSCALARS a double 1\nLOOKUP_TABLE default\n"
    );
    (0..216).for_each(|i| writeln!(text, "{}", 2 * (i % 6) + i / 36).unwrap());
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtk"), text).unwrap();
    folder
}

/// The picture of nodes before the renderer, which draws `volume` with further keys.
fn drawn(folder: &Path, nodes: &str, volume: &str, keys: &str) -> Result<Picture> {
    let text = format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"a.vtk\"\nscalar = \"a\"\n{nodes}\n\
         [nodes.look]\ntype = \"transfer-function\"\ninputs = {{ volume = \"grid\" }}\n\
         [[nodes.look.widgets]]\nkind = \"colormap\"\nextinction = 0.5\n\
         [nodes.view]\ntype = \"camera\"\nview = \"isometric\"\nsize = [48, 40]\ninputs = {{ volume = \"grid\" }}\n\
         [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
         inputs = {{ volume = \"{volume}\", transfer_function = \"look\", camera = \"view\" }}\n{keys}\n\
         [nodes.taker]\ntype = \"taker\"\ninputs = {{ image = \"picture\" }}\n"
    );
    Ok(picture_of(&taken(&text, folder, &Demand::default())?.0))
}

#[test]
fn what_is_not_stated_cuts_through_the_middle_of_the_data() {
    for corner in [[0.0; 3], [1e8, -1e8, 3e7]] {
        let folder = folder(corner, [1.0; 3]);
        let [x, y, z] = corner.map(|low| low + 2.5);
        let [top_x, top_y, top_z] = corner.map(|low| low + 5.0);
        let low_z = corner[2];
        let radius = 0.25 * 75f64.sqrt();
        let whole = drawn(folder.path(), "", "grid", "").unwrap();
        for (silent, stated) in [
            (
                "kind = \"plane\"",
                format!("kind = \"plane\", origin = [{x:?}, {y:?}, {z:?}], normal = [1, 0, 0]"),
            ),
            (
                "kind = \"plane\", normal = [1, 2, 3], invert = true",
                format!(
                    "kind = \"plane\", origin = [{x:?}, {y:?}, {z:?}], normal = [1, 2, 3], invert = true"
                ),
            ),
            (
                "kind = \"plane\", origin = [\"50 %\", \"50 %\", \"100 %\"], normal = [0, 1, -1]",
                format!("kind = \"plane\", origin = [{x:?}, {y:?}, {top_z:?}], normal = [0, 1, -1]"),
            ),
            (
                "kind = \"box\"",
                format!(
                    "kind = \"box\", low = [{x:?}, {y:?}, {z:?}], high = [{top_x:?}, {top_y:?}, {top_z:?}]"
                ),
            ),
            (
                "kind = \"sphere\"",
                format!("kind = \"sphere\", centre = [{x:?}, {y:?}, {z:?}], radius = {radius:?}"),
            ),
            (
                "kind = \"cylinder\"",
                format!(
                    "kind = \"cylinder\", from = [{x:?}, {y:?}, {low_z:?}], to = [{x:?}, {y:?}, {top_z:?}], radius = {radius:?}"
                ),
            ),
        ] {
            let clipped =
                |clip: &str| drawn(folder.path(), "", "grid", &format!("clip = [{{ {clip} }}]")).unwrap();
            let found = clipped(silent);
            assert!(found == clipped(&stated) && found != whole, "{silent} {corner:?}");
            assert!(found.rgba.iter().any(|pixel| pixel[3] > 0.1), "{silent} {corner:?}: nothing is seen");
            let kept = |clip: &str| {
                let nodes = format!(
                    "[nodes.kept]\ntype = \"threshold\"\nclip = [{{ {clip} }}]\ninputs = {{ volume = \"grid\" }}\n"
                );
                drawn(folder.path(), &nodes, "kept", "").unwrap()
            };
            let found = kept(silent);
            assert!(found == kept(&stated) && found != whole, "threshold: {silent} {corner:?}");
        }
    }
}

#[test]
fn what_cannot_be_cut_is_refused_before_data_are_read_where_that_is_known() {
    let nowhere = tempfile::tempdir().unwrap();
    for (clip, said) in [
        ("kind = \"plane\", normal = [0, 0, 0]", "has no direction"),
        (
            "kind = \"box\", low = [\"60 %\", \"0 %\", \"0 %\"], high = [\"40 %\", \"100 %\", \"100 %\"]",
            "no inside",
        ),
        ("kind = \"sphere\", radius = \"0 %\"", "'radius' is out of range"),
        ("kind = \"sphere\", centre = [\"p50\", 0, 0]", "a percentile is a value of a field"),
        // What is sound as far as it is known is read, and there is no file.
        ("kind = \"box\", high = [0.2, 0.2, 0.2]", "no such file"),
    ] {
        let error =
            drawn(nowhere.path(), "", "grid", &format!("clip = [{{ {clip} }}]")).unwrap_err().to_string();
        assert!(error.contains(said), "{clip}: {error}");
    }
}

/// Data without a height: a plane cuts them, and a box between two equal heights is refused in words.
#[test]
fn flat_data_are_cut_by_a_plane_and_have_no_box() {
    let folder = folder([0.0, 0.0, 1e8], [1.0, 1.0, 1e-10]);
    let plane = drawn(folder.path(), "", "grid", "clip = [{ kind = \"plane\" }]");
    assert!(plane.is_ok(), "{}", plane.unwrap_err());
    let error = drawn(folder.path(), "", "grid", "clip = [{ kind = \"box\" }]").unwrap_err().to_string();
    assert!(error.contains("the box has no inside"), "{error}");
}
