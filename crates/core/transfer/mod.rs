//! Transfer functions: widgets over the (s, g) plane (docs/src/explanation/optics.md, section 5).
//!
//! Symbols: s the scalar, g the gradient magnitude, v = (s, g); ρ the extinction coefficient (1/L) =
//! extinction / unit distance × the widget's profile (peak 1); c the widget's linear RGB colour. Where an axis is logarithmic, widgets stand
//! at log₁₀ of s or g.
//!
//! What a widget is stands in one file a kind, in `kinds`: its keys in a pipeline file, its checks, its properties, where
//! its support lies. How it is integrated is said by each engine.

mod axis;
mod function;
mod hull;
mod kinds;
mod region;
mod relative;
mod rescale;
mod support;

pub use axis::{AxisScale, DECADES, off_axes, on_axes};
pub use function::{OpticalModel, TransferFunction, Widget, read};
pub(crate) use hull::meets;
pub use hull::{Corners, box_corners};
pub use kinds::{
    AxisOrigin, BandSpacing, CURVE_PARAMETERS, ColorSource, ControlPoint, LoadFiles, MAX_FIELDS, Profile,
    Properties, Table, UnreadFiles, WIDGET_KINDS, Wave, color_curve,
};
pub use region::{Convex, HalfPlane, Region, Slab, SupportRadius};
pub use relative::{DataStatistics, StatisticsRequest, resolved, statistics_request, with_placeholders};
pub use rescale::{on_other_scales, rescaled};
pub use support::Support;

#[cfg(test)]
mod tests;
