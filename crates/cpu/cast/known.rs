//! Faces, kept between pictures.

use super::OF_CELL;
use super::half_faces::HalfFaces;
use super::mesh::Mesh;
use crate::spare::kept;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::Grid;

/// What is known of a volume's faces, and of the cells that are drawn now.
#[derive(Debug, Clone)]
pub(crate) struct KnownFaces {
    kept: Arc<Kept>,
    /// Cells that widgets touch, whether they are in view or not.
    drawn: Arc<Vec<u32>>,
}

#[derive(Debug, Default)]
struct Kept {
    mesh: Mutex<Option<Arc<Mesh>>>,
    half_faces: Mutex<Option<Arc<HalfFaces>>>,
}

impl KnownFaces {
    /// Nothing yet, and no cell.
    pub fn none() -> KnownFaces {
        KnownFaces { kept: Arc::default(), drawn: Arc::default() }
    }

    /// The same of other cells of the volume.
    pub fn with(&self, drawn: &Arc<Vec<u32>>) -> KnownFaces {
        KnownFaces { kept: self.kept.clone(), drawn: drawn.clone() }
    }

    pub fn drawn(&self) -> &[u32] {
        &self.drawn
    }

    /// Bytes of a cell that are still to be taken.
    pub fn bytes_to_find(&self) -> u64 {
        let mesh = self.kept.mesh.lock().unwrap_or_else(PoisonError::into_inner);
        if mesh.is_some() { 0 } else { OF_CELL }
    }

    /// Faces of the volume, found if they are not known.
    pub fn mesh(&self, grid: &Grid) -> Arc<Mesh> {
        kept(&self.kept.mesh, |_| true, || Mesh::new(grid))
    }

    /// The same of the cells that are drawn.
    pub fn half_faces(&self, mesh: &Mesh, grid: &Grid) -> Arc<HalfFaces> {
        let all = grid.tetrahedra.len();
        let is_ours = |half_faces: &HalfFaces| {
            let cells = &half_faces.cells;
            Arc::ptr_eq(cells, &self.drawn) || (cells.len() == all && self.drawn.len() == all)
        };
        kept(&self.kept.half_faces, is_ours, || HalfFaces::new(mesh, &grid.tetrahedra, &self.drawn))
    }
}
