//! What every integrator must fulfil, and how fast those that sample approach the closed forms.

mod adaptive;
mod tables;
mod tabulated;

use super::*;
use crate::arbitrary::segment;
use crate::{Contribution, Segment};
use proptest::prelude::*;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Widget};

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

#[test]
fn every_kind_has_a_word_of_its_own_and_keeps_the_numbers_that_it_has() {
    let given = Numbers {
        tolerance: Some(0.5),
        count: Some(7),
        table_size: Some(9),
        oversampling: Some(3),
        planes: Some(4),
    };
    for (k, kind) in Integrator::EVERY.iter().enumerate() {
        assert_eq!(Integrator::WORDS[k].0, kind.name());
        assert!(Integrator::EVERY[..k].iter().all(|other| other.name() != kind.name()), "{kind:?}");
        assert_eq!(kind.with(Numbers::default()), *kind);
        let (with, own) = (kind.with(given), kind.numbers());
        assert!(with.is_kind_of(kind) && with.check().is_ok(), "{with:?}");
        let expected = Numbers {
            tolerance: own.tolerance.and(given.tolerance),
            count: own.count.and(given.count),
            table_size: own.table_size.and(given.table_size),
            oversampling: own.oversampling.and(given.oversampling),
            planes: own.planes.and(given.planes),
        };
        assert_eq!(with.numbers(), expected);
    }
}

/// Both are of second order: twice the samples, a quarter of the error (within a tenth, once it is small).
#[test]
fn sampling_converges_to_the_closed_forms_with_second_order() {
    for model in [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 1e-9 }] {
        let transfer_function = smooth(model);
        let exact = Analytic::new(&transfer_function, WidgetBlend::Exact).expect("valid").integrate(&ACROSS);
        let error = |name: &str, count: usize| {
            let found = match name {
                "riemann" => Riemann::new(&transfer_function, count).expect("valid").integrate(&ACROSS),
                _ => {
                    Segments::with_closed_forms(&transfer_function, count).expect("valid").integrate(&ACROSS)
                }
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
    let one = Segments::with_closed_forms(&transfer_function, 1).expect("valid").integrate(&inside);
    let exact = Clipped::new(&transfer_function).expect("piecewise-linear").integrate(&inside);
    // ψ to a few roundings.
    assert!(largest_error(&one, &exact) < 1e-14);
}

const EXTENT: Extent = Extent { scalar: [0.0, 1.0], longest: 10.0 };

/// Every integrator of this crate, with modest tables.
fn all() -> [Integrator; 9] {
    [
        Integrator::Analytic,
        Integrator::Adaptive { tolerance: 1e-3 },
        Integrator::Segments { count: 7, table_size: 9 },
        Integrator::Riemann { count: 5 },
        Integrator::PreIntegrated { table_size: 9, oversampling: 2 },
        Integrator::PreIntegratedCylindrical { table_size: 9, oversampling: 2, planes: 1 },
        Integrator::Clipped,
        Integrator::VertexSampled,
        Integrator::Tabulated { table_size: 9 },
    ]
}

#[test]
fn what_an_integrator_cannot_serve_names_one_that_can() {
    let refusal = |integrator, transfer_function: &TransferFunction| {
        let here = can_serve(&integrator, transfer_function).expect_err("refused").to_string();
        let made = new(&integrator, WidgetBlend::Exact, transfer_function, &EXTENT).err().expect("refused");
        assert_eq!(here, made.to_string());
        here
    };
    let bivariate = smooth(OpticalModel::DensityEmitter);
    let message = refusal(Integrator::Clipped, &bivariate);
    assert!(message.contains("'clipped'") && message.contains("2 widgets"), "{message}");
    assert!(
        message.contains("analytic, adaptive, segments, riemann, vertex-sampled, tabulated, reference"),
        "{message}"
    );
    for integrator in [
        Integrator::PreIntegrated { table_size: 8, oversampling: 2 },
        Integrator::PreIntegratedCylindrical { table_size: 8, oversampling: 2, planes: 1 },
    ] {
        let message = refusal(integrator, &bivariate);
        assert!(message.contains("widgets[0] (gaussian)"), "{message}");
        assert!(message.contains("gradient magnitude") && !message.contains("clipped"), "{message}");
        assert!(can_serve(&integrator, &piecewise()).is_ok());
    }
    let mut banded = piecewise();
    banded.widgets[0].profile =
        Profile::GaussianNd { fields: vec!["p".into()], centre: vec![0.0], matrix: vec![vec![1.0]] };
    assert!(
        refusal(Integrator::PreIntegrated { table_size: 8, oversampling: 2 }, &banded)
            .contains("fields of its own")
    );
    assert!(refusal(Integrator::Clipped, &banded).contains("widgets[0] (gaussian-nd)"));
}

#[test]
fn a_setting_out_of_range_is_refused() {
    let refusal = |integrator: Integrator| {
        let message = can_serve(&integrator, &piecewise()).expect_err("refused").to_string();
        assert!(message.contains(&format!("'{}'", integrator.name())), "{message}");
        message
    };
    assert!(refusal(Integrator::Riemann { count: 0 }).contains("number of segments"));
    assert!(refusal(Integrator::Segments { count: 0, table_size: 4 }).contains("number of segments"));
    assert!(refusal(Integrator::Segments { count: 1, table_size: 1 }).contains("table_size"));
    assert!(refusal(Integrator::Segments { count: 1, table_size: 4097 }).contains("2 to 4096"));
    assert!(refusal(Integrator::PreIntegrated { table_size: 513, oversampling: 2 }).contains("2 to 512"));
    assert!(
        refusal(Integrator::PreIntegratedCylindrical { table_size: 1, oversampling: 2, planes: 1 })
            .contains("2 to 512")
    );
    let cylindrical = |table_size, oversampling, planes| {
        refusal(Integrator::PreIntegratedCylindrical { table_size, oversampling, planes })
    };
    assert!(cylindrical(64, 2, 9).contains("planes of the integrator"));
    assert!(cylindrical(64, 0, 1).contains("1 to 64"));
    // As much memory as 512 entries a side with one.
    let large = cylindrical(512, 2, 2);
    assert!(large.contains("table_size = 512") && large.contains("1 to 1"), "{large}");
    assert!(refusal(Integrator::Adaptive { tolerance: 0.0 }).contains("tolerance"));
    assert!(refusal(Integrator::Adaptive { tolerance: f64::NAN }).contains("tolerance"));
}

/// Values that are not numbers draw nothing, whoever integrates.
#[test]
fn what_is_not_a_number_contributes_nothing() {
    let broken = Segment { front: [f64::NAN, 0.5], ..ACROSS };
    for integrator in all() {
        let look = match integrator {
            Integrator::Tabulated { .. } => smooth(OpticalModel::DensityEmitter),
            _ => piecewise(),
        };
        let made = new(&integrator, WidgetBlend::Exact, &look, &EXTENT).expect("serves");
        let found = made.integrate(&broken);
        assert_eq!((found.color, found.opacity), ([0.0; 3], 0.0), "{}", integrator.name());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    /// Whatever the integrator, A is within [0, 1] and C between 0 and the brightest colour.
    #[test]
    fn every_integrator_stays_within_bounds(
        transfer_function in crate::arbitrary::transfer_function(),
        segment in segment(),
    ) {
        for integrator in all() {
            if can_serve(&integrator, &transfer_function).is_err() {
                continue;
            }
            let found = new(&integrator, WidgetBlend::Exact, &transfer_function, &EXTENT)
                .expect("serves")
                .integrate(&segment);
            prop_assert!((0.0..=1.0).contains(&found.opacity), "{integrator:?}");
            prop_assert!(found.color.into_iter().all(|c| c >= 0.0 && c.is_finite()), "{integrator:?}");
            if transfer_function.model == OpticalModel::DensityEmitter {
                // 1.5 is the brightest colour; tables hold 32 bits.
                let most = 1.5 * (1.0 + 1e-6);
                prop_assert!(found.color.into_iter().all(|c| c <= most), "{integrator:?} {:?}", found.color);
            }
        }
    }
}
