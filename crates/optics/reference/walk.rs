//! One ray cell by cell: what a pixel is made of.

use super::crossing::{Crossing, Ray};
use super::segment::{Integrand, Tolerance, Workspace};
use super::tracer::{Seen, Tracer};
use crate::{Contribution, WidgetBlend};
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;

/// One cell on a ray, and what it gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Number of the tetrahedron.
    pub cell: u32,
    /// Entry and exit from the eye, or from its plane where rays are parallel, along the ray; world units.
    pub distance: [f64; 2],
    /// Length inside, world units.
    pub length: f64,
    /// s, g and the further fields at entry.
    pub front: Vec<f64>,
    /// The same at exit.
    pub back: Vec<f64>,
    /// Optical depth of each widget by itself.
    pub depths: Vec<f64>,
    /// Factor of the opacity and the colour by the silhouette; 1 without.
    pub silhouette: f64,
    /// Factor of the colour by light; 1 without.
    pub light: f64,
    /// What the cell gives, silhouette and light included in colour and opacity.
    pub part: Contribution,
    /// What of the light from here reaches the eye: the transmittance of all before.
    pub transmittance: f64,
}

/// A ray from the eye on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Walk {
    /// The cells in the order of the scene.
    pub steps: Vec<Step>,
    /// Cells behind these that were not looked at, since no light comes from there.
    pub hidden: u64,
    /// What the ray sees.
    pub seen: Seen,
}

impl Step {
    /// What it adds to the ray: colour and opacity.
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

    /// A ray cell by cell. `transfer_function`: the scene's. Errors: what cannot be integrated.
    pub fn walk(&self, ray: &Ray, transfer_function: &TransferFunction) -> Result<Walk> {
        let each = Integrand::new(transfer_function, WidgetBlend::Mix, Tolerance::PICTURE)?;
        let crossings = self.crossings(ray);
        let (mut steps, mut work) = (Vec::with_capacity(crossings.len()), Workspace::default());
        let mut failure = Ok(());
        let seen = self.composite(ray, &crossings, &mut work, |crossing, transmittance, part| match self
            .step(ray, crossing, transmittance, part, &each)
        {
            Ok(step) => steps.push(step),
            Err(error) if failure.is_ok() => failure = Err(error),
            Err(_) => {}
        })?;
        failure?;
        Ok(Walk { hidden: (crossings.len() - steps.len()) as u64, steps, seen })
    }

    fn step(
        &self,
        ray: &Ray,
        crossing: &Crossing,
        transmittance: f64,
        part: &Contribution,
        each: &Integrand,
    ) -> Result<Step> {
        let (length, [front, back]) = self.segment(ray, crossing);
        let depths = each.depths(length, &front, &back, &mut Workspace::default());
        let [silhouette, light] = self.surface(ray, crossing);
        Ok(Step {
            cell: crossing.cell,
            distance: crossing.depth.map(|depth| depth * ray.stretch() * self.unit()),
            length,
            depths: depths.map_err(|error| error.at_item(format!("cell {}", crossing.cell)))?,
            front,
            back,
            silhouette,
            light,
            part: *part,
            transmittance,
        })
    }
}
