//! Optics: the integral of one ray segment, and compositing (docs/src/explanation/optics.md, sections 6, 7, 9 and 10).
//!
//! The 64-bit closed forms here are what every other form of the program is compared with. One file a kind of widget
//! in [`kinds`] (`uniform` has none: its integral is the length of the clipped stretch), each with its formula's source.

pub mod clip;
mod compiled;
pub mod compositing;
pub mod curved_axes;
pub mod depth_image;
pub mod engine;
pub mod integrators;
pub mod kinds;
pub mod linear;
pub mod overlap;
pub mod quadrature;
pub mod ray_events;
pub mod scene;
pub mod scene_parts;
pub mod shading;
pub mod special;
pub mod trace;
pub mod track;

pub use compiled::CompiledTransferFunction;

/// One ray segment: the crossing of one cell. Values vary linearly from front to back. For the closed forms these are positions on the axes
/// of the transfer function: where one is logarithmic, a crossing is several segments ([`curved_axes`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment<'a> {
    /// D, Euclidean length in world units, ≥ 0.
    pub length: f64,
    /// (s, g) at the front (entry).
    pub front: [f64; 2],
    /// (s, g) at the back (exit).
    pub back: [f64; 2],
    /// Further fields at the front, in the order of `TransferFunction::fields`.
    pub fields_front: &'a [f64],
    /// Further fields at the back.
    pub fields_back: &'a [f64],
}

impl<'a> Segment<'a> {
    /// A segment with these values, [s, g, fields …], at its ends.
    pub fn of_values(length: f64, front: &'a [f64], back: &'a [f64]) -> Segment<'a> {
        Segment {
            length,
            front: [front[0], front[1]],
            back: [back[0], back[1]],
            fields_front: &front[2..],
            fields_back: &back[2..],
        }
    }
}

/// Contribution of one segment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contribution {
    /// Optical depth T = ∫ρ.
    pub optical_depth: f64,
    /// Premultiplied linear colour C.
    pub color: [f64; 3],
    /// Opacity A = 1 − e^(−T).
    pub opacity: f64,
}

/// Combination of several widgets that are active on one stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WidgetBlend {
    /// The ordered integral ∫ Σ c_i ρ_i e^(−T), to a stated tolerance.
    #[default]
    Exact,
    /// Kniss et al. 2003, Eq. 15: optical depths added, colours averaged by optical depth.
    Mix,
}

#[cfg(test)]
mod extent_tests;
#[cfg(test)]
mod support_tests;
#[cfg(test)]
mod tests;
