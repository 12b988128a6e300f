//! Observed orders of convergence beside the expected ones, after Etiene et al., "Verifying Volume Rendering Using
//! Discretization Error Analysis" (2014), section 4.
//!
//! With an error e(N) = c N^(−p) of N pieces, p = log(e(N₁)/e(N₂)) / log(N₂/N₁) between two numbers of pieces. A
//! scene has a p of its own where the transfer function does; where it jumps, the place of the jump is known to
//! a piece only. A floor is left whatever N by the rounding of 32 bits and of the reference, and by an order of segments that is
//! not exact. It is taken to be independent of the rest, so that squares add up: p is that of √(e² − floor²). Errors near the
//! floor tell nothing and are left out.

use super::RendererVariant;
use serde::Serialize;
use voltet_core::transfer::{OpticalModel, TransferFunction};

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

#[cfg(test)]
mod tests {
    use super::*;

    fn smooth() -> TransferFunction {
        TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets: Vec::new() }
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
}
