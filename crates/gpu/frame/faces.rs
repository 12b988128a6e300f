//! The order of a volume's cells along their faces, for compositors that blend: found on the CPU, and kept while it holds.

use crate::frame::renderer::Renderer;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::camera::{Camera, Projection};
use voltet_core::visibility::{FaceOrder, Faces, OrderError};
use voltet_optics::scene::Scene;

/// What is kept of a grid: its faces, and the order that was found last, with the camera that it is for.
#[derive(Default)]
pub(crate) struct Orders {
    faces: Option<Faces>,
    last: Option<(Camera, Found)>,
}

/// The order, or why there is none.
pub(crate) type Found = std::result::Result<Arc<FaceOrder>, OrderError>;

impl Renderer {
    /// The order for a scene's camera, and the seconds that it took; none where it was there.
    ///
    /// Errors: a camera out of range.
    pub(crate) fn along_faces(&self, scene: &Scene) -> Result<(Found, Option<f64>)> {
        let (grid, camera) = (&scene.volume.grid, &scene.camera);
        let mut orders = self.orders();
        let Orders { faces, last } = &mut *orders;
        let begun = Instant::now();
        let faces = faces.get_or_insert_with(|| Faces::new(grid));
        if let Some((_, found)) = last.as_ref().filter(|(known, found)| serves(faces, known, found, camera)) {
            return Ok((found.clone(), None));
        }
        let found = faces.order(grid, camera)?.map(Arc::new);
        *last = Some((*camera, found.clone()));
        Ok((found, Some(begun.elapsed().as_secs_f64())))
    }
}

/// Whether what was found for one camera serves another: without gaps, and where nothing was made to fit the pixels, only the eye
/// is of account.
fn serves(faces: &Faces, known: &Camera, found: &Found, camera: &Camera) -> bool {
    let is_same_eye = match (known.projection, camera.projection) {
        (Projection::Perspective { .. }, Projection::Perspective { .. }) => known.eye == camera.eye,
        _ => false,
    };
    let is_of_eye =
        faces.is_independent_of_direction() && found.as_ref().is_ok_and(|order| order.taken_out == 0);
    known == camera || (is_of_eye && is_same_eye)
}
