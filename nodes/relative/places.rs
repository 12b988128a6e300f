//! Places and lengths in space, as numbers or as shares of the bounds of the data, declared once for the nodes that have them. A place that
//! is not stated lies in the middle of the data, so that what is cut there is cut at once.

use glam::DVec3;
use voltet_core::grid::extent;
use voltet_core::transfer::{DataStatistics, resolved};
use voltet_core::{Error, Result};
use voltet_graph::{
    ArrayRef, AxisRef, DefaultValue, Parameter, ParameterType, Parameters, Range, RelativeNumberType,
    StatisticKind,
};

/// A place, also by shares of the bounds.
pub(crate) const POSITION: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Measured(&RelativeNumberType {
        plain: ParameterType::Numbers(Some(3), Range::ANY),
        statistic: StatisticKind::Place,
        axis: AxisRef::Places(&["x", "y", "z"]),
    }),
    unit: "world units",
    default: DefaultValue::Required,
    help: "",
};

/// A radius, also as a share of the diagonal of the bounds.
pub(crate) const RADIUS: Parameter = Parameter {
    name: "radius",
    parameter_type: ParameterType::Measured(&RelativeNumberType {
        plain: ParameterType::Number(Range::above(0.0)),
        statistic: StatisticKind::Width,
        axis: AxisRef::Every("diagonal"),
    }),
    ..POSITION
};

/// The middle of the data.
pub(crate) const MIDDLE: DefaultValue = DefaultValue::Texts(&["50 %", "50 %", "50 %"]);

/// A point of a plane.
pub(crate) const ORIGIN: Parameter =
    Parameter { name: "origin", default: MIDDLE, help: "a point of the plane", ..POSITION };

/// The normal of a plane.
pub(crate) const NORMAL: Parameter = Parameter {
    name: "normal",
    parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
    unit: "world space",
    default: DefaultValue::Numbers(&[1.0, 0.0, 0.0]),
    help: "the plane's normal; any length above 0",
};

/// The bounds of the data.
pub(crate) struct SpatialRegion([DVec3; 2]);

impl SpatialRegion {
    /// The bounds, where there are data. Errors: there are none.
    pub fn from_known(bounds: Option<[DVec3; 2]>) -> Result<SpatialRegion> {
        let none = || Error::run("the grid has no points, so nothing can be relative to its bounds");
        bounds.map(SpatialRegion).ok_or_else(none)
    }
}

impl DataStatistics for SpatialRegion {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        let [low, high] = self.0;
        match quantity {
            ArrayRef::Named("x") => Ok([low.x, high.x]),
            ArrayRef::Named("y") => Ok([low.y, high.y]),
            ArrayRef::Named("z") => Ok([low.z, high.z]),
            _ => Ok([0.0, extent::diagonal(self.0)]),
        }
    }

    fn percentile(&self, quantity: &ArrayRef, _: f64) -> Result<f64> {
        Err(Error::usage(format!("{quantity} is a place, and a percentile is a value of a field")))
    }
}

/// The parameters with places for percentages of bounds, and a radius for one of their diagonal; as they are where they have none.
///
/// # Errors
/// - there are percentages and no bounds.
pub fn placed(p: &Parameters, bounds: Option<[DVec3; 2]>) -> Result<Parameters> {
    if p.relative_numbers().is_empty() {
        return Ok(p.clone());
    }
    resolved(p, &SpatialRegion::from_known(bounds)?)
}
