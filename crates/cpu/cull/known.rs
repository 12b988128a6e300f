//! What is known of a volume between pictures.

use super::asked::{Asked, CornerValues, SAMPLED};
use super::blocks::Block;
use super::touched::{CELLS_TO_SAMPLE, Touched, WORTH};
use crate::attribute::attributes_of;
use crate::cast::KnownFaces;
use crate::cells::{Casting, Cells, MOST_AT_ONCE};
use crate::kept::Views;
use crate::spare::{Spare, kept};
use crate::view::{Seen, View};
use rayon::prelude::*;
use std::sync::{Arc, Mutex};
use voltet_core::camera::Camera;
use voltet_core::grid::extent;
use voltet_core::progress::Progress;
use voltet_core::transfer::{Support, TransferFunction};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_optics::shading::Ordering;
use voltet_simd::LaneSet;

/// Optical depth that all culled cells together may have along the longest ray: a tenth of the 1e-6 that a
/// pixel may change.
const DEPTH_LEFT_OUT: f64 = 1e-7;

/// Cells that one thread takes at a time.
const CHUNK: usize = 1 << 14;

/// What is known of a volume between pictures: how far it reaches, its values' ranges, over blocks of cells too, which cells the
/// last widgets touch, and where the last camera sees the points. A picture finds anew only what depends on what changed: where
/// only the camera did, the cells that are touched stay; where only colours did, or extinctions by less than a factor of two, all of
/// it. What is kept takes at most 5 bytes a cell and 25 a point, where rays go from cell to cell 85 more a cell, and the memory that the
/// last picture was drawn in.
#[derive(Debug)]
pub struct Known {
    volume: Arc<Volume>,
    length: f64,
    ranges: [[f64; 2]; 2],
    steepest: f64,
    blocks: Mutex<Option<Arc<Vec<Block>>>>,
    touched: Mutex<Option<Arc<Touched>>>,
    sight: Mutex<Option<Arc<Sight>>>,
    spare: Arc<Spare>,
    views: Views,
    faces: KnownFaces,
}

/// The points as one camera sees them.
#[derive(Debug)]
struct Sight {
    camera: Camera,
    seen: Arc<Vec<Seen>>,
    /// The planes of the view that each point lies outside of.
    outside: Vec<u8>,
    /// Whether any does.
    any_outside: bool,
}

impl Sight {
    /// Whether no plane of the view has all corners of a cell outside.
    fn sees(&self, corners: &[u32; 4]) -> bool {
        corners.iter().fold(u8::MAX, |all, &p| all & self.outside[p as usize]) == 0
    }
}

impl Known {
    /// Errors: an extent beyond 64-bit floats.
    pub fn new(volume: &Arc<Volume>) -> Result<Known> {
        let range = |values: &[f64]| extent::range(values).unwrap_or_default();
        Ok(Known {
            length: extent::scene_length(extent::bounds(&volume.grid.points))?,
            ranges: [
                range(&volume.scalar),
                volume.gradient_magnitude.as_ref().map_or([0.0; 2], |g| range(g)),
            ],
            steepest: volume.gradient.as_ref().map_or(0.0, |gradient| {
                let [low, high] = range(bytemuck::cast_slice(gradient));
                low.abs().max(high.abs())
            }),
            volume: volume.clone(),
            blocks: Mutex::default(),
            touched: Mutex::default(),
            sight: Mutex::default(),
            spare: Arc::default(),
            views: Views::default(),
            faces: KnownFaces::none(),
        })
    }

    /// The volume.
    pub fn volume(&self) -> &Arc<Volume> {
        &self.volume
    }

    /// Keeps each tetrahedron that could contribute to the picture. Culling changes no pixel by more than 1e-6.
    ///
    /// Errors: a camera out of range, a transfer function that looks at quantities the volume does not have.
    pub fn cull(
        &self,
        transfer_function: &TransferFunction,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Cells> {
        self.cull_by(transfer_function, camera, false, progress)
    }

    /// The same, and every cell is asked, whether the picture gains by it or not: for who wants to know which are kept.
    ///
    /// Errors: those of [`Known::cull`].
    pub fn cull_each(
        &self,
        transfer_function: &TransferFunction,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Cells> {
        self.cull_by(transfer_function, camera, true, progress)
    }

    fn cull_by(
        &self,
        transfer_function: &TransferFunction,
        camera: &Camera,
        each: bool,
        progress: &dyn Progress,
    ) -> Result<Cells> {
        let nothing = self.none_kept()?;
        let sight = self.sight(camera)?;
        progress.report("cull", 0.3);
        // A cell whose density is nowhere above this adds less than DEPTH_LEFT_OUT over the whole diagonal.
        let least = DEPTH_LEFT_OUT / self.length;
        let attributes = attributes_of(&nothing, transfer_function)?;
        let asked = Asked {
            support: &Support::new(transfer_function)?.in_steps(least),
            least,
            tetrahedra: &self.volume.grid.tetrahedra,
            values: CornerValues::new(&attributes, transfer_function),
            blocks: &|| kept(&self.blocks, |_| true, || Block::every(&self.volume)),
            ranges: self.ranges,
        };
        let touched = self.touched(&asked, transfer_function.fields(), each);
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        let in_view = |id: u32| sight.sees(&self.volume.grid.tetrahedra[id as usize]);
        let kept = match sight.any_outside && (each || is_worth_asking(&touched.cells, in_view)) {
            true => Arc::new(those(&touched.cells, in_view)),
            false => touched.cells.clone(),
        };
        let is_untouched = |&widget: &usize| match touched.examples[widget] {
            Some(id) if !sight.any_outside || in_view(id) => false,
            Some(_) => asked.example(widget, &kept).is_none(),
            None => true,
        };
        Ok(Cells {
            culled_by_transfer_function: (asked.tetrahedra.len() - touched.cells.len()) as u64,
            culled_by_frustum: (touched.cells.len() - kept.len()) as u64,
            untouched: (0..touched.examples.len()).filter(is_untouched).collect(),
            not_worth_asking: touched.not_worth_asking,
            culled_for: Some(transfer_function.clone()),
            faces: Some(self.faces.with(&touched.cells)),
            seen: Some((*camera, sight.seen.clone())),
            kept,
            ..nothing.clone()
        })
    }

    /// Keeps every tetrahedron and every widget, for comparison with [`Known::cull`]: the picture is the same, by more work. Nothing
    /// is handed on to the project stage that it could use again.
    ///
    /// Errors: those of [`Known::cull`].
    pub fn keep_all(&self, transfer_function: &TransferFunction, camera: &Camera) -> Result<Cells> {
        let mut cells = self.none_kept()?;
        View::new(camera, cells.length, [0.0; 2])?;
        attributes_of(&cells, transfer_function)?;
        let count = u32::try_from(self.volume.grid.tetrahedra.len()).map_err(|_| {
            Error::run("the grid has too many tetrahedra").expected(format!("at most {}", u32::MAX))
        })?;
        (cells.kept, cells.exhaustive) = (Arc::new((0..count).collect()), true);
        cells.faces = Some(KnownFaces::none().with(&cells.kept));
        Ok(cells)
    }

    /// Every cell in view, whatever widgets touch.
    pub(crate) fn all_in_view(&self, camera: &Camera) -> Result<Cells> {
        let sight = self.sight(camera)?;
        let tetrahedra = &self.volume.grid.tetrahedra;
        let count = u32::try_from(tetrahedra.len()).unwrap_or(u32::MAX);
        let in_view = |id: &u32| !sight.any_outside || sight.sees(&tetrahedra[*id as usize]);
        let kept: Vec<u32> = (0..count).into_par_iter().filter(in_view).collect();
        let culled_by_frustum = u64::from(count) - kept.len() as u64;
        Ok(Cells { kept: Arc::new(kept), culled_by_frustum, ..self.none_in_view(camera)? })
    }

    /// A view of no cell, for who draws what was kept of them.
    pub(crate) fn none_in_view(&self, camera: &Camera) -> Result<Cells> {
        let seen = Some((*camera, self.sight(camera)?.seen.clone()));
        Ok(Cells { seen, from_the_middle: true, ..self.none_kept()? })
    }

    /// What is kept of views.
    pub(crate) fn views(&self) -> &Views {
        &self.views
    }

    /// Ranges of s and g.
    pub(crate) fn ranges(&self) -> [[f64; 2]; 2] {
        self.ranges
    }

    /// World units in the scene length.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// The volume before any cell is kept.
    pub(crate) fn none_kept(&self) -> Result<Cells> {
        Ok(Cells {
            volume: self.volume.clone(),
            kept: Arc::default(),
            ordering: Ordering::PerPixel,
            culled_by_transfer_function: 0,
            culled_by_frustum: 0,
            not_worth_asking: None,
            length: self.length,
            seen: None,
            ranges: self.ranges,
            untouched: Vec::new(),
            exhaustive: false,
            lanes: LaneSet::detect()?,
            casting: Casting::IfItPays,
            most_at_once: MOST_AT_ONCE,
            spare: self.spare.clone(),
            culled_for: None,
            faces: None,
            from_the_middle: false,
            densest_least: 0.0,
            steepest: self.steepest,
        })
    }

    /// The points as a camera sees them.
    fn sight(&self, camera: &Camera) -> Result<Arc<Sight>> {
        let view = View::new(camera, self.length, [0.0; 2])?;
        let of = |sight: &Sight| sight.camera == *camera;
        Ok(kept(&self.sight, of, || {
            let (seen, outside) = view.see(&self.volume.grid.points);
            let any_outside = outside.par_iter().with_min_len(CHUNK).any(|&planes| planes != 0);
            Sight { camera: *camera, seen: Arc::new(seen), outside, any_outside }
        }))
    }

    /// The cells that widgets touch. `fields`: those that their bounds number; `each`: every cell is asked.
    fn touched(&self, asked: &Asked, fields: Vec<&str>, each: bool) -> Arc<Touched> {
        let is_asked = |touched: &Touched| !each || touched.not_worth_asking.is_none();
        let of = |touched: &Touched| touched.is_of(asked, &fields) && is_asked(touched);
        kept(&self.touched, of, || Touched::find(asked, &fields, each))
    }
}

/// Whether enough cells lie out of view: a cell that does is soon done with by all that draws, too.
fn is_worth_asking(ids: &[u32], in_view: impl Fn(u32) -> bool + Sync) -> bool {
    if ids.len() < CELLS_TO_SAMPLE {
        return true;
    }
    let asked = ids.par_iter().step_by(SAMPLED).with_min_len(256);
    let (count, out) = (asked.len(), asked.filter(|&&id| !in_view(id)).count());
    out as f64 >= WORTH * count as f64
}

/// Those of a list, in its order.
fn those(ids: &[u32], is_one: impl Fn(u32) -> bool + Sync) -> Vec<u32> {
    let mut those = vec![0; ids.len()];
    // Each chunk's at its beginning, without branches that could be foretold by no one; then the chunks side by side.
    let of = |(those, ids): (&mut [u32], &[u32])| {
        let mut count = 0;
        for &id in ids {
            those[count] = id;
            count += usize::from(is_one(id));
        }
        count
    };
    let counts: Vec<usize> = those.par_chunks_mut(CHUNK).zip(ids.par_chunks(CHUNK)).map(of).collect();
    let mut end = 0;
    for (chunk, &count) in counts.iter().enumerate() {
        those.copy_within(chunk * CHUNK..chunk * CHUNK + count, end);
        end += count;
    }
    those.truncate(end);
    those
}
