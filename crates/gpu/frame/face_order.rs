//! The order of a volume's cells along their faces, for compositors that blend: found on the CPU, and kept while it holds.

use std::sync::Arc;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::camera::{Camera, Projection};
use voltet_core::visibility::{FaceOrder, Faces, OrderError};
use voltet_optics::scene::Scene;

/// Cache of a grid's faces, and of the last order with its camera.
#[derive(Default)]
pub(crate) struct FaceOrderCache {
    faces: Option<Faces>,
    last: Option<(Camera, FaceOrderResult)>,
}

/// The order, or the reason why there is none.
pub(crate) type FaceOrderResult = std::result::Result<Arc<FaceOrder>, OrderError>;

impl FaceOrderCache {
    /// The order for a scene's camera, and the seconds that it took; none where it was there.
    ///
    /// Errors: a camera out of range.
    pub fn find(&mut self, scene: &Scene) -> Result<(FaceOrderResult, Option<f64>)> {
        let (grid, camera) = (&scene.volume.grid, &scene.camera);
        let FaceOrderCache { faces, last } = self;
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

/// True if the order of one camera holds for another: without gaps, and where nothing was made to fit the pixels, only the eye
/// is of account.
fn serves(faces: &Faces, known: &Camera, found: &FaceOrderResult, camera: &Camera) -> bool {
    let is_same_eye = match (known.projection, camera.projection) {
        (Projection::Perspective { .. }, Projection::Perspective { .. }) => known.eye == camera.eye,
        _ => false,
    };
    let is_of_eye =
        faces.is_independent_of_direction() && found.as_ref().is_ok_and(|order| order.taken_out == 0);
    known == camera || (is_of_eye && is_same_eye)
}
