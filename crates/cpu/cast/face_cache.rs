//! Face cache: shared faces, cached between pictures.

use super::half_faces::{BYTES_PER_CELL, HalfFaces};
use super::mesh::Mesh;
use crate::cache::get_or_compute;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::Grid;

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

    /// Faces of the volume.
    pub fn mesh(&self, grid: &Grid) -> Arc<Mesh> {
        get_or_compute(&self.faces.mesh, |_| true, || Mesh::new(grid))
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
