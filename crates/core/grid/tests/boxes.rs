//! Boxes in cells of any kind, as a reader would hand them over.

use super::*;
use crate::grid::generate::{box_of_tetrahedra, lattice};
use crate::progress::NoProgress;

/// Cell type that a box is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

/// The box of `box_of_tetrahedra` in cells of any kind, as a reader would hand it over.
pub fn box_of(kind: Kind, counts: [usize; 3], bounds: [DVec3; 2], jitter: f64) -> RawGrid {
    let counts = counts.map(|n| n.max(1));
    let points = lattice(counts, bounds, jitter);
    let mut out = Builder { points, set: CellSet::default(), mid: Default::default() };
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
    RawGrid::new(out.points, Cells::Mixed(out.set))
}

/// Gives parts the scalar `field`, sampled at the points.
pub fn parts_with_scalar(mut parts: RawGrid, name: &str, field: impl Fn(DVec3) -> f64) -> RawGrid {
    let values = parts.points.iter().map(|&p| field(p)).collect();
    parts.scalar = Some(Scalar { name: name.into(), association: Association::Point, values });
    parts
}

/// `build` with default options and no progress.
pub fn built(parts: RawGrid) -> Result<Grid> {
    build(parts, &Options::default(), &NoProgress)
}

struct Builder {
    points: Vec<DVec3>,
    set: CellSet,
    mid: HashMap<(u32, u32), u32>,
}

impl Builder {
    fn cell(&mut self, code: u8, corners: &[u32]) {
        self.set.push(code, corners.iter().copied());
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
