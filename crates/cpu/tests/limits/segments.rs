//! Single segments: what is read of the fields, what is ordered, what goes in 64 bits.

use super::*;
use voltet_cpu::introspect::{integrate_segments, lane_sets};
use voltet_simd::LaneSet;

/// One widget looks at eight fields at most, several together at more: what is drawn is read where it stands, and what a
/// picture has no room for is refused.
#[test]
fn widgets_look_at_eleven_fields_together() {
    let nd = |fields: std::ops::Range<usize>, extinction: f64| {
        let (count, names) = (fields.len(), fields.map(|k| format!("field {k:02}")).collect());
        let row = |i: usize| (0..count).map(|j| f64::from(u8::from(i == j))).collect();
        let matrix = (0..count).map(row).collect();
        let profile = Profile::GaussianNd { fields: names, centre: vec![0.0; count], matrix };
        Widget { profile, color: [1.0; 3], extinction, region: None }
    };
    // The same all along, so that the depths are the profiles at one point.
    let values: Vec<f64> = (1..=12).map(|k| 0.0625 * f64::from(k)).collect();
    let at = |fields: std::ops::Range<usize>| (-values[fields].iter().map(|v| v * v).sum::<f64>()).exp();
    let draw = |count: usize| {
        let look = look(vec![nd(0..8, 0.5), nd(8..count, 0.3)]);
        let ends = &values[..count];
        let segment =
            Segment { length: 1.0, front: [0.0; 2], back: [0.0; 2], fields_front: ends, fields_back: ends };
        integrate_segments(LaneSet::detect().unwrap(), &look, &SHADING, false, &[segment])
    };
    let depth = draw(11).expect("draws")[0].contribution.optical_depth;
    let exact = 0.5 * at(0..8) + 0.3 * at(8..11);
    // Rounding of the depth to 32 bits: the values have few digits.
    assert!((depth / exact - 1.0).abs() < 2e-7, "{depth} for {exact}");
    let refusal = draw(12).expect_err("more fields than a picture is drawn from").to_string();
    assert!(refusal.contains("12 beside s and g") && refusal.contains("at most 11"), "{refusal}");
}

/// A triangular Gaussian's width is g itself: it keeps its digits where g is a hundred-thousandth of the largest, though no
/// value of the data is 0.
#[test]
fn small_widths_keep_their_digits() {
    let profile = Profile::TriangularGaussian { centre: 0.5, sigma: 1.0 };
    let look = look(vec![Widget { profile, color: [1.0; 3], extinction: 1.0, region: None }]);
    let small = segment([0.5, 1e-5], [0.5 + 1e-5, 1.7e-5]);
    let list = [segment([0.0, 1e-5], [1.0, 1.0]), small];
    let exact = exact_of(&look, &small).optical_depth;
    for lanes in lane_sets() {
        let found = integrate_segments(lanes, &look, &SHADING, false, &list).expect("draws")[1];
        let depth = found.contribution.optical_depth;
        // Some steps of 32 bits in the ends and in the mean; counted from the middle of g they leave 1e-3.
        assert!((depth / exact - 1.0).abs() < 2e-6, "{depth} for {exact} on {}", lanes.name());
        assert_eq!(found.fallback, None, "left to 64 bits on {}", lanes.name());
    }
}

/// What lies near the widgets keeps its digits, though the data reach thirty times as far: a segment along which g changes by
/// a hundred-thousandth of its range is cut where the edge of a region is.
#[test]
fn edges_keep_their_digits_where_the_data_reach_far() {
    let low = Widget {
        region: Some(Region::rectangle([0.0, 2.0], [0.0, 2.5])),
        ..uniform([0.0; 2], 1.0, [1.0; 3])
    };
    let profile = Profile::Gaussian { centre: [4.0, 3.0], matrix: [[9.0, 0.0], [0.0, 0.4]] };
    let look = look(vec![low, Widget { profile, color: [1.0; 3], extinction: 1.0, region: None }]);
    let grazing = segment([0.8, 2.49937], [0.9, 2.50041]);
    let list = [segment([0.0, 0.0], [5.0, 100.0]), grazing];
    let exact = exact_of(&look, &grazing).optical_depth;
    for lanes in lane_sets() {
        let depth = integrate_segments(lanes, &look, &SHADING, false, &list).expect("draws")[1]
            .contribution
            .optical_depth;
        // Some steps of 32 bits at a distance of 1 from the middle of the widgets' places, over what g changes by; from the
        // middle of the data they are fifty times as long.
        assert!((depth - exact).abs() < 2e-4, "{depth} for {exact} on {}", lanes.name());
    }
}
/// Widgets are mixed without regard to their order only where that is worth less than 1e-8.
#[test]
fn overlap_is_ordered_from_a_product_of_depths_on() {
    for depth in [3e-5, 9e-5, 1.1e-4, 3e-4, 1e-3] {
        let halves = [([0.0, 0.5], [1.0, 0.0, 0.0]), ([0.5, 1.0], [0.0, 0.0, 1.0])]
            .map(|(s, c)| uniform(s, 2.0 * depth, c));
        let gaussian = |s, color| {
            let profile = Profile::Gaussian { centre: [s, 0.0], matrix: [[1.0, 0.0], [0.0, 0.0]] };
            Widget { profile, color, extinction: depth, region: None }
        };
        let smooth = [gaussian(-0.5, [1.0, 0.0, 0.0]), gaussian(1.5, [0.0, 0.0, 1.0])];
        for widgets in [halves, smooth] {
            let look = look(widgets.to_vec());
            let across = segment([0.0; 2], [1.0, 0.0]);
            let exact = exact_of(&look, &across).color;
            for lanes in lane_sets() {
                let found = integrate_segments(lanes, &look, &SHADING, false, &[across]).expect("draws")[0];
                for (found, exact) in found.contribution.color.into_iter().zip(exact) {
                    // And some roundings of 32 bits.
                    let bound = 1e-8 + 1e-6 * exact;
                    let error = (found - exact).abs();
                    assert!(error < bound, "depth {depth:e} on {}: {found} for {exact}", lanes.name());
                }
            }
        }
    }
}

/// Segments of s anywhere between 0 and 1, the first of them all of it.
fn some_segments(count: usize) -> Vec<Segment<'static>> {
    let share = |i: usize, step: f64| (0.5 + i as f64 * step).fract();
    let one = |i| match i {
        0 => segment([0.0; 2], [1.0, 0.0]),
        _ => segment([share(i, 0.618), 0.0], [share(i, 0.755), 0.0]),
    };
    (0..count).map(one).collect()
}

/// Where Gaussians extend over up to two widths four points on one or four steps leave 3e-5 of their depth, and where they
/// extend over more, panels leave no more than that.
#[test]
fn overlap_is_integrated_by_as_many_steps_as_it_needs() {
    // A segment spans one unit at most; the first spans all.
    for (widths, extinction) in [(2.0, 1.5), (2.0, 0.4), (8.0, 1.5), (8.0, 0.4)] {
        let gaussian = |s, color| {
            let profile = Profile::Gaussian { centre: [s, 0.0], matrix: [[widths, 0.0], [0.0, 0.0]] };
            Widget { profile, color, extinction, region: None }
        };
        let look = look(vec![gaussian(0.3, [1.0, 0.0, 0.0]), gaussian(0.6, [0.0, 0.0, 1.0])]);
        let list = some_segments(400);
        for lanes in lane_sets() {
            let found = integrate_segments(lanes, &look, &SHADING, false, &list).expect("draws");
            let mut worst = 0.0;
            for (found, segment) in found.iter().zip(&list) {
                let exact = exact_of(&look, segment);
                for (found, color) in found.contribution.color.into_iter().zip(exact.color) {
                    worst = f64::max(worst, (found - color).abs() / exact.optical_depth);
                }
            }
            println!("{worst:.1e} of the depth over {widths} widths on {}", lanes.name());
            assert!(worst < 3e-5, "{worst:e} of the depth over {widths} widths on {}", lanes.name());
        }
    }
}

/// The same where densities fall steeply, towards each other, whichever share each has of the depth: 4e-6 of
/// all light.
#[test]
fn overlap_of_tails_is_integrated_by_as_many_steps_as_it_needs() {
    for (widths, from, thinner) in [0.3, 0.5, 1.0, 2.0]
        .into_iter()
        .flat_map(|w| [1.0, 2.0, 3.5].map(|q| (w, q)))
        .flat_map(|(w, q)| [1.0, 1e-2, 1e-4].map(|f| (w, q, f)))
    {
        let gaussian = |s, share: f64, color| {
            let profile = Profile::Gaussian { centre: [s, 0.0], matrix: [[widths, 0.0], [0.0, 0.0]] };
            Widget { profile, color, extinction: share * 3.0 * f64::exp(from * from), region: None }
        };
        let away = from / widths;
        let look =
            look(vec![gaussian(-away, 1.0, [1.0, 0.0, 0.0]), gaussian(1.0 + away, thinner, [0.0, 0.0, 1.0])]);
        let list = some_segments(100);
        for lanes in lane_sets() {
            let found = integrate_segments(lanes, &look, &SHADING, false, &list).expect("draws");
            for (found, segment) in found.iter().zip(&list) {
                let exact = exact_of(&look, segment);
                for (found, color) in found.contribution.color.into_iter().zip(exact.color) {
                    let error = (found - color).abs();
                    assert!(
                        error < 4e-6,
                        "{found} for {color}, {widths} widths, {from}, {thinner}, on {}",
                        lanes.name()
                    );
                }
            }
        }
    }
}

/// What a region cuts on a segment is dense on a part of it alone, so that its order is that of the part.
#[test]
fn what_a_region_cuts_is_ordered_where_it_is() {
    let red = [1.0, 0.0, 0.0];
    let wave = Wave { origin: [-0.5, 0.0], angle: 0.0, scale: [1.0; 2], period: 4.0, band_width: 1.0 };
    let smooth = |profile, color, region| Widget { profile, color, extinction: 0.05, region };
    let gaussian = |s: f64| Profile::Gaussian { centre: [s, 0.0], matrix: [[0.1, 0.0], [0.0, 0.0]] };
    let half = || Some(Region::rectangle([-1.0, 0.5], [-1.0, 1.0]));
    let behind = smooth(gaussian(0.7), [0.0, 0.0, 1.0], None);
    for profile in [Profile::Uniform, gaussian(0.4), Profile::SineWave(wave)] {
        let look = look(vec![smooth(profile.clone(), red, half()), behind.clone()]);
        for across in [segment([0.0; 2], [1.0, 0.0]), segment([1.0, 0.0], [0.0; 2])] {
            let exact = exact_of(&look, &across).color;
            for lanes in lane_sets() {
                let found = integrate_segments(lanes, &look, &SHADING, false, &[across]).expect("draws")[0];
                for (found, exact) in found.contribution.color.into_iter().zip(exact) {
                    // The panels' 1e-5; taken as if it were everywhere, order is off by a hundredth of the light.
                    assert!(
                        (found - exact).abs() <= 1e-5 * exact,
                        "{profile:?} on {}: {found} for {exact}",
                        lanes.name()
                    );
                }
            }
        }
    }
}

/// Fields far from 0 and waves far from their origin keep their digits: what lies between is taken away in 64 bits.
#[test]
fn what_is_far_from_zero_keeps_its_digits() {
    let widget = |profile| Widget { profile, color: [1.0; 3], extinction: 1.0, region: None };
    let wave = Wave { origin: [-1000.03, 0.0], angle: 0.0, scale: [1.0; 2], period: 0.1, band_width: 1.0 };
    let nd = Profile::GaussianNd {
        fields: vec!["p".into(), "q".into()],
        centre: vec![100.5, -50.2],
        matrix: vec![vec![3.0, 1.0], vec![0.0, 2.0]],
    };
    let (front, back) = ([100.2, -50.4], [100.9, -49.9]);
    for profile in [Profile::SineWave(wave), nd] {
        let look = look(vec![widget(profile)]);
        let names = look.fields().len();
        let across = Segment {
            fields_front: &front[..names],
            fields_back: &back[..names],
            ..segment([0.312, 0.0], [0.377, 0.0])
        };
        let exact = exact_of(&look, &across).optical_depth;
        for lanes in lane_sets() {
            let found = integrate_segments(lanes, &look, &SHADING, false, &[across]).expect("draws")[0];
            let depth = found.contribution.optical_depth;
            // Some steps of 32 bits at the ends; ten thousand bands, or a hundred widths, would leave 1e-4 and more.
            assert!((depth / exact - 1.0).abs() < 4e-6, "{depth} for {exact} on {}", lanes.name());
            assert_eq!(found.fallback, None, "left to 64 bits on {}", lanes.name());
        }
    }
}

/// A depth that 32 bits do not hold is the most that they hold.
#[test]
fn depths_beyond_32_bits_are_finite() {
    let look = look(vec![uniform([-1.0, 2.0], 1e200, [1.0; 3]), uniform([-1.0, 2.0], 1e200, [0.5; 3])]);
    for lanes in lane_sets() {
        let across = segment([0.0; 2], [1.0, 0.0]);
        let found =
            integrate_segments(lanes, &look, &SHADING, false, &[across]).expect("draws")[0].contribution;
        assert_eq!((found.optical_depth, found.opacity), (f64::from(f32::MAX), 1.0), "on {}", lanes.name());
    }
}

/// A tenth inside each limit lanes serve a segment, a tenth beyond it 64 bits do, and it is said why.
#[test]
fn what_32_bits_do_not_hold_is_left_to_64() {
    let widget = |profile| Widget { profile, color: [1.0, 0.5, 0.2], extinction: 1.0, region: None };
    let line = |widths: f64| Profile::Gaussian { centre: [0.5, 0.0], matrix: [[widths, 0.0], [0.0, 0.0]] };
    let everywhere = |extinction, color| uniform([-1.0, 2.0], extinction, color);
    let wave = |bands: f64| {
        let period = 1.0 / bands;
        Profile::SineWave(Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period, band_width: 1.0 })
    };
    let nd = |widths: f64| {
        let (fields, matrix) = (vec!["field".to_owned()], vec![vec![widths]]);
        Profile::GaussianNd { fields, centre: vec![0.5], matrix }
    };
    let triangular_nd = |widths: f64| {
        let (fields, matrix) = (vec!["field".to_owned()], vec![vec![widths]]);
        Profile::TriangularGaussianNd { fields, magnitude: "one".into(), centre: vec![0.5], matrix }
    };
    type Of<'a> = &'a dyn Fn(f64) -> Vec<Widget>;
    let of_gaussian = "100,000 widths of a Gaussian, or 50 of a triangular one";
    let cases: [(f64, f64, Of, &str); 7] = [
        (1e5, 1.0, &|widths| vec![widget(line(widths))], of_gaussian),
        (1e5, 1.0, &|widths| vec![widget(nd(widths))], of_gaussian),
        // g is 1.
        (
            50.0,
            1.0,
            &|widths| vec![widget(Profile::TriangularGaussian { centre: 0.5, sigma: 1.0 / widths })],
            of_gaussian,
        ),
        (50.0, 1.0, &|widths| vec![widget(triangular_nd(widths))], of_gaussian),
        (1e6, 1.0, &|bands| vec![widget(wave(bands))], "its numbers leave 32 bits"),
        (
            1e7,
            1.0,
            &|depth| vec![everywhere(0.9 * depth, [1.0; 3]), everywhere(0.1 * depth, [0.5; 3])],
            "a density of over 10,000,000",
        ),
        // A unit distance of 1e30 lengths.
        (
            1.0,
            1e30,
            &|_| vec![widget(Profile::TriangularGaussian { centre: 0.5, sigma: 0.1 })],
            "lengths per unit distance",
        ),
    ];
    let (one, zero) = ([0.0, 1.0], [1.0, 1.0]);
    for (limit, unit_distance, of, why) in cases {
        for (share, is_left) in [(0.9, false), (1.1, true)] {
            let mut look = look(of(share * limit));
            // A longer unit is a shorter length.
            look.unit_distance = unit_distance * share;
            let names = look.fields().len();
            let across = Segment {
                fields_front: &one[..names],
                fields_back: &zero[..names],
                ..segment([0.0, 1.0], [1.0, 1.0])
            };
            let across = if unit_distance == 1.0 { Segment { length: share, ..across } } else { across };
            for lanes in lane_sets() {
                let found = integrate_segments(lanes, &look, &SHADING, false, &[across]).expect("draws")[0];
                let expected = is_left.then_some(true);
                assert_eq!(
                    found.fallback.map(|fallback| fallback.contains(why)),
                    expected,
                    "{why}, {share} on {}: {:?}",
                    lanes.name(),
                    found.fallback
                );
            }
        }
    }
}

/// However many widgets overlap, lanes put them in order.
#[test]
fn more_widgets_than_eight_overlap_in_lanes() {
    let gaussian = |k: usize| {
        let centre = [0.3 + 0.03 * k as f64, 0.5];
        let color = [k as f64 / 12.0, 1.0 - k as f64 / 12.0, 0.3];
        let profile = Profile::Gaussian { centre, matrix: [[6.0, 0.0], [0.0, 1.0]] };
        Widget { profile, color, extinction: 0.6, region: None }
    };
    let look = look((0..12).map(gaussian).collect());
    // Gentle ones that closed forms serve, and one that is walked in panels.
    let list =
        [segment([0.4, 0.5], [0.42, 0.5]), segment([0.3, 0.4], [0.6, 0.5]), segment([0.0, 0.0], [1.0, 1.0])];
    for lanes in lane_sets() {
        let found = integrate_segments(lanes, &look, &SHADING, false, &list).expect("draws");
        for (found, segment) in found.iter().zip(&list) {
            let exact = exact_of(&look, segment);
            assert_eq!(found.fallback, None, "left to 64 bits on {}", lanes.name());
            for (a, b) in found.contribution.color.into_iter().zip(exact.color) {
                assert!((a - b).abs() < 1e-6, "{a} for {b} on {}", lanes.name());
            }
        }
    }
}
