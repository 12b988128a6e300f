//! Random widgets of every kind, transfer functions and segments for property tests. A new kind gets its entry in [`profile`] and its
//! arm in [`divide_gradients`].

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::sync::Arc;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, WIDGET_KINDS, Wave, Widget,
};
use voltet_optics::Segment;

fn wave() -> impl Strategy<Value = Wave> {
    (-1.0..1.0, -1.0..1.0, 0.0..6.3, 0.05..3.0, prop_oneof![Just(1.0), 0.01..1.0_f64]).prop_map(
        |(s, g, angle, period, band_width)| Wave {
            origin: [s, g],
            angle,
            scale: [1.0, 0.7],
            period,
            band_width,
        },
    )
}

fn profile() -> impl Strategy<Value = Profile> {
    let gaussian = (0.0..1.0, 0.0..1.0, 0.02..1.0, -1.0..1.0, 0.02..1.0).prop_map(
        |(s, g, a, b, c): (f64, _, f64, f64, f64)| Profile::Gaussian {
            centre: [s, g],
            matrix: [[1.0 / a, b / a], [0.0, 1.0 / c]],
        },
    );
    let triangular =
        (0.0..1.0, 0.02..0.5).prop_map(|(centre, sigma)| Profile::TriangularGaussian { centre, sigma });
    let points = proptest::collection::vec((0.0..1.0, 0.0..1.0, 0.0..1.0), 1..6).prop_map(
        |mut points: Vec<(f64, f64, f64)>| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let point = |(s, c, extinction)| ControlPoint { s, color: [c, 1.0 - c, 0.5], extinction };
            Profile::PiecewiseLinear { points: points.into_iter().map(point).collect() }
        },
    );
    let table = proptest::collection::vec(proptest::array::uniform4(0.0..1.0_f32), 12).prop_map(|texels| {
        Profile::Table(Arc::new(Table { width: 4, height: 3, texels, s: [0.1, 0.9], g: [0.2, 0.8] }))
    });
    let gaussian_nd = (
        proptest::array::uniform3(0.0..1.0_f64),
        proptest::array::uniform3(proptest::array::uniform3(-2.0..2.0_f64)),
        0.0..6.0_f64,
    )
        .prop_map(|(centre, mut matrix, narrow)| {
            (0..3).for_each(|i| matrix[i][i] += narrow);
            Profile::GaussianNd {
                fields: ["a", "b", "c"].map(String::from).to_vec(),
                centre: centre.to_vec(),
                matrix: matrix.map(|row| row.to_vec()).to_vec(),
            }
        });
    let triangular_nd = (
        proptest::array::uniform2(0.0..1.0_f64),
        proptest::array::uniform2(proptest::array::uniform2(-2.0..2.0_f64)),
        0.0..6.0_f64,
    )
        .prop_map(|(centre, mut matrix, narrow)| {
            (0..2).for_each(|i| matrix[i][i] += narrow);
            Profile::TriangularGaussianNd {
                fields: ["c", "a"].map(String::from).to_vec(),
                magnitude: "b".into(),
                centre: centre.to_vec(),
                matrix: matrix.map(|row| row.to_vec()).to_vec(),
            }
        });
    prop_oneof![
        Just(Profile::Uniform),
        gaussian_nd,
        triangular_nd,
        gaussian,
        triangular,
        wave().prop_map(Profile::TriangleWave),
        wave().prop_map(Profile::SineWave),
        points,
        table,
    ]
}

/// A widget over about the unit square, with or without a region.
pub fn widget() -> impl Strategy<Value = Widget> {
    let region = prop_oneof![
        Just(None),
        (0.0..0.5, 0.5..1.0, 0.0..0.5, 0.5..1.0)
            .prop_map(|(a, b, c, d)| Some(Region::rectangle([a, b], [c, d]))),
        (0.0..0.5, 0.5..1.0)
            .prop_map(|(a, b)| Some(Region { corners: vec![[a, 0.0], [b, 0.3], [0.5, b + 0.1]] })),
    ];
    (profile(), region, proptest::array::uniform3(0.0..1.5_f64), -2.0..3.0_f64).prop_map(
        |(profile, region, color, magnitude)| {
            let uniform = profile == Profile::Uniform;
            let all = uniform.then(|| Region::rectangle([0.3, 0.7], [0.2, 0.9]));
            Widget { profile, color, extinction: 10.0_f64.powf(magnitude), region: region.or(all) }
        },
    )
}

/// One widget of each kind, the same each time.
pub fn widget_of_each_kind() -> Vec<Widget> {
    let mut runner = TestRunner::deterministic();
    let mut draw = |_| widget().new_tree(&mut runner).expect("no case is refused").current();
    let drawn: Vec<Widget> = (0..1000).map(&mut draw).collect();
    let of_kind = |kind: &VariantSchema| {
        let found = drawn.iter().find(|widget| widget.profile.name() == kind.name);
        found.unwrap_or_else(|| panic!("no random widget is of the kind {}", kind.name)).clone()
    };
    // A colour map is a piecewise-linear profile.
    WIDGET_KINDS.iter().filter(|kind| !kind.name.ends_with("colormap")).map(of_kind).collect()
}

/// Changes a profile so that it has the same values over gradients that are smaller by a factor.
pub fn divide_gradients(profile: &mut Profile, scale: f64) {
    match profile {
        Profile::Gaussian { centre, matrix } => {
            centre[1] /= scale;
            matrix.iter_mut().for_each(|row| row[1] *= scale);
        }
        Profile::TriangularGaussian { sigma, .. } => *sigma *= scale,
        Profile::TriangleWave(wave) | Profile::SineWave(wave) => {
            wave.origin[1] /= scale;
            wave.scale[1] *= scale;
        }
        Profile::Table(table) => {
            let mut scaled = table.as_ref().clone();
            scaled.g.iter_mut().for_each(|g| *g /= scale);
            *table = scaled.into();
        }
        // Of fields of their own.
        Profile::GaussianNd { .. } | Profile::TriangularGaussianNd { .. } => {}
        Profile::Uniform | Profile::PiecewiseLinear { .. } => {}
    }
}

/// One to three widgets under either model.
pub fn transfer_function() -> impl Strategy<Value = TransferFunction> {
    let model = prop_oneof![
        Just(OpticalModel::DensityEmitter),
        prop_oneof![Just(1.0 / 255.0), 1e-6..0.5_f64]
            .prop_map(|cutoff| OpticalModel::ConstantEmitter { cutoff }),
    ];
    (model, 0.1..2.0_f64, proptest::collection::vec(widget(), 1..4)).prop_map(
        |(model, unit_distance, widgets)| TransferFunction {
            model,
            unit_distance,
            widgets,
            axes: Default::default(),
        },
    )
}

/// Values of the three further fields, kept for as long as the tests run.
pub fn fields(values: [f64; 3]) -> &'static [f64] {
    Box::leak(Box::new(values))
}

/// A segment in the unit square, some of them flat in s, in g or in both, with three further fields.
pub fn segment() -> impl Strategy<Value = Segment<'static>> {
    let value = || proptest::array::uniform2(0.0..1.0_f64);
    let further = || proptest::array::uniform3(0.0..1.0_f64);
    (0.001..10.0_f64, value(), value(), 0..8, further(), further()).prop_map(
        |(length, front, mut back, flat, f, b)| {
            for axis in 0..2 {
                if flat >> axis & 1 == 1 && flat >= 4 {
                    back[axis] = front[axis];
                }
            }
            Segment { length, front, back, fields_front: fields(f), fields_back: fields(b) }
        },
    )
}
