//! Bounds of the error of a result.
//!
//! ε is the working precision, k the condition number of the case: the relative change of the result, in
//! units of ε, when the differences of the inputs change by a relative ε. No program can be expected to do
//! better than about ε (1 + k); the factors 8 (64-bit) and 16 (32-bit) on ε (4 + k) are twice to four times
//! what plain implementations of the stable forms were measured to need.

use super::case::{Case, SegmentCase};
use crate::{Condition, Precision};
use voltet_core::transfer::{AxisOrigin, OpticalModel, Profile};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// |error| ≤ relative · |exact| + floor.
    Bound {
        relative: f64,
        /// Absolute part.
        floor: f64,
    },
    /// Only 0 ≤ value ≤ limit, finite.
    Within {
        /// Largest value allowed.
        limit: f64,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BoundedQuantity {
    OpticalDepth,
    Color,
    Opacity,
}

/// The share of the brightest colour that may be missing: what lies behind an optical depth of 37 or 25.
fn color_floor(precision: Precision) -> f64 {
    match precision {
        Precision::F64 => 1e-16,
        Precision::F32 | Precision::Wgsl => 1e-11,
    }
}

/// The rule for one quantity of a segment; `condition`: k of T, C and A.
pub(super) fn rule(
    precision: Precision,
    case: &Case,
    segment: &SegmentCase,
    condition: Condition,
    quantity: BoundedQuantity,
) -> Rule {
    let condition = match quantity {
        BoundedQuantity::OpticalDepth => condition[0],
        BoundedQuantity::Color => condition[1],
        BoundedQuantity::Opacity => condition[2],
    };
    let free = Rule::Within { limit: limit(segment, quantity) };
    // Where the exact value is discontinuous no condition number exists; at region edges, whose coordinates
    // are exact, 5 stands for it.
    let k = if case.category == "edges" {
        5.0
    } else if let Some(k) = condition {
        k
    } else {
        return free;
    };
    let epsilon = precision.epsilon();
    let rounding = epsilon * (4.0 + k);
    let depth = segment.exact.optical_depth;
    let color = quantity == BoundedQuantity::Color;
    let one_density = segment.density() && segment.transfer_function.widgets.len() == 1;
    let has = |test: &dyn Fn(&Profile) -> bool| {
        segment.transfer_function.widgets.iter().any(|widget| test(&widget.profile))
    };
    let by_quadrature = has(&|p| !p.properties().has_elementary_mean);
    let narrow = case.category == "narrow";
    let relative = match precision {
        Precision::F64 => {
            // Clip lengths of a millionth of the segment: regions and emission windows.
            let clipped = narrow
                && ((color && !segment.density())
                    || segment.transfer_function.widgets.iter().any(|w| w.region.is_some()));
            let method = if clipped {
                1e-8
            } else if narrow {
                if by_quadrature { 1e-9 } else { 0.0 }
            } else if by_quadrature {
                1e-10
            } else if !color || one_density {
                0.0
            } else if depth > 1e4 {
                1e-10
            } else {
                1e-12
            };
            method + 8.0 * rounding
        }
        Precision::F32 | Precision::Wgsl => {
            // Twice as much is left to devices.
            let device = if precision == Precision::Wgsl { 2.0 } else { 1.0 };
            if 16.0 * rounding > 0.1 || (color && !one_density && depth > 1e4) {
                return free;
            }
            let gaussian = has(&is_gaussian);
            if narrow {
                if !(gaussian && case.subject.ends_with("inside")) {
                    return free;
                }
                1e-4 + 16.0 * rounding
            } else if color && !one_density {
                device * (1e-4 + 32.0 * rounding)
            } else {
                device * 16.0 * rounding
            }
        }
    };
    let floor = floor_of(precision, segment, color);
    Rule::Bound { relative, floor }
}

/// The rule for a chain of segments with one transfer function. Its cases state no condition number; where
/// their segments hold depth, k stays under 40.
pub(super) fn ray_rule(
    precision: Precision,
    count: usize,
    exact: &SegmentCase,
    quantity: BoundedQuantity,
) -> Rule {
    let epsilon = precision.epsilon();
    let steps = 4.0 * count as f64 * epsilon;
    let rounding = epsilon * 44.0;
    let color = quantity == BoundedQuantity::Color;
    let relative = match (precision, color) {
        (Precision::F64, false) => 8.0 * rounding,
        (Precision::F64, true) => 1e-12 + 8.0 * rounding,
        (Precision::F32, false) => 16.0 * rounding,
        (Precision::F32, true) => 1e-4 + 32.0 * rounding,
        (Precision::Wgsl, false) => 32.0 * rounding,
        (Precision::Wgsl, true) => 2e-4 + 64.0 * rounding,
    };
    let floor = floor_of(precision, exact, color);
    Rule::Bound { relative: relative + steps, floor }
}

pub(super) fn table_rule(precision: Precision, quantity: &str, depth: f64) -> Rule {
    let relative = match (precision, quantity) {
        (Precision::F64, "psi") => 4e-15,
        (Precision::F64, "F" | "B") => 2e-11,
        (Precision::F32 | Precision::Wgsl, "psi" | "F" | "B") => 2e-6,
        // x is half of the depth; e^(−x) may err by 3 + 2x units, and carries the rounding of x.
        (Precision::Wgsl, _) => precision.epsilon() * (4.0 + 2.0 * depth),
        // e^(−x) carries the rounding of x.
        _ => (4e-15_f64).min(8.0 * precision.epsilon()) + precision.epsilon() * (2.0 + depth),
    };
    Rule::Bound { relative, floor: precision.floor() }
}

/// The absolute part of a bound. A colour may also be off by what the floor of T makes of it.
fn floor_of(precision: Precision, segment: &SegmentCase, color: bool) -> f64 {
    if color {
        color_floor(precision) * brightness(segment) + precision.floor() * segment.brightest()
    } else {
        precision.floor()
    }
}

/// S = c_max min(1, T), or c_max (D/U) min(1, 1/T).
fn brightness(segment: &SegmentCase) -> f64 {
    let depth = segment.exact.optical_depth;
    let brightest = segment.brightest();
    if segment.density() {
        brightest * depth.min(1.0)
    } else {
        brightest * segment.length / segment.transfer_function.unit_distance * (1.0 / depth).min(1.0)
    }
}

fn limit(segment: &SegmentCase, quantity: BoundedQuantity) -> f64 {
    match quantity {
        BoundedQuantity::OpticalDepth => f64::MAX,
        BoundedQuantity::Opacity => 1.0,
        BoundedQuantity::Color => match segment.transfer_function.model {
            OpticalModel::DensityEmitter => segment.brightest() * (1.0 + 1e-5),
            OpticalModel::ConstantEmitter { .. } => f64::MAX,
        },
    }
}

/// True if the peak of a narrow widget is found in 32 bits: about one centre, by a function of the segment's ends alone.
fn is_gaussian(profile: &Profile) -> bool {
    let properties = profile.properties();
    properties.has_elementary_mean && properties.axes.iter().any(|axis| matches!(axis, AxisOrigin::Centre(_)))
}
