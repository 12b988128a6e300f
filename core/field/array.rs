//! `array`: the gradient that a solver wrote itself.

use super::{
    Declaration, Gradient, GradientFilter, Parameter, ParameterKind, Setting, Settings, check_scalar,
};
use crate::grid::Grid;
use crate::progress::Progress;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;

/// Takes ∇s from a point array of three components.
pub struct FromArray;

fn name(settings: &Settings) -> Option<&str> {
    match settings.get("array") {
        Some(Setting::Text(name)) => Some(name),
        _ => None,
    }
}

impl GradientFilter for FromArray {
    fn declaration(&self) -> Declaration {
        Declaration {
            name: "array".into(),
            help: "A point array of three components that holds the gradient already.".into(),
            parameters: vec![Parameter {
                name: "array".into(),
                help: "Name of the point array that holds ∂s/∂x, ∂s/∂y, ∂s/∂z.".into(),
                kind: ParameterKind::PointArray,
            }],
        }
    }

    fn arrays(&self, settings: &Settings) -> Vec<String> {
        name(settings).map(String::from).into_iter().collect()
    }

    fn gradient(&self, grid: &Grid, s: &[f64], settings: &Settings, _: &dyn Progress) -> Result<Gradient> {
        check_scalar(grid, s)?;
        let Some(name) = name(settings) else {
            return Err(Error::usage("the gradient method 'array' needs the name of an array")
                .accepted("array = \"NAME\", a point array of three components")
                .at_item("array"));
        };
        let known = || {
            let names: Vec<&str> = grid
                .point_arrays
                .iter()
                .filter(|(_, a)| a.component_count == 3)
                .map(|(n, _)| n.as_str())
                .collect();
            format!(
                "a point array of three components{}",
                if names.is_empty() { String::new() } else { format!(", one of: {}", names.join(", ")) }
            )
        };
        let Some(array) = grid.point_arrays.get(name) else {
            return Err(Error::run("there is no such array").found(format!("'{name}'")).accepted(known()));
        };
        if array.component_count != 3 || array.values.len() != 3 * grid.points.len() {
            return Err(Error::run("an array cannot be a gradient")
                .found(format!("{} components", array.component_count))
                .accepted(known())
                .at_item(name));
        }
        let vectors = array.values.par_chunks_exact(3).with_min_len(1 << 14).map(DVec3::from_slice).collect();
        Ok(Gradient { vectors, fallbacks: Vec::new() })
    }
}
