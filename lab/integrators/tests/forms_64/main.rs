//! Requirements of every integrator, and orders of convergence of those that sample.

mod tables;
mod tabulated;

use proptest::prelude::*;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet_integrators::*;
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::{
    self, Analytic, Extent, Integrator, IntegratorKind, SegmentIntegrator, can_serve, new,
};
use voltet_optics::{Contribution, Segment};
use voltet_testing::random::{segment, transfer_function};

fn smooth(model: OpticalModel) -> TransferFunction {
    let gaussian = |s: f64, color| Widget {
        profile: Profile::Gaussian { centre: [s, 0.5], matrix: [[2.0, 0.3], [0.0, 1.5]] },
        color,
        extinction: 3.0,
        region: None,
    };
    let widgets = vec![gaussian(0.3, [1.0, 0.2, 0.0]), gaussian(0.7, [0.0, 0.5, 1.2])];
    TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() }
}

fn largest_error(a: &Contribution, b: &Contribution) -> f64 {
    let colors = a.color.iter().zip(b.color).map(|(a, b)| (a - b).abs());
    colors.fold((a.opacity - b.opacity).abs(), f64::max)
}

const ACROSS: Segment<'static> =
    Segment { length: 1.3, front: [0.1, 0.2], back: [0.9, 0.7], fields_front: &[], fields_back: &[] };

/// All kinds, those that ship first.
fn every_kind() -> impl Iterator<Item = &'static dyn IntegratorKind> {
    integrators::KINDS.into_iter().chain(KINDS)
}

#[test]
fn every_kind_has_a_name_and_keeps_the_settings_that_it_has() {
    let given =
        [("tolerance", 0.5), ("segments", 7.0), ("table_size", 9.0), ("oversampling", 3.0), ("planes", 4.0)];
    let mut names = Vec::new();
    for kind in every_kind() {
        let default = Integrator::new(kind);
        assert!(!names.contains(&default.name()), "{default:?}");
        names.push(default.name());
        assert!(default.check().is_ok(), "{default:?}");
        let with = given.iter().fold(default, |with, (name, value)| with.with(name, *value));
        assert!(with.is_kind_of(&default) && with.check().is_ok(), "{with:?}");
        for (name, value) in given {
            assert_eq!(with.setting(name), default.setting(name).and(Some(value)), "{with:?}");
        }
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
                _ => Segments::new(&transfer_function, count, None).expect("valid").integrate(&ACROSS),
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
    TransferFunction {
        model: OpticalModel::DensityEmitter,
        unit_distance: 1.0,
        widgets: vec![widget],
        axes: Default::default(),
    }
}

#[test]
fn one_piece_of_a_linear_function_is_exact() {
    let transfer_function = piecewise();
    let inside = Segment { front: [0.25, 0.0], back: [0.4, 0.0], ..ACROSS };
    let one = Segments::new(&transfer_function, 1, None).expect("valid").integrate(&inside);
    let exact = Analytic::new(&transfer_function, WidgetBlend::Exact).expect("valid").integrate(&inside);
    // ψ to a few roundings.
    assert!(largest_error(&one, &exact) < 1e-14);
}

const EXTENT: Extent = Extent { scalar: [0.0, 1.0], longest: 10.0 };

/// Every integrator, with modest tables.
fn all() -> [Integrator; 8] {
    [
        Integrator::ANALYTIC,
        Integrator::adaptive(1e-3),
        segments(7, 9),
        riemann(5),
        pre_integrated(9, 2),
        pre_integrated_cylindrical(9, 2, 1),
        VERTEX_SAMPLED,
        tabulated(9),
    ]
}

#[test]
fn what_an_integrator_cannot_serve_is_named() {
    let refusal = |integrator, transfer_function: &TransferFunction| {
        let here = can_serve(&integrator, transfer_function).expect_err("refused");
        let made = new(&integrator, WidgetBlend::Exact, transfer_function, &EXTENT).err().expect("refused");
        assert_eq!((&here.what, &here.got), (&made.what, &made.got));
        here.to_string()
    };
    let bivariate = smooth(OpticalModel::DensityEmitter);
    for integrator in [pre_integrated(8, 2), pre_integrated_cylindrical(8, 2, 1)] {
        let message = refusal(integrator, &bivariate);
        assert!(message.contains("widgets[0] (gaussian)"), "{message}");
        assert!(message.contains("gradient magnitude"), "{message}");
        assert!(can_serve(&integrator, &piecewise()).is_ok());
    }
    let mut banded = piecewise();
    banded.widgets[0].profile =
        Profile::GaussianNd { fields: vec!["p".into()], centre: vec![0.0], matrix: vec![vec![1.0]] };
    assert!(refusal(pre_integrated(8, 2), &banded).contains("further fields"));
    assert!(refusal(tabulated(8), &piecewise()).contains("widgets[0] (piecewise-linear)"));
}

#[test]
fn a_setting_out_of_range_is_refused() {
    let refusal = |integrator: Integrator| {
        let message = can_serve(&integrator, &piecewise()).expect_err("refused").to_string();
        assert!(message.contains(&format!("'{}'", integrator.name())), "{message}");
        message
    };
    assert!(refusal(riemann(0)).contains("number of segments"));
    assert!(refusal(segments(0, 4)).contains("number of segments"));
    assert!(refusal(segments(1, 1)).contains("table_size"));
    assert!(refusal(segments(1, 4097)).contains("2 to 4096"));
    assert!(refusal(pre_integrated(513, 2)).contains("2 to 512"));
    assert!(refusal(pre_integrated_cylindrical(1, 2, 1)).contains("2 to 512"));
    let cylindrical = |table_size, oversampling, planes| {
        refusal(pre_integrated_cylindrical(table_size, oversampling, planes))
    };
    assert!(cylindrical(64, 2, 9).contains("planes of the integrator"));
    assert!(cylindrical(64, 0, 1).contains("1 to 64"));
    // As much memory as 512 entries a side with one.
    let large = cylindrical(512, 2, 2);
    assert!(large.contains("table_size = 512") && large.contains("1 to 1"), "{large}");
    assert!(refusal(Integrator::adaptive(0.0)).contains("tolerance"));
    assert!(refusal(Integrator::adaptive(f64::NAN)).contains("tolerance"));
}

/// Values that are not numbers draw nothing, whoever integrates.
#[test]
fn what_is_not_a_number_contributes_nothing() {
    let broken = Segment { front: [f64::NAN, 0.5], ..ACROSS };
    for integrator in all() {
        let look = match integrator.is_kind_of(&tabulated(2)) {
            true => smooth(OpticalModel::DensityEmitter),
            false => piecewise(),
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
        transfer_function in transfer_function(),
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

proptest! {
    #[test]
    fn the_mapping_is_its_inverse(front in 0.0..1.0_f64, back in 0.0..1.0_f64, length in 1e-6..1.0_f64) {
        let [angle, s, t] = to_cylinder(front, back, length);
        prop_assert!((0.0..=1.0).contains(&angle) && (0.0..=1.0).contains(&s));
        let [f, b, l] = from_cylinder(angle, s, t);
        // A few roundings of numbers up to 1.
        prop_assert!((f - front).abs() < 1e-15 && b == back && (l - length).abs() < 1e-15);
    }
}

#[test]
fn at_the_axis_every_plane_serves() {
    let [angle, s, t] = to_cylinder(0.3, 0.3, 0.0);
    assert_eq!((angle, s, t), (0.5, 0.0, 0.3));
}

#[test]
fn every_header_is_complete_and_names_pieces() {
    for piece in WGSL_PIECES {
        let header = piece.text.lines().next().unwrap_or("");
        assert!(header.starts_with("// Uses: ") && header.contains(". Fills: "), "{}", piece.file);
        for name in piece.uses() {
            let known = WGSL_PIECES.iter().any(|other| other.name == name);
            assert!(known || voltet_shaders::piece(name).is_some(), "{} uses '{name}'", piece.file);
        }
    }
}
