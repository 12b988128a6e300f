//! Traversal of one ray, cell by cell.

use super::crossing::Ray;
use super::tracer::{TracedRay, Tracer};
use crate::Contribution;
use voltet_core::Result;

/// Cell on a ray, and its contribution.
#[derive(Debug, Clone, PartialEq)]
pub struct CellCrossing {
    /// Number of the tetrahedron.
    pub cell: u32,
    /// Entry and exit from the eye, or from its plane where rays are parallel, along the ray; world units.
    pub distance: [f64; 2],
    /// Length inside, world units.
    pub length: f64,
    /// s, g and the further fields at entry.
    pub front: Vec<f64>,
    /// s, g and the further fields at exit.
    pub back: Vec<f64>,
    /// Factor of the opacity and the colour by the silhouette; 1 without.
    pub silhouette: f64,
    /// Factor of the colour by light; 1 without.
    pub light: f64,
    /// Contribution of the cell, silhouette and light included in colour and opacity.
    pub part: Contribution,
    /// Transmittance of all cells before.
    pub transmittance: f64,
}

/// A ray from the eye on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Walk {
    /// The cells in the order of the scene.
    pub steps: Vec<CellCrossing>,
    /// Cells behind these that were not looked at, since no light comes from there.
    pub hidden: u64,
    /// Result of the ray.
    pub seen: TracedRay,
}

impl CellCrossing {
    /// Colour and opacity that it adds to the ray.
    pub fn contribution(&self) -> [f64; 4] {
        let [r, g, b] = self.part.color;
        [r, g, b, self.part.opacity].map(|x| self.transmittance * x)
    }
}

impl Tracer<'_> {
    /// The rays of a pixel, in the order of its samples.
    pub fn rays(&self, [x, y]: [u32; 2]) -> Vec<Ray> {
        let places = super::tiles::sample_places(self.camera().samples);
        places.iter().map(|place| self.ray(f64::from(x) + place[0], f64::from(y) + place[1])).collect()
    }

    /// The crossings of a ray before the near plane, which cuts them away.
    pub fn cut_away(&self, ray: &Ray) -> usize {
        let whole = |cell| self.crossing_from(ray, cell, 0.0).is_some() && self.crossing(ray, cell).is_none();
        (0..self.cell_count()).filter(|&cell| whole(cell)).count()
    }

    /// Traces a ray cell by cell. Errors: what cannot be integrated.
    pub fn walk(&self, ray: &Ray) -> Result<Walk> {
        let crossings = self.crossings(ray);
        let mut steps = Vec::with_capacity(crossings.len());
        let seen = self.composite(ray, &crossings, |crossing, transmittance, part| {
            let (length, [front, back]) = self.segment(ray, crossing);
            let [silhouette, light] = self.surface(ray, crossing);
            steps.push(CellCrossing {
                cell: crossing.cell,
                distance: crossing.depth.map(|depth| depth * ray.stretch() * self.unit()),
                length,
                front,
                back,
                silhouette,
                light,
                part: *part,
                transmittance,
            });
        })?;
        Ok(Walk { hidden: (crossings.len() - steps.len()) as u64, steps, seen })
    }
}
