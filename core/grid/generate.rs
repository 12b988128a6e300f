//! Small grids for tests and measurements: a box cut into cells of any kind, and fields sampled on it.

use super::cells::{CellSet, Polyhedron};
use super::parts::{Association, Cells, Options, Parts, Scalar};
use super::{Grid, build, code};
use crate::Result;
use crate::progress::Silent;
use glam::DVec3;
use std::sync::Arc;

/// What a box is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Kind {
    Tetrahedra,
    Voxels,
    Hexahedra,
    /// Two wedges a hexahedron, one of each vertex order.
    Wedges,
    /// Six pyramids a hexahedron, with a point in the middle.
    Pyramids,
    /// Hexahedra as polyhedra.
    Polyhedra,
    /// Tetrahedra with straight edges and mid-edge nodes.
    QuadraticTetrahedra,
    /// Hexahedra with straight edges and mid-edge nodes.
    QuadraticHexahedra,
}

/// A box of `counts[0] × counts[1] × counts[2]` hexahedra, each cut into five or six tetrahedra by the rule of
/// [`build()`], without a scalar. Points inside are moved at random (always alike) by up to `jitter` × the spacing
/// along each axis, those on the boundary within it; up to 0.25 no cell turns over.
pub fn box_of_tetrahedra(counts: [usize; 3], bounds: [DVec3; 2], jitter: f64) -> Grid {
    let parts = Parts::new(lattice(counts, bounds, jitter), Cells::Structured(counts.map(|n| n.max(1) + 1)));
    let mut grid = build(parts, &Options::default(), &Silent).expect("a box has cells");
    // These tetrahedra are the cells, rather than parts of hexahedra.
    grid.source_cells = None;
    let origin = Arc::make_mut(&mut grid.origin);
    origin.cells_by_type = [(code::TETRA, grid.tetrahedra.len() as u64)].into();
    grid
}

/// Gives a grid the scalar `field`, sampled at its points.
pub fn with_scalar(mut grid: Grid, name: &str, field: impl Fn(DVec3) -> f64) -> Grid {
    grid.scalar = Some(Arc::new(sample(&grid, field)));
    grid.scalar_name = name.into();
    grid
}

/// A field at every point of a grid.
pub fn sample<T>(grid: &Grid, field: impl Fn(DVec3) -> T) -> Vec<T> {
    grid.points.iter().map(|&p| field(p)).collect()
}

/// The box of [`box_of_tetrahedra`] in cells of any kind, as a reader would hand it over.
pub fn box_of(kind: Kind, counts: [usize; 3], bounds: [DVec3; 2], jitter: f64) -> Parts {
    let counts = counts.map(|n| n.max(1));
    let points = lattice(counts, bounds, jitter);
    let mut out =
        Builder { points, set: CellSet { offsets: vec![0], ..CellSet::default() }, mid: Default::default() };
    if kind == Kind::Tetrahedra || kind == Kind::QuadraticTetrahedra {
        let grid = box_of_tetrahedra(counts, bounds, jitter);
        for t in grid.tetrahedra.iter() {
            if kind == Kind::Tetrahedra {
                out.cell(code::TETRA, t);
            } else {
                let edges = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)];
                out.quadratic(code::QUADRATIC_TETRA, t, &edges);
            }
        }
    } else {
        let n = counts.map(|n| n + 1);
        for (k, j, i) in (0..counts[2])
            .flat_map(|k| (0..counts[1]).flat_map(move |j| (0..counts[0]).map(move |i| (k, j, i))))
        {
            let v: [u32; 8] = std::array::from_fn(|c| {
                ((i + (c & 1)) + n[0] * ((j + (c >> 1 & 1)) + n[1] * (k + (c >> 2)))) as u32
            });
            out.hexahedron(kind, [v[0], v[1], v[3], v[2], v[4], v[5], v[7], v[6]]);
        }
    }
    Parts::new(out.points, Cells::Mixed(out.set))
}

/// Gives parts the scalar `field`, sampled at the points.
pub fn parts_with_scalar(mut parts: Parts, name: &str, field: impl Fn(DVec3) -> f64) -> Parts {
    let values = parts.points.iter().map(|&p| field(p)).collect();
    parts.scalar = Some(Scalar { name: name.into(), association: Association::Point, values });
    parts
}

/// [`build()`] with default options and no progress.
pub fn built(parts: Parts) -> Result<Grid> {
    build(parts, &Options::default(), &Silent)
}

struct Builder {
    points: Vec<DVec3>,
    set: CellSet,
    mid: std::collections::HashMap<(u32, u32), u32>,
}

impl Builder {
    fn cell(&mut self, code: u8, corners: &[u32]) {
        self.set.types.push(code);
        self.set.connectivity.extend_from_slice(corners);
        self.set.offsets.push(self.set.connectivity.len() as u64);
    }

    fn quadratic(&mut self, code: u8, corners: &[u32], edges: &[(usize, usize)]) {
        let mut nodes = corners.to_vec();
        for &(a, b) in edges {
            let (a, b) = (corners[a].min(corners[b]), corners[a].max(corners[b]));
            let points = &mut self.points;
            let node = *self.mid.entry((a, b)).or_insert_with(|| {
                let middle = points[a as usize].midpoint(points[b as usize]);
                points.push(middle);
                points.len() as u32 - 1
            });
            nodes.push(node);
        }
        self.cell(code, &nodes);
    }

    /// One hexahedron (VTK's order) in cells of a kind.
    fn hexahedron(&mut self, kind: Kind, v: [u32; 8]) {
        const FACES: [[usize; 4]; 6] =
            [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];
        match kind {
            Kind::Voxels => self.cell(code::VOXEL, &[v[0], v[1], v[3], v[2], v[4], v[5], v[7], v[6]]),
            Kind::Wedges => {
                self.cell(code::WEDGE, &[v[0], v[1], v[2], v[4], v[5], v[6]]);
                self.cell(code::WEDGE, &[v[0], v[3], v[2], v[4], v[7], v[6]]);
            }
            Kind::Pyramids => {
                let middle = v.iter().map(|&p| self.points[p as usize]).sum::<DVec3>() / 8.0;
                self.points.push(middle);
                let apex = self.points.len() as u32 - 1;
                for f in FACES {
                    self.cell(code::PYRAMID, &[v[f[0]], v[f[1]], v[f[2]], v[f[3]], apex]);
                }
            }
            Kind::Polyhedra => {
                let cell = self.set.types.len() as u32;
                self.cell(code::POLYHEDRON, &v);
                let faces = FACES.iter().map(|f| f.iter().map(|&c| v[c]).collect()).collect();
                self.set.polyhedra.push(Polyhedron { cell, faces });
            }
            Kind::QuadraticHexahedra => {
                let edges = [
                    (0, 1),
                    (1, 2),
                    (2, 3),
                    (3, 0),
                    (4, 5),
                    (5, 6),
                    (6, 7),
                    (7, 4),
                    (0, 4),
                    (1, 5),
                    (2, 6),
                    (3, 7),
                ];
                self.quadratic(code::QUADRATIC_HEXAHEDRON, &v, &edges);
            }
            _ => self.cell(code::HEXAHEDRON, &v),
        }
    }
}

/// The points of a box, x fastest.
fn lattice(counts: [usize; 3], [low, high]: [DVec3; 2], jitter: f64) -> Vec<DVec3> {
    let counts = counts.map(|n| n.max(1));
    let mut points = Vec::with_capacity(counts.iter().map(|n| n + 1).product());
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for k in 0..=counts[2] {
        for j in 0..=counts[1] {
            for i in 0..=counts[0] {
                let at = [i, j, k];
                let t = DVec3::from_array(std::array::from_fn(|axis| {
                    let shift = jitter * (2.0 * random.next() - 1.0);
                    let inside = at[axis] > 0 && at[axis] < counts[axis];
                    (at[axis] as f64 + if inside { shift } else { 0.0 }) / counts[axis] as f64
                }));
                points.push(low * (DVec3::ONE - t) + high * t);
            }
        }
    }
    points
}

/// A small generator of uniform numbers (xorshift64*, Marsaglia 2003, Vigna 2016), the same on every machine.
pub struct Random(pub u64);

impl Random {
    /// The next number in [0, 1).
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
