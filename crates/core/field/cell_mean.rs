//! `cell-average` and `volume-weighted`: means of the cells' constant gradients at the points. `array`: the gradient that a solver wrote.
//!
//! In a tetrahedron with edges e₁, e₂, e₃ from one corner and differences Δ₁, Δ₂, Δ₃ of the scalar along them the
//! gradient of the linear interpolant is ∇s = n / d with d = e₁ · (e₂ × e₃) = ±6 V and
//! n = Δ₁ e₂ × e₃ + Δ₂ e₃ × e₁ + Δ₃ e₁ × e₂.
//! `cell-average` is the plain mean of ∇s over the cells that use the point (as VTK's vtkGradientFilter on
//! tetrahedra), `volume-weighted` is Σ V ∇s / Σ V = Σ ±n / Σ |d|, which never divides by the volume of one cell.

use super::filter::for_points;
use super::{Fallback, Gradient, GradientFilter, check_scalar};
use crate::Result;
use crate::grid::{Grid, sum_over_cells};
use crate::parameters::{DefaultValue, Parameter, ParameterType, Parameters, VariantSchema};
use crate::progress::Progress;
use glam::DVec3;
use rayon::prelude::*;

/// Unweighted mean over the cells that use a point.
pub struct CellAverage;

/// Mean over the cells that use a point, weighted by their volume.
pub struct VolumeWeighted;

impl GradientFilter for CellAverage {
    fn declaration(&self) -> VariantSchema {
        VariantSchema {
            name: "cell-average",
            summary: "Plain mean of the constant gradients of the cells around a point, as VTK's gradient filter: \
                   first order.",
            parameters: &[],
        }
    }

    fn gradient(&self, grid: &Grid, s: &[f64], _: &Parameters, progress: &dyn Progress) -> Result<Gradient> {
        cell_means(grid, s, progress, |n, d| (n / d, 1.0))
    }
}

impl GradientFilter for VolumeWeighted {
    fn declaration(&self) -> VariantSchema {
        VariantSchema {
            name: "volume-weighted",
            summary: "Mean of the constant gradients of the cells around a point, weighted by volume: first order, \
                   unmoved by flat cells.",
            parameters: &[],
        }
    }

    fn gradient(&self, grid: &Grid, s: &[f64], _: &Parameters, progress: &dyn Progress) -> Result<Gradient> {
        cell_means(grid, s, progress, |n, d| (n * d.signum(), d.abs()))
    }
}

/// Σ of the first over Σ of the second part of `term(n, d)` at every point.
fn cell_means(
    grid: &Grid,
    s: &[f64],
    progress: &dyn Progress,
    term: impl Fn(DVec3, f64) -> (DVec3, f64) + Sync,
) -> Result<Gradient> {
    check_scalar(grid, s)?;
    let scale = grid.length_scale();
    progress.report("gradient", 0.0);
    let sums: Vec<(DVec3, f64)> = sum_over_cells(
        grid,
        |cell| {
            if progress.cancelled() {
                return None;
            }
            let values = grid.tetrahedra[cell].map(|p| s[p as usize]);
            cell_gradient(grid.corners(cell), values, scale).map(|(n, d)| term(n, d))
        },
        |sum: &mut (DVec3, f64), (value, weight)| {
            sum.0 += *value;
            sum.1 += *weight;
        },
    );
    let (vectors, [without_volume]) = for_points(
        grid.points.len(),
        progress,
        || (),
        |(), p| {
            let (sum, weight) = sums[p];
            let gradient = sum / weight * scale;
            if weight > 0.0 && gradient.is_finite() { (gradient, None) } else { (DVec3::ZERO, Some(0)) }
        },
    )?;
    Ok(Gradient {
        vectors,
        fallbacks: Fallback::list([("set to zero: no cell around the point has a volume", without_volume)]),
    })
}

/// n and d of a tetrahedron, lengths multiplied by `scale`; `None` where its volume is zero to rounding.
#[inline]
fn cell_gradient([a, b, c, d]: [DVec3; 4], s: [f64; 4], scale: f64) -> Option<(DVec3, f64)> {
    let (e1, e2, e3) = ((b - a) * scale, (c - a) * scale, (d - a) * scale);
    let (c1, c2, c3) = (e2.cross(e3), e3.cross(e1), e1.cross(e2));
    let determinant = e1.dot(c1);
    // Below its rounding error neither size nor sign of the volume mean anything: a few ε × Σ |products| from the
    // products, which |e₁| |e₂| |e₃| bounds, and ε × |x| × the area of the faces from the coordinates themselves.
    let products = e1.length_squared() * e2.length_squared() * e3.length_squared();
    let resolution = a.abs().max_element() * scale;
    let coordinates =
        resolution * resolution * (c1.length_squared() + c2.length_squared() + c3.length_squared());
    const NOISE: f64 = 4.0 * f64::EPSILON;
    if determinant == 0.0 || determinant * determinant <= NOISE * NOISE * (products + coordinates) {
        return None;
    }
    Some(((s[1] - s[0]) * c1 + (s[2] - s[0]) * c2 + (s[3] - s[0]) * c3, determinant))
}

/// Takes ∇s from a point array of three components.
pub struct FromArray;

const DECLARATION: VariantSchema = VariantSchema {
    name: "array",
    summary: "A point array of three components that holds the gradient already.",
    parameters: &[Parameter {
        name: "array",
        parameter_type: ParameterType::ArrayName,
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
