//! The study itself: setting after setting, and what comes of it.

use super::convergence::{Convergence, convergence};
use super::errors::{Errors, difference, errors};
use super::flip::Seen;
use super::measure::{Cost, Frames, measure};
use super::pareto;
use super::reference::Reference;
use super::refine::{Refinement, Source, refinement};
use super::{Scene, Setting, settings};
use voltet_core::error::ErrorKind;
use voltet_core::optics::Overlap;
use voltet_core::optics::integrators::Integrator;
use voltet_core::progress::Progress;
use voltet_core::shading::Order;
use voltet_core::{Error, Result};
use voltet_nodes::encode;

/// Which of the errors decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// The largest error of a pixel.
    #[default]
    Maximum,
    /// The root of the mean square.
    RootMeanSquare,
    /// What 99.9 % of the pixels are under.
    Percentile,
    /// The mean of FLIP.
    Flip,
}

impl Measure {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Maximum => "max",
            Measure::RootMeanSquare => "rms",
            Measure::Percentile => "p99.9",
            Measure::Flip => "flip",
        }
    }

    /// What it is, as the label of an axis.
    pub fn label(self) -> &'static str {
        match self {
            Measure::Maximum => "largest error of premultiplied linear RGBA (1 = full scale)",
            Measure::RootMeanSquare => "root-mean-square error of premultiplied linear RGBA (1 = full scale)",
            Measure::Percentile => {
                "99.9 percentile of the error of premultiplied linear RGBA (1 = full scale)"
            }
            Measure::Flip => "mean FLIP difference (0 = equal, 1 = largest)",
        }
    }
}

/// What is asked of a study.
#[derive(Debug, Clone)]
pub struct Wish {
    /// Integrators to look at; none for all.
    pub only: Vec<String>,
    /// How often each is drawn.
    pub frames: Frames,
    /// Which error decides about the front and the recommendation.
    pub measure: Measure,
    /// The error that is allowed.
    pub max_error: Option<f64>,
    /// How often the grid is refined, to tell the integration's error from the data model's; 0: not at all.
    pub refine: u32,
}

/// One setting, measured.
#[derive(Debug, Clone)]
pub struct Row {
    /// The setting.
    pub setting: Setting,
    /// What it costs.
    pub cost: Cost,
    /// How wrong it is.
    pub errors: Errors,
    /// The mean of FLIP against the reference.
    pub flip: f64,
    /// Whether nothing is both cheaper and better.
    pub on_front: bool,
    /// Whether the file draws with it.
    pub of_file: bool,
    /// The difference of its picture from the reference, as PNG: see [`difference`].
    pub difference_png: Vec<u8>,
}

/// What came of it.
#[derive(Debug, Clone)]
pub struct Study {
    /// The scene.
    pub scene: Scene,
    /// What was asked for.
    pub wish: Wish,
    /// What the pictures are compared with.
    pub reference: Reference,
    /// The settings that were measured.
    pub rows: Vec<Row>,
    /// How many there are.
    pub setting_count: usize,
    /// The row that costs least under the error allowed.
    pub recommended: Option<usize>,
    /// Orders of convergence of the integrators that were looked at over their numbers of pieces.
    pub convergence: Vec<Convergence>,
    /// What refining the grid shows, where that was asked for.
    pub refinement: Option<Refinement>,
}

impl Row {
    /// The error that decides.
    pub fn error(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Maximum => self.errors.maximum,
            Measure::RootMeanSquare => self.errors.root_mean_square,
            Measure::Percentile => self.errors.percentile_99_9,
            Measure::Flip => self.flip,
        }
    }
}

impl Study {
    /// Whether it was stopped before all that was asked for was measured.
    pub fn stopped(&self) -> bool {
        self.rows.len() < self.setting_count || (self.wish.refine > 0 && self.refinement.is_none())
    }
}

/// Measures every setting. A stop, once the reference is there, keeps the settings that are done; see
/// [`Study::stopped`].
///
/// Errors: integrators asked for that cannot serve the scene; those of drawing.
pub fn study(scene: Scene, wish: Wish, reference: Reference, progress: &dyn Progress) -> Result<Study> {
    let settings = settings(&scene, &wish.only);
    if settings.is_empty() {
        return Err(Error::usage("none of the integrators asked for can serve this scene")
            .found(wish.only.join(", "))
            .accepted("others, or none, for all that can"));
    }
    let seen = Seen::new(&reference.picture, scene.background);
    let whole: f64 = settings.iter().map(Setting::weight).sum();
    let own = scene.setting();
    let mut done = 0.0;
    let mut rows = Vec::new();
    for setting in &settings {
        progress.report(&setting.label(), done / whole);
        match measure(&scene, setting, &wish.frames, progress) {
            Ok((picture, cost)) => rows.push(Row {
                difference_png: encode::png(&difference(&picture, &reference.picture), [0.0; 3])?,
                setting: *setting,
                cost,
                errors: errors(&picture, &reference.picture),
                flip: Seen::new(&picture, scene.background).difference(&seen),
                on_front: false,
                of_file: setting.draws_as(&own),
            }),
            Err(error) if error.kind == ErrorKind::Cancelled => break,
            Err(error) => return Err(error),
        }
        done += setting.weight();
    }
    let mut study = judged(scene, wish, reference, rows, settings.len());
    if study.wish.refine > 0 && study.rows.len() == study.setting_count {
        let Study { scene, reference, wish, .. } = &study;
        study.refinement = match refinement(scene, reference, wish.refine, &Source::Gradients, progress) {
            Ok(found) => Some(found),
            Err(error) if error.kind == ErrorKind::Cancelled => None,
            Err(error) => return Err(error),
        };
    }
    Ok(study)
}

/// Front, recommendation and orders.
fn judged(scene: Scene, wish: Wish, reference: Reference, mut rows: Vec<Row>, setting_count: usize) -> Study {
    let points: Vec<[f64; 2]> =
        rows.iter().map(|row| [row.cost.picture.median_ms, row.error(wish.measure)]).collect();
    for (row, on_front) in rows.iter_mut().zip(pareto::front(&points)) {
        row.on_front = on_front;
    }
    let recommended = wish.max_error.and_then(|bound| pareto::cheapest(&points, bound));
    let convergence =
        ["segments", "riemann"].into_iter().filter_map(|name| converging(name, &rows, &scene)).collect();
    Study { scene, wish, reference, rows, setting_count, recommended, convergence, refinement: None }
}

/// The convergence of an integrator over its number of pieces, with its largest table.
fn converging(name: &'static str, rows: &[Row], scene: &Scene) -> Option<Convergence> {
    let count = |row: &Row| match row.setting.integrator {
        Integrator::Segments { count, table_size: 256 } if name == "segments" => Some(count),
        Integrator::Riemann { count } if name == "riemann" => Some(count),
        _ => None,
    };
    let mut errors: Vec<(usize, f64)> =
        rows.iter().filter_map(|row| Some((count(row)?, row.errors.root_mean_square))).collect();
    errors.sort_unstable_by_key(|level| level.0);
    if errors.len() < 2 {
        return None;
    }
    let exact = |row: &&Row| {
        let closed = matches!(row.setting.integrator, Integrator::Analytic | Integrator::Adaptive { .. });
        closed && row.setting.overlap == Overlap::Exact && row.setting.order == Order::Exact
    };
    let floor =
        rows.iter().filter(exact).map(|row| row.errors.root_mean_square).fold(f64::INFINITY, f64::min);
    // Where no closed form was looked at, single precision is all that is known.
    let floor = if floor.is_finite() { floor } else { f64::from(f32::EPSILON) };
    Some(convergence(name, &errors, floor, &scene.transfer_function))
}
