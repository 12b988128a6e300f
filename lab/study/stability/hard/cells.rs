//! Hard cells: degenerate, at extreme coordinates, thousands along a ray.

use super::scene::{FIELDS, Hard, cube, look, moved, outside};
use glam::DVec3;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::Grid;
use voltet_core::transfer::{Profile, TransferFunction, Widget};

/// Every one.
pub(super) fn scenes() -> Vec<Hard> {
    let slivers = [1e-2, 1e-4, 1e-6].map(slivers);
    flat()
        .into_iter()
        .chain(slivers)
        .chain(without_volume())
        .chain(far())
        .chain([needles(), deep()])
        .collect()
}

/// Cells squeezed to a layer.
fn flat() -> Vec<Hard> {
    let base = cube([3, 3, 3], 0.0);
    let layer = |thickness: f64| {
        let place = move |p: DVec3| {
            let x = [0.0, 0.5, 0.5 + thickness, 1.0][(p.x * 3.0).round() as usize];
            DVec3::new(x, p.y, p.z)
        };
        moved(format!("a layer of thickness {thickness:e}"), "degenerate cells", &base, place)
    };
    [1e-3, 1e-6, 1e-9, 1e-12, 0.0].map(layer).into()
}

/// Cells squeezed together across one axis but for a layer at each end, by a Gaussian over two further fields.
fn slivers(thin: f64) -> Hard {
    let base = cube([4, 4, 4], 0.1);
    let place = move |p: DVec3| {
        DVec3::new(p.x, p.y, 0.5 + (p.z - 0.5) * if p.z.min(1.0 - p.z) < 0.2 { 1.0 } else { thin })
    };
    let name = format!("slivers of {thin:e} by two fields");
    let several = Profile::GaussianNd {
        fields: FIELDS.map(String::from).into(),
        centre: vec![0.2, 0.9],
        matrix: vec![vec![3.0, 0.7], vec![-0.4, 2.5]],
    };
    let widget = Widget { profile: several, extinction: 6.0, color: [0.9, 0.6, 0.1], region: None };
    let look = TransferFunction { widgets: vec![widget], ..look() };
    Hard { look, ..moved(name, "degenerate cells", &base, place) }
}

/// Cells with four points in a plane, on a line or in one place, among others.
fn without_volume() -> Vec<Hard> {
    let base = cube([3, 3, 3], 0.0);
    // Points 0 to 3 lie on an edge, 0, 21, 42, 63 on the diagonal, 0, 1, 4, 5 in a face.
    let kinds: [(&str, &[[u32; 4]]); 3] = [
        ("cells in a plane", &[[0, 1, 4, 5], [0, 3, 12, 15]]),
        ("cells on a line", &[[0, 1, 2, 3], [0, 21, 42, 63]]),
        ("cells with equal points", &[[5, 5, 9, 11], [7, 7, 7, 7], [3, 3, 3, 30]]),
    ];
    let scene = |(name, cells): (&str, &[[u32; 4]])| {
        let mut all = base.tetrahedra.to_vec();
        all.extend(cells.iter().map(|cell| {
            let mut cell = *cell;
            cell.sort_unstable();
            cell
        }));
        let grid = Grid { tetrahedra: SharedSlice::from(all), ..base.clone() };
        moved(name.into(), "degenerate cells", &grid, |p| p)
    };
    kinds.map(scene).into()
}

/// Cells a hundred thousand times as long as wide, seen across.
fn needles() -> Hard {
    let base = cube([3, 3, 3], 0.2);
    let narrow = |p: DVec3| DVec3::new(p.x, 0.5 + 1e-5 * (p.y - 0.5), p.z);
    let scene = moved("needles of 1 : 100,000".into(), "degenerate cells", &base, narrow);
    let camera = Camera {
        eye: DVec3::new(0.503, -2.0, 0.507),
        target: DVec3::new(0.503, 0.0, 0.507),
        projection: Projection::Orthographic { height: 0.9 },
        ..outside()
    };
    // So that 1e-5 of length is seen.
    Hard { camera, look: TransferFunction { unit_distance: 1e-5, ..look() }, ..scene }
}

/// The cube at other scales, and far from the origin.
fn far() -> Vec<Hard> {
    let base = cube([4, 4, 4], 0.2);
    let scene = |(scale, offset): (f64, DVec3)| {
        let place = move |p: DVec3| offset + scale * p;
        let name = format!("lengths of {scale:.0e} at {:.1e} from the origin", offset.length());
        let view = outside();
        let camera = Camera { eye: place(view.eye), target: place(view.target), ..view };
        let look = TransferFunction { unit_distance: scale, ..look() };
        Hard { camera, look, ..moved(name, "extreme coordinates", &base, place) }
    };
    [
        (1e-30, DVec3::ZERO),
        (1e-20, DVec3::ZERO),
        (1e20, DVec3::ZERO),
        (1e30, DVec3::ZERO),
        (1.0, DVec3::new(1e6, -1e6, 1e6)),
        (1e-3, DVec3::new(1e3, 1e3, -1e3)),
        (1e20, DVec3::new(1e26, 0.0, -1e26)),
    ]
    .map(scene)
    .into()
}

/// Thousands of segments on a pixel.
fn deep() -> Hard {
    let base = cube([1, 600, 1], 0.0);
    let scene = moved("over 1,200 cells along a ray".into(), "long compositing chains", &base, |p| {
        DVec3::new(p.x, 3.0 * p.y, p.z)
    });
    let projection = Projection::Perspective { fov_y: 18.0 };
    let (eye, target) = (DVec3::new(0.45, -3.0, 0.55), DVec3::new(0.5, 0.0, 0.5));
    Hard { camera: Camera { eye, target, projection, size: [8, 8], ..outside() }, ..scene }
}
