//! `weighted-fit`: the linear function through each point that fits its neighbours best, the nearer ones more.
//!
//! ∇s minimises Σ_q w_q² (∇s · d_q − Δ_q)² over the points q that share an edge with p, with d_q = x_q − x_p,
//! Δ_q = s_q − s_p and w_q² = t_q |d_q|^(−2 power), t_q being how far q is trusted. With power 1 and every point trusted
//! alike this is the method `least-squares`.

use voltet::core::Result;
use voltet::core::field::{Fallback, Gradient, GradientFilter, for_points};
use voltet::core::glam::{DMat3, DVec3};
use voltet::core::grid::{Grid, Neighbours, cells_of_points};
use voltet::core::progress::Progress;
use voltet::graph::{DefaultValue, Parameter, ParameterType, Parameters, Range, VariantSchema};

/// A filter has no state: all that it goes by is given to it.
pub struct WeightedFit;

const DECLARATION: VariantSchema = VariantSchema {
    name: "weighted-fit",
    summary: "Linear fit to the neighbouring points, weighted by a power of their distance.",
    parameters: &[
        Parameter {
            name: "power",
            parameter_type: ParameterType::Number(Range::within(0.0, 4.0)),
            unit: "",
            default: DefaultValue::Number(1.0),
            help: "the power of the distance that a neighbour's weight is divided by; 1 is least-squares",
        },
        Parameter {
            name: "trust",
            parameter_type: ParameterType::Text,
            unit: "",
            default: DefaultValue::Unset("every point alike"),
            help: "the point array that says how far each point is trusted: 0 not at all",
        },
    ],
};

/// Under this determinant of the normal matrix, in cubes of a third of its trace, the neighbours lie in a plane.
const FLAT: f64 = 1e-9;

impl GradientFilter for WeightedFit {
    fn declaration(&self) -> VariantSchema {
        DECLARATION
    }

    /// The reader decodes what is named here, where somebody looks at the gradient.
    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        Ok(trust(parameters).map(str::to_string).into_iter().collect())
    }

    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient> {
        let power = parameters.number("power")?;
        let trust = trust(parameters).map(|name| grid.point_array(name, 1)).transpose();
        let trust = trust.map_err(|error| parameters.locate("trust", error))?;
        let trust_of = |q: usize| trust.map_or(1.0, |array| array.values[q].max(0.0));
        let cells = cells_of_points(grid);
        // On all cores, point by point; `neighbours` is the memory of one thread.
        let fit = |neighbours: &mut Neighbours, p: usize| {
            let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
            for q in neighbours.around(grid, &cells, p).iter().map(|&q| q as usize) {
                let d = grid.points[q] - grid.points[p];
                let weight = trust_of(q) * d.length().powf(-2.0 * power);
                matrix += DMat3::from_cols(d * d.x, d * d.y, d * d.z) * weight;
                right += d * (weight * (scalar[q] - scalar[p]));
            }
            let third = (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z) / 3.0;
            match matrix.determinant() > FLAT * third.powi(3) {
                true => (matrix.inverse() * right, None),
                false => (DVec3::ZERO, Some(0)),
            }
        };
        let (vectors, [flat]) = for_points(grid.points.len(), progress, Neighbours::default, fit)?;
        let fallbacks =
            Fallback::list([("set to zero: the neighbours that are trusted lie in a plane", flat)]);
        Ok(Gradient { vectors, fallbacks })
    }
}

fn trust(parameters: &Parameters) -> Option<&str> {
    parameters.optional("trust")?.text()
}
