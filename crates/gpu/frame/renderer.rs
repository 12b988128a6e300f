//! Renderer of a volume: its grid on a device, the buffers that stay between its frames, and the order of its cells along their
//! faces, which is found on the CPU and kept while it holds.

use crate::device::{Device, GrowingBuffer, locked};
use crate::grid::{DeviceGrid, GrowingSplitBuffer};
use crate::raster::RasterBuffers;
use crate::tables::Tables;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Instant;
use voltet_core::Result;
use voltet_core::camera::{Camera, Projection};
use voltet_core::visibility::{FaceOrder, Faces, OrderError};
use voltet_core::volume::Volume;
use voltet_optics::scene::Scene;

/// A volume on a device, ready to be drawn.
pub struct Renderer {
    pub(crate) grid: DeviceGrid,
    buffers: Mutex<FrameBuffers>,
    orders: Mutex<FaceOrderCache>,
}

impl Renderer {
    /// Uploads the grid. Errors: what has more parts than the device binds at a time; memory.
    pub fn new(device: Arc<Device>, volume: &Volume) -> Result<Renderer> {
        Ok(Renderer {
            grid: DeviceGrid::new(device, volume)?,
            buffers: Mutex::default(),
            orders: Mutex::default(),
        })
    }

    /// Sets the initial work of a tile in one dispatch (cells tested).
    pub fn with_budget_of(self, work: u32) -> Renderer {
        self.buffers().budget = Some(work);
        self
    }

    /// Sets the number of cells in a draw of the raster compositor.
    pub fn with_runs_of(self, cells: u32) -> Renderer {
        self.buffers().raster.run_length = Some(cells.max(1));
        self
    }

    /// The device.
    pub fn device(&self) -> &Arc<Device> {
        &self.grid.device
    }

    /// The order of the cells along their faces for a scene's camera, and the seconds that finding it took; none where it was kept.
    ///
    /// Errors: a camera out of range.
    pub(crate) fn along_faces(&self, scene: &Scene) -> Result<(FaceOrderResult, Option<f64>)> {
        let (grid, camera) = (&scene.volume.grid, &scene.camera);
        let FaceOrderCache { faces, last } = &mut *locked(&self.orders);
        let begun = Instant::now();
        let faces = faces.get_or_insert_with(|| Faces::new(grid));
        if let Some((_, found)) = last.as_ref().filter(|(known, found)| serves(faces, known, found, camera)) {
            return Ok((found.clone(), None));
        }
        let found = faces.order(grid, camera)?.map(Arc::new);
        *last = Some((*camera, found.clone()));
        Ok((found, Some(begun.elapsed().as_secs_f64())))
    }

    pub(crate) fn buffers(&self) -> MutexGuard<'_, FrameBuffers> {
        locked(&self.buffers)
    }
}

/// Cache of a grid's faces, and of the last order with its camera.
#[derive(Default)]
struct FaceOrderCache {
    faces: Option<Faces>,
    last: Option<(Camera, FaceOrderResult)>,
}

/// The order, or the reason why there is none.
pub(crate) type FaceOrderResult = std::result::Result<Arc<FaceOrder>, OrderError>;

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

/// Buffers that a frame is read back by.
#[derive(Default)]
pub(crate) struct ReadbackBuffers {
    pub picture: GrowingBuffer,
    pub counts: GrowingBuffer,
}

/// Buffers that stay between frames.
#[derive(Default)]
pub(crate) struct FrameBuffers {
    pub seen: GrowingSplitBuffer,
    pub attributes: GrowingSplitBuffer,
    pub bounds: GrowingSplitBuffer,
    pub entries: GrowingBuffer,
    pub picture: GrowingBuffer,
    pub counts: GrowingBuffer,
    /// Readback buffers of frames that are drawn one at a time.
    pub returned: ReadbackBuffers,
    /// Readback buffers for frames in flight that are not in use.
    pub idle_readbacks: Vec<ReadbackBuffers>,
    /// Frames in flight.
    pub in_flight: usize,
    pub tables: Tables,
    pub raster: RasterBuffers,
    /// Work of a tile in one dispatch, as far as former frames of the grid have come.
    pub budget: Option<u32>,
    /// Entries of the lists that the last frame needed.
    pub capacity: u32,
    /// True if tiles have had more work than one dispatch does, so that their pixels' states are kept.
    pub keeps_states: bool,
}
