//! Refinement of the grid, which separates the two errors of a picture: that of the integration, and that of taking the
//! data as linear in each cell.
//!
//! Each tetrahedron is cut in eight. With values linear between the coarse points the field stays what it is, and so does
//! the exact picture: what changes is the integration, whose order over the size of cells is observed. With values that the
//! data would have between the points (from the source, where it is a function; else by cubic Hermite interpolation along
//! each edge from the gradients at its ends) the exact picture changes: by what the linear model leaves out.

use super::convergence::{Convergence, convergence};
use super::errors::errors;
use super::{Reference, RenderConfig, RendererVariant, Subject};
use glam::DVec3;
use serde::Serialize;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::field::{LeastSquares, Method};
use voltet_core::grid::{Array, RefinedGrid, refine};
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_integrators::{riemann, segments};
use voltet_optics::WidgetBlend;
use voltet_optics::engine::Accumulation;
use voltet_optics::engine::{AdapterRequest, RenderOptions};
use voltet_optics::integrators::Integrator;
use voltet_optics::shading::VisibilityOrder;

/// Most cells of the finest grid: some 20 GiB while they are drawn.
const MAX_CELLS: u64 = 100_000_000;

pub enum Source<'a> {
    Gradients,
    /// From the function that the data are samples of: s and ∇s.
    Function(&'a (dyn Fn(DVec3) -> (f64, DVec3) + Sync)),
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Refinement {
    /// Cells of each grid, the given one first.
    pub cells: Vec<u64>,
    /// For each integrator its error over the pieces of an edge, the field being the same.
    pub integration: Vec<Convergence>,
    /// By how much the exact picture changes, from one grid to the next finer one, when values between the points are not
    /// taken as linear.
    pub model: Convergence,
    /// By how much the picture of the given grid differs from that of the finest such one, root mean square: about the
    /// error of the linear data model.
    pub model_error: f64,
    /// Root-mean-square error of the closed forms on the given grid: that of the integration.
    pub integration_error: f64,
}

/// Refuses levels of refinement that make the grid too large, before anything is drawn.
pub fn refuse_too_fine(subject: &Subject, levels: u32) -> Result<()> {
    let count = subject.scene.volume.grid.tetrahedra.len() as u64;
    let refined = |levels: u32| 8u64.checked_pow(levels).and_then(|pieces| count.checked_mul(pieces));
    let fits = |levels: u32| refined(levels).is_some_and(|cells| cells <= MAX_CELLS);
    if fits(levels) {
        return Ok(());
    }
    let cells = match refined(levels) {
        Some(cells) => cells.to_string(),
        // Beyond 64 bits nobody needs every digit.
        None => format!("{:.1e}", count as f64 * 8f64.powi(levels.min(300) as i32)),
    };
    let most = (1..levels).rev().find(|&levels| fits(levels));
    let fewer = most.map_or("no --refine".into(), |most| format!("--refine {most} or less"));
    Err(Error::usage("the grid is too large to be refined that often")
        .got(format!("{cells} cells of {count}, refined {levels} times"))
        .expected(format!("at most {MAX_CELLS} cells: {fewer}")))
}

/// Refines the scene's grid `levels` times (at least once).
///
/// Errors: grids that would get too large, those of drawing, a stop.
pub fn refinement(
    subject: &Subject,
    reference: &Reference,
    levels: u32,
    source: &Source,
    progress: &dyn Progress,
) -> Result<Refinement> {
    refuse_too_fine(subject, levels)?;
    let count = subject.scene.volume.grid.tetrahedra.len() as u64;
    let exact = RenderConfig {
        variant: RendererVariant::NATIVE,
        integrator: Integrator::ANALYTIC,
        overlap: WidgetBlend::Exact,
        order: VisibilityOrder::Exact,
        accumulation: Accumulation::Float,
    };
    let tried = [
        ("riemann, 4 samples", RenderConfig { integrator: riemann(4), ..exact }),
        ("segments, 1 piece", RenderConfig { integrator: segments(1, 256), ..exact }),
        ("closed forms", exact),
    ];
    let mut errors_of: Vec<Vec<(usize, f64)>> = vec![Vec::new(); tried.len()];
    let (mut cells, mut changes, mut model_error) = (vec![count], Vec::new(), 0.0);
    let (mut linear, mut smooth) = (subject.clone(), subject.clone());
    smooth.scene.volume = with_gradient(&subject.scene.volume, progress)?;
    let given = picture(&smooth, &exact, progress)?;
    let mut coarser = given.clone();
    for level in 0..=levels {
        for (k, (name, setting)) in tried.iter().enumerate() {
            let done = f64::from(level) + k as f64 / tried.len() as f64;
            progress.report(name, done / f64::from(levels + 1));
            let drawn = picture(&linear, setting, progress)?;
            errors_of[k].push((1 << level, errors(&drawn, &reference.picture).root_mean_square));
        }
        if level == levels {
            break;
        }
        linear.scene.volume = Arc::new(refined(&linear.scene.volume, None)?);
        smooth.scene.volume = Arc::new(refined(&smooth.scene.volume, Some(source))?);
        cells.push(linear.scene.volume.grid.tetrahedra.len() as u64);
        let drawn = picture(&smooth, &exact, progress)?;
        changes.push((1 << level, errors(&drawn, &coarser).root_mean_square));
        model_error = errors(&drawn, &given).root_mean_square;
        coarser = drawn;
    }
    let integration_error = errors_of[2][0].1;
    let floor = errors_of[2].iter().map(|level| level.1).fold(0.0, f64::max);
    let of = |name, errors: &[(usize, f64)], floor| {
        convergence(name, errors, floor, &subject.scene.transfer_function)
    };
    let integration = (0..2).map(|k| of(tried[k].0, &errors_of[k], floor)).collect();
    let mut model = of("the linear data model", &changes, floor);
    (model.expected, model.reason) = (2.0, "a smooth field, linear in cells");
    Ok(Refinement { cells, integration, model, model_error, integration_error })
}

fn picture(subject: &Subject, setting: &RenderConfig, progress: &dyn Progress) -> Result<Picture> {
    let scene = setting.scene(subject);
    let volume = setting.variant.engine.open(&AdapterRequest::default())?.prepare(&scene.volume)?;
    Ok(volume.draw(&scene, &RenderOptions::default(), &CancelOnly(progress))?.picture)
}

/// The volume with ∇s at every point: by the filter of the pipeline, where it has one ([`Subject::gather`] was asked for it),
/// else by the standard one.
fn with_gradient(volume: &Arc<Volume>, progress: &dyn Progress) -> Result<Arc<Volume>> {
    if volume.gradient.is_some() {
        return Ok(volume.clone());
    }
    let method = Method::with_defaults(Arc::new(LeastSquares))?;
    let gradient = method.gradient(&volume.grid, &volume.scalar, &CancelOnly(progress))?;
    Ok(Arc::new(Volume { gradient: Some(SharedSlice::from(gradient.vectors)), ..Volume::clone(volume) }))
}

/// The volume on the refined grid: everything linear between the coarse points, or s, ∇s and g from a source.
fn refined(volume: &Volume, source: Option<&Source>) -> Result<Volume> {
    let mut refined = refine(&volume.grid)?;
    for (name, array) in &volume.grid.point_arrays {
        let count = array.component_count;
        let mut values = array.values.clone();
        for [a, b] in &refined.ends {
            let at = |p: u32, k: usize| array.values[p as usize * count + k];
            values.make_mut().extend((0..count).map(|k| 0.5 * (at(*a, k) + at(*b, k))));
        }
        let array = Array { component_count: count, values };
        refined.grid.point_arrays.insert(name.clone(), Arc::new(array));
    }
    let halfway = |values: &[f64]| refined.values(values, |[a, b]| 0.5 * (values[a] + values[b]));
    let (scalar, gradient, gradient_magnitude);
    match (source, &volume.gradient) {
        (Some(source), Some(slopes)) => {
            let values = between(volume, slopes, &refined, source);
            let magnitude = |g: &SharedSlice<f64>| {
                let coarse = g.len();
                g.iter().copied().chain(values[coarse..].iter().map(|(_, slope)| slope.length())).collect()
            };
            gradient_magnitude = volume.gradient_magnitude.as_ref().map(magnitude);
            scalar = values.iter().map(|value| value.0).collect();
            gradient = Some(SharedSlice::from(values.iter().map(|value| value.1).collect::<Vec<_>>()));
        }
        _ => {
            scalar = halfway(&volume.scalar);
            gradient_magnitude = volume.gradient_magnitude.as_ref().map(|g| halfway(g).into());
            let middle = |slopes: &[DVec3]| refined.values(slopes, |[a, b]| 0.5 * (slopes[a] + slopes[b]));
            gradient = volume.gradient.as_ref().map(|slopes| middle(slopes).into());
        }
    }
    Ok(Volume {
        grid: Arc::new(refined.grid),
        scalar: SharedSlice::from(scalar),
        gradient,
        gradient_magnitude,
    })
}

/// s and ∇s at every point of the refined grid.
///
/// With e the edge from a to b, the cubic through both values and slopes has at its middle the value
/// (s_a + s_b)/2 + e·(∇s_a − ∇s_b)/8 and along e the slope 3 (s_b − s_a)/2 − e·(∇s_a + ∇s_b)/4; across it the mean of both
/// slopes is taken.
fn between(volume: &Volume, slopes: &[DVec3], refined: &RefinedGrid, source: &Source) -> Vec<(f64, DVec3)> {
    let points = &volume.grid.points;
    let s = &volume.scalar;
    let coarse: Vec<(f64, DVec3)> = s.iter().copied().zip(slopes.iter().copied()).collect();
    refined.values(&coarse, |[a, b]| {
        if let Source::Function(function) = source {
            return function(points[a] + 0.5 * (points[b] - points[a]));
        }
        let edge = points[b] - points[a];
        let value = 0.5 * (s[a] + s[b]) + edge.dot(slopes[a] - slopes[b]) / 8.0;
        let mean = 0.5 * (slopes[a] + slopes[b]);
        let along = 1.5 * (s[b] - s[a]) - 0.5 * edge.dot(mean);
        let square = edge.length_squared();
        let slope = if square > 0.0 { mean + edge * ((along - edge.dot(mean)) / square) } else { mean };
        (value, slope)
    })
}
