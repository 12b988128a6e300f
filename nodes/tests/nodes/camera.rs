//! Cameras that are stated by a view, by angles, or by what they are fitted to.

use super::graph;
use glam::DVec3;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::extent::corners;
use voltet_core::{Error, Result};
use voltet_graph::NoObserver;

/// Ends of the box of `wavelet` as it stands below.
const ENDS: [DVec3; 2] = [DVec3::splat(-10.0), DVec3::splat(10.0)];

/// The camera of a pipeline with these lines in its node; `wire`: what feeds it.
fn camera(lines: &str, wire: &str) -> Result<Camera> {
    let text = format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"wavelet\"\n\
         [nodes.look]\ntype = \"transfer-function\"\n[nodes.view]\ntype = \"camera\"\nsize = [32, 24]\n{lines}\n{wire}\n\
         [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
         inputs = {{ volume = \"grid\", transfer_function = \"look\", camera = \"view\" }}\n\
         [nodes.file]\ntype = \"image-writer\"\npath = \"view.png\"\ninputs = {{ image = \"picture\" }}\n"
    );
    let folder = tempfile::tempdir().unwrap();
    let report = voltet_nodes::session().run(&graph(&text, folder.path())?, &NoObserver)?;
    Ok(*report.origins.cameras[0].1)
}

const WIRE: &str = "inputs = { volume = \"grid\" }";

/// From this direction to all of a box.
fn fitted(eye: DVec3, up: DVec3, projection: Projection, ends: [DVec3; 2]) -> Camera {
    let size = [32, 24];
    let camera = Camera { eye, target: DVec3::ZERO, up, projection, near: 0.0, size, samples: 1 };
    camera.fitted(&corners(ends)).unwrap()
}

const PERSPECTIVE: Projection = Projection::Perspective { fov_y: 30.0 };

#[test]
fn a_view_is_fitted_to_the_data_from_its_side() {
    for (view, eye, up) in [
        ("+x", DVec3::X, DVec3::Z),
        ("-x", -DVec3::X, DVec3::Z),
        ("+y", DVec3::Y, DVec3::Z),
        ("-y", -DVec3::Y, DVec3::Z),
        ("+z", DVec3::Z, DVec3::Y),
        ("-z", -DVec3::Z, DVec3::Y),
        ("isometric", DVec3::ONE, DVec3::Z),
    ] {
        let found = camera(&format!("view = \"{view}\""), WIRE).unwrap();
        assert_eq!(found, fitted(eye, up, PERSPECTIVE, ENDS), "{view}");
    }
    let found = camera("view = \"+x\"\nup = [0.0, -1.0, 0.0]\nheight = \"auto\"", WIRE).unwrap();
    assert_eq!(found, fitted(DVec3::X, -DVec3::Y, Projection::Orthographic { height: 1.0 }, ENDS));
    // The margin is 6 %.
    assert_eq!(found.projection, Projection::Orthographic { height: 20.0 / 0.94 });
    let found = camera("view = \"+x\"\nheight = 3.0", WIRE).unwrap();
    assert_eq!(found.projection, Projection::Orthographic { height: 3.0 });
}

#[test]
fn a_view_is_fitted_to_a_region_in_numbers_or_shares_of_the_bounds() {
    let ends = [DVec3::new(-10.0, -5.0, 0.0), DVec3::new(0.0, 5.0, 10.0)];
    let wanted = fitted(-DVec3::Y, DVec3::Z, PERSPECTIVE, ends);
    // Numbers alone need no data.
    let numbers = "view = \"-y\"\nfit = [-10.0, 0.0, -5.0, 5.0, 0.0, 10.0]";
    assert_eq!(camera(numbers, "").unwrap(), wanted);
    let shares = "view = \"-y\"\nfit = [\"0 %\", 0.0, \"25 %\", \"75 %\", \"50 %\", \"100 %\"]";
    assert_eq!(camera(shares, WIRE).unwrap(), wanted);
}

#[test]
fn angles_and_zoom_follow_a_view_or_an_eye() {
    let angles = "azimuth = 30.0\nelevation = -20.0\nroll = 10.0\nzoom = 2.0";
    let eye = Camera {
        eye: DVec3::new(0.0, -8.0, 1.0),
        target: DVec3::new(0.0, 0.0, 1.0),
        ..fitted(DVec3::X, DVec3::Z, PERSPECTIVE, ENDS)
    };
    let turned = eye.turned([30.0, -20.0, 10.0]).unwrap();
    let found = camera(&format!("eye = [0.0, -8.0, 1.0]\ntarget = [0.0, 0.0, 1.0]\n{angles}"), "").unwrap();
    assert_eq!(found, Camera { projection: Projection::Perspective { fov_y: 15.0 }, ..turned });
    // A view is fitted after it is turned.
    let found = camera(&format!("view = \"-y\"\n{angles}"), WIRE).unwrap();
    let view = Camera { eye: -DVec3::Y, target: DVec3::ZERO, ..eye };
    let wanted = view.turned([30.0, -20.0, 10.0]).unwrap().fitted(&corners(ENDS)).unwrap();
    assert_eq!(found, wanted.zoomed(2.0));
}

#[test]
fn contradictions_are_refused_where_they_stand() {
    let eye = "eye = [0.0, -8.0, 1.0]";
    let both = &format!("{eye}\ntarget = [0.0, 0.0, 0.0]");
    for (lines, wire, wanted) in [
        (&*format!("view = \"+x\"\n{eye}"), WIRE, "'view' and 'eye' exclude each other: found view = \"+x\""),
        ("view = \"+x\"\ntarget = [0.0, 0.0, 0.0]", WIRE, "'view' and 'target' exclude each other"),
        ("", "", "the camera has no 'eye'"),
        (eye, "", "the camera has no 'target'"),
        (&format!("{both}\nfit = [0.0, 1.0, 0.0, 1.0, 0.0, 1.0]"), "", "'fit' belongs to a view"),
        (&format!("{both}\nheight = \"auto\""), "", "height = \"auto\" belongs to a view"),
        ("view = \"+x\"\nfov_y = 20.0\nheight = \"auto\"", WIRE, "'fov_y' and 'height' exclude each other"),
        ("view = \"+x\"\nfit = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0]", "", "the box is empty"),
        ("view = \"+x\"\nfit = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]", "", "fitted to what has no extent"),
        ("view = \"+x\"", "", "relative to data, and no data are wired in"),
        ("view = \"+x\"\nfit = [\"0 %\", 1.0, 0.0, 1.0, 0.0, 1.0]", "", "no data are wired in"),
        ("view = \"+x\"\nelevation = 90.0", WIRE, "parallel to the view direction"),
        ("view = \"+x\"\nup = [2.0, 0.0, 0.0]", WIRE, "parallel to the view direction"),
        ("view = \"+x\"\nzoom = 0.1", WIRE, "fov_y is out of range: found 300"),
        ("view = \"+x\"\nzoom = 0.0", WIRE, "'zoom' is out of range"),
        ("view = \"x\"", WIRE, "'view' does not know this word"),
    ] {
        let error: Error = camera(lines, wire).unwrap_err();
        assert!(error.to_string().contains(wanted), "{lines}: {error}");
        let is_placed = error.location.span.is_some() || error.location.node.is_some();
        assert!(is_placed, "{lines}: {error:?}");
    }
}
