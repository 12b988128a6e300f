//! Frame renderer: the composite stage on all threads.

use crate::attribute::{Attribute, gradient_attributes};
use crate::composite::frame::{FrameContext, SegmentSource};
use crate::composite::lane_axes::LaneAxes;
use crate::composite::worker::{Worker, WorkerOutput};
use crate::counts::Counts;
use crate::projection::{Projection, SubpixelView};
use crate::segment_cache::{CacheBudget, SegmentCache};
use crate::shade::shader::Shader;
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use rayon::prelude::*;
use std::sync::atomic::AtomicUsize;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_optics::depth_image::{SampleStretches, Supersegment, VolumetricDepthImage};
use voltet_optics::ray_events::{RayEvents, composite_behind};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Ordering;

/// A projection with the compiled shader and the integrator's tables: all that is made once for drawing it.
pub struct FrameRenderer<'a> {
    pub(crate) projection: &'a Projection,
    pub(crate) attributes: Vec<Attribute<'a>>,
    pub(crate) shader: Shader,
    /// Curved axes of s and g.
    pub(crate) axes: Option<LaneAxes>,
    pub(crate) table_bytes: u64,
}

/// Inputs of a view's rays beside cells.
#[derive(Clone, Copy, Default)]
pub(crate) struct RayInputs<'a> {
    pub depth_limit: Option<&'a [f32]>,
    pub events: Option<&'a RayEvents>,
    pub cache: Option<&'a SegmentCache>,
    /// True if the stretches of rays that the cells fill are recorded.
    pub records_stretches: bool,
}

pub(crate) struct DrawnFrame {
    pub picture: Picture,
    pub counts: Counts,
    /// The stretches of rays that the cells fill, where they are recorded.
    pub depth_image: Option<VolumetricDepthImage>,
}

/// Checks depth limits: one a pixel, each a number.
fn check_depth_limit(limits: &[f32], [width, height]: [usize; 2]) -> Result<()> {
    if limits.len() != width * height {
        let error = Error::usage("the rays' ends are not one a pixel").got(limits.len());
        return Err(error.expected(format!("{width} × {height}, the camera's")));
    }
    match limits.iter().position(|end| end.is_nan()) {
        None => Ok(()),
        Some(pixel) => Err(Error::usage("the end of a ray is not a number")
            .got(format!("pixel {} of row {}", pixel % width, pixel / width))
            .expected("depths, infinite where nothing limits a ray")),
    }
}

impl FrameRenderer<'_> {
    /// Integrates and composites every pixel's segments. Errors: a cancelled run, a segment that the integrator cannot integrate.
    pub fn composite(&self, progress: &dyn Progress) -> Result<(Picture, Counts)> {
        self.picture(RayInputs::default(), None, progress)
    }

    /// Like [`FrameRenderer::composite`], with the surfaces and clips of a scene, for which the cells must be in the exact order, and with
    /// rays that end, as at opaque surfaces of another renderer. `depth_limit`: for each pixel, row by row from the top, the depth of its
    /// ray's end along the view direction (world units); infinite where nothing ends it. Errors: another number of pixels, a depth that
    /// is not a number; those of [`Scene::ray_event_source`].
    pub fn composite_scene(
        &self,
        scene: &Scene,
        depth_limit: Option<&[f32]>,
        progress: &dyn Progress,
    ) -> Result<(Picture, Counts)> {
        self.picture(RayInputs { depth_limit, ..RayInputs::default() }, Some(scene), progress)
    }

    /// Draws the picture alone.
    fn picture(
        &self,
        inputs: RayInputs<'_>,
        scene: Option<&Scene>,
        progress: &dyn Progress,
    ) -> Result<(Picture, Counts)> {
        let drawn = self.draw(inputs, scene, progress)?;
        Ok((drawn.picture, drawn.counts))
    }

    /// Records the segments in place of drawing them: of one sample a pixel. `None` where they take more than `limit` bytes, or a
    /// pixel has too many.
    pub(crate) fn record(&self, limit: u64, progress: &dyn Progress) -> Result<Option<SegmentCache>> {
        let Some(sample) = self.projection.samples.first() else { return Ok(None) };
        let budget = CacheBudget::new(limit);
        let tiles = sample.queue();
        let frame = self.frame(sample, &tiles, &self.attributes, RayInputs::default());
        let frame = FrameContext { sorted: true, ..frame };
        let outputs = self.run(&frame, Some(&budget), progress)?;
        if budget.is_exhausted() {
            return Ok(None);
        }
        let tiles = outputs.into_iter().flat_map(|output| output.cached).collect();
        let [columns, rows] = self.projection.camera.size.map(|n| (n as usize).div_ceil(TILE));
        Ok(Some(SegmentCache::new(tiles, columns * rows, self.projection.max_optical_depth)))
    }

    /// Inputs of the workers for a sub-pixel view.
    fn frame<'b>(
        &'b self,
        sample: &'b SubpixelView,
        tiles: &'b [u32],
        attributes: &'b [Attribute<'b>],
        RayInputs { depth_limit, events, cache, records_stretches }: RayInputs<'b>,
    ) -> FrameContext<'b> {
        let cells = &self.projection.cells;
        let grid = &cells.volume.grid;
        let sorted = match cells.ordering {
            // Cached segments are sorted.
            _ if cache.is_some() => false,
            // The cells may have been ordered for another shading.
            Ordering::Independent | Ordering::PerPixel => self.shader.one_color.is_none(),
            Ordering::CellCentroid | Ordering::Submission => false,
        };
        FrameContext {
            view: &sample.view,
            lanes: cells.lanes,
            shader: &self.shader,
            source: &sample.source,
            tiles,
            cache,
            input: sample.input(grid, attributes),
            points: &grid.points,
            near: sample.near,
            scalar_count: self.attributes.len(),
            sorted,
            exhaustive: cells.exhaustive,
            depth_limit,
            events,
            axes: self.axes.as_ref(),
            records_stretches,
            buffers: &cells.buffers,
        }
    }

    fn run(
        &self,
        frame: &FrameContext<'_>,
        recording: Option<&CacheBudget>,
        progress: &dyn Progress,
    ) -> Result<Vec<WorkerOutput>> {
        let next = AtomicUsize::new(0);
        let outputs: Vec<Result<WorkerOutput>> =
            rayon::broadcast(|_| Worker { frame, next: &next, recording, progress }.run());
        let outputs: Vec<WorkerOutput> = outputs.into_iter().collect::<Result<_>>()?;
        progress.check_cancelled()?;
        match self.shader.failure() {
            Some(error) => Err(error.clone()),
            None => Ok(outputs),
        }
    }

    /// [`FrameRenderer::composite_scene`], or from cached segments of this view, for a projection of no cell.
    pub(crate) fn draw(
        &self,
        inputs: RayInputs<'_>,
        scene: Option<&Scene>,
        progress: &dyn Progress,
    ) -> Result<DrawnFrame> {
        let FrameRenderer { projection, attributes, table_bytes, .. } = self;
        let cells = &projection.cells;
        let [width, height] = projection.camera.size.map(|n| n as usize);
        if let Some(limits) = inputs.depth_limit {
            check_depth_limit(limits, [width, height])?;
        }
        let event_source = scene.map_or(Ok(None), Scene::ray_event_source)?;
        let mut picture = Picture::transparent(width, height);
        let mut depth_image = inputs.records_stretches.then(|| VolumetricDepthImage {
            size: [width, height],
            top: 0,
            resolution: 0.0,
            samples: Vec::new(),
        });
        let (cells_projected, table_bytes) = (projection.cells_projected().unwrap_or(0), *table_bytes);
        let mut counts = Counts { cells_projected, table_bytes, ..Counts::default() };
        let offsets = projection.camera.sample_offsets();
        let weight = 1.0 / offsets.len() as f32;
        let mut all = attributes.clone();
        if projection.samples.iter().any(|sample| attributes.len() < sample.attribute_count) {
            all.extend(gradient_attributes(cells)?);
        }
        for (k, &offset) in offsets.iter().enumerate() {
            let further;
            let sample = match projection.samples.get(k) {
                Some(sample) => sample,
                None => {
                    further = projection.sample(offset, &all, progress)?;
                    &further
                }
            };
            let events = event_source.as_ref().map(|source| source.events(offset, progress));
            let mut events = events.transpose()?;
            if let (Some(events), Some(limits)) = (&mut events, inputs.depth_limit) {
                events.end_at(limits);
            }
            let tiles = sample.queue();
            let inputs = RayInputs { events: events.as_ref(), ..inputs };
            let frame = self.frame(sample, &tiles, &all, inputs);
            let mut outputs = self.run(&frame, None, progress)?;
            let mut mistracked: Vec<u32> =
                outputs.iter().flat_map(|output| output.mistracked.iter().copied()).collect();
            mistracked.sort_unstable();
            if !mistracked.is_empty() {
                let projected = sample.projected(cells, &all, &mistracked)?;
                counts.tiles_lost += mistracked.len() as u64;
                let frame = self.frame(&projected, &mistracked, &all, RayInputs { cache: None, ..inputs });
                outputs.extend(self.run(&frame, None, progress)?);
            }
            let tiles_wide = width.div_ceil(TILE);
            let mut pictures: Vec<Option<&TilePicture>> = vec![None; tiles_wide * height.div_ceil(TILE)];
            for output in &outputs {
                counts += output.counts;
                for (tile, pixels) in &output.tiles {
                    pictures[*tile as usize] = Some(pixels);
                }
            }
            add(&mut picture, &pictures, events.as_ref(), weight);
            if let Some(image) = &mut depth_image {
                put_sample(image, &outputs)?;
            }
        }
        Ok(DrawnFrame { picture, counts, depth_image })
    }
}

/// Adds the stretches of a sample of all pixels.
fn put_sample(image: &mut VolumetricDepthImage, outputs: &[WorkerOutput]) -> Result<()> {
    let [width, height] = image.size;
    let mut pixels: Vec<&[Supersegment]> = vec![&[]; width * height];
    for (tile, stretches) in outputs.iter().flat_map(|output| &output.stretches) {
        image.resolution = image.resolution.max(stretches.resolution);
        let rect = TileRect::new(*tile as usize, image.size);
        for pixel in 0..PIXELS {
            if pixel % TILE < rect.size[0] && pixel / TILE < rect.size[1] {
                let place = (rect.top + pixel / TILE) * width + rect.left + pixel % TILE;
                pixels[place] = stretches.of_pixel(pixel);
            }
        }
    }
    image.samples.push(SampleStretches::new(&pixels)?);
    Ok(())
}

impl SubpixelView {
    /// Tiles that have work, numbered row by row, those with most work first; none where regions are projected one by one.
    fn queue(&self) -> Vec<u32> {
        match &self.source {
            SegmentSource::Tiles(bins) => bins.queue(self.view.size[0]),
            SegmentSource::Regions(_) => Vec::new(),
            SegmentSource::RayCast(caster) => caster.queue(),
        }
    }
}

/// Adds the tiles of a sample, by its weight; where there is none, surfaces alone.
fn add(picture: &mut Picture, tiles: &[Option<&TilePicture>], events: Option<&RayEvents>, weight: f32) {
    let width = picture.width;
    let tiles_wide = width.div_ceil(TILE);
    picture.rgba.par_chunks_mut(width).enumerate().for_each(|(j, row)| {
        for (i, pixel) in row.iter_mut().enumerate() {
            let value = match (tiles[j / TILE * tiles_wide + i / TILE], events) {
                (Some(tile), _) => tile[(j % TILE) * TILE + i % TILE],
                (None, None) => continue,
                (None, Some(events)) => {
                    let mut alone = [0.0; 4];
                    composite_behind(events.of_pixel(i, j), &mut alone);
                    alone
                }
            };
            for (sum, value) in pixel.iter_mut().zip(value) {
                *sum += weight * value;
            }
        }
    });
}
