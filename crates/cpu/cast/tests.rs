//! Half-faces against the cells themselves.

use super::edge_functions::{edge_function, edges_inside};
use super::half_faces::{EXIT_FLAG, HalfFaces, Mesh, NO_FACE, ORDER, ROTATION_BITS, Side};
use proptest::prelude::*;
use std::sync::Arc;
use voltet_core::grid::Grid;
use voltet_simd::{Float, Kernel, LaneSet, Lanes, Mask, dispatch, mask_of};
use voltet_testing::pictures::grids::{cube, moved};

/// The corners of a half-face in their order.
fn corners(grid: &Grid, mesh: &Mesh, cells: &[u32], half_face: u32) -> [u32; 3] {
    let cell = cells[half_face as usize / 4] as usize;
    let [a, b, c] = ORDER[half_face as usize % 4].map(|k| grid.tetrahedra[cell][k]);
    if mesh.sides[cell] == Side::Negative { [a, c, b] } else { [a, b, c] }
}

/// Whatever face a ray goes out by, it comes in by one of the same corners, rotation as the record says, or is out.
fn leads_on(grid: &Grid, cells: &Arc<Vec<u32>>) -> usize {
    let mesh = Mesh::new(grid, None);
    let half_faces = HalfFaces::new(&mesh, &grid.tetrahedra, cells);
    let mut out = 0;
    for (number, record) in half_faces.records[..4 * cells.len()].iter().enumerate() {
        let [fourth, nexts @ ..] = record.map(f32::to_bits);
        let here = corners(grid, &mesh, cells, number as u32);
        for (slot, next) in nexts.into_iter().enumerate() {
            let mut now = here;
            now[slot] = fourth;
            if next & EXIT_FLAG != 0 {
                let mut left = corners(grid, &mesh, cells, next & !EXIT_FLAG);
                left.sort_unstable();
                now.sort_unstable();
                assert_eq!(now, left, "out of {number}");
                out += 1;
                continue;
            }
            let there = corners(grid, &mesh, cells, next >> ROTATION_BITS);
            let rotation = next & ((1 << ROTATION_BITS) - 1);
            for (k, corner) in now.into_iter().enumerate() {
                assert_eq!(corner, there[(k + rotation as usize) % 3], "from {number} by {slot}");
            }
        }
    }
    // Each face is left by three half-faces of its cell.
    assert_eq!(out, 3 * half_faces.boundary.len());
    half_faces.boundary.len()
}

#[test]
fn half_faces_lead_on_by_the_same_corners() {
    let grid = cube([4, 3, 5], 0.2);
    let all: Arc<Vec<u32>> = Arc::new((0..grid.tetrahedra.len() as u32).collect());
    // Two triangles for each square of the surface.
    assert_eq!(leads_on(&grid, &all), 4 * (4 * 3 + 3 * 5 + 5 * 4));
    let some: Arc<Vec<u32>> = Arc::new(all.iter().copied().filter(|cell| cell % 5 != 0).collect());
    assert!(leads_on(&grid, &some) > 4 * (4 * 3 + 3 * 5 + 5 * 4));
    // Mirrored, all cells are of the other side.
    let mirrored = moved(&grid, |p| glam::DVec3::new(-p.x, p.y, p.z));
    assert_eq!(leads_on(&mirrored, &all), 4 * (4 * 3 + 3 * 5 + 5 * 4));
}

#[test]
fn cells_on_one_side_of_a_face_share_none() {
    // Folded over: the middle of three layers of points lies behind the last.
    let folded =
        moved(&cube([2, 1, 1], 0.0), |p| glam::DVec3::new([0.0, 1.0, 0.4][(2.0 * p.x) as usize], p.y, p.z));
    let mesh = Mesh::new(&folded, None);
    for (half_face, &there) in mesh.neighbours.iter().enumerate().filter(|(_, there)| **there != NO_FACE) {
        assert_eq!(mesh.neighbours[there as usize], half_face as u32);
        let layer = |half_face: usize| half_face / 4 / (folded.tetrahedra.len() / 2);
        assert_eq!(layer(half_face), layer(there as usize), "across the fold");
    }
    let flat = moved(&cube([2, 1, 1], 0.0), |p| glam::DVec3::new(p.x.min(0.5), p.y, p.z));
    let mesh = Mesh::new(&flat, None);
    assert!(mesh.sides.contains(&Side::Flat));
    let of_flat = |half_face: usize| mesh.sides[half_face / 4] == Side::Flat;
    assert!((0..mesh.neighbours.len()).all(|k| !of_flat(k) || mesh.neighbours[k] == NO_FACE));
}

/// On which side two places pass the ray, and the same places exchanged.
struct Both([[f32; 2]; 2]);

impl Kernel<[bool; 2]> for Both {
    fn run<L: Lanes>(self) -> [bool; 2] {
        let [a, b] = self.0.map(|place| place.map(L::F::splat));
        let (there, back) = (edge_function::<L>(a, b), edge_function::<L>(b, a));
        let (one, other, _) =
            edges_inside::<L>([there, back, there], [[a, b], [b, a], [a, b]], mask_of::<L>(u32::MAX));
        assert_eq!(there.lt(L::F::splat(0.0)).any(), L::F::splat(0.0).lt(back).any());
        [one.any(), other.any()]
    }
}

/// Sides (bits) on which two edges pass the rays, those of even lanes and of odd, with all rays wanted and with the even ones alone.
struct Wanted([[[f32; 2]; 2]; 2]);

impl Kernel<[[u32; 3]; 2]> for Wanted {
    fn run<L: Lanes>(self) -> [[u32; 3]; 2] {
        let [even, odd] = self.0.map(|edge| edge.map(|place| place.map(L::F::splat)));
        let place =
            |k: usize| [0, 1].map(|axis| L::F::select(mask_of::<L>(EVEN), even[k][axis], odd[k][axis]));
        let (a, b) = (place(0), place(1));
        let (there, back) = (edge_function::<L>(a, b), edge_function::<L>(b, a));
        [u32::MAX, EVEN].map(|wanted| {
            let (x, y, z) =
                edges_inside::<L>([there, back, there], [[a, b], [b, a], [a, b]], mask_of::<L>(wanted));
            [x.bits(), y.bits(), z.bits()]
        })
    }
}

/// Every second lane.
const EVEN: u32 = 0x5555_5555;

/// Edge function of two places.
struct EdgeFunction([[f32; 2]; 2]);

impl Kernel<f32> for EdgeFunction {
    fn run<L: Lanes>(self) -> f32 {
        let [a, b] = self.0.map(|place| place.map(L::F::splat));
        let mut found = [0.0; 64];
        edge_function::<L>(a, b).store(&mut found);
        found[0]
    }
}

/// Steps of places, such that some edges pass through the ray.
fn place() -> impl Strategy<Value = [f32; 2]> {
    let near = (-4..5i32, -4..5i32).prop_map(|(x, y)| [x as f32, y as f32]);
    let odd = (-20..20i32, 1..2000i32)
        .prop_map(|(n, step)| [n as f32 * step as f32 * 3e-4, n as f32 * step as f32 * 7e-4]);
    prop_oneof![near, odd, prop::array::uniform2(-50.0f32..50.0)]
}

proptest! {
    /// Also without a fused multiply-add: the edge runs from far on one side of the ray to far on the other and passes close by it.
    #[test]
    fn an_edge_function_keeps_its_digits(a in prop::array::uniform2(-50.0f32..50.0), by in 0.1f32..10.0) {
        let b = a.map(|x| -by * x);
        let [[ax, ay], [bx, by]] = [a, b].map(|place| place.map(f64::from));
        let exact = ax * by - ay * bx;
        for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
            let found = dispatch(lanes, EdgeFunction([a, b]));
            let error = (f64::from(found) - exact).abs();
            prop_assert!(error <= 2e-7 * exact.abs(), "{}: {found:e} for {exact:e}", lanes.name());
        }
    }

    /// The same holds where an edge passes through the ray.
    #[test]
    fn a_ray_passes_an_edge_on_one_side(a in place(), b in place()) {
        prop_assume!(a != b);
        for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
            let [one, other] = dispatch(lanes, Both([a, b]));
            prop_assert_ne!(one, other, "{} {:?} {:?}", lanes.name(), a, b);
        }
    }

    /// Rays that do not count change nothing of those that do.
    #[test]
    fn wanted_rays_pass_edges_as_if_all_were_wanted(a in place(), b in place(), c in place(), d in place()) {
        prop_assume!(a != b && c != d);
        for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
            let [all, even] = dispatch(lanes, Wanted([[a, b], [c, d]]));
            prop_assert_eq!(all.map(|bits| bits & EVEN), even.map(|bits| bits & EVEN), "{}", lanes.name());
        }
    }
}
