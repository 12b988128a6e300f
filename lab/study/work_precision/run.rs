//! The study itself: setting after setting, and what comes of it.

use super::convergence::{Convergence, convergence};
use super::errors::{Errors, difference, errors};
use super::flip::PreparedPicture;
use super::measure::Cost;
use super::reference::Reference;
use super::settings::Numbers;
use super::{RenderConfig, RendererVariant, Subject};
use crate::work_precision::convergence::{Refinement, Source, refinement};
use crate::work_precision::measure::{Adapter, Benches};
use crate::work_precision::settings::{Measure, StudyOptions};
use voltet_core::error::ErrorKind;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_integrators::DEFAULT_SIDE;
use voltet_io::encode;
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::Integrator;
use voltet_simd::LaneSet;

#[derive(Debug, Clone)]
pub struct Row {
    pub setting: RenderConfig,
    pub cost: Cost,
    pub errors: Errors,
    /// The mean of FLIP against the reference.
    pub flip: f64,
    /// True if nothing is both cheaper and better.
    pub on_front: bool,
    pub of_file: bool,
    /// The difference of its picture from the reference, as PNG: see [`difference`].
    pub difference_png: Vec<u8>,
}

/// A setting that the device does not draw.
#[derive(Debug, Clone)]
pub struct Refused {
    pub setting: RenderConfig,
    pub error: Error,
}

#[derive(Debug, Clone)]
pub struct Study {
    pub subject: Subject,
    pub wish: StudyOptions,
    pub reference: Reference,
    pub rows: Vec<Row>,
    pub refused: Vec<Refused>,
    pub setting_count: usize,
    pub adapters: Vec<Adapter>,
    /// The vector lanes of the native engine.
    pub vector_units: &'static str,
    /// Configuration by which the file draws on this machine; `None`: on a device that was not looked at, or not at all.
    pub own: Option<RenderConfig>,
    /// Engines that were not measured, with the reason and the remedy.
    pub left_out: Vec<String>,
    /// The row that costs least under the error allowed.
    pub recommended: Option<usize>,
    /// Orders of convergence of the integrators that were looked at over their numbers of pieces.
    pub convergence: Vec<Convergence>,
    /// Results of refining the grid, if requested.
    pub refinement: Option<Refinement>,
}

impl Row {
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
    /// True if it was stopped before all that was asked for was measured.
    pub fn stopped(&self) -> bool {
        self.stopped_early() || (self.wish.refine > 0 && self.refinement.is_none())
    }
}

/// Measures every setting. A stop, once the reference is there, keeps the settings that are done; see
/// [`Study::stopped`].
///
/// Errors: integrators asked for that cannot serve the scene; those of drawing on the native engine; a device that draws
/// nothing, where it is all that was asked for.
pub fn study(
    subject: Subject,
    wish: StudyOptions,
    mut benches: Benches,
    reference: Reference,
    progress: &dyn Progress,
) -> Result<Study> {
    let settings = benches.settings(&subject, &wish.only);
    if settings.is_empty() {
        return Err(Error::usage("none of the integrators asked for can serve this scene")
            .got(wish.only.join(", "))
            .expected("no choice of integrators, for all that can"));
    }
    let seen = PreparedPicture::new(&reference.picture, subject.background);
    let whole: f64 = settings.iter().map(RenderConfig::weight).sum();
    let (mut done, mut rows, mut refused) = (0.0, Vec::new(), Vec::new());
    for setting in &settings {
        progress.report(&setting.label(), done / whole);
        match benches.measure(&subject, setting, &wish.frames, progress) {
            Ok((picture, cost)) => rows.push(Row {
                difference_png: encode::png(&difference(&picture, &reference.picture), [0.0; 3], None)?,
                setting: *setting,
                cost,
                errors: errors(&picture, &reference.picture),
                flip: PreparedPicture::new(&picture, subject.background).difference(&seen),
                on_front: false,
                of_file: false,
            }),
            Err(error) if error.kind == ErrorKind::Cancelled => break,
            // What a device does not hold another engine may.
            Err(error) if setting.variant.engine.on_device => {
                refused.push(Refused { setting: *setting, error });
            }
            Err(error) => return Err(error),
        }
        done += setting.weight();
    }
    if let ([], [first, ..]) = (rows.as_slice(), refused.as_slice()) {
        return Err(first.error.clone());
    }
    let own = benches.own(&subject, &|own| refused.iter().any(|no: &Refused| no.setting.draws_as(own)));
    let adapters = benches.adapters(&subject, &wish);
    let setting_count = settings.len();
    let mut study = Study {
        vector_units: LaneSet::detect()?.name(),
        subject,
        wish,
        reference,
        rows,
        refused,
        setting_count,
        adapters,
        own,
        left_out: benches.left_out,
        recommended: None,
        convergence: Vec::new(),
        refinement: None,
    };
    study.judge();
    if study.wish.refine > 0 && !study.stopped_early() {
        let Study { subject, reference, wish, .. } = &study;
        study.refinement = match refinement(subject, reference, wish.refine, &Source::Gradients, progress) {
            Ok(found) => Some(found),
            Err(error) if error.kind == ErrorKind::Cancelled => None,
            Err(error) => return Err(error),
        };
    }
    Ok(study)
}

impl Study {
    /// True if settings were left.
    fn stopped_early(&self) -> bool {
        self.rows.len() + self.refused.len() < self.setting_count
    }

    /// Front, recommendation and orders.
    fn judge(&mut self) {
        let (rows, wish) = (&mut self.rows, &self.wish);
        let points: Vec<[f64; 2]> =
            rows.iter().map(|row| [row.cost.picture.median_ms, row.error(wish.measure)]).collect();
        for (row, on_front) in rows.iter_mut().zip(front(&points)) {
            row.on_front = on_front;
            row.of_file = self.own.is_some_and(|own| row.setting.draws_as(&own));
        }
        self.recommended = wish.max_error.and_then(|bound| cheapest(&points, bound));
        let counted = |kind: &&Integrator| Numbers::of(kind).count.is_some();
        let counted: Vec<&Integrator> = self.subject.integrators.iter().filter(counted).collect();
        let each =
            RendererVariant::all().flat_map(|variant| counted.iter().map(move |kind| (variant, *kind)));
        self.convergence =
            each.filter_map(|(variant, kind)| converging(kind, variant, &self.rows, &self.subject)).collect();
    }
}

/// The convergence of an integrator with one variant over its number of pieces, with its default table.
fn converging(
    kind: &Integrator,
    variant: RendererVariant,
    rows: &[Row],
    subject: &Subject,
) -> Option<Convergence> {
    let rows = || rows.iter().filter(|row| row.setting.variant == variant);
    let count = |row: &Row| {
        let integrator = row.setting.integrator;
        let numbers = Numbers::of(&integrator);
        let usual = numbers.table_size.is_none_or(|side| side == DEFAULT_SIDE);
        numbers.count.filter(|_| usual && integrator.is_kind_of(kind))
    };
    let order = rows().find(|row| count(row).is_some())?.setting.order;
    let in_order = || rows().filter(|row| row.setting.order == order);
    let mut errors: Vec<(usize, f64)> =
        in_order().filter_map(|row| Some((count(row)?, row.errors.root_mean_square))).collect();
    errors.sort_unstable_by_key(|level| level.0);
    if errors.len() < 2 {
        return None;
    }
    // What the closed forms leave is what the order of segments and rounding do, here and in the reference.
    let exact = |row: &&Row| {
        let integrator = row.setting.integrator;
        let closed = integrator == Integrator::ANALYTIC || integrator.tolerance().is_some();
        closed && row.setting.overlap == WidgetBlend::Exact
    };
    let floor = in_order().filter(exact).map(|row| row.errors.root_mean_square).fold(f64::INFINITY, f64::min);
    // Where no closed form was looked at, single precision is all that is known.
    let floor = if floor.is_finite() { floor } else { f64::from(f32::EPSILON) };
    let found = convergence(kind.name(), &errors, floor, &subject.scene.transfer_function);
    Some(Convergence { engine: variant.label(), ..found })
}

/// For each point (cost, error) whether it is on the Pareto front: no other one is at most as dear and at most as
/// wrong, and in one of the two less. Numbers that are not finite are never on it.
pub fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    let sound = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    points.iter().map(|p| sound(p) && !points.iter().any(|other| sound(other) && beats(other, p))).collect()
}

/// The cheapest point whose error is at most `bound`; of equally dear ones the best.
pub fn cheapest(points: &[[f64; 2]], bound: f64) -> Option<usize> {
    let fits = (0..points.len()).filter(|&i| points[i][1] <= bound && points[i][0].is_finite());
    fits.min_by(|&a, &b| {
        let by = |k: usize| points[a][k].total_cmp(&points[b][k]);
        by(0).then(by(1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 2]; 7] = [
        [1.0, 0.5],
        // As dear as the first, and worse.
        [1.0, 0.6],
        [2.0, 0.1],
        // Dearer and worse than the third.
        [3.0, 0.2],
        // Dearer and no better than the third.
        [4.0, 0.1],
        [8.0, 0.0],
        [0.5, f64::INFINITY],
    ];

    #[test]
    fn the_front_holds_what_nothing_beats() {
        assert_eq!(front(&POINTS), [true, false, true, false, false, true, false]);
        // Twins do not beat each other.
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0]]), [true, true]);
    }

    #[test]
    fn the_cheapest_under_a_bound_is_taken_with_the_bound_included() {
        assert_eq!(cheapest(&POINTS, 0.5), Some(0));
        assert_eq!(cheapest(&POINTS, 0.2), Some(2));
        assert_eq!(cheapest(&POINTS, 0.05), Some(5));
        assert_eq!(cheapest(&POINTS[..5], 0.05), None);
    }
}
