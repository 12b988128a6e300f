//! `array`: the gradient that a solver wrote itself.

use super::{Gradient, GradientFilter, check_scalar};
use crate::Result;
use crate::grid::Grid;
use crate::parameters::{DefaultValue, Parameter, ParameterType, Parameters, VariantSchema};
use crate::progress::Progress;
use glam::DVec3;
use rayon::prelude::*;

/// Takes ∇s from a point array of three components.
pub struct FromArray;

const DECLARATION: VariantSchema = VariantSchema {
    name: "array",
    summary: "A point array of three components that holds the gradient already.",
    parameters: &[Parameter {
        name: "array",
        parameter_type: ParameterType::Text,
        unit: "",
        default: DefaultValue::Required,
        help: "name of the point array that holds ∂s/∂x, ∂s/∂y, ∂s/∂z",
    }],
};

impl GradientFilter for FromArray {
    fn declaration(&self) -> VariantSchema {
        DECLARATION
    }

    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        Ok(vec![parameters.text("array")?.to_string()])
    }

    fn gradient(
        &self,
        grid: &Grid,
        s: &[f64],
        parameters: &Parameters,
        _: &dyn Progress,
    ) -> Result<Gradient> {
        check_scalar(grid, s)?;
        let array = grid.point_array(parameters.text("array")?, 3).map_err(|error| error.at_item("array"))?;
        let vectors = array.values.par_chunks_exact(3).with_min_len(1 << 14).map(DVec3::from_slice).collect();
        Ok(Gradient { vectors, fallbacks: Vec::new() })
    }
}
