use super::*;
use crate::optics::{Overlap, Segment};
use proptest::prelude::*;

fn widget(profile: Profile) -> Widget {
    Widget { profile, color: [1.0, 0.5, 0.2], extinction: 1.0, region: None }
}

fn gaussian(sigma: f64) -> Widget {
    let k = std::f64::consts::FRAC_1_SQRT_2 / sigma;
    widget(Profile::Gaussian { centre: [0.5, 0.5], matrix: [[k, 0.0], [0.0, k]] })
}

#[test]
fn a_narrow_widget_between_the_vertices_is_seen() {
    let narrow = gaussian(1e-6);
    let bound = |s, g| narrow.profile_bound(&s, &g).expect("a valid widget");
    assert_eq!(bound([0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]), 1.0, "inside the hull");
    assert_eq!(bound([0.0, 1.0, 0.2, 0.3], [0.0, 1.0, 0.1, 0.2]), 1.0, "on an edge");
    assert_eq!(bound([0.0, 0.4, 0.2, 0.3], [0.0, 1.0, 0.1, 0.2]), 0.0, "beside the hull");
    assert_eq!(bound([0.5; 4], [0.4, 0.45, 0.47, 0.49]), 0.0, "flat, on a line through the centre");
}

#[test]
fn a_region_that_only_its_corner_box_meets_is_left_out() {
    let mut uniform = widget(Profile::Uniform);
    uniform.region = Some(Region::rectangle([0.0, 1.0], [f64::NEG_INFINITY, 1.0]));
    let bound = |s, g| uniform.profile_bound(&s, &g).expect("a valid widget");
    // A sliver along s + g = 2.2 passes the corner (1, 1).
    assert_eq!(bound([0.5, 1.7, 1.1, 1.2], [1.7, 0.5, 1.1, 1.0]), 0.0);
    assert_eq!(bound([0.5, 1.7, 0.9, 1.2], [1.7, 0.5, 1.0, 1.0]), 1.0);
}

fn widgets() -> impl Strategy<Value = Widget> {
    let wave = |(period, band_width, angle)| Wave {
        origin: [0.1, 0.2],
        angle,
        scale: [1.0, 0.7],
        period,
        band_width,
    };
    let profile = prop_oneof![
        (0.01..1.0, -1.0..1.0, 0.01..1.0).prop_map(|(a, b, c): (f64, f64, f64)| Profile::Gaussian {
            centre: [0.4, 0.6],
            matrix: [[1.0 / a, b / a], [0.0, 1.0 / c]]
        }),
        (0.01..0.5).prop_map(|sigma| Profile::TriangularGaussian { centre: 0.5, sigma }),
        (0.05..2.0, 0.01..1.0, 0.0..6.0).prop_map(move |w| Profile::TriangleWave(wave(w))),
        (0.05..2.0, 0.01..1.0, 0.0..6.0).prop_map(move |w| Profile::SineWave(wave(w))),
        proptest::collection::vec((0.0..1.0, 0.0..1.0), 1..6).prop_map(|mut points: Vec<(f64, f64)>| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let points = points
                .into_iter()
                .map(|(s, extinction)| ControlPoint { s, color: [1.0; 3], extinction })
                .collect();
            Profile::PiecewiseLinear { points }
        }),
        Just(Profile::Uniform),
    ];
    let region = prop_oneof![
        Just(None),
        (0.0..0.5, 0.5..1.0).prop_map(|(a, b)| Some(Region::rectangle([a, b], [0.2, 0.7]))),
        (0.0..0.5, 0.5..1.0)
            .prop_map(|(a, b)| Some(Region { corners: vec![[a, 0.0], [b, 0.3], [0.5, b + 0.1]] })),
    ];
    (profile, region).prop_map(|(profile, region)| {
        let mut widget = widget(profile);
        widget.region = region;
        if widget.region.is_none() && widget.profile == Profile::Uniform {
            widget.region = Some(Region::rectangle([0.3, 0.6], [0.3, 0.6]));
        }
        widget
    })
}

proptest! {
    /// Along any path through the cell, T ≤ bound × length.
    #[test]
    fn no_path_through_the_cell_exceeds_the_bound(
        widget in widgets(),
        s in proptest::array::uniform4(0.0..1.0_f64),
        g in proptest::array::uniform4(0.0..1.0_f64),
        size in 0.001..1.0_f64,
        from in proptest::array::uniform4(0.001..1.0_f64),
        to in proptest::array::uniform4(0.001..1.0_f64),
    ) {
        let model = OpticalModel::DensityEmitter;
        let transfer_function = TransferFunction { model, unit_distance: 1.0, widgets: vec![widget] };
        let s = s.map(|x| 0.5 + size * (x - 0.5));
        let g = g.map(|x| 0.5 + size * (x - 0.5));
        let mix = |weights: [f64; 4], values: [f64; 4]| {
            let sum: f64 = weights.iter().sum();
            weights.iter().zip(values).map(|(w, v)| w / sum * v).sum::<f64>()
        };
        let (front, back) = ([mix(from, s), mix(from, g)], [mix(to, s), mix(to, g)]);
        let segment = Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
        let prepared = Prepared::new(&transfer_function).expect("valid");
        let depth = prepared.integrate(&segment, Overlap::Exact).optical_depth;
        let bound = Support::new(&transfer_function).expect("valid").bound(&s, &g, &[]);
        prop_assert!(depth <= bound * (1.0 + 1e-9) + 1e-300, "{depth} > {bound}");
    }
}
