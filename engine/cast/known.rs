//! Faces, kept between pictures.

use super::half_faces::HalfFaces;
use super::mesh::Mesh;
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
    half_faces: Mutex<Option<OfCells>>,
}

/// Half-faces, and the cells that they are of.
type OfCells = (Arc<Vec<u32>>, Arc<HalfFaces>);

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

    /// Faces of the volume and of the cells, found if they are not known.
    pub fn of(&self, grid: &Grid) -> (Arc<Mesh>, Arc<HalfFaces>) {
        let mesh = kept(&self.kept.mesh, |_| true, || Arc::new(Mesh::new(grid)));
        let all = grid.tetrahedra.len();
        let is_ours = |(cells, _): &OfCells| {
            Arc::ptr_eq(cells, &self.drawn) || (cells.len() == all && self.drawn.len() == all)
        };
        let make = || {
            let half_faces = HalfFaces::new(&mesh, &grid.tetrahedra, &self.drawn);
            (self.drawn.clone(), Arc::new(half_faces))
        };
        let (_, half_faces) = kept(&self.kept.half_faces, is_ours, make);
        (mesh, half_faces)
    }
}

/// What is kept if it is right, else made anew and kept instead. Nobody waits for another who makes it.
fn kept<T: Clone>(place: &Mutex<Option<T>>, is_right: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> T {
    let there = place.lock().unwrap_or_else(PoisonError::into_inner).clone();
    if let Some(there) = there.filter(|there| is_right(there)) {
        return there;
    }
    let made = make();
    *place.lock().unwrap_or_else(PoisonError::into_inner) = Some(made.clone());
    made
}
