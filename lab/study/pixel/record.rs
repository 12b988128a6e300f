//! Results of one pixel.

use voltet_optics::trace::Walk;

/// One pixel.
#[derive(Debug, Clone)]
pub struct Pixel {
    /// The node that draws.
    pub node: String,
    /// Column from the left and row from the top, from 0.
    pub place: [u32; 2],
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Rays of the pixel.
    pub samples: u32,
    /// The one of them that is shown cell by cell, from 0.
    pub sample: u32,
    /// Origin and direction of the ray (world units).
    pub ray: [[f64; 3]; 2],
    /// The ray.
    pub walk: Walk,
    /// Optical depth of each widget by itself, for each cell of the ray.
    pub depths: Vec<Vec<f64>>,
    /// For each of its steps the file's own cell, and what that is.
    pub cells: Vec<(usize, String)>,
    /// The widgets' kinds, in their order.
    pub widgets: Vec<&'static str>,
    /// Names of the values at a cell's ends: s, g, further fields.
    pub names: Vec<String>,
    /// The pixel by the 64-bit referee: C, A.
    pub referee: [f64; 4],
    /// The pixel as the pipeline draws it.
    pub drawn: EnginePixel,
    /// The pixel by each integrator.
    pub integrators: Vec<IntegratorPixel>,
    /// Background of the picture where the pipeline writes it (linear RGB).
    pub background: [f64; 3],
    /// Reason why the ray shows nothing, where it does.
    pub nothing: Option<String>,
}

/// A pixel of an engine's picture.
#[derive(Debug, Clone)]
pub struct EnginePixel {
    /// The engine and what it runs on.
    pub engine: String,
    /// C, A.
    pub rgba: [f64; 4],
}

/// A pixel by one integrator.
#[derive(Debug, Clone)]
pub struct IntegratorPixel {
    /// Its name.
    pub name: &'static str,
    /// Its numbers, for people.
    pub numbers: String,
    /// True if it is the one that the pipeline draws with.
    pub own: bool,
    /// C, A; or why it has none.
    pub rgba: Result<[f64; 4], String>,
}

impl Pixel {
    /// The largest difference of a channel from the referee.
    pub fn difference(&self, rgba: [f64; 4]) -> f64 {
        (0..4).map(|c| (rgba[c] - self.referee[c]).abs()).fold(0.0, f64::max)
    }

    /// Each widget's share of a step's optical depth, where it has one: its place and the share.
    pub fn shares(depths: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let whole: f64 = depths.iter().sum();
        depths.iter().enumerate().filter(|(_, depth)| **depth > 0.0).map(move |(k, depth)| (k, depth / whole))
    }
}

/// The mean of the rays of a pixel.
pub(super) fn mean(rays: impl ExactSizeIterator<Item = [f64; 4]>) -> [f64; 4] {
    let count = rays.len() as f64;
    rays.fold([0.0; 4], |sum, ray| std::array::from_fn(|c| sum[c] + ray[c] / count))
}
