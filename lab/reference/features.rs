//! Places along a path of a widget's peaks, kinks and steps, and of a width from its centre.

use crate::linear_on_segment::{Cuts, LinearOnSegment, Place, Wide, quadratic_crossings};
use crate::term::{Bands, ReadyProfile, Term};
use voltet_core::transfer::ControlPoint;
use voltet_core::{Error, Result};

/// More bands than this in one cell are refused rather than drawn for hours.
const MAX_BANDS: f64 = 1e6;

/// Bands that are counted from so far away have lost their last digits: a phase is known to 2⁻¹⁰² of itself.
const FARTHEST_PHASE: f64 = 1e15;

/// A path that leads this many widths past a Gaussian is not known to a width's 1e-13.
const FARTHEST_WIDTHS: f64 = 1e17;

/// Distances from a Gaussian's centre at which it is cut, by widths (where it is 1/e): as far as it can be told from 0.
/// A stretch of a width and a half is smooth enough for one rule.
const WIDTHS: [f64; 8] = [1.5, 3.0, 4.5, 6.5, 9.5, 13.75, 20.0, NOTHING];

/// Here exp(−q²) is less than the smallest double.
pub(crate) const NOTHING: f64 = 27.5;

impl Term {
    /// Cuts where the profile changes its character; with a cutoff also where it passes it.
    pub(crate) fn features(
        &self,
        along: &[LinearOnSegment],
        cutoff: Option<f64>,
        cuts: &mut Cuts,
    ) -> Result<()> {
        match &self.shape {
            ReadyProfile::Uniform => {}
            ReadyProfile::Gaussian(_) => gaussian(along, cutoff, cuts)?,
            ReadyProfile::Triangular(..) => triangular(along, cutoff, cuts),
            ReadyProfile::Bands(wave) => bands(wave, along[0], cutoff, cuts)?,
            ReadyProfile::Linear { points, peak } => linear(points, along[0], cutoff.map(|c| c * peak), cuts),
            ReadyProfile::Table(texels) => texels.features(along, cutoff, cuts),
        }
        Ok(())
    }
}

fn gaussian(along: &[LinearOnSegment], cutoff: Option<f64>, cuts: &mut Cuts) -> Result<()> {
    let squares =
        |f: &dyn Fn(&LinearOnSegment) -> Wide| along.iter().map(|a| f(a).value().powi(2)).sum::<f64>();
    let length = squares(&|a| a.step).sqrt();
    // A shorter path is smooth enough as it is.
    let long = length > WIDTHS[0];
    // What is above the cutoff at both ends is above it between them.
    let reach = cutoff.map(|cutoff| -cutoff.ln());
    let reach = reach.filter(|reach| squares(&|a| a.front).max(squares(&|a| a.back)) >= *reach);
    if length == 0.0 || length.is_nan() || !long && reach.is_none() {
        return Ok(());
    }
    let dot = |f: &dyn Fn(&LinearOnSegment) -> Wide| along.iter().fold(Wide::ZERO, |sum, a| sum + f(a));
    let square = dot(&|a| a.step * a.step);
    let slope = dot(&|a| a.front * a.step);
    let nearest = Place::behind_front(-(slope / square));
    let within = |share: f64| (-1.0..=2.0).contains(&share);
    if within(nearest.share()) {
        let apart: f64 = along.iter().map(|a| a.at(nearest).value().powi(2)).sum();
        let farthest =
            along.iter().map(|a| a.front.abs().value().max(a.back.abs().value())).fold(0.0, f64::max);
        if apart < NOTHING * NOTHING && farthest > FARTHEST_WIDTHS {
            return Err(Error::run("a Gaussian is too narrow for the values along a segment")
                .got(format!("{farthest:.3e} of its widths"))
                .expected(format!("at most {FARTHEST_WIDTHS:.0e}")));
        }
        if let Some(reach) = reach.filter(|reach| apart < *reach) {
            let half = Wide::from((reach - apart).sqrt() / length);
            cuts.firm(Some(nearest.moved(-half)));
            cuts.firm(Some(nearest.moved(half)));
        }
    } else if let Some(reach) = reach {
        let offset = dot(&|a| a.front * a.front) - Wide::from(reach);
        let place = |t: f64| cuts.firm(Some(Place::behind_front(Wide::from(t))));
        quadratic_crossings(square.value(), slope.value(), offset.value(), place);
    }
    if long {
        cuts.soft(Some(nearest));
        for widths in WIDTHS {
            let by = Wide::from(widths / length);
            cuts.soft(Some(nearest.moved(-by)));
            cuts.soft(Some(nearest.moved(by)));
        }
    }
    Ok(())
}

/// Widths at which it is cut, by their number at the place with the fewest of them.
fn widths() -> impl Iterator<Item = f64> {
    [1.0, 2.0].into_iter().chain(WIDTHS)
}

fn triangular(along: &[LinearOnSegment], cutoff: Option<f64>, cuts: &mut Cuts) {
    let Some((width, offsets)) = along.split_last() else { return };
    let reach = cutoff.filter(|cutoff| *cutoff > 0.0).map(|cutoff| -cutoff.ln());
    cuts.soft(width.passes(Wide::ZERO));
    match offsets {
        [offset] => triangular_line(*offset, *width, reach, cuts),
        _ => triangular_path(offsets, *width, reach, cuts),
    }
}

fn triangular_line(offset: LinearOnSegment, width: LinearOnSegment, reach: Option<f64>, cuts: &mut Cuts) {
    cuts.soft(offset.passes(Wide::ZERO));
    let line = |x: f64| offset.less(width.times(Wide::from(x))).passes(Wide::ZERO);
    let side = |x: f64, o: Wide, w: Wide| o.value() < x * w.value();
    for widths in widths().flat_map(|x| [x, -x]) {
        if side(widths, offset.front, width.front) != side(widths, offset.back, width.back) {
            cuts.soft(line(widths));
        }
    }
    if let Some(reach) = reach {
        cuts.firm(line(reach.sqrt()));
        cuts.firm(line(-reach.sqrt()));
    }
}

/// Over several coordinates |q|²/m² is a ratio of quadratic functions: cut where it is least, and where it passes levels.
fn triangular_path(offsets: &[LinearOnSegment], width: LinearOnSegment, reach: Option<f64>, cuts: &mut Cuts) {
    let sum = |f: &dyn Fn(&LinearOnSegment) -> Wide| offsets.iter().fold(Wide::ZERO, |sum, a| sum + f(a));
    let square = sum(&|a| a.step * a.step);
    let slope = sum(&|a| a.front * a.step);
    let offset = sum(&|a| a.front * a.front);
    let (m, rise) = (width.front, width.step);
    // The derivative of the ratio is a linear function by m³.
    let nearest = Place::behind_front((offset * rise - slope * m) / (square * m - slope * rise));
    let ratio = |place: Place| -> f64 {
        let m = width.at(place).value();
        offsets.iter().map(|a| (a.at(place).value() / m).powi(2)).sum()
    };
    let is_inside = Place::FRONT.is_before(nearest) && nearest.is_before(Place::BACK);
    let least = if is_inside && width.at(nearest).value() > 0.0 { ratio(nearest) } else { 0.0 };
    cuts.soft(Some(nearest));
    let each = |level: f64, cut: &mut dyn FnMut(Option<Place>)| {
        let less = |by: Wide, from: Wide| (from - by * level).value();
        let (square, slope) = (less(rise * rise, square), less(m * rise, slope));
        quadratic_crossings(square, slope, less(m * m, offset), |t| {
            let place = Place::behind_front(Wide::from(t));
            // Also passed by −m.
            cut(Some(place).filter(|place| width.at(*place).value() > 0.0));
        });
    };
    // One of Newton's steps, by which a root of doubles has twice their digits.
    let step = |place: Place, level: f64| -> Place {
        let m = width.at(place);
        let value = sum(&|a| a.at(place) * a.at(place)) - m * m * level;
        let slope = sum(&|a| a.at(place) * a.step) - m * rise * level;
        let by = -(value / slope).half();
        if by.value().is_finite() { place.moved(by) } else { place }
    };
    for level in widths().map(|x| x * x).flat_map(|square| [square, least + square]) {
        each(level, &mut |place| cuts.soft(place));
    }
    if let Some(reach) = reach {
        each(reach, &mut |place| cuts.firm(place.map(|place| step(step(place, reach), reach))));
    }
}

fn bands(bands: &Bands, phase: LinearOnSegment, cutoff: Option<f64>, cuts: &mut Cuts) -> Result<()> {
    let [from, to] = cuts.window().map(|place| phase.at(place));
    let (low, high) = if from.order(to).is_le() { (from, to) } else { (to, from) };
    let farthest = low.value().abs().max(high.value().abs());
    if farthest.is_nan() || farthest > FARTHEST_PHASE {
        return Err(Error::run("a wave's bands are too far from its origin")
            .got(format!("{farthest:.3e} bands"))
            .expected(format!("at most {FARTHEST_PHASE:.0e}")));
    }
    let (low, high) = (low.floor(), high.floor());
    if high - low > MAX_BANDS {
        return Err(Error::run("a cell holds more bands of a wave widget than are drawn")
            .got(format!("{:.3e} bands", high - low))
            .expected(format!("at most {MAX_BANDS:.0e}")));
    }
    let lit = cutoff.map(|cutoff| bands.half_width(cutoff));
    for band in 0..=(high - low) as u64 {
        let peak = low + band as f64 + 0.5;
        cuts.firm(phase.passes(Wide::from(peak)));
        for half in [Some(bands.half), lit].into_iter().flatten() {
            cuts.firm(phase.passes(Wide::difference(peak, half)));
            // The foot of two bands that touch is one place.
            if half < 0.5 {
                cuts.firm(phase.passes(Wide::difference(peak, -half)));
            }
        }
    }
    Ok(())
}

/// `level`: the extinction that counts as cutoff.
fn linear(points: &[ControlPoint], scalar: LinearOnSegment, level: Option<f64>, cuts: &mut Cuts) {
    for point in points {
        cuts.firm(scalar.passes(Wide::from(point.s)));
    }
    let Some(level) = level else { return };
    for pair in points.windows(2) {
        let (e0, e1) = (pair[0].extinction, pair[1].extinction);
        if (e0 > level) != (e1 > level) {
            let share = (level - e0) / (e1 - e0);
            let apart = Wide::difference(pair[1].s, pair[0].s);
            cuts.firm(scalar.passes(Wide::from(pair[0].s) + apart * share));
        }
    }
}
