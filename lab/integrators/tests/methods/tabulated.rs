//! Gaussians' integrals from tables, and what is linear between the grid's points.

use crate::found::Found;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_integrators::classified;
use voltet_integrators::{VERTEX_SAMPLED, tabulated};
use voltet_optics::Segment;
use voltet_testing::segments::{Numbers, gaussian, look, overlapping, segments, triangular, uniform, widget};

const MODELS: [OpticalModel; 4] = [
    OpticalModel::DensityEmitter,
    OpticalModel::ConstantEmitter { cutoff: 0.25 },
    OpticalModel::ConstantEmitter { cutoff: 1e-6 },
    OpticalModel::ConstantEmitter { cutoff: 0.0 },
];

/// From depths that add a last digit to those of solid matter.
const EXTINCTIONS: [f64; 5] = [1e-12, 0.1, 3.0, 300.0, 1e12];

/// Further fields of the ends of as many segments.
fn fields(count: usize, ends: usize) -> Vec<Vec<f64>> {
    let mut numbers = Numbers(11);
    (0..ends).map(|_| (0..count).map(|_| numbers.next()).collect()).collect()
}

#[test]
fn widgets_from_tables_are_those_of_64_bits() {
    let mut found = Found::default();
    let list = segments(96, 2.0);
    for model in MODELS {
        for extinction in EXTINCTIONS {
            let red = gaussian(0.4, [1.0, 0.1, 0.0], extinction);
            let blue = gaussian(0.6, [0.0, 0.3, 1.2], 0.7 * extinction);
            // Beyond the table's domain.
            let matrix = [[40.0, 0.0], [0.0, 30.0]];
            let narrow = widget(Profile::Gaussian { centre: [0.5; 2], matrix }, [0.3, 1.0, 0.6], extinction);
            let cut = Widget { region: uniform(1.0).region, ..blue.clone() };
            let in_region = Widget { region: uniform(1.0).region, ..triangular(extinction) };
            let scenes = [
                vec![red.clone()],
                vec![red.clone(), blue],
                vec![red, uniform(extinction), triangular(extinction)],
                vec![narrow, cut],
                vec![in_region, uniform(0.3 * extinction)],
            ];
            for (number, widgets) in scenes.into_iter().enumerate() {
                for table_size in [2, 33, 128] {
                    let name = format!("{model:?} × {extinction:e}, {number}, side {table_size}");
                    let look = look(model, widgets.clone());
                    found.judge(&name, &look, tabulated(table_size), &list);
                }
            }
        }
    }
    found.passed();
    assert!(found.left.is_empty(), "{:?}", found.left);
}

#[test]
fn widgets_over_fields_from_tables_are_those_of_64_bits() {
    let mut found = Found::default();
    let plain = segments(96, 2.0);
    let ends = fields(3, 2 * plain.len());
    let with_fields = |(k, segment): (usize, &Segment<'static>)| Segment {
        fields_front: &ends[2 * k],
        fields_back: &ends[2 * k + 1],
        ..*segment
    };
    let list: Vec<Segment> = plain.iter().enumerate().map(with_fields).collect();
    let names = || ["a".to_string(), "b".to_string()].to_vec();
    for model in MODELS {
        for extinction in EXTINCTIONS {
            let matrix = vec![vec![5.0, 1.0], vec![0.0, 3.0]];
            let centre = vec![0.4, 0.6];
            let nd = Profile::GaussianNd { fields: names(), centre: centre.clone(), matrix: matrix.clone() };
            let triangular =
                Profile::TriangularGaussianNd { fields: names(), magnitude: "m".into(), centre, matrix };
            let cut = Widget {
                region: uniform(1.0).region,
                ..widget(triangular.clone(), [0.9, 0.2, 0.1], extinction)
            };
            let nd = widget(nd, [0.1, 0.6, 0.9], extinction);
            let triangular = widget(triangular, [0.2, 1.0, 0.5], 0.5 * extinction);
            for (number, widgets) in [vec![nd.clone(), triangular], vec![cut, nd]].into_iter().enumerate() {
                let name = format!("{model:?} × {extinction:e}, {number}");
                found.judge(&name, &look(model, widgets), tabulated(128), &list);
            }
        }
    }
    found.passed();
    assert!(found.left.is_empty(), "{:?}", found.left);
}

/// Segments that span more widths than 32 bits resolve fall back to 64 bits, and so do values that are not numbers.
#[test]
fn paths_that_32_bits_do_not_hold_are_left() {
    let matrix = [[1e7, 0.0], [0.0, 0.0]];
    let narrow = widget(Profile::Gaussian { centre: [0.5, 0.0], matrix }, [1.0; 3], 3.0);
    let mut found = Found::default();
    found.judge("narrow", &look(MODELS[0], vec![narrow]), tabulated(33), &segments(8, 2.0));
    found.passed();
    assert!(found.left.values().sum::<usize>() > 0, "nothing was left to 64 bits");
}

/// A scene that is classified at the ends of segments.
fn at_ends(look: &TransferFunction, list: &[Segment]) -> (TransferFunction, Vec<[Vec<f64>; 2]>) {
    let none: &[f64] = &[];
    let points = list.iter().flat_map(|segment| [(segment.front, none), (segment.back, none)]);
    let found = classified(look, points).expect("within range");
    let at = |point: usize| found.arrays.iter().map(|array| array[point]).collect();
    let ends = (0..list.len()).map(|k| [at(2 * k), at(2 * k + 1)]).collect();
    (found.bound, ends)
}

#[test]
fn what_is_linear_between_points_is_that_of_64_bits() {
    let mut found = Found::default();
    let plain = segments(96, 2.0);
    for model in MODELS {
        for extinction in [1e-12, 0.1, 3.0, 300.0, 1e7] {
            for (number, widgets) in overlapping(extinction).into_iter().enumerate() {
                let (bound, ends) = at_ends(&look(model, widgets), &plain);
                let pairs = plain.iter().zip(&ends);
                let list: Vec<Segment> = pairs
                    .map(|(segment, [front, back])| Segment {
                        fields_front: front,
                        fields_back: back,
                        ..*segment
                    })
                    .collect();
                let name = format!("{model:?} × {extinction:e}, {number}");
                found.judge(&name, &bound, VERTEX_SAMPLED, &list);
            }
        }
    }
    found.passed();
    assert!(found.left.is_empty(), "{:?}", found.left);
}
