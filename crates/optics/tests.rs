//! What every integral must fulfil, whatever the widgets.

use super::compositing::Composite;
use super::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use proptest::prelude::*;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_testing::random::{self, divide_gradients, fields, transfer_function, widget};

/// A random segment, of the type that is tested: to unit tests that of the test support is another.
pub(crate) fn segment() -> impl Strategy<Value = Segment<'static>> {
    random::segment().prop_map(|s| Segment {
        length: s.length,
        front: s.front,
        back: s.back,
        fields_front: s.fields_front,
        fields_back: s.fields_back,
    })
}

/// Quadrature of overlaps and of triangular Gaussians is good to 1e-12 of the brightest colour; where a
/// narrow window is cut out of a segment, the cut's rounding takes 1e-10 of it.
const TOLERANCE: f64 = 2e-10;

fn integrate(transfer_function: &TransferFunction, segment: &Segment) -> Contribution {
    CompiledTransferFunction::new(transfer_function)
        .expect("a valid transfer function")
        .integrate(segment, WidgetBlend::Exact)
}

fn part(segment: &Segment<'static>, from: f64, to: f64) -> Segment<'static> {
    let at =
        |t: f64| -> [f64; 2] { std::array::from_fn(|i| segment.front[i] * (1.0 - t) + segment.back[i] * t) };
    let (front, back) = (segment.fields_front, segment.fields_back);
    let further = |t: f64| fields(std::array::from_fn(|i| front[i] * (1.0 - t) + back[i] * t));
    Segment {
        length: segment.length * (to - from),
        front: at(from),
        back: at(to),
        fields_front: further(from),
        fields_back: further(to),
    }
}

/// The most that C can be: the brightest colour, times D/U for the constant-emitter.
fn brightness(transfer_function: &TransferFunction, segment: &Segment) -> f64 {
    let colors = transfer_function.widgets.iter().map(|w| match &w.profile {
        Profile::PiecewiseLinear { .. } | Profile::Table(_) => 1.0,
        _ => w.color.into_iter().fold(0.0, f64::max),
    });
    match transfer_function.model {
        OpticalModel::DensityEmitter => colors.fold(0.0, f64::max),
        OpticalModel::ConstantEmitter { .. } => {
            colors.sum::<f64>() * segment.length / transfer_function.unit_distance
        }
    }
}

/// Below the least normal number there are no digits to hold: a widget's tail may end in 5e-320.
fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= TOLERANCE * scale + f64::MIN_POSITIVE
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(600) })]

    #[test]
    fn splitting_a_segment_changes_nothing(
        transfer_function in transfer_function(), segment in segment(), cut in 0.001..0.999_f64,
    ) {
        let whole = integrate(&transfer_function, &segment);
        let (front, back) = (part(&segment, 0.0, cut), part(&segment, cut, 1.0));
        let parts = [front, back].map(|part| integrate(&transfer_function, &part));
        let mut joined = Composite::default();
        parts.iter().for_each(|part| joined.add(part.color, part.opacity));
        let depth = parts[0].optical_depth + parts[1].optical_depth;
        prop_assert!(close(whole.optical_depth, depth, depth), "T {} {depth}", whole.optical_depth);
        prop_assert!(close(whole.opacity, joined.opacity(), whole.opacity));
        let scale = brightness(&transfer_function, &segment);
        for (a, b) in whole.color.into_iter().zip(joined.color) {
            prop_assert!(close(a, b, scale), "C {a} {b}");
        }
    }

    #[test]
    fn reversing_a_segment_leaves_its_opacity(
        transfer_function in transfer_function(), segment in segment(),
    ) {
        let reversed = Segment {
            front: segment.back,
            back: segment.front,
            fields_front: segment.fields_back,
            fields_back: segment.fields_front,
            ..segment
        };
        let there = integrate(&transfer_function, &segment);
        let back = integrate(&transfer_function, &reversed);
        prop_assert!(close(there.optical_depth, back.optical_depth, there.optical_depth));
        prop_assert!(close(there.opacity, back.opacity, there.opacity));
    }

    #[test]
    fn more_extinction_is_more_opacity_within_bounds(
        mut transfer_function in transfer_function(), segment in segment(), factor in 1.0..1e6_f64,
    ) {
        let less = integrate(&transfer_function, &segment);
        for widget in &mut transfer_function.widgets {
            widget.extinction *= factor;
            if let Profile::PiecewiseLinear { points } = &mut widget.profile {
                points.iter_mut().for_each(|p| p.extinction *= factor);
            }
        }
        let more = integrate(&transfer_function, &segment);
        prop_assert!(less.opacity <= more.opacity * (1.0 + TOLERANCE) + f64::MIN_POSITIVE);
        let brightest = brightness(&transfer_function, &segment) * (1.0 + TOLERANCE);
        for found in [less, more] {
            prop_assert!((0.0..=1.0).contains(&found.opacity));
            prop_assert!(found.color.into_iter().all(|c| c >= 0.0 && c <= brightest), "{:?}", found.color);
        }
    }

    #[test]
    fn one_colour_glows_as_it_absorbs(
        mut transfer_function in transfer_function(), segment in segment(),
    ) {
        transfer_function.model = OpticalModel::DensityEmitter;
        transfer_function.widgets.retain(|w| {
            !matches!(w.profile, Profile::PiecewiseLinear { .. } | Profile::Table(_))
        });
        let color = [0.3, 0.0, 1.7];
        transfer_function.widgets.iter_mut().for_each(|w| w.color = color);
        let found = integrate(&transfer_function, &segment);
        for (a, c) in found.color.into_iter().zip(color) {
            prop_assert!((a - c * found.opacity).abs() <= 4.0 * f64::EPSILON * a);
        }
        // The same by the ordered integral: a second colour that differs by nothing that matters.
        if let Some(widget) = transfer_function.widgets.first_mut() {
            widget.color[1] = 1e-300;
        }
        let ordered = integrate(&transfer_function, &segment);
        for (a, b) in found.color.into_iter().zip(ordered.color) {
            prop_assert!(close(a, b, 1.7 * found.opacity), "{a} {b}");
        }
    }

    #[test]
    fn scaling_length_and_unit_distance_together_changes_nothing(
        mut transfer_function in transfer_function(), segment in segment(), exponent in -90..90,
    ) {
        let before = integrate(&transfer_function, &segment);
        let scale = 2.0_f64.powi(exponent);
        transfer_function.unit_distance *= scale;
        let scaled = Segment { length: segment.length * scale, ..segment };
        // A power of two: not a bit may change.
        prop_assert_eq!(before, integrate(&transfer_function, &scaled));
    }

    #[test]
    fn the_scale_of_the_scene_changes_nothing(
        mut transfer_function in transfer_function(), segment in segment(), exponent in -60..60,
    ) {
        let before = integrate(&transfer_function, &segment);
        // All lengths by a power of two: gradients shrink as lengths grow, and so does what widgets ask of them.
        let scale = 2.0_f64.powi(exponent);
        transfer_function.unit_distance *= scale;
        for widget in &mut transfer_function.widgets {
            for corner in widget.region.iter_mut().flat_map(|region| &mut region.corners) {
                corner[1] /= scale;
            }
            divide_gradients(&mut widget.profile, scale);
        }
        let smaller = |v: [f64; 2]| [v[0], v[1] / scale];
        let scaled = Segment {
            length: segment.length * scale,
            front: smaller(segment.front),
            back: smaller(segment.back),
            ..segment
        };
        prop_assert_eq!(before, integrate(&transfer_function, &scaled));
    }

    #[test]
    fn a_triangular_gaussian_over_one_field_is_that_of_s_and_g(
        segment in segment(), centre in 0.0..1.0_f64, sigma in 0.02..0.5_f64, constant in any::<bool>(),
    ) {
        let model = match constant {
            true => OpticalModel::ConstantEmitter { cutoff: 0.01 },
            false => OpticalModel::DensityEmitter,
        };
        let of = |profile| TransferFunction {
            model,
            unit_distance: 1.0,
            widgets: vec![Widget { profile, color: [1.0, 0.5, 0.2], extinction: 3.0, region: None }], axes: Default::default(),
        };
        let plane = integrate(&of(Profile::TriangularGaussian { centre, sigma }), &segment);
        let (fields_front, fields_back) = (&segment.front, &segment.back);
        // Named in the order of s and g.
        let nd = of(Profile::TriangularGaussianNd {
            fields: vec!["a".into()],
            magnitude: "b".into(),
            centre: vec![centre],
            matrix: vec![vec![1.0 / sigma]],
        });
        let over_field = integrate(&nd, &Segment { fields_front, fields_back, ..segment });
        // Widths by σ before or after: some roundings of x, and of where panels and the window begin.
        prop_assert!(close(plane.optical_depth, over_field.optical_depth, plane.optical_depth));
        prop_assert!(close(plane.color[0], over_field.color[0], brightness(&nd, &segment)));
    }

    #[test]
    fn one_of_two_equal_widgets_can_be_replaced_by_doubling(
        widget in widget(), segment in segment(), constant in any::<bool>(),
    ) {
        let model = OpticalModel::DensityEmitter;
        let mut twice = TransferFunction { model, unit_distance: 1.0, widgets: vec![widget.clone(), widget], axes: Default::default() };
        let mut once = twice.clone();
        once.widgets.truncate(1);
        let double = &mut once.widgets[0];
        double.extinction *= 2.0;
        if let Profile::PiecewiseLinear { points } = &mut double.profile {
            points.iter_mut().for_each(|p| p.extinction *= 2.0);
        }
        let mut scale = 1.0;
        if constant {
            let model = OpticalModel::ConstantEmitter { cutoff: 0.01 };
            (once.model, twice.model, scale) = (model, model, 2.0);
        }
        // The second is the ordered integral of two, the first the closed form of one.
        let (one, two) = (integrate(&once, &segment), integrate(&twice, &segment));
        prop_assert!(close(one.optical_depth, two.optical_depth, one.optical_depth));
        let bright = brightness(&twice, &segment);
        for (a, b) in one.color.into_iter().zip(two.color) {
            prop_assert!(close(scale * a, b, bright), "C {} {b}", scale * a);
        }
    }
}

/// Values of mpmath at 40 digits; 4 ε each.
#[test]
#[expect(clippy::excessive_precision, reason = "as computed, to 18 digits")]
fn special_functions_have_their_digits() {
    use super::special::{dawson, erfcx};
    let table = [
        (0.1, 0.0993359923978528666, 0.896456979969126637),
        (0.29, 0.274274729792979601, 0.741528716452097775),
        (0.31, 0.290882255315697856, 0.727775619601146036),
        (1.0, 0.538079506912768419, 0.427583576155807004),
        (2.5, 0.223083722167435481, 0.210806364061143581),
        (5.0, 0.102134074424276835, 0.110704637733068626),
        (9.9, 0.0507667506518046975, 0.0567024569388322682),
        (10.1, 0.0497512566108298062, 0.055590487009239876),
        (30.0, 0.0166759414010591758, 0.0187958888614167515),
    ];
    for (x, f, e) in table {
        for (name, found, exact) in [("F", dawson(x), f), ("erfcx", erfcx(x), e), ("F(−x)", -dawson(-x), f)]
        {
            assert!(
                (found - exact).abs() <= 4.0 * f64::EPSILON * exact,
                "{name}({x}) = {found}, not {exact}"
            );
        }
    }
}

#[test]
fn a_wrong_number_is_refused_with_its_place() {
    use voltet_core::transfer::{Region, Widget};
    let widget = Widget { profile: Profile::Uniform, color: [1.0, -0.1, 0.0], extinction: 1.0, region: None };
    let region = Some(Region::rectangle([0.0, 1.0], [0.0, 1.0]));
    let model = OpticalModel::DensityEmitter;
    let of = |widget: Widget| TransferFunction {
        model,
        unit_distance: 1.0,
        widgets: vec![widget],
        axes: Default::default(),
    };
    let message = |t: &TransferFunction| CompiledTransferFunction::new(t).expect_err("refused").to_string();
    let negative = message(&of(widget.clone()));
    assert!(negative.contains("colour") && negative.contains("widgets[0]"), "{negative}");
    let right = Widget { color: [1.0; 3], region, ..widget };
    assert!(message(&of(Widget { region: None, ..right.clone() })).contains("region"));
    assert!(message(&of(Widget { extinction: f64::NAN, ..right.clone() })).contains("extinction"));
    let mut bad_unit = of(right);
    assert!(CompiledTransferFunction::new(&bad_unit).is_ok());
    bad_unit.unit_distance = 0.0;
    assert!(message(&bad_unit).contains("unit distance"));
}
