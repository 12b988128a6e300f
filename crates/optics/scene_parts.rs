//! Scenes whose grid is drawn part by part: what all parts together say about how each of them is drawn, so that a cell gives the same bits
//! in any part as in the whole grid.
//!
//! Numbers that an engine rounds by (the extent of the grid, of its values, of its points on the screen, its longest edges) are found over
//! all parts before the first is drawn. What depends on the cells that are selected for the picture ([`SceneChoices`]) is known when those
//! of all parts are tallied. Where all parts are in memory at a time, those of several processes, this is before any is drawn. Parts that
//! are read one after the other are drawn as they come, and drawn again where the choice of the whole is another one.

use rayon::prelude::*;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::extent;
use voltet_core::volume::{Volume, VolumeExtent};
use voltet_core::{Error, Result};

/// Points or cells of one task.
const CHUNK: usize = 1 << 13;

/// Extent of a scene's grid in space, in values and in the view.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneExtent {
    /// Extent of the volume.
    pub volume: VolumeExtent,
    /// Ranges of the further fields that the transfer function reads, in their order; from +∞ to −∞ of a field without values.
    pub fields: Vec<[f64; 2]>,
    /// The longest edge of all cells, and of those that are thin, world units.
    pub longest_edges: [f64; 2],
    /// Ranges of the points' positions to the right of the view axis and below it (pixels), and of their depths (world units).
    pub view: [[f64; 2]; 3],
}

/// Range of nothing.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn wider([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.min(c), b.max(d)]
}

impl SceneExtent {
    /// The extent of a part's own cells. `fields`: names of the further fields.
    ///
    /// # Errors
    /// - a camera out of range, a field that the grid does not have.
    pub fn of_part(volume: &Volume, fields: &[&str], camera: &Camera) -> Result<SceneExtent> {
        let grid = &volume.grid;
        let points = &grid.points[..grid.drawn_points()];
        let frame = camera.frame()?;
        let in_perspective = matches!(camera.projection, Projection::Perspective { .. });
        let position = |chunk: &[glam::DVec3]| {
            let [right, down, depths] = &mut [NOTHING; 3];
            for point in chunk {
                let from_eye = *point - camera.eye;
                let depth = from_eye.dot(frame.forward);
                *depths = wider(*depths, [depth; 2]);
                // What lies behind the eye has no position.
                if !in_perspective || depth > 0.0 {
                    let side = if in_perspective { depth * frame.pixel } else { frame.pixel };
                    *right = wider(*right, [from_eye.dot(frame.right) / side; 2]);
                    *down = wider(*down, [from_eye.dot(-frame.up) / side; 2]);
                }
            }
            [*right, *down, *depths]
        };
        let joined = |a: [[f64; 2]; 3], b: [[f64; 2]; 3]| [0, 1, 2].map(|k: usize| wider(a[k], b[k]));
        let range = |name: &&str| {
            let values = grid.field("the transfer function", name)?;
            Ok(extent::range(&values[..points.len().min(values.len())]).unwrap_or(NOTHING))
        };
        Ok(SceneExtent {
            volume: VolumeExtent::from_volume(volume),
            fields: fields.iter().map(range).collect::<Result<_>>()?,
            longest_edges: extent::longest_edges(&grid.points, &grid.tetrahedra),
            view: points.par_chunks(CHUNK).map(position).reduce(|| [NOTHING; 3], joined),
        })
    }

    /// The extent of both together.
    pub fn joined(&self, other: &SceneExtent) -> SceneExtent {
        SceneExtent {
            volume: self.volume.joined(&other.volume),
            fields: self.fields.iter().zip(&other.fields).map(|(a, b)| wider(*a, *b)).collect(),
            longest_edges: [0, 1].map(|k: usize| self.longest_edges[k].max(other.longest_edges[k])),
            view: [0, 1, 2].map(|k: usize| wider(self.view[k], other.view[k])),
        }
    }

    /// The extent as numbers that other processes are sent.
    pub fn to_numbers(&self) -> Vec<f64> {
        let VolumeExtent { bounds, ranges, max_gradient } = &self.volume;
        let bounds = bounds.map_or(vec![f64::NAN; 6], |ends| ends.map(|end| end.to_array()).concat());
        let further = [self.view.concat(), self.fields.concat()].concat();
        [bounds, ranges.concat(), vec![*max_gradient], self.longest_edges.to_vec(), further].concat()
    }

    /// The extent that [`SceneExtent::to_numbers`] made numbers of; `None` of none, from a process without cells.
    ///
    /// # Errors
    /// - another count of numbers.
    pub fn from_numbers(numbers: &[f64]) -> Result<Option<SceneExtent>> {
        if numbers.is_empty() {
            return Ok(None);
        }
        let broken = || Error::run("another process sent a broken extent").got(numbers.len());
        let (ends, rest) = numbers.split_first_chunk::<6>().ok_or_else(broken)?;
        let (&[a, b, c, d, max_gradient, longest, thin], rest) =
            rest.split_first_chunk::<7>().ok_or_else(broken)?;
        let (view, fields) = rest.as_chunks::<2>().0.split_first_chunk::<3>().ok_or_else(broken)?;
        let [low, high] = [0, 3].map(|k| glam::DVec3::from_slice(&ends[k..]));
        let bounds = (!low.x.is_nan()).then_some([low, high]);
        Ok(Some(SceneExtent {
            volume: VolumeExtent { bounds, ranges: [[a, b], [c, d]], max_gradient },
            fields: fields.to_vec(),
            longest_edges: [longest, thin],
            view: *view,
        }))
    }
}

/// Choices of an engine for the picture of a whole grid.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SceneChoices {
    /// True to cast rays from cell to cell, false to project cells; `None`: as each part would do by itself.
    pub casts_rays: Option<bool>,
    /// Widgets that no cell in view touches, as far as this changes how values are rounded.
    pub inactive_widgets: Vec<usize>,
}

impl SceneChoices {
    /// True if parts whose cells were selected by these choices, with these [`PartTally::methods`], serve those that were then decided.
    /// Projected cells are final, since their boundary is not known.
    pub fn serves(&self, decided: &SceneChoices, [cast, projected]: [bool; 2]) -> bool {
        let is_other = if decided.casts_rays == Some(true) { projected } else { cast };
        let is_same = !is_other && self.inactive_widgets == decided.inactive_widgets;
        is_same || self.casts_rays == Some(false) || self == decided
    }
}

/// Figures of the cells that were selected in parts of a grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartTally {
    /// Pixels that cells in view cover, each cell by itself.
    pub covered_pixels: f64,
    /// Cells in widgets' supports.
    pub cells: f64,
    /// Faces at the boundary of these cells that no other part can share.
    pub outer_faces: f64,
    /// Further faces there, by keys of their corners' positions. A face between two parts is there twice.
    pub boundary: Vec<u64>,
    /// True if the boundary of a part is not known, through which rays could be cast: it did not pay for the part by itself. Then the
    /// choice to cast rays is not final: it is made again with all boundaries.
    pub lacks_boundary: bool,
    /// True for each widget that a cell in view touches.
    pub active_widgets: Vec<bool>,
    /// True if rays were cast through a part; if cells in view of one were projected that could have been.
    pub methods: [bool; 2],
}

impl PartTally {
    /// Adds the figures of another part.
    pub fn add(&mut self, other: PartTally) {
        self.covered_pixels += other.covered_pixels;
        self.cells += other.cells;
        self.outer_faces += other.outer_faces;
        self.boundary.extend(other.boundary);
        self.lacks_boundary |= other.lacks_boundary;
        self.active_widgets.resize(self.active_widgets.len().max(other.active_widgets.len()), false);
        self.active_widgets.iter_mut().zip(other.active_widgets).for_each(|(own, other)| *own |= other);
        self.methods.iter_mut().zip(other.methods).for_each(|(own, other)| *own |= other);
    }

    /// Counts the faces whose keys are there once as outer faces, and drops all keys: those of all parts are there.
    pub fn count_boundary(&mut self) {
        let mut keys = std::mem::take(&mut self.boundary);
        keys.par_sort_unstable();
        self.outer_faces += keys.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).count() as f64;
    }
}
