//! Observed orders of convergence beside the expected ones, after Etiene et al., "Verifying Volume Rendering Using
//! Discretization Error Analysis" (2014), section 4.
//!
//! With an error e(N) = c N^(−p) of N pieces, p = log(e(N₁)/e(N₂)) / log(N₂/N₁) between two numbers of pieces. A
//! scene has a p of its own where the transfer function does; where it jumps, the place of the jump is known to
//! a piece only. A floor is left whatever N by the rounding of 32 bits and of the reference, and by an order of segments that is
//! not exact. It is taken to be independent of the rest, so that squares add up: p is that of √(e² − floor²). Errors near the
//! floor tell nothing and are left out.
//!
//! Refinement of the grid, which separates the two errors of a picture: that of the integration, and that of taking the
//! data as linear in each cell.
//!
//! Each tetrahedron is cut in eight. With values linear between the coarse points the field stays what it is, and so does
//! the exact picture: what changes is the integration, whose order over the size of cells is observed. With values that the
//! data would have between the points (from the source, where it is a function; else by cubic Hermite interpolation along
//! each edge from the gradients at its ends) the exact picture changes: by what the linear model leaves out.

use crate::work_precision::errors::errors;
use crate::work_precision::{Reference, RenderConfig, RendererVariant, Subject};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;
use voltet_core::field::{LeastSquares, Method};
use voltet_core::grid::{Array, Grid};
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, SharedSlice};
use voltet_integrators::{riemann, segments};
use voltet_optics::engine::{AdapterRequest, RenderOptions};
use voltet_optics::integrators::Integrator;

/// Errors under this many times the floor are left out: the floor is then more than a quarter of what the square of the error
/// holds, and what is left after it little more than a guess.
const ABOVE_FLOOR: f64 = 2.0;

/// Number of of the finest levels the observed order is taken over: coarser ones are not yet on the slope.
const LEVELS: usize = 4;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    pub integrator: &'static str,
    pub engine: String,
    /// For each number of pieces the error, and the order between the number before and this one.
    pub levels: Vec<Level>,
    /// The root-mean-square error that no number of pieces gets under.
    pub floor: f64,
    /// The slope of the last four levels above the floor, by least squares; `None` for fewer than two.
    pub observed: Option<f64>,
    pub expected: f64,
    pub reason: &'static str,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Level {
    pub count: usize,
    /// The root-mean-square error.
    pub error: f64,
    /// Error less the floor; 0 where it is under that.
    pub own_error: f64,
    pub order: Option<f64>,
    /// True if the error is above the floor, so that it tells something.
    pub above_floor: bool,
}

/// The convergence, on the native engine, over (N, error) in rising N. `floor`: the error that no N gets under.
pub fn convergence(
    integrator: &'static str,
    errors: &[(usize, f64)],
    floor: f64,
    transfer_function: &TransferFunction,
) -> Convergence {
    let mut levels: Vec<Level> = Vec::with_capacity(errors.len());
    for &(count, error) in errors {
        let above_floor = error > ABOVE_FLOOR * floor && error.is_finite();
        let own_error = (error * error - floor * floor).max(0.0).sqrt();
        let order = levels
            .last()
            .filter(|last| above_floor && last.above_floor)
            .map(|last| (last.own_error / own_error).ln() / (count as f64 / last.count as f64).ln());
        levels.push(Level { count, error, own_error, order, above_floor });
    }
    let telling: Vec<[f64; 2]> = levels
        .iter()
        .filter(|level| level.above_floor)
        .map(|level| [(level.count as f64).ln(), level.own_error.ln()])
        .collect();
    let observed = slope(&telling[telling.len().saturating_sub(LEVELS)..]).map(|slope| -slope);
    let (expected, reason) = expected(transfer_function);
    let engine = RendererVariant::NATIVE.label();
    Convergence { integrator, engine, levels, floor, observed, expected, reason }
}

/// The slope of the straight line through the points, by least squares; `None` for fewer than two.
fn slope(points: &[[f64; 2]]) -> Option<f64> {
    if points.len() < 2 {
        return None;
    }
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let sum = |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>();
    Some(sum(&|p| (p[0] - x) * (p[1] - y)) / sum(&|p| (p[0] - x).powi(2)))
}

/// The order of sampling at the middles of pieces, and of pieces linear between samples: both are of second order
/// for a function with a bounded second derivative or corners, of first order where it jumps.
fn expected(transfer_function: &TransferFunction) -> (f64, &'static str) {
    let mut widgets = transfer_function.widgets.iter();
    let cut = widgets.any(|widget| widget.region.is_some() || widget.profile.properties().jumps);
    let glow = matches!(transfer_function.model, OpticalModel::ConstantEmitter { .. });
    match (cut, glow) {
        (true, _) => (1.0, "a widget jumps at an edge, whose place is known to a piece"),
        (_, true) => (1.0, "a glow begins at once, and its place is known to a piece"),
        _ => (2.0, "the widgets are continuous"),
    }
}

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
    let exact = RenderConfig::native(Integrator::ANALYTIC);
    let tried = [
        ("riemann, 4 samples", RenderConfig::native(riemann(4))),
        ("segments, 1 piece", RenderConfig::native(segments(1, 256))),
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
///
/// With e the edge from a to b, the cubic through both values and slopes has at its middle the value
/// (s_a + s_b)/2 + e·(∇s_a − ∇s_b)/8 and along e the slope 3 (s_b − s_a)/2 − e·(∇s_a + ∇s_b)/4; across it the mean of both
/// slopes is taken.
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
    let Volume { grid, scalar, gradient, gradient_magnitude } = volume;
    let at = |p: usize| {
        let slope = gradient.as_ref().map_or(DVec3::ZERO, |slopes| slopes[p]);
        (scalar[p], slope, gradient_magnitude.as_ref().map_or(0.0, |g| g[p]))
    };
    let values = refined.values(at, |a, b| {
        let ((s_a, slope_a, g_a), (s_b, slope_b, g_b)) = (at(a), at(b));
        let (mean, slope) = (0.5 * (s_a + s_b), 0.5 * (slope_a + slope_b));
        let edge = grid.points[b] - grid.points[a];
        let (value, slope) = match source {
            None => return (mean, slope, 0.5 * (g_a + g_b)),
            Some(Source::Function(function)) => function(grid.points[a] + 0.5 * edge),
            Some(Source::Gradients) => {
                let along = 1.5 * (s_b - s_a) - 0.5 * edge.dot(slope);
                let square = edge.length_squared();
                let turn = if square > 0.0 { (along - edge.dot(slope)) / square } else { 0.0 };
                (mean + edge.dot(slope_a - slope_b) / 8.0, slope + edge * turn)
            }
        };
        (value, slope, slope.length())
    });
    Ok(Volume {
        scalar: values.iter().map(|value| value.0).collect(),
        gradient: gradient.as_ref().map(|_| values.iter().map(|value| value.1).collect()),
        gradient_magnitude: gradient_magnitude.as_ref().map(|_| values.iter().map(|value| value.2).collect()),
        grid: Arc::new(refined.grid),
    })
}

/// A refined grid: points and tetrahedra alone, no values.
#[derive(Debug, Clone)]
struct RefinedGrid {
    /// The points of the coarse grid, then one in the middle of each edge; eight tetrahedra for each coarse one.
    grid: Grid,
    /// The coarse points between which each further point lies.
    ends: Vec<[u32; 2]>,
}

impl RefinedGrid {
    /// Values at the points of the refined grid: those `at` the coarse points, and what `middle` makes of the two ends of
    /// each edge.
    fn values<T: Send>(
        &self,
        at: impl Fn(usize) -> T + Sync + Send,
        middle: impl Fn(usize, usize) -> T + Sync + Send,
    ) -> Vec<T> {
        let count = self.grid.points.len() - self.ends.len();
        let further = self.ends.par_iter().map(|[a, b]| middle(*a as usize, *b as usize));
        (0..count).into_par_iter().map(at).chain(further).collect()
    }
}

/// The edges of a tetrahedron, by its corners.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The corners' tetrahedra: a corner and the middles of its edges, by their places in [`EDGES`].
const CORNERS: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 4], [1, 3, 5], [2, 4, 5]];

/// Opposite edges, whose middles span a diagonal of the octahedron, with the ring of middles around it.
const DIAGONALS: [([usize; 2], [usize; 4]); 3] =
    [([0, 5], [1, 2, 4, 3]), ([1, 4], [0, 2, 5, 3]), ([2, 3], [0, 1, 5, 4])];

/// Cuts every tetrahedron in eight: four at the corners, and four around a diagonal of the octahedron that they leave (Bey, "Tetrahedral
/// Grid Refinement", 1995). Every face is cut in four by the middles of its edges, so neighbours match whatever the diagonal; the
/// shortest one is taken, which keeps cells from getting thin.
///
/// Errors: more points or tetrahedra than 32 bits count.
fn refine(grid: &Grid) -> Result<RefinedGrid> {
    let key = |cell: &[u32; 4], [a, b]: [usize; 2]| {
        let (low, high) = (cell[a].min(cell[b]), cell[a].max(cell[b]));
        u64::from(low) << 32 | u64::from(high)
    };
    let mut edges: Vec<u64> =
        grid.tetrahedra.par_iter().flat_map_iter(|cell| EDGES.map(|edge| key(cell, edge))).collect();
    edges.par_sort_unstable();
    edges.dedup();
    let (point_count, cell_count) = (grid.points.len() + edges.len(), 8 * grid.tetrahedra.len());
    if u32::try_from(point_count).is_err() || u32::try_from(cell_count).is_err() {
        return Err(Error::run("the grid has too many cells to be refined")
            .got(format!("{point_count} points and {cell_count} cells"))
            .expected(format!("at most {} of either", u32::MAX)));
    }
    let ends: Vec<[u32; 2]> = edges.par_iter().map(|&key| [(key >> 32) as u32, key as u32]).collect();
    let further = ends.par_iter().map(|ends| {
        let [a, b] = ends.map(|p| grid.points[p as usize]);
        a + 0.5 * (b - a)
    });
    let points: Vec<DVec3> = grid.points.par_iter().copied().chain(further).collect();
    let first = grid.points.len() as u32;
    let tetrahedra: Vec<[u32; 4]> = grid
        .tetrahedra
        .par_iter()
        .flat_map_iter(|cell| {
            // Every edge is in the list.
            let middle = EDGES.map(|edge| first + edges.partition_point(|&k| k < key(cell, edge)) as u32);
            eight(cell, &middle, &points)
        })
        .collect();
    let grid = Grid {
        points: SharedSlice::from(points),
        tetrahedra: SharedSlice::from(tetrahedra),
        ..Grid::default()
    };
    Ok(RefinedGrid { grid, ends })
}

/// The parts of a cell.
fn eight(cell: &[u32; 4], middle: &[u32; 6], points: &[DVec3]) -> [[u32; 4]; 8] {
    let length = |&([a, b], _): &([usize; 2], [usize; 4])| {
        points[middle[a] as usize].distance_squared(points[middle[b] as usize])
    };
    let shortest = DIAGONALS.iter().min_by(|a, b| length(a).total_cmp(&length(b)));
    let ([a, b], ring) = shortest.unwrap_or(&DIAGONALS[0]);
    let mut parts = [[0; 4]; 8];
    for (k, edges) in CORNERS.iter().enumerate() {
        parts[k] = [cell[k], middle[edges[0]], middle[edges[1]], middle[edges[2]]];
    }
    for k in 0..4 {
        parts[4 + k] = [middle[*a], middle[*b], middle[ring[k]], middle[ring[(k + 1) % 4]]];
    }
    parts.iter_mut().for_each(|part| part.sort_unstable());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;
    use voltet_core::grid::generate::box_of_tetrahedra;
    use voltet_core::grid::tetrahedron_volume;

    fn smooth() -> TransferFunction {
        TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: 1.0,
            widgets: Vec::new(),
            axes: Default::default(),
        }
    }

    #[test]
    fn a_power_law_gives_its_own_power_down_to_the_floor() {
        // e = 0.3 N^−2 beside a floor of 4e-4, twice which is reached between 16 and 32.
        let floor = 4e-4;
        let errors: Vec<(usize, f64)> =
            [1, 2, 4, 8, 16, 32, 64].map(|n: usize| (n, (0.3 / (n * n) as f64).hypot(floor))).to_vec();
        let found = convergence("riemann", &errors, floor, &smooth());
        // Rounding of squares and logarithms.
        assert!((found.observed.unwrap() - 2.0).abs() < 1e-11, "{found:?}");
        assert_eq!(found.levels[0].order, None);
        assert!((found.levels[4].order.unwrap() - 2.0).abs() < 1e-11);
        assert_eq!((found.levels[5].order, found.levels[5].above_floor), (None, false));
        assert_eq!(found.expected, 2.0);
    }

    #[test]
    fn only_the_finest_levels_count_and_one_says_nothing() {
        // First order, but for the two coarsest levels, which are too good.
        let errors = [(1, 0.01), (2, 0.02), (4, 0.25), (8, 0.125), (16, 0.0625), (32, 0.03125)];
        let found = convergence("segments", &errors, 0.0, &smooth());
        assert!((found.observed.unwrap() - 1.0).abs() < 1e-12, "{found:?}");
        assert_eq!(convergence("segments", &errors[..1], 0.0, &smooth()).observed, None);
        assert_eq!(convergence("segments", &errors, 1.0, &smooth()).observed, None);
    }

    #[test]
    fn jumps_make_it_first_order() {
        use voltet_core::transfer::{Profile, Region, Wave, Widget};
        let profile = Profile::Gaussian { centre: [0.0; 2], matrix: [[1.0, 0.0], [0.0, 0.0]] };
        let widget = Widget { profile, color: [1.0; 3], extinction: 1.0, region: None };
        let of = |widget: Widget| expected(&TransferFunction { widgets: vec![widget], ..smooth() }).0;
        assert_eq!(of(widget.clone()), 2.0);
        let region = Some(Region::rectangle([0.0, 1.0], [0.0, 1.0]));
        assert_eq!(of(Widget { region, ..widget.clone() }), 1.0);
        let wave = Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period: 1.0, band_width: 0.5 };
        assert_eq!(of(Widget { profile: Profile::SineWave(wave), ..widget }), 1.0);
        let model = OpticalModel::ConstantEmitter { cutoff: 0.1 };
        assert_eq!(expected(&TransferFunction { model, ..smooth() }).0, 1.0);
    }

    #[test]
    fn eight_parts_fill_each_cell_and_neighbours_match() {
        let coarse = box_of_tetrahedra([2, 3, 2], [DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5)], 0.2);
        let refined = refine(&refine(&coarse).unwrap().grid).unwrap();
        let grid = &refined.grid;
        assert_eq!(grid.tetrahedra.len(), 64 * coarse.tetrahedra.len());
        let volume = |grid: &Grid| -> f64 {
            (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i))).sum()
        };
        // A sum of some thousand roundings.
        assert!((volume(grid) - volume(&coarse)).abs() < 1e-12);
        let least = (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i)));
        assert!(least.fold(f64::INFINITY, f64::min) > 0.0);
        assert!(grid.tetrahedra.iter().all(|cell| cell.is_sorted()));
        // Every face belongs to two cells, but for those on the six sides of the box, which are 16 times as many.
        let on_sides = |grid: &Grid| {
            let mut faces: HashMap<[u32; 3], usize> = HashMap::new();
            for cell in grid.tetrahedra.iter() {
                for out in 0..4 {
                    let face: Vec<u32> = (0..4).filter(|&k| k != out).map(|k| cell[k]).collect();
                    *faces.entry([face[0], face[1], face[2]]).or_default() += 1;
                }
            }
            assert!(faces.values().all(|&count| count <= 2));
            faces.values().filter(|&&count| count == 1).count()
        };
        assert_eq!(on_sides(grid), 16 * on_sides(&coarse));
    }

    #[test]
    fn a_linear_field_stays_itself() {
        let coarse = box_of_tetrahedra([2, 2, 2], [DVec3::ZERO, DVec3::ONE], 0.2);
        let field = |p: &DVec3| 1.0 + 2.0 * p.x - p.y + 0.5 * p.z;
        let values: Vec<f64> = coarse.points.iter().map(field).collect();
        let refined = refine(&coarse).unwrap();
        let values = refined.values(|p| values[p], |a, b| 0.5 * (values[a] + values[b]));
        for (point, value) in refined.grid.points.iter().zip(values) {
            assert!((field(point) - value).abs() < 1e-14);
        }
    }
}
