//! Section of the data by a plane: s and g at the pixels of a picture of it, linear in each cell.

use super::query::{Query, QueryRun};
use super::request::VolumeSource;
use glam::{DMat3, DVec2, DVec3};
use std::sync::Arc;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::Observer;

/// Barycentric distance outside of a cell within which a position still counts as on its face.
const ON_FACE: f64 = 1e-9;

/// A section that is wanted.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SectionQuery {
    pub source: VolumeSource,
    /// The point in the middle, world units.
    pub centre: DVec3,
    /// Unit vectors in the plane: to the right and up in its picture.
    pub axes: [DVec3; 2],
    /// Half of its height, world units.
    pub half: f64,
    /// Pixels of its picture.
    pub size: [usize; 2],
}

/// Section of the data by a plane.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Section {
    /// As it was asked for.
    pub of: SectionQuery,
    /// [s, g] at the middle of each pixel, rows from the top; none outside of all cells.
    pub values: Vec<Option<[f64; 2]>>,
    /// Cells that the plane cuts.
    pub cells: usize,
}

impl SectionQuery {
    /// World units a pixel.
    fn step(&self) -> f64 {
        2.0 * self.half / self.size[1].max(1) as f64
    }

    /// In the plane, from the middle of the picture: pixels to the right and up.
    fn place(&self, point: DVec3) -> DVec2 {
        let from = point - self.centre;
        DVec2::new(from.dot(self.axes[0]), from.dot(self.axes[1])) / self.step()
    }

    fn cut(&self, volume: &Volume, observer: &dyn Observer) -> Result<Section> {
        let [width, height] = self.size;
        let mut section = Section { of: self.clone(), values: vec![None; width * height], cells: 0 };
        let normal = self.axes[0].cross(self.axes[1]);
        let Volume { grid, scalar, gradient_magnitude, .. } = volume;
        let aside: Vec<f64> = grid.points.iter().map(|point| (*point - self.centre).dot(normal)).collect();
        for (i, cell) in grid.tetrahedra.iter().enumerate() {
            if i % 4096 == 0 && observer.cancelled() {
                return Err(Error::cancelled());
            }
            let at = cell.map(|point| point as usize);
            let distances = at.map(|point| aside[point]);
            if distances.iter().all(|d| *d > 0.0) || distances.iter().all(|d| *d < 0.0) {
                continue;
            }
            let corners = at.map(|point| grid.points[point]);
            let g = gradient_magnitude.as_ref();
            let of = |point: usize| [scalar[point], g.map_or(0.0, |g| g[point])];
            if self.fill(&mut section.values, corners, distances, at.map(of)) {
                section.cells += 1;
            }
        }
        Ok(section)
    }

    /// Fills the pixels whose middles lie in a cell; false if the cell has no volume.
    fn fill(
        &self,
        values: &mut [Option<[f64; 2]>],
        corners: [DVec3; 4],
        distances: [f64; 4],
        at_corners: [[f64; 2]; 4],
    ) -> bool {
        let edges =
            DMat3::from_cols(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
        let inverse = edges.inverse();
        if !inverse.is_finite() {
            return false;
        }
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            if distances[a] * distances[b] <= 0.0 && distances[a] != distances[b] {
                let share = distances[a] / (distances[a] - distances[b]);
                let place = self.place(corners[a].lerp(corners[b], share));
                (low, high) = (low.min(place), high.max(place));
            }
        }
        let [width, height] = self.size.map(|side| side as f64);
        // From places to pixels; beyond the picture there are none.
        let first = |x: f64| x.floor().max(0.0) as usize;
        let last = |x: f64, count: f64| (x.ceil().clamp(0.0, count)) as usize;
        let columns = first(low.x + 0.5 * width)..last(high.x + 0.5 * width, width);
        let rows = first(0.5 * height - high.y)..last(0.5 * height - low.y, height);
        for row in rows {
            for column in columns.clone() {
                let point = self.point([column as f64 + 0.5, row as f64 + 0.5]);
                let [b, c, d] = (inverse * (point - corners[0])).to_array();
                let shares = [1.0 - b - c - d, b, c, d];
                if shares.iter().all(|share| *share >= -ON_FACE) {
                    let value = |k: usize| (0..4).map(|v| shares[v] * at_corners[v][k]).sum();
                    values[row * self.size[0] + column] = Some([value(0), value(1)]);
                }
            }
        }
        true
    }

    /// The point at a place of the picture, in pixels from its upper left corner.
    pub fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        let [width, height] = self.size.map(|side| side as f64);
        let [right, up] = self.axes;
        self.centre + self.step() * ((x - 0.5 * width) * right + (0.5 * height - y) * up)
    }
}

impl Query for SectionQuery {
    type Reply = Arc<Section>;
    const WAITS: bool = true;

    fn answer(&self, run: &mut QueryRun) -> Result<Arc<Section>> {
        let volume = self.source.volume(run, &[])?;
        self.cut(&volume, run.observer).map(Arc::new)
    }
}
