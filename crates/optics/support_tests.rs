use crate::{CompiledTransferFunction, Segment, WidgetBlend};
use proptest::prelude::*;
use voltet_core::transfer::*;
use voltet_core::transfer::{Profile, Region};

fn widget(profile: Profile) -> Widget {
    Widget { profile, color: [1.0, 0.5, 0.2], extinction: 1.0, region: None }
}

fn gaussian(sigma: f64) -> Widget {
    let k = std::f64::consts::FRAC_1_SQRT_2 / sigma;
    widget(Profile::Gaussian { centre: [0.5, 0.5], matrix: [[k, 0.0], [0.0, k]] })
}

/// Bound of a widget of extinction 1, which is that of its profile.
fn profile_bound(widget: &Widget, s: [f64; 4], g: [f64; 4]) -> f64 {
    let (model, widgets) = (OpticalModel::DensityEmitter, vec![widget.clone()]);
    let look = TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() };
    Support::new(&look).expect("a valid widget").bound(&Corners { s: &s, g: &g, fields: &[] })
}

fn touches(support: &Support, corners: &Corners, least: f64) -> bool {
    support.first_overlapping_widget(0, corners, least).is_some()
}

/// Values that are the same at all corners.
const EVEN: Corners = Corners { s: &[0.5; 4], g: &[0.5; 4], fields: &[] };

#[test]
fn a_narrow_widget_between_the_vertices_is_seen() {
    let narrow = gaussian(1e-6);
    let bound = |s, g| profile_bound(&narrow, s, g);
    assert_eq!(bound([0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]), 1.0, "inside the hull");
    assert_eq!(bound([0.0, 1.0, 0.2, 0.3], [0.0, 1.0, 0.1, 0.2]), 1.0, "on an edge");
    assert_eq!(bound([0.0, 0.4, 0.2, 0.3], [0.0, 1.0, 0.1, 0.2]), 0.0, "beside the hull");
    assert_eq!(bound([0.5; 4], [0.4, 0.45, 0.47, 0.49]), 0.0, "flat, on a line through the centre");
}

#[test]
fn a_region_that_only_its_corner_box_meets_is_left_out() {
    let mut uniform = widget(Profile::Uniform);
    uniform.region = Some(Region::rectangle([0.0, 1.0], [f64::NEG_INFINITY, 1.0]));
    let bound = |s, g| profile_bound(&uniform, s, g);
    // A sliver along s + g = 2.2 passes the corner (1, 1).
    assert_eq!(bound([0.5, 1.7, 1.1, 1.2], [1.7, 0.5, 1.1, 1.0]), 0.0);
    assert_eq!(bound([0.5, 1.7, 0.9, 1.2], [1.7, 0.5, 1.0, 1.0]), 1.0);
}

/// What lies on an edge of a region is in it, so a cell whose values reach just there is not left out: where they stay on the
/// edge, all of the cell is inside.
#[test]
fn values_on_an_edge_of_a_region_are_in_it() {
    let mut uniform = widget(Profile::Uniform);
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let five = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0]];
    for corners in [square.to_vec(), five.to_vec()] {
        uniform.region = Some(Region { corners });
        let bound = |s, g| profile_bound(&uniform, s, g);
        for (on, beyond) in [(0.0, -0.1), (1.0, 1.1)] {
            assert_eq!(bound([on; 4], [0.2, 0.4, 0.6, 0.8]), 1.0, "s stays at {on}");
            assert_eq!(bound([0.2, 0.4, 0.6, 0.8], [on; 4]), 1.0, "g stays at {on}");
            assert_eq!(bound([on, on, beyond, beyond], [0.2, 0.4, 0.6, 0.8]), 1.0, "s reaches {on}");
            assert_eq!(bound([beyond; 4], [0.2, 0.4, 0.6, 0.8]), 0.0, "s stays at {beyond}");
        }
    }
}

/// Each of three widgets adds two thirds of what counts, all of them together twice as much.
#[test]
fn widgets_that_are_too_thin_alone_count_together() {
    let region = Some(Region::rectangle([-1.0, 2.0], [-1.0, 2.0]));
    let thin = |profile| Widget { extinction: 2e-7, region: region.clone(), ..widget(profile) };
    let wide = Profile::Gaussian { centre: [0.5; 2], matrix: [[1e-3, 0.0], [0.0, 1e-3]] };
    for profile in [Profile::Uniform, wide] {
        let widgets = vec![thin(profile); 3];
        let look = TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: 1.0,
            widgets,
            axes: Default::default(),
        };
        let support = Support::new(&look).expect("valid");
        let touches = |least| touches(&support, &EVEN, least);
        assert!(touches(3e-7) && touches(5.9e-7) && !touches(6.1e-7));
    }
}

/// Cells whose answers two transfer functions of the same shapes share, and where they part.
#[test]
fn answers_stay_while_an_extinction_moves_between_two_steps() {
    let least = 1e-7;
    let of = |extinction: f64, color: [f64; 3], model| {
        let widget = Widget { extinction, color, ..gaussian(0.01) };
        let look = TransferFunction {
            model,
            unit_distance: 1.0,
            widgets: vec![widget.clone(), widget],
            axes: Default::default(),
        };
        Support::new(&look).expect("valid").in_steps(least)
    };
    let density = OpticalModel::DensityEmitter;
    let grey = |extinction| of(extinction, [0.5; 3], density);
    // Each of two widgets adds what counts from 5e-8 on, and steps are its doubles.
    assert_eq!(grey(5e-8 * 5.0), grey(5e-8 * 7.9));
    assert_ne!(grey(5e-8 * 7.9), grey(5e-8 * 8.1));
    assert_eq!(grey(0.0), grey(4.9e-8));
    assert_ne!(grey(0.0), grey(5.1e-8));
    assert_eq!(grey(1.0), of(1.0, [0.1, 0.9, 1.0], density), "a colour that is no brighter than white");
    assert_ne!(grey(1.0), of(1.0, [3.0; 3], density));
    // What glows evenly counts with its brightness, where it absorbs anything.
    let glowing = |extinction, brightness| {
        of(extinction, [brightness; 3], OpticalModel::ConstantEmitter { cutoff: 0.01 })
    };
    assert_ne!(glowing(1e-9, 1.0), glowing(1e-9, 3.0));
    assert_ne!(glowing(0.0, 1.0), glowing(1e-9, 1.0));
}

/// What adds nothing touches nothing, wherever it lies.
#[test]
fn widgets_without_extinction_touch_no_cell() {
    let model = OpticalModel::DensityEmitter;
    let none = Widget { extinction: 0.0, ..gaussian(0.1) };
    let look = TransferFunction { model, unit_distance: 1.0, widgets: vec![none], axes: Default::default() };
    assert!(!touches(&Support::new(&look).expect("valid"), &EVEN, 1e-7));
}

#[test]
fn intervals_of_s_hold_what_widgets_reach() {
    let of = |widgets: Vec<Widget>| {
        let look = TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: 1.0,
            widgets,
            axes: Default::default(),
        };
        look.intervals_of_s(1.0, 1e-8)
    };
    assert_eq!(of(vec![]), [[0.0; 2]; 0]);
    assert_eq!(of(vec![widget(Profile::Uniform)]), [[f64::NEG_INFINITY, f64::INFINITY]]);
    // A profile of exp(−s²/2σ²): 1e-8 is √(2 ln 1e8) = 6.07 widths away.
    let [[low, high]] = of(vec![gaussian(0.01)])[..] else { panic!("not one interval") };
    assert!((low - (0.5 - 0.0607)).abs() < 1e-4 && (high - (0.5 + 0.0607)).abs() < 1e-4, "{low} {high}");
    // Turned by 45°, ten times as wide along one axis as along the other.
    let turned = widget(Profile::Gaussian { centre: [0.5, 0.5], matrix: [[50.0, 50.0], [5.0, -5.0]] });
    let [[low, high]] = of(vec![turned])[..] else { panic!("not one interval") };
    let reach = 1e8_f64.ln().sqrt() * 0.5 * (1.0 / 50.0 + 1.0 / 5.0);
    assert!((low - (0.5 - reach)).abs() < 1e-4 && (high - (0.5 + reach)).abs() < 1e-4, "{low} {high}");
    // Apart and overlapping, and one that a region cuts.
    let at = |s: f64| widget(Profile::Gaussian { centre: [s, 0.5], matrix: [[50.0, 0.0], [0.0, 1.0]] });
    let region = Some(Region::rectangle([0.8, 5.0], [f64::NEG_INFINITY, f64::INFINITY]));
    let cut = Widget { region, ..at(0.85) };
    let found = of(vec![at(5.0), at(0.1), cut, at(0.2)]);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[0][0] < 0.05 && found[0][1] > 0.25 && (found[1][0] - 0.8).abs() < 1e-5, "{found:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(600) })]

    /// Along any path through the cell, T and C ≤ bound × length.
    #[test]
    fn no_path_through_the_cell_exceeds_the_bound(
        widget in voltet_testing::random::widget(),
        s in proptest::array::uniform4(0.0..1.0_f64),
        g in proptest::array::uniform4(0.0..1.0_f64),
        size in 0.001..1.0_f64,
        constant in any::<bool>(),
        from in proptest::array::uniform4(0.001..1.0_f64),
        to in proptest::array::uniform4(0.001..1.0_f64),
        share in 0.0..1.0_f64,
    ) {
        let model = if constant {
            OpticalModel::ConstantEmitter { cutoff: 0.01 }
        } else {
            OpticalModel::DensityEmitter
        };
        let transfer_function = TransferFunction { model, unit_distance: 1.0, widgets: vec![widget], axes: Default::default() };
        let s = s.map(|x| 0.5 + size * (x - 0.5));
        let g = g.map(|x| 0.5 + size * (x - 0.5));
        let mix = |weights: [f64; 4], values: [f64; 4]| {
            let sum: f64 = weights.iter().sum();
            weights.iter().zip(values).map(|(w, v)| w / sum * v).sum::<f64>()
        };
        let prepared = CompiledTransferFunction::new(&transfer_function).expect("valid");
        let support = Support::new(&transfer_function).expect("valid");
        // Values of the further fields that a gaussian-nd widget looks at.
        let all_fields = [s, g, [s[3], s[2], s[1], s[0]]];
        let fields = &all_fields[..transfer_function.fields().len()];
        let corners = Corners { s: &s, g: &g, fields };
        let bound = support.bound(&corners);
        // The quick test agrees with the bound.
        if bound > 0.0 {
            prop_assert!(touches(&support, &corners, bound * 0.999));
            prop_assert!(!touches(&support, &corners, bound * 1.001));
        }
        // Steps keep every cell that is kept without them, and a box that is covered has no other.
        let stepped = support.clone().in_steps(bound * 0.999);
        prop_assert!(bound == 0.0 || touches(&stepped, &corners, bound * 0.999));
        let least = bound * share;
        let over = |[low, high]: [f64; 2], x: &f64| [low.min(*x), high.max(*x)];
        let ranges = [s, g].map(|values| values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], over));
        for support in [&support, &support.clone().in_steps(least)] {
            if support.cover(&ranges, least).is_some() {
                for s_at in s {
                    for g_at in g {
                        let at = Corners { s: &[s_at; 4], g: &[g_at; 4], fields };
                        prop_assert!(touches(support, &at, least));
                    }
                }
            }
        }
        // Whatever g is, nothing counts at an s outside of the intervals.
        let intervals = transfer_function.intervals_of_s(1.0, least);
        for s_at in s.into_iter().filter(|s| intervals.iter().all(|[low, high]| s < low || high < s)) {
            let at = Corners { s: &[s_at; 4], g: &g, fields };
            prop_assert!(support.bound(&at) <= least * (1.0 + 1e-9));
        }
        for first in 0..3 {
            let toucher = support.first_overlapping_widget(first, &corners, bound * 0.999);
            prop_assert_eq!(toucher.is_some(), bound > 0.0);
        }
        // A path through the inside, and paths that stay at a vertex: there the bound is often reached.
        let corner = |i: usize| std::array::from_fn(|k| f64::from(u8::from(k == i)));
        let vertices = (0..4).map(|i| (corner(i), corner(i)));
        for (from, to) in vertices.chain([(from, to)]) {
            let [fields_front, fields_back] =
                [from, to].map(|weights| fields.iter().map(|field| mix(weights, *field)).collect::<Vec<_>>());
            let segment = Segment {
                length: 1.0,
                front: [mix(from, s), mix(from, g)],
                back: [mix(to, s), mix(to, g)],
                fields_front: &fields_front,
                fields_back: &fields_back,
            };
            let found = prepared.integrate(&segment, WidgetBlend::Exact);
            let most = found.color.into_iter().fold(found.optical_depth, |most, c| most.max(c));
            prop_assert!(most <= bound * (1.0 + 1e-9) + 1e-300, "{most} > {bound}");
        }
    }
}
