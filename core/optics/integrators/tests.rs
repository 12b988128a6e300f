use super::*;
use crate::optics::arbitrary::segment;
use crate::transfer::{ControlPoint, OpticalModel, Widget};
use proptest::prelude::*;

fn smooth(model: OpticalModel) -> TransferFunction {
    let gaussian = |s: f64, color| Widget {
        profile: Profile::Gaussian { centre: [s, 0.5], matrix: [[2.0, 0.3], [0.0, 1.5]] },
        color,
        extinction: 3.0,
        region: None,
    };
    let widgets = vec![gaussian(0.3, [1.0, 0.2, 0.0]), gaussian(0.7, [0.0, 0.5, 1.2])];
    TransferFunction { model, unit_distance: 1.0, widgets }
}

fn largest_error(a: &Contribution, b: &Contribution) -> f64 {
    let colors = a.color.iter().zip(b.color).map(|(a, b)| (a - b).abs());
    colors.fold((a.opacity - b.opacity).abs(), f64::max)
}

const ACROSS: Segment<'static> =
    Segment { length: 1.3, front: [0.1, 0.2], back: [0.9, 0.7], fields_front: &[], fields_back: &[] };

/// Both are of second order: twice the samples, a quarter of the error (within a tenth, once it is small).
#[test]
fn sampling_converges_to_the_closed_forms_with_second_order() {
    for model in [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 1e-9 }] {
        let transfer_function = smooth(model);
        let exact = Analytic::new(&transfer_function, Overlap::Exact).expect("valid").integrate(&ACROSS);
        let error = |name: &str, count: usize| {
            let found = match name {
                "riemann" => Riemann::new(&transfer_function, count).expect("valid").integrate(&ACROSS),
                _ => Segments::new(&transfer_function, count).expect("valid").integrate(&ACROSS),
            };
            largest_error(&exact, &found)
        };
        for name in ["riemann", "segments"] {
            let (coarse, fine) = (error(name, 64), error(name, 128));
            assert!(coarse < 1e-3, "{name}: {coarse}");
            assert!((3.6..4.4).contains(&(coarse / fine)), "{name}: {coarse} to {fine}");
        }
    }
}

fn piecewise() -> TransferFunction {
    let point = |s, extinction, color| ControlPoint { s, color, extinction };
    let points = vec![
        point(0.2, 0.5, [1.0, 0.0, 0.3]),
        point(0.45, 6.0, [0.2, 1.0, 0.0]),
        point(0.8, 0.0, [0.0, 0.4, 1.0]),
    ];
    let widget = Widget {
        profile: Profile::PiecewiseLinear { points },
        color: [0.0; 3],
        extinction: 0.0,
        region: None,
    };
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets: vec![widget] }
}

#[test]
fn one_piece_of_a_linear_function_is_exact() {
    let transfer_function = piecewise();
    let inside = Segment { front: [0.25, 0.0], back: [0.4, 0.0], ..ACROSS };
    let one = Segments::new(&transfer_function, 1).expect("valid").integrate(&inside);
    let exact = Clipped::new(&transfer_function).expect("piecewise-linear").integrate(&inside);
    // ψ to a few roundings.
    assert!(largest_error(&one, &exact) < 1e-14);
}

#[test]
fn what_an_integrator_cannot_serve_names_one_that_can() {
    let message = Clipped::new(&smooth(OpticalModel::DensityEmitter)).expect_err("refused").to_string();
    assert!(message.contains("clipped") && message.contains("analytic"), "{message}");
    assert!(Riemann::new(&piecewise(), 0).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// Whatever the sampling, A is within [0, 1] and C between 0 and the brightest colour.
    #[test]
    fn sampling_stays_within_bounds(
        transfer_function in crate::optics::arbitrary::transfer_function(),
        segment in segment(),
        count in 1..40_usize,
    ) {
        let found = [
            Riemann::new(&transfer_function, count).expect("valid").integrate(&segment),
            Segments::new(&transfer_function, count).expect("valid").integrate(&segment),
        ];
        for found in found {
            prop_assert!((0.0..=1.0).contains(&found.opacity));
            prop_assert!(found.color.into_iter().all(|c| c >= 0.0 && c.is_finite()));
            if transfer_function.model == OpticalModel::DensityEmitter {
                prop_assert!(found.color.into_iter().all(|c| c <= 1.5 * (1.0 + 1e-12)));
            }
        }
    }
}
