//! Measurements of a filter: errors on finer and finer grids, exactness, two materials, invariance, noise, time and memory, a picture.

use super::manufactured::{
    Field, JUMP, LINEAR, MATERIALS, MEETING, Mesh, Meshed, QUADRATIC, SMOOTH, coincident_pairs, out_of_axes,
};
use super::report::{
    Convergence, Cost, DataError, Exactness, Fault, FilterReport, Invariance, Materials, Noise, PictureError,
    Series,
};
use crate::work_precision;
use glam::DVec3;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::camera::{Camera, Projection};
use voltet_core::error::ErrorKind;
use voltet_core::field::{Fallback, Method, magnitude};
use voltet_core::grid::Grid;
use voltet_core::grid::generate::{Random, sample};
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_core::{Result, SharedSlice};
use voltet_io::{encode, memory};
use voltet_nodes::drawing::NATIVE;
use voltet_optics::WidgetBlend;
use voltet_optics::engine::{AdapterRequest, Engine, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};

pub(super) struct Subject<'a> {
    method: &'a Method,
    pub found: FilterReport,
    progress: &'a dyn Progress,
    /// Called after each piece of work, with its stage.
    step: &'a dyn Fn(&str),
}

impl<'a> Subject<'a> {
    pub fn new(method: &'a Method, progress: &'a dyn Progress, step: &'a dyn Fn(&str)) -> Subject<'a> {
        let declared = method.declaration();
        let parameters = method.parameters().iter().map(|(parameter, setting, _)| {
            let value = setting.map_or_else(|| parameter.default.to_string(), |it| it.datum.to_string());
            (parameter.name.to_string(), value)
        });
        let (name, summary) = (declared.name.into(), declared.summary.into());
        let found =
            FilterReport { name, summary, parameters: parameters.collect(), ..FilterReport::default() };
        Subject { method, found, progress, step }
    }

    fn done(&self) {
        (self.step)(&self.found.name);
    }

    /// ∇s at the points; `None` where the filter fails, which is noted. `at`: while what is measured.
    ///
    /// Errors: a stopped run.
    fn gradient(
        &mut self,
        at: impl FnOnce() -> String,
        grid: &Grid,
        s: &[f64],
    ) -> Result<Option<Vec<DVec3>>> {
        let note = |what: String, failed| self.found.faults.push(Fault { at: at(), what, failed });
        match self.method.gradient(grid, s, &CancelOnly(self.progress)) {
            Err(error) if error.kind == ErrorKind::Cancelled => Err(error),
            Err(error) => {
                note(error.to_string(), true);
                Ok(None)
            }
            Ok(gradient) if gradient.fallbacks.is_empty() => Ok(Some(gradient.vectors)),
            Ok(gradient) => {
                let each = gradient.fallbacks.iter().map(Fallback::to_string);
                note(each.collect::<Vec<_>>().join("; "), false);
                Ok(Some(gradient.vectors))
            }
        }
    }

    /// Everything but costs and pictures.
    pub fn measure(&mut self, levels: &[usize]) -> Result<()> {
        self.convergence(levels)?;
        self.exactness()?;
        self.materials(levels)?;
        self.invariance()?;
        self.noise()
    }

    /// Orders of every smooth field on every family of grids.
    fn convergence(&mut self, levels: &[usize]) -> Result<()> {
        for mesh in Mesh::ALL {
            let mut series = SMOOTH.map(|_| [Series::default(), Series::default()]);
            for &count in levels {
                let meshed = mesh.grid(count);
                for (field, series) in SMOOTH.iter().zip(&mut series) {
                    let Some(errors) = self.errors(mesh, &meshed, field)? else { continue };
                    for (series, [root_mean_square, maximum]) in series.iter_mut().zip(errors) {
                        series.root_mean_square.push(root_mean_square);
                        series.maximum.push(maximum);
                    }
                }
                self.done();
            }
            for (field, mut series) in SMOOTH.iter().zip(series) {
                // It failed somewhere, which is noted.
                if series[0].root_mean_square.len() == levels.len() {
                    series.iter_mut().for_each(|one| one.order = order(&one.root_mean_square, levels));
                    let [inside, boundary] = series;
                    let (mesh, field) = (mesh.name(), field.name);
                    self.found.convergence.push(Convergence { mesh, field, inside, boundary });
                }
            }
        }
        Ok(())
    }

    /// Root mean square and largest error inside and on the boundary, by the root mean square of the exact gradient.
    fn errors(&mut self, mesh: Mesh, meshed: &Meshed, field: &Field) -> Result<Option<[[f64; 2]; 2]>> {
        let grid = &meshed.grid;
        let at = || format!("{} on the {} grid of {} points", field.name, mesh.name(), grid.points.len());
        let exact = sample(grid, field.gradient);
        let Some(found) = self.gradient(at, grid, &sample(grid, field.value))? else { return Ok(None) };
        let [scale, _] = sizes(exact.iter().map(|v| v.length()));
        Ok(Some([false, true].map(|boundary| {
            let pairs = found.iter().zip(&exact).zip(&meshed.at_boundary).filter(|(_, at)| **at == boundary);
            sizes(pairs.map(|((a, b), _)| (*a - *b).length() / scale))
        })))
    }

    /// Errors on a linear and a quadratic field.
    fn exactness(&mut self) -> Result<()> {
        const COUNT: usize = 8;
        for mesh in Mesh::EXACT {
            let meshed = mesh.grid(COUNT);
            let linear = self.largest_errors(mesh, &meshed, &LINEAR)?;
            let quadratic = self.largest_errors(mesh, &meshed, &QUADRATIC)?;
            self.done();
            if let (Some([inside, boundary]), Some([quadratic_inside, quadratic_boundary])) =
                (linear, quadratic)
            {
                let (mesh, linear) = (mesh.name(), inside.max(boundary));
                self.found.exactness.push(Exactness { mesh, linear, quadratic_inside, quadratic_boundary });
            }
        }
        Ok(())
    }

    /// The largest error inside and on the boundary, by the largest gradient.
    fn largest_errors(&mut self, mesh: Mesh, meshed: &Meshed, field: &Field) -> Result<Option<[f64; 2]>> {
        let errors = self.errors(mesh, meshed, field)?;
        let [scale, most] = sizes(meshed.grid.points.iter().map(|&p| (field.gradient)(p).length()));
        Ok(errors.map(|each| each.map(|[_, maximum]| maximum * scale / most)))
    }

    /// Two materials that meet in a plane of the regular grid.
    fn materials(&mut self, levels: &[usize]) -> Result<()> {
        /// Cells on either side of the meeting of materials that are not asked to converge.
        const NEAR: usize = 2;
        /// Share of the jump from which an error counts as reached by it.
        const NOTICED: f64 = 0.01;
        let mut found = Materials { beyond: Vec::new(), order: None, reach: 0, overshoot: 0.0 };
        for &count in levels {
            // The plane is one of the grid's.
            let count = count + count % 2;
            let Meshed { grid, .. } = Mesh::Regular.grid(count);
            let at = || format!("two materials on the regular grid of {} points", grid.points.len());
            let Some(vectors) = self.gradient(at, &grid, &sample(&grid, MATERIALS.value))? else {
                return Ok(());
            };
            let cells_off = |p: DVec3| ((p.x - MEETING) * count as f64).abs().round() as usize;
            let error = |(p, v): (&DVec3, &DVec3)| (*v - (MATERIALS.gradient)(*p)).length() / JUMP;
            let pairs = || grid.points.iter().zip(&vectors);
            found.beyond.push(pairs().filter(|(p, _)| cells_off(**p) > NEAR).map(error).fold(0.0, f64::max));
            // Those of the finest stay. In the plane itself either slope is right.
            let far = pairs().filter(|(p, _)| cells_off(**p) > 0).filter(|pair| error(*pair) > NOTICED);
            found.reach = far.map(|(p, _)| cells_off(*p)).max().unwrap_or(0);
            let beyond = |v: &DVec3| (v.x - (1.0 + JUMP)).max(1.0 - v.x).max(0.0) / JUMP;
            found.overshoot = vectors.iter().map(beyond).fold(0.0, f64::max);
            self.done();
        }
        found.order = order(&found.beyond, levels);
        self.found.materials = Some(found);
        Ok(())
    }

    /// Differences after changes without effect on a gradient (position, orientation, size and numbering of the grid, offset and unit of the
    /// scalar), brought back; all relative to the largest gradient.
    fn invariance(&mut self) -> Result<()> {
        const COUNT: usize = 8;
        /// Offset of the grid, in its own sides.
        const FAR: DVec3 = DVec3::new(1000.3, -2000.7, 500.1);
        const LARGER: f64 = 1e4;
        /// Offset of the scalar, in its own ranges.
        const ADDED: f64 = 1e4;
        const TIMES: f64 = -1e-6;
        /// Roundings that a reconstruction may take one after the other, with the condition of its matrices.
        const ROUNDINGS: f64 = 300.0;
        let grid = Mesh::Distorted.grid(COUNT).grid;
        let scalar = sample(&grid, SMOOTH[0].value);
        let usual = self.gradient(|| "the grid of invariance".into(), &grid, &scalar)?;
        let Some(usual) = usual else { return Ok(()) };
        let [_, scale] = sizes(usual.iter().map(|v| v.length()));
        let [_, reach] = sizes(FAR.to_array().into_iter());
        let moved =
            |place: &dyn Fn(DVec3) -> DVec3| Grid { points: sample(&grid, place).into(), ..grid.clone() };
        let with = |change: &dyn Fn(f64) -> f64| scalar.iter().map(|&s| change(s)).collect::<Vec<f64>>();
        let (turn, spacing) = (out_of_axes(), 1.0 / COUNT as f64);
        let numbering = Numbering::new(&grid);
        let renumbered = numbering.to.iter().map(|&old| scalar[old]).collect();
        // What was changed, the grid and the scalar afterwards, how a vector is brought back, and what rounding of positions and
        // values by 2⁻⁵³ may make of it over one spacing.
        type Back<'a> = &'a dyn Fn(DVec3) -> DVec3;
        let changes: [(&'static str, Grid, Vec<f64>, Back<'_>, f64); 6] = [
            ("translation", moved(&|p| p + FAR), scalar.clone(), &|v| v, reach / spacing),
            ("rotation", moved(&|p| turn * p), scalar.clone(), &|v| turn.transpose() * v, 1.0 / spacing),
            ("scaling of space", moved(&|p| p * LARGER), scalar.clone(), &|v| v * LARGER, 1.0 / spacing),
            ("a constant added", grid.clone(), with(&|s| s + ADDED), &|v| v, ADDED / spacing),
            ("scaling of the scalar", grid.clone(), with(&|s| s * TIMES), &|v| v / TIMES, 1.0 / spacing),
            ("numbering", numbering.grid.clone(), renumbered, &|v| v, 1.0 / spacing),
        ];
        for (under, grid, scalar, back, loss) in changes {
            let found = self.gradient(|| under.into(), &grid, &scalar)?;
            self.done();
            let Some(mut found) = found else { continue };
            if under == "numbering" {
                found = numbering.back(&found);
            }
            let [_, difference] =
                sizes(found.iter().zip(&usual).map(|(v, w)| (back(*v) - *w).length() / scale));
            let rounding = ROUNDINGS * f64::EPSILON * loss;
            self.found.invariance.push(Invariance { under, difference, rounding });
        }
        Ok(())
    }

    /// Gradients of noise (independent, of variance 1 at every point), by the spacing along the axes before the grid is deformed.
    fn noise(&mut self) -> Result<()> {
        const COUNT: usize = 16;
        for mesh in [Mesh::Regular, Mesh::Distorted] {
            let Meshed { grid, at_boundary } = mesh.grid(COUNT);
            let mut random = Random(0x2545_F491_4F6C_DD1D);
            // Uniform, of variance 1.
            let values: Vec<f64> =
                grid.points.iter().map(|_| (2.0 * random.next() - 1.0) * 3f64.sqrt()).collect();
            let found = self.gradient(|| format!("noise on the {} grid", mesh.name()), &grid, &values)?;
            self.done();
            let Some(found) = found else { continue };
            let [inside, boundary] = [false, true].map(|boundary| {
                let there = found.iter().zip(&at_boundary).filter(|(_, at)| **at == boundary);
                sizes(there.map(|(v, _)| v.length()))[0] / COUNT as f64
            });
            self.found.noise.push(Noise { mesh: mesh.name(), inside, boundary });
        }
        Ok(())
    }
}

/// The largest error on a linear field of slope (1.7, −0.9, 0.6), by that slope, at the points of cells.
fn linear_error(found: &[DVec3], grid: &Grid) -> f64 {
    let slope = (LINEAR.gradient)(DVec3::ZERO);
    let used = grid.tetrahedra.as_flattened().iter();
    used.map(|&p| (found[p as usize] - slope).length()).fold(0.0, f64::max) / slope.length()
}

/// Measures all filters on the user's own grid: finite, and exact on linear fields. The field is in units of the grid's size, so that
/// rounding is that of the families.
pub(super) fn on_data(subjects: &mut [Subject<'_>], grid: &Grid) -> Result<()> {
    let used = || grid.tetrahedra.as_flattened().iter().map(|&p| grid.points[p as usize]);
    let low = used().fold(DVec3::INFINITY, DVec3::min);
    let size = (used().fold(DVec3::NEG_INFINITY, DVec3::max) - low).max_element();
    let place = |p: DVec3| (p - low) / size;
    let unit = Grid { points: sample(grid, place).into(), ..grid.clone() };
    // Points that no cell uses may not be finite.
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    let values = sample(&unit, |p| finite((LINEAR.value)(p)));
    let coincident_pairs = coincident_pairs(&unit);
    for subject in subjects {
        let at = || format!("linear on the given grid of {} points", unit.points.len());
        if let Some(found) = subject.gradient(at, &unit, &values)? {
            let (points, linear) = (unit.points.len(), linear_error(&found, &unit));
            subject.found.data = Some(DataError { points, coincident_pairs, linear });
        }
        (subject.step)("data");
    }
    Ok(())
}

/// Root of the mean square of lengths and the largest of them.
fn sizes(lengths: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut sum, mut most, mut count) = (0.0, 0.0f64, 0usize);
    for length in lengths {
        (sum, most, count) = (sum + length * length, most.max(length), count + 1);
    }
    [(sum / count.max(1) as f64).sqrt(), most]
}

/// log(e₁/e₂) / log(n₂/n₁) of the two finest; `None` below what rounding leaves.
fn order(errors: &[f64], levels: &[usize]) -> Option<f64> {
    /// Relative errors of gradients below this are rounding: of differences of values, over short edges.
    const ROUNDING: f64 = 1e-10;
    let [.., coarse, fine] = *errors else { return None };
    let [.., few, many] = *levels else { return None };
    (coarse.min(fine) > ROUNDING).then(|| (coarse / fine).ln() / (many as f64 / few as f64).ln())
}

/// Grid with its points and cells in another order, and the corners of cells turned.
struct Numbering {
    grid: Grid,
    /// The old number of each new point.
    to: Vec<usize>,
}

impl Numbering {
    fn new(grid: &Grid) -> Numbering {
        let mut random = Random(0x5DEE_CE66_D1CE_5EED);
        let mut shuffled = |count: usize| {
            let mut order: Vec<usize> = (0..count).collect();
            (1..count).rev().for_each(|k| order.swap(k, (random.next() * (k + 1) as f64) as usize));
            order
        };
        let (to, cells) = (shuffled(grid.points.len()), shuffled(grid.tetrahedra.len()));
        let mut from = vec![0u32; to.len()];
        to.iter().enumerate().for_each(|(new, &old)| from[old] = new as u32);
        // A cyclic change of three corners keeps a cell's handedness.
        let turned = |[a, b, c, d]: [u32; 4]| [b, c, a, d].map(|p| from[p as usize]);
        let tetrahedra = cells.iter().map(|&cell| turned(grid.tetrahedra[cell])).collect();
        let points = to.iter().map(|&old| grid.points[old]).collect();
        let grid = Grid { points, tetrahedra, ..grid.clone() };
        Numbering { grid, to }
    }

    fn back(&self, vectors: &[DVec3]) -> Vec<DVec3> {
        let mut found = vec![DVec3::ZERO; vectors.len()];
        self.to.iter().zip(vectors).for_each(|(&old, &v)| found[old] = v);
        found
    }
}

/// Measures time and memory of all filters on one large grid, which take turns: `rounds` times each after one that warms up.
pub(super) fn costs(subjects: &mut [Subject<'_>], count: usize, rounds: usize) -> Result<()> {
    let grid = Mesh::Distorted.grid(count).grid;
    // The first run warms up and shows whether what holds on small grids holds here.
    let (linear, smooth) = (sample(&grid, LINEAR.value), sample(&grid, SMOOTH[0].value));
    let mut linear_errors = vec![f64::NAN; subjects.len()];
    let mut seconds = vec![Vec::with_capacity(rounds); subjects.len()];
    let mut most: Vec<Option<u64>> = vec![None; subjects.len()];
    for round in 0..=rounds {
        for (k, subject) in subjects.iter_mut().enumerate() {
            let before = memory::forget_peak().then(memory::peak).flatten();
            let at = || format!("the grid of {} points that is timed", grid.points.len());
            let faults = subject.found.faults.len();
            let begun = Instant::now();
            let found = subject.gradient(at, &grid, if round == 0 { &linear } else { &smooth })?;
            let taken = begun.elapsed().as_secs_f64();
            let peak = memory::peak().zip(before).map(|(peak, before)| peak.saturating_sub(before));
            if round > 0 {
                // Faults are noted once.
                subject.found.faults.truncate(faults);
                seconds[k].extend(found.map(|_| taken));
            } else if let Some(found) = found {
                linear_errors[k] = linear_error(&found, &grid);
            }
            // The first takes memory that the later ones have.
            most[k] = most[k].max(peak);
            (subject.step)("time");
        }
    }
    let measured = subjects.iter_mut().zip(seconds).zip(most).zip(linear_errors);
    for (((subject, mut seconds), memory_bytes), linear_error) in measured {
        seconds.sort_by(f64::total_cmp);
        let (Some(&fastest_s), Some(&slowest_s)) = (seconds.first(), seconds.last()) else { continue };
        let (points, tetrahedra) = (grid.points.len(), grid.tetrahedra.len());
        let median_s = seconds[seconds.len() / 2];
        subject.found.cost =
            Some(Cost { points, tetrahedra, median_s, fastest_s, slowest_s, linear_error, memory_bytes });
    }
    Ok(())
}

/// Renderer of a scene whose widgets look at the gradient magnitude and whose light looks at the gradient.
pub(super) struct TestRenderer<'a> {
    pub engine: Arc<dyn Engine>,
    grid: Arc<Grid>,
    exact: Picture,
    progress: &'a dyn Progress,
}

const SIZE: [u32; 2] = [256, 256];
const FIELD: Field = SMOOTH[1];
const PAPER: [f64; 3] = [1.0; 3];

impl TestRenderer<'_> {
    /// Draws with the exact gradient.
    pub fn new(progress: &dyn Progress) -> Result<TestRenderer<'_>> {
        // Coarse, as data is where boundaries count.
        let grid = Arc::new(Mesh::Distorted.grid(16).grid);
        let engine = NATIVE.open(&AdapterRequest::hardware(None))?;
        let mut renderer = TestRenderer { engine, grid, exact: Picture::transparent(0, 0), progress };
        renderer.exact = renderer.draw(sample(&renderer.grid, FIELD.gradient))?;
        Ok(renderer)
    }

    /// The picture with the exact gradient, PNG.
    pub fn exact_png(&self) -> Result<Vec<u8>> {
        encode::png(&self.exact, PAPER, None)
    }

    /// Draws with the filter's gradient and compares.
    pub fn compare(&self, subject: &mut Subject<'_>) -> Result<()> {
        let values = sample(&self.grid, FIELD.value);
        if let Some(gradient) = subject.gradient(|| "the picture".into(), &self.grid, &values)? {
            let picture = self.draw(gradient)?;
            let errors = work_precision::errors(&picture, &self.exact);
            subject.found.picture = Some(PictureError {
                size: SIZE,
                maximum: errors.maximum,
                root_mean_square: errors.root_mean_square,
                pixels_over_step: errors.pixels_over_step,
                png: encode::png(&picture, PAPER, None)?,
            });
        }
        (subject.step)("picture");
        Ok(())
    }

    fn draw(&self, gradient: Vec<DVec3>) -> Result<Picture> {
        let volume = Arc::new(Volume {
            grid: self.grid.clone(),
            scalar: SharedSlice::from(sample(&self.grid, FIELD.value)),
            gradient_magnitude: Some(SharedSlice::from(magnitude(&gradient))),
            gradient: Some(SharedSlice::from(gradient)),
        });
        // The steep flank of the peak, and its summit, which is flat: only g tells them from what has the same s elsewhere.
        let gaussian = |centre, widths: [f64; 2], extinction, color| {
            let matrix = [[1.0 / widths[0], 0.0], [0.0, 1.0 / widths[1]]];
            Widget { profile: Profile::Gaussian { centre, matrix }, color, extinction, region: None }
        };
        let widgets = vec![
            gaussian([0.6, 2.15], [0.06, 0.25], 12.0, [0.15, 0.45, 0.9]),
            gaussian([1.0, 0.0], [0.08, 0.6], 20.0, [0.95, 0.45, 0.1]),
        ];
        let model = OpticalModel::DensityEmitter;
        let light = Light { ambient: 0.4, diffuse: 0.6, direction: DVec3::new(-1.0, -1.5, 2.0).normalize() };
        let scene = Scene::new(
            volume.clone(),
            Arc::new(TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() }),
            Camera {
                eye: DVec3::new(1.7, -1.3, 1.5),
                target: DVec3::new(0.46, 0.54, 0.55),
                up: DVec3::Z,
                projection: Projection::Perspective { fov_y: 32.0 },
                near: 0.0,
                size: SIZE,
                samples: 1,
            },
            Shading {
                integrator: Integrator::ANALYTIC,
                overlap: WidgetBlend::Exact,
                silhouette: None,
                light: Some(light),
            },
            VisibilityOrder::Exact,
        );
        let prepared = self.engine.prepare(&volume)?;
        Ok(prepared.draw(&scene, &RenderOptions::default(), &CancelOnly(self.progress))?.picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_those_of_power_laws() {
        let levels = [4, 8, 16];
        let errors = |p: i32| levels.map(|n| 3.0 * f64::from(n as i32).powi(-p));
        for p in [1, 2, 3] {
            let found = order(&errors(p), &levels).unwrap_or(f64::NAN);
            assert!((found - f64::from(p)).abs() < 1e-12, "{found} for {p}");
        }
        assert_eq!(order(&[1e-3, 1e-14], &[4, 8]), None);
        assert_eq!(order(&[1e-3], &[4]), None);
    }

    #[test]
    fn sizes_of_nothing_are_zero() {
        assert_eq!(sizes(std::iter::empty()), [0.0; 2]);
        assert_eq!(sizes([3.0, 4.0].into_iter()), [12.5f64.sqrt(), 4.0]);
    }

    #[test]
    fn another_numbering_is_the_same_grid() {
        let grid = Mesh::Distorted.grid(3).grid;
        let other = Numbering::new(&grid);
        assert_ne!(other.grid.points, grid.points);
        assert_eq!(other.back(&other.grid.points), *grid.points);
        let volume = |grid: &Grid| -> f64 {
            let corners = |t: &[u32; 4]| t.map(|p| grid.points[p as usize]);
            grid.tetrahedra.iter().map(|t| voltet_core::grid::tetrahedron_volume(corners(t))).sum()
        };
        assert!((volume(&other.grid) - volume(&grid)).abs() < 1e-12);
    }
}
