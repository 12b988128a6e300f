//! The integrators that sample or look up, in lanes, against their own 64-bit truths, on every lane set.

use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::optics::integrators::{self, Extent};
use voltet_core::optics::{Overlap, Prepared, Segment};
use voltet_core::progress::Silent;
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_engine::{Integrated, Segments, keep_all, segments};
use voltet_judge::segment_cases;
use voltet_judge::segment_twin::{Measure, change_of_places, numbers};
use voltet_testing::pictures::grids::{cube, smooth};
use voltet_testing::pictures::looks::outside;

/// Of ε (4 |truth| + change + what a shift of each sample changes). Exponentials and quotients leave some steps of 32 bits; so does
/// the table that is filled in them.
const TOLERANCE: f64 = 16.0;

fn shading(integrator: Integrator) -> Shading {
    Shading { integrator, overlap: Overlap::Exact, silhouette: None, light: None }
}

/// Places of the samples.
fn places(integrator: &Integrator) -> Vec<f64> {
    match *integrator {
        Integrator::Riemann { count } => (0..count).map(|i| (i as f64 + 0.5) / count as f64).collect(),
        Integrator::Segments { count, .. } => (0..=count).map(|i| i as f64 / count as f64).collect(),
        _ => Vec::new(),
    }
}

/// Stored values lie within twice the power of two above their span, and are rounded there.
fn spans(list: &[Segment]) -> Vec<f64> {
    let values = |a: usize| {
        list.iter().flat_map(move |segment| match a {
            0 | 1 => [segment.front[a], segment.back[a]],
            _ => [segment.fields_front[a - 2], segment.fields_back[a - 2]],
        })
    };
    let span = |a: usize| {
        let [low, high] =
            values(a).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        if high > low { (high - low).log2().ceil().exp2() } else { 0.0 }
    };
    (0..2 + list[0].fields_front.len()).map(span).collect()
}

/// What the judged segments of one integrator came to.
#[derive(Default)]
struct Found {
    judged: usize,
    left: BTreeMap<&'static str, usize>,
    worst: f64,
    broken: Vec<String>,
}

impl Found {
    /// Judges each segment of a scene on each lane set.
    fn judge(&mut self, name: &str, look: &TransferFunction, integrator: Integrator, list: &[Segment]) {
        let longest = list.iter().map(|segment| segment.length).fold(0.0, f64::max);
        let scalars = || list.iter().flat_map(|segment| [segment.front[0], segment.back[0]]);
        let scalar = [scalars().fold(f64::INFINITY, f64::min), scalars().fold(f64::NEG_INFINITY, f64::max)];
        let extent = Extent { scalar, longest };
        // What is subdivided to a tolerance is held to the closed forms themselves.
        let (truth, tolerance) = match integrator {
            Integrator::Adaptive { tolerance } => (Integrator::Analytic, tolerance),
            _ => (integrator, 0.0),
        };
        let truth = integrators::new(&truth, Overlap::Exact, look, &extent).expect("serves");
        let prepared = Prepared::new(look).expect("valid");
        let spans = spans(list);
        let brightest = look.widgets.iter().map(Widget::brightest).sum::<f64>();
        let measures: Vec<(Measure, [f64; 5])> = list
            .iter()
            .map(|segment| {
                let measure = Measure::new(truth.as_ref(), segment, &|a, _| spans[a]);
                let exact = numbers(&measure.exact);
                let mut further = change_of_places(&prepared, segment, &places(&integrator), exact);
                if integrator.has_table_of_lengths() {
                    // A place errs by an ε of the table's side, and the entries about it may differ by all that glows.
                    let side = integrator.numbers().table_size.map_or(0.0, |side| side as f64);
                    let light = match look.model {
                        OpticalModel::DensityEmitter => exact[4],
                        OpticalModel::ConstantEmitter { .. } => segment.length / look.unit_distance,
                    };
                    further[1..4].fill(side * light * brightest / TOLERANCE);
                }
                further[1..4]
                    .iter_mut()
                    .for_each(|x| *x += tolerance / (TOLERANCE * f64::from(f32::EPSILON)));
                (measure, further)
            })
            .collect();
        for Segments { lanes, .. } in Segments::each() {
            let drawn = segments(lanes, look, &shading(integrator), false, list).expect("draws");
            for ((segment, (measure, further)), Integrated { contribution, left }) in
                list.iter().zip(&measures).zip(drawn)
            {
                if let Some(why) = left {
                    *self.left.entry(why).or_default() += 1;
                }
                let scale = match look.model {
                    OpticalModel::DensityEmitter => 1.0,
                    OpticalModel::ConstantEmitter { .. } => segment.length / look.unit_distance,
                };
                let ratio = measure.ratio(&contribution, *further, TOLERANCE, brightest * scale);
                self.judged += 1;
                self.worst = self.worst.max(ratio);
                if ratio > 1.0 {
                    self.broken.push(format!(
                        "{name} by {} on {}: {ratio:.2}: {contribution:?} for {:?}, {segment:?} {left:?}",
                        integrator.name(),
                        lanes.name(),
                        measure.exact
                    ));
                }
            }
        }
    }

    fn passed(&self) {
        println!("{} judged, worst {:.3}, left {:?}", self.judged, self.worst, self.left);
        let shown = self.broken.len().min(10);
        assert!(self.broken.is_empty(), "{}\n{}", self.broken.len(), self.broken[..shown].join("\n"));
    }
}

/// Samples alone, in twos, in groups of four with one over, and so many that Gaussians follow from step to step.
const SAMPLING: [Integrator; 6] = [
    Integrator::Riemann { count: 1 },
    Integrator::Riemann { count: 2 },
    Integrator::Riemann { count: 13 },
    Integrator::Segments { count: 1, table_size: 33 },
    Integrator::Segments { count: 6, table_size: 33 },
    Integrator::Riemann { count: 64 },
];

#[test]
fn samples_are_those_of_64_bits_on_the_exact_cases() {
    let mut all: [Found; SAMPLING.len()] = Default::default();
    for (n, (id, _, case)) in segment_cases().expect("well formed").into_iter().enumerate() {
        let which = n % SAMPLING.len();
        all[which].judge(&id, &case.transfer_function, SAMPLING[which], &[case.segment()]);
    }
    for found in &all {
        found.passed();
        assert!(found.judged > 100, "only {} values were judged", found.judged);
        // What is left to 64 bits: the widest segments, and depths beyond 32 bits.
        let left: usize = found.left.values().sum();
        assert!(20 * left < found.judged, "{left} of {} were left to 64 bits", found.judged);
    }
}

/// Numbers in [0, 1) that 32 bits hold: SplitMix64 (Steele, Lea & Flood 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from((((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64) as f32)
    }
}

/// Segments over the unit square, of lengths up to `longest`; every eighth flat in s, in g or in both.
fn random_segments(count: usize, longest: f64) -> Vec<Segment<'static>> {
    let mut numbers = Numbers(7);
    let mut segment = |i: usize| {
        let [front, mut back] = [[numbers.next(), numbers.next()], [numbers.next(), numbers.next()]];
        for (axis, back) in back.iter_mut().enumerate() {
            if i.is_multiple_of(8) && (i / 8) % 3 != axis {
                *back = front[axis];
            }
        }
        // The first spans what all do.
        let [front, back] = if i == 0 { [[0.0; 2], [1.0; 2]] } else { [front, back] };
        let length = if i == 0 { longest } else { numbers.next() * longest };
        Segment { length, front, back, fields_front: &[], fields_back: &[] }
    };
    (0..count).map(&mut segment).collect()
}

const MODELS: [OpticalModel; 2] =
    [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 0.25 }];

fn widget(profile: Profile, color: [f64; 3], extinction: f64) -> Widget {
    Widget { profile, color, extinction, region: None }
}

fn look(model: OpticalModel, widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model, unit_distance: 1.0, widgets }
}

/// A piecewise-linear function, and a Gaussian in front of it and behind.
fn ramp(factor: f64) -> Vec<Widget> {
    let point = |s, extinction, color| ControlPoint { s, color, extinction: factor * extinction };
    let points = vec![
        point(0.1, 0.0, [0.1, 0.2, 0.9]),
        point(0.3, 1.0, [0.1, 0.8, 0.9]),
        point(0.55, 0.3, [0.9, 0.7, 0.1]),
        point(0.9, 6.0, [1.0, 0.1, 0.1]),
    ];
    let gaussian = Profile::Gaussian { centre: [0.5, 0.0], matrix: [[8.0, 0.0], [0.0, 0.0]] };
    vec![
        widget(Profile::PiecewiseLinear { points }, [0.0; 3], 0.0),
        widget(gaussian, [0.5, 1.0, 0.25], factor * 4.0),
    ]
}

#[test]
fn tables_over_lengths_are_those_of_64_bits() {
    let list = random_segments(200, 2.0);
    let mut found = Found::default();
    for model in MODELS {
        // From depths that add a last digit to those of solid matter.
        for factor in [1e-12, 1e-3, 1.0, 100.0, 1e12] {
            for table_size in [2, 9, 34] {
                let integrators = [
                    Integrator::PreIntegrated { table_size, oversampling: 2 },
                    Integrator::PreIntegrated { table_size, oversampling: 3 },
                    Integrator::PreIntegratedCylindrical { table_size, oversampling: 2, planes: 1 },
                    Integrator::PreIntegratedCylindrical { table_size, oversampling: 1, planes: 4 },
                ];
                for integrator in integrators {
                    let name = format!("{model:?} × {factor:e}, side {table_size}");
                    found.judge(&name, &look(model, ramp(factor)), integrator, &list);
                }
            }
        }
    }
    found.passed();
    assert!(found.left.is_empty(), "{:?}", found.left);
}

/// Two or three widgets of every kind.
fn overlapping(extinction: f64) -> Vec<Vec<Widget>> {
    let plane = |s| Profile::Gaussian { centre: [s, 0.5], matrix: [[6.0, 1.0], [0.0, 3.0]] };
    let wave = Wave { origin: [0.1, 0.2], angle: 0.4, scale: [1.0; 2], period: 0.3, band_width: 0.6 };
    let point = |s, extinction, r| ControlPoint { s, color: [r, 0.5, 0.1], extinction };
    let points =
        vec![point(0.0, 0.0, 1.0), point(0.5, 2.0 * extinction, 0.2), point(1.0, 0.5 * extinction, 0.4)];
    let linear = widget(Profile::PiecewiseLinear { points }, [0.0; 3], 1.0);
    let triangular =
        widget(Profile::TriangularGaussian { centre: 0.5, sigma: 0.4 }, [0.2, 1.0, 0.5], extinction);
    let region = Region { corners: vec![[0.2, 0.0], [1.0, 0.3], [0.3, 1.0]] };
    let uniform = Widget { region: Some(region), ..widget(Profile::Uniform, [0.1, 0.2, 1.0], extinction) };
    let red = widget(plane(0.4), [1.0, 0.1, 0.0], extinction);
    let blue = widget(plane(0.6), [0.0, 0.3, 1.2], 0.7 * extinction);
    let sine = widget(Profile::SineWave(wave), [0.9, 0.8, 0.1], extinction);
    let triangle = widget(Profile::TriangleWave(wave), [0.0, 0.8, 0.6], extinction);
    vec![
        vec![red.clone(), blue.clone()],
        vec![red.clone(), uniform, triangular.clone()],
        vec![blue.clone(), sine],
        vec![triangle, linear.clone(), red],
        vec![linear, triangular.clone()],
        vec![Widget { extinction, ..image(5, 4) }, blue],
        vec![triangular],
        vec![Widget { extinction, ..image(3, 5) }],
    ]
}

/// A table widget of any texels.
fn image(width: usize, height: usize) -> Widget {
    let mut numbers = Numbers((width * 100 + height) as u64);
    let texels = (0..width * height).map(|_| std::array::from_fn(|_| numbers.next() as f32)).collect();
    let table = Table { width, height, texels, s: [0.125, 0.875], g: [0.0, 0.75] };
    widget(Profile::Table(Arc::new(table)), [0.0; 3], 3.0)
}

/// A tolerance is met within the rounding of 32 bits; samples are those of 64 bits whatever the widgets, also where depths are those
/// of solid matter.
#[test]
fn every_kind_of_widget_is_sampled_and_subdivided() {
    let list = random_segments(96, 2.0);
    let mut sampled = Found::default();
    let mut subdivided = Found::default();
    for model in MODELS {
        for extinction in [1e-12, 0.1, 3.0, 300.0, 1e12] {
            for (number, widgets) in overlapping(extinction).into_iter().enumerate() {
                let (look, name) = (look(model, widgets), format!("{model:?} × {extinction:e}, {number}"));
                for integrator in SAMPLING {
                    sampled.judge(&name, &look, integrator, &list);
                }
                if extinction < 1e3 {
                    for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
                        subdivided.judge(&name, &look, Integrator::Adaptive { tolerance }, &list);
                    }
                }
            }
        }
    }
    sampled.passed();
    subdivided.passed();
    assert!(sampled.left.is_empty(), "{:?}", sampled.left);
}

/// Segments that no widget reaches are not asked, and the picture is the same.
#[test]
fn empty_segments_are_left_out_without_a_trace() {
    let volume = smooth(cube([8, 8, 8], 0.2));
    let camera = outside([48, 48]);
    // Narrow, in s alone, so that tables serve it; of two colours, so that segments are taken in order.
    let narrow = |centre, color| {
        let matrix = [[60.0, 0.0], [0.0, 0.0]];
        widget(Profile::Gaussian { centre: [centre, 0.0], matrix }, color, 30.0)
    };
    for model in MODELS {
        let look = look(model, vec![narrow(0.4, [1.0, 0.2, 0.1]), narrow(0.7, [0.1, 0.4, 1.0])]);
        for integrator in SAMPLING.into_iter().chain([
            Integrator::PreIntegrated { table_size: 128, oversampling: 2 },
            Integrator::PreIntegratedCylindrical { table_size: 128, oversampling: 2, planes: 1 },
            Integrator::Adaptive { tolerance: 1e-3 },
        ]) {
            // Cells are the same: a table's domain is that of the cells that are drawn.
            let draw = |no_leave_out| {
                let mut cells = keep_all(&volume, &look, &camera).expect("keeps");
                cells.no_leave_out = no_leave_out;
                voltet_engine::draw(&cells, &look, &camera, &shading(integrator), &Silent).expect("draws")
            };
            let (usual, counts) = draw(false);
            let (whole, all) = draw(true);
            let pairs = usual.rgba.iter().flatten().zip(whole.rgba.iter().flatten());
            let difference = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            let name = format!("{integrator:?}, {model:?}");
            assert!(whole.rgba.iter().any(|p| p[3] > 0.3), "{name}: nothing to see");
            // 1e-8 of depth each ray and widget, and their rounding.
            assert!(difference < 1e-6, "{name}: {difference:e}");
            // Walks in panels count every segment.
            let walks = matches!(integrator, Integrator::Adaptive { .. });
            assert!(walks || counts.evaluations < all.evaluations, "{name}: {counts:?} {all:?}");
        }
    }
}
