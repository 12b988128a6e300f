//! One slice D = const of a pre-integrated table: the light of every path from s_i to s_j at once.
//!
//! Symbols: s_0 … s_(n−1) the nodes, m = n − 1 steps between them; D the length of a path, ρ̄ the mean extinction
//! along it, E₁(T) = (1 − e^(−T))/T. Lengths are shares of the longest segment, so extinctions are pure numbers. Roettger & Ertl 2002, section 3, integrate all texels of a slice side by
//! side, each by as many samples as it spans entries: n³ operations a slice. Here a path of d steps is a window of
//! d steps, each of length D/d, and the windows of equal d share their work: blocks of d steps are composited from
//! their start and from their end, and a window is what is left of one block over what is begun of the next (van
//! Herk 1992; Gil & Werman 1993, for maxima). That is n² operations a slice, with the same sums.
//!
//! A step is as many homogeneous pieces as the paper's oversampling factor says, with the mean extinction and glow of the closed forms, so a feature
//! between two nodes is not missed. Each piece absorbs its own light (E₁), which Eq. 6 leaves out.

use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_optics::integrators::Extent;
use voltet_optics::special::mean_transmittance;
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};

/// A homogeneous stretch, or a point: per longest segment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Material {
    pub extinction: f64,
    /// Σ cᵢ ρᵢ or Σ κᵢ.
    pub glow: [f64; 3],
}

/// A transfer function of the scalar alone, by its nodes and steps.
#[derive(Debug, Clone)]
pub struct Ramp {
    /// Least and largest node.
    pub range: [f64; 2],
    pub nodes: Vec<Material>,
    /// Pieces of a step: the paper's oversampling factor.
    pub parts: usize,
    pub pieces: Vec<Material>,
}

impl Ramp {
    /// `size` ≥ 2 nodes over the range of the scalar, `parts` ≥ 1 pieces from one to the next.
    pub fn new(
        transfer_function: &TransferFunction,
        size: usize,
        parts: usize,
        extent: &Extent,
    ) -> Result<Self> {
        let numbers = [extent.scalar[0], extent.scalar[1], extent.longest];
        if numbers.iter().any(|x| !x.is_finite()) || extent.longest <= 0.0 {
            return Err(Error::run("the data give no domain for a pre-integrated table")
                .got(format!("scalars {:?}, longest segment {}", extent.scalar, extent.longest))
                .expected("finite scalars and cells with an extent"));
        }
        let prepared = CompiledTransferFunction::new(transfer_function)?;
        let [low, high] = extent.scalar;
        let high = if high > low { high } else { low + low.abs().max(1.0) };
        let unit = transfer_function.unit_distance;
        // Means over the path between two values.
        let mean = |front: f64, back: f64| {
            let (front, back) = ([front, 0.0], [back, 0.0]);
            let segment = |length: f64| Segment { length, front, back, fields_front: &[], fields_back: &[] };
            let extinction = prepared.optical_depth(&segment(unit)) / unit;
            // Light of a path so short that nothing of it is absorbed, to 1e-9.
            let short = (1e-9 / extinction).min(unit);
            let light = prepared.integrate(&segment(short), WidgetBlend::Exact);
            let glow = light.color.map(|c| c / short * extent.longest);
            Material { extinction: extinction * extent.longest, glow }
        };
        let at = |x: f64| low + (high - low) * (x / (size - 1) as f64).min(1.0);
        let nodes = (0..size).map(|i| mean(at(i as f64), at(i as f64))).collect();
        let part = |k: usize| at(k as f64 / parts as f64);
        let pieces = (0..(size - 1) * parts).map(|k| mean(part(k), part(k + 1))).collect();
        Ok(Ramp { range: [low, high], nodes, parts, pieces })
    }

    fn extinction_of(step: &[Material]) -> f64 {
        step.iter().map(|part| part.extinction).sum::<f64>() / step.len() as f64
    }

    pub fn size(&self) -> usize {
        self.nodes.len()
    }

    /// Position of s, in steps from the first node.
    #[inline]
    pub fn place(&self, s: f64) -> f64 {
        let [low, high] = self.range;
        let last = (self.nodes.len() - 1) as f64;
        ((s - low) / (high - low) * last).clamp(0.0, last)
    }

    /// ρ̄ of each path (i, j), row by row; it does not depend on D.
    pub fn mean_extinctions(&self) -> Vec<f32> {
        let n = self.size();
        let steps: Vec<f64> = self.pieces.chunks_exact(self.parts).map(Ramp::extinction_of).collect();
        let mut sums = vec![0.0; n];
        for (i, step) in steps.iter().enumerate() {
            sums[i + 1] = sums[i] + step;
        }
        let mean = |i: usize, j: usize| match i.abs_diff(j) {
            0 => self.nodes[i].extinction,
            // Neighbours from the step itself: the sums' rounding must not hide a thin one behind a dense one.
            1 => steps[i.min(j)],
            d => (sums[j] - sums[i]).abs() / d as f64,
        };
        (0..n * n).map(|k| single(mean(k / n, k % n))).collect()
    }

    /// C/(D E₁(ρ̄D)) of each path (i, j), row by row, in front of 0: the glow of a homogeneous path that shines as much.
    pub fn fill(&self, length: f64, slice: &mut [[f32; 4]]) {
        let n = self.size();
        let store = |[r, g, b]: [f64; 3]| [single(r), single(g), single(b), 0.0];
        for (i, node) in self.nodes.iter().enumerate() {
            slice[i * n + i] = store(node.glow);
        }
        let nothing = vec![Light::CLEAR; n - 1];
        let (mut there, mut back) = (SlidingSums::new(&nothing), SlidingSums::new(&nothing));
        for span in 1..n {
            let share = 1.0 / (span * self.parts) as f64;
            for (i, step) in self.pieces.chunks_exact(self.parts).enumerate() {
                (there.steps[i], back.steps[i]) = (Light::CLEAR, Light::CLEAR);
                for part in step {
                    let light = Light::new(part, length, share);
                    there.steps[i] = there.steps[i].over(&light);
                    back.steps[i] = light.over(&back.steps[i]);
                }
            }
            there.gather(span, Light::over);
            back.gather(span, |near, far| far.over(near));
            for i in 0..n - span {
                let j = i + span;
                slice[i * n + j] = store(there.window(i, span, Light::over).glow());
                slice[j * n + i] = store(back.window(i, span, |near, far| far.over(near)).glow());
            }
        }
    }
}

/// Number of tiles less 1: `planes` times as many as the table has entries a side, rounded up so that the creases of f
/// lie on tiles.
pub const fn last_tile(table_size: usize, planes: usize) -> usize {
    4 * table_size.saturating_mul(planes).div_ceil(4)
}

/// In 32 bits, finite.
pub(crate) fn single(x: f64) -> f32 {
    x.min(f64::from(f32::MAX)) as f32
}

/// Emission of a stretch (divided by D), and its optical depth.
#[derive(Debug, Clone, Copy)]
struct Light {
    emission: [f64; 3],
    depth: f64,
    transmittance: f64,
}

impl Light {
    const CLEAR: Light = Light { emission: [0.0; 3], depth: 0.0, transmittance: 1.0 };

    /// The share `share` of a path of length D.
    fn new(matter: &Material, length: f64, share: f64) -> Light {
        let depth = matter.extinction * length * share;
        let opacity = -(-depth).exp_m1();
        let mean = if depth > 1e-8 { opacity / depth } else { 1.0 - 0.5 * depth };
        Light { emission: matter.glow.map(|g| g * share * mean), depth, transmittance: 1.0 - opacity }
    }

    #[inline]
    fn over(&self, behind: &Light) -> Light {
        Light {
            emission: std::array::from_fn(|i| self.emission[i] + self.transmittance * behind.emission[i]),
            depth: self.depth + behind.depth,
            transmittance: self.transmittance * behind.transmittance,
        }
    }

    fn glow(&self) -> [f64; 3] {
        let mean = mean_transmittance(self.depth);
        self.emission.map(|e| e / mean)
    }
}

/// Sliding windows over the steps.
struct SlidingSums {
    steps: Vec<Light>,
    /// Block sums of each step: up to it, and from it on.
    begun: Vec<Light>,
    left: Vec<Light>,
}

impl SlidingSums {
    fn new(nothing: &[Light]) -> Self {
        SlidingSums { steps: nothing.to_vec(), begun: nothing.to_vec(), left: nothing.to_vec() }
    }

    fn gather(&mut self, span: usize, join: impl Fn(&Light, &Light) -> Light) {
        let count = self.steps.len();
        for start in (0..count).step_by(span) {
            let end = (start + span).min(count);
            self.begun[start] = self.steps[start];
            for i in start + 1..end {
                self.begun[i] = join(&self.begun[i - 1], &self.steps[i]);
            }
            self.left[end - 1] = self.steps[end - 1];
            for i in (start..end - 1).rev() {
                self.left[i] = join(&self.steps[i], &self.left[i + 1]);
            }
        }
    }

    /// The window of `span` steps from step i on.
    #[inline]
    fn window(&self, i: usize, span: usize, join: impl Fn(&Light, &Light) -> Light) -> Light {
        if i.is_multiple_of(span) { self.left[i] } else { join(&self.left[i], &self.begun[i + span - 1]) }
    }
}
