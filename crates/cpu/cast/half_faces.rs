//! Faces that cells share: those of a volume, the half-faces of the cells that are drawn, and the cache that keeps both between pictures.

use crate::cache::get_or_compute;
use crate::tolerances::FLAT_CELL;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::{Grid, cells_of_faces, extent};

/// Cells at most: limited by the numbers of half-faces.
pub(crate) const MAX_CELLS: usize = 1 << 27;

/// Bytes of a cell: its half-faces, the faces that it shares, the side of its corners, its index among the drawn cells.
pub(crate) const BYTES_PER_CELL: u64 = 4 * (16 + 4) + 1 + 4;

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 12;

/// Flag in place of a next half-face: the ray exits the drawn cells, by the half-face whose number stands beside it.
pub(super) const EXIT_FLAG: u32 = 1 << 31;

// Half-faces are numbered above `ROTATION_BITS` and below `EXIT_FLAG`.
const _: () = assert!(MAX_CELLS <= 1 << (31 - ROTATION_BITS - 2));

/// Low bits of a next half-face: the rotation of its corners against those of this one.
pub(super) const ROTATION_BITS: u32 = 2;

/// The half-faces of the cells that are drawn, four a cell by the corner opposite.
#[derive(Debug)]
pub(crate) struct HalfFaces {
    /// For each half-face the corner opposite, then for each of its three the half-face that a ray enters by which passes it on the
    /// other side, through the face without it: number << [`ROTATION_BITS`] | rotation, or [`EXIT_FLAG`] with the half-face that it leaves by. Bits in place
    /// of floats. Behind them the sentinel, which leads to itself.
    pub records: Vec<[f32; 4]>,
    /// Boundary faces of the drawn cells, with their corners: these turn clockwise on the screen where rays enter.
    pub boundary: Vec<BoundaryFace>,
    pub cells: Arc<Vec<u32>>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundaryFace {
    pub half_face: u32,
    pub corners: [u32; 3],
}

/// The corners of a cell's faces, by the corner opposite, in the order in which rays see them that come in: of a cell whose fourth corner
/// lies on the positive side of the first three. Of another one the last two are exchanged. The first is the lowest.
pub(super) const ORDER: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// For each face and each of its corners, by side, as [`ORDER`] has them: the rotation of the corners of the face without it, where
/// the fourth takes its place, against their order on the other side, which begins with the lowest, too.
const ROTATIONS: [[[u32; 3]; 4]; 2] = {
    let mut turns = [[[0; 3]; 4]; 2];
    let mut face = 0;
    while face < 4 {
        let mut slot = 0;
        while slot < 3 {
            let [a, b, c] = ORDER[face];
            let mut side = 0;
            while side < 2 {
                let mut now = if side == 0 { [a, b, c] } else { [a, c, b] };
                now[slot] = face;
                let first = if now[0] < now[1] && now[0] < now[2] {
                    0
                } else if now[1] < now[2] {
                    1
                } else {
                    2
                };
                turns[side][face][slot] = (3 - first) % 3;
                side += 1;
            }
            slot += 1;
        }
        face += 1;
    }
    turns
};

impl HalfFaces {
    /// Half-faces of some cells of a grid, ascending.
    pub fn new(mesh: &Mesh, tetrahedra: &[[u32; 4]], cells: &Arc<Vec<u32>>) -> HalfFaces {
        // Where all cells are drawn, indices are their numbers.
        let indices = (cells.len() < tetrahedra.len()).then(|| {
            let mut indices = vec![NO_FACE; tetrahedra.len()];
            for (index, &cell) in cells.iter().enumerate() {
                indices[cell as usize] = index as u32;
            }
            indices
        });
        let index_of = |cell: u32| indices.as_ref().map_or(cell, |indices| indices[cell as usize]);
        let sentinel = 4 * cells.len() as u32;
        let mut records: Vec<[f32; 4]> = bytemuck::zeroed_vec(sentinel as usize + 1);
        let boundaries: Vec<Vec<BoundaryFace>> = records
            .par_chunks_mut(4 * CHUNK)
            .zip(cells.par_chunks(CHUNK))
            .enumerate()
            .map(|(chunk, (records, cells))| {
                let mut boundary = Vec::new();
                for (k, (&cell, records)) in cells.iter().zip(records.chunks_exact_mut(4)).enumerate() {
                    let corners = &tetrahedra[cell as usize];
                    let numbers = ((chunk * CHUNK + k) as u32, cell as usize);
                    mesh.add_half_faces(numbers, corners, index_of, records, &mut boundary);
                }
                boundary
            })
            .collect();
        let to_itself = f32::from_bits(sentinel << ROTATION_BITS);
        if let Some(last) = records.last_mut() {
            *last = [f32::from_bits(0), to_itself, to_itself, to_itself];
        }
        HalfFaces { records, boundary: boundaries.concat(), cells: cells.clone() }
    }

    pub fn sentinel(&self) -> u32 {
        self.records.len() as u32 - 1
    }
}

impl Mesh {
    /// Adds a cell's half-faces to the records and the boundary. `index`: that of the cell among the drawn ones.
    fn add_half_faces(
        &self,
        (index, cell): (u32, usize),
        corners: &[u32; 4],
        index_of: impl Fn(u32) -> u32,
        records: &mut [[f32; 4]],
        boundary: &mut Vec<BoundaryFace>,
    ) {
        let side = match self.sides[cell] {
            Side::Positive => 0,
            Side::Negative => 1,
            // No ray comes in.
            Side::Flat => return,
        };
        let order = ORDER.map(|[a, b, c]| if side == 0 { [a, b, c] } else { [a, c, b] });
        let mut behind = [EXIT_FLAG; 4];
        for (face, behind) in behind.iter_mut().enumerate() {
            let there = self.neighbours[4 * cell + face];
            let other = if there == NO_FACE { NO_FACE } else { index_of(there / 4) };
            if other == NO_FACE {
                let half_face = 4 * index + face as u32;
                *behind = EXIT_FLAG | half_face;
                boundary.push(BoundaryFace { half_face, corners: order[face].map(|k| corners[k]) });
            } else {
                *behind = (4 * other + there % 4) << ROTATION_BITS;
            }
        }
        for (face, record) in records.iter_mut().enumerate() {
            let mut words = [corners[face], 0, 0, 0];
            for (slot, word) in words[1..].iter_mut().enumerate() {
                // Out by the face that lacks this corner.
                let next = behind[order[face][slot]];
                *word = if next & EXIT_FLAG == 0 { next | ROTATIONS[side][face][slot] } else { next };
            }
            *record = words.map(f32::from_bits);
        }
    }
}

/// Cells of a chunk of work.
const MESH_CHUNK: usize = 1 << 13;

/// Side of the face of a cell's first three corners on which the fourth lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// In their plane.
    Flat,
    Positive,
    Negative,
}

/// Shared faces of a volume, whatever is drawn of it.
#[derive(Debug)]
pub(crate) struct Mesh {
    /// For each face (4 a cell, by the corner opposite) the face of the cell on its other side; [`NO_FACE`] where there is none, or none
    /// that lies on the other side.
    pub neighbours: Vec<u32>,
    pub(super) sides: Vec<Side>,
    /// The longest edge of all cells of the whole grid, and of those that are thin, world units.
    pub longest: [f64; 2],
}

pub(super) const NO_FACE: u32 = u32::MAX;

impl Mesh {
    /// `longest`: the longest edges, where they are known.
    pub fn new(grid: &Grid, longest: Option<[f64; 2]>) -> Mesh {
        let measure = |cell: &[u32; 4]| {
            let [a, b, c, d] = extent::corners_of(&grid.points, *cell);
            let [e, f, g] = [b - a, c - a, d - a];
            let volume = e.dot(f.cross(g));
            let side = if volume.abs() <= FLAT_CELL * e.length() * f.length() * g.length() {
                Side::Flat
            } else if volume > 0.0 {
                Side::Positive
            } else {
                Side::Negative
            };
            let of_cell = || extent::longest_edges_of_cell([a, b, c, d]);
            (side, longest.map_or_else(of_cell, |_| [0.0; 2]))
        };
        let max = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        let found: Vec<(Vec<Side>, [f64; 2])> = grid
            .tetrahedra
            .par_chunks(MESH_CHUNK)
            .map(|cells| {
                let mut longest = [0.0; 2];
                let side = |cell| {
                    let (side, of_cell) = measure(cell);
                    longest = max(longest, of_cell);
                    side
                };
                let sides = cells.iter().map(side).collect();
                (sides, longest)
            })
            .collect();
        let of_all = || found.iter().fold([0.0; 2], |longest, (_, of_chunk)| max(longest, *of_chunk));
        let longest = longest.unwrap_or_else(of_all);
        let sides = found.into_iter().map(|(sides, _)| sides).collect::<Vec<_>>().concat();
        let mut neighbours = cells_of_faces(grid);
        // Cells without a volume are passed by: no ray comes in, and what lies beside them is at a boundary. Cells on one side of the face
        // that they share overlap.
        let is_opposite = |here: usize, there: usize| {
            let side = |half_face: usize| match sides[half_face / 4] {
                Side::Flat => None,
                side => Some((side == Side::Positive) == half_face.is_multiple_of(2)),
            };
            matches!((side(here), side(there)), (Some(one), Some(other)) if one != other)
        };
        neighbours.par_chunks_mut(MESH_CHUNK).enumerate().for_each(|(chunk, faces)| {
            for (k, there) in faces.iter_mut().enumerate() {
                if *there != NO_FACE && !is_opposite(chunk * MESH_CHUNK + k, *there as usize) {
                    *there = NO_FACE;
                }
            }
        });
        Mesh { neighbours, sides, longest }
    }
}

/// Cached faces of a volume, with the cells that are drawn now.
#[derive(Debug, Clone)]
pub(crate) struct FaceCache {
    faces: Arc<CachedFaces>,
    /// Cells in widgets' supports, in view or not.
    drawn: Arc<Vec<u32>>,
}

#[derive(Debug, Default)]
struct CachedFaces {
    mesh: Mutex<Option<Arc<Mesh>>>,
    half_faces: Mutex<Option<Arc<HalfFaces>>>,
}

impl FaceCache {
    /// Empty cache, without cells.
    pub fn empty() -> FaceCache {
        FaceCache { faces: Arc::default(), drawn: Arc::default() }
    }

    /// The cache with other cells of the volume.
    pub fn with(&self, drawn: &Arc<Vec<u32>>) -> FaceCache {
        FaceCache { faces: self.faces.clone(), drawn: drawn.clone() }
    }

    pub fn drawn(&self) -> &Arc<Vec<u32>> {
        &self.drawn
    }

    /// Bytes of a cell that are not allocated yet.
    pub fn missing_bytes(&self) -> u64 {
        let mesh = self.faces.mesh.lock().unwrap_or_else(PoisonError::into_inner);
        if mesh.is_some() { 0 } else { BYTES_PER_CELL }
    }

    /// Faces of the volume, with the longest edges of the whole grid where they are known.
    pub fn mesh(&self, grid: &Grid, longest: Option<[f64; 2]>) -> Arc<Mesh> {
        get_or_compute(&self.faces.mesh, |_| true, || Mesh::new(grid, longest))
    }

    /// Half-faces of some cells, ascending.
    pub fn half_faces(&self, mesh: &Mesh, grid: &Grid, cells: &Arc<Vec<u32>>) -> Arc<HalfFaces> {
        let all = grid.tetrahedra.len();
        let is_valid = |cached: &HalfFaces| {
            Arc::ptr_eq(&cached.cells, cells) || (cached.cells.len() == all && cells.len() == all)
        };
        get_or_compute(&self.faces.half_faces, is_valid, || HalfFaces::new(mesh, &grid.tetrahedra, cells))
    }
}
