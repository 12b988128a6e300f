//! Pre-integrated tables: what the device fills them with, what it reads from them, and how long that takes.

use crate::device::Device;
use crate::integrators::{shading, stored};
use crate::scene::{Composed, Scenes};
use std::time::Instant;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet_integrators::{Material, PreIntegrated, Ramp};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical};
use voltet_optics::integrators::{Extent, Integrator, new};
use voltet_optics::special::mean_transmittance;
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_shaders::{Axis, Places};
use voltet_testing::segment_twin::{Measure, numbers};
use voltet_testing::segments::{MODELS, segments};

const LONGEST: f64 = 2.0;
const EXTENT: Extent = Extent { scalar: [0.0, 1.0], longest: LONGEST };
/// Values stored over a range of their own.
const AXES: [Axis; 2] = [Axis { offset: -0.5, scale: 2.0 }, Axis { offset: 0.0, scale: 1.0 }];

/// A piecewise-linear function, and a Gaussian in front of it and behind.
fn scene(model: OpticalModel) -> TransferFunction {
    let point = |s, extinction, color| ControlPoint { s, color, extinction };
    let points = vec![
        point(0.1, 0.0, [0.1, 0.2, 0.9]),
        point(0.3, 1.0, [0.1, 0.8, 0.9]),
        point(0.55, 0.3, [0.9, 0.7, 0.1]),
        point(0.9, 6.0, [1.0, 0.1, 0.1]),
    ];
    let linear = Profile::PiecewiseLinear { points };
    let gaussian = Profile::Gaussian { centre: [0.5, 0.0], matrix: [[8.0, 0.0], [0.0, 0.0]] };
    let widget = |profile, extinction| Widget { profile, color: [0.5, 1.0, 0.25], extinction, region: None };
    TransferFunction {
        model,
        unit_distance: 1.0,
        widgets: vec![widget(linear, 0.0), widget(gaussian, 4.0)],
        axes: Default::default(),
    }
}

/// Seconds of `run`, and what it gives.
fn timed<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let made = run();
    (start.elapsed().as_secs_f64(), made)
}

/// The plain loop over D, s_f, s_b and the pieces of the path, on one core (Roettger & Ertl 2002, section 3).
fn four_loops(ramp: &Ramp) -> Vec<[f32; 3]> {
    let n = ramp.size();
    let mut table = Vec::with_capacity(n * n * n);
    for k in 0..n {
        let length = (k as f64 / (n - 1) as f64).powi(2);
        for i in 0..n {
            for j in 0..n {
                let lowest = i.min(j) * ramp.parts;
                let count = i.abs_diff(j) * ramp.parts;
                let step = length / count.max(1) as f64;
                let (mut emission, mut depth) = ([0.0; 3], 0.0_f64);
                for m in 0..count {
                    let at = lowest + if j < i { count - 1 - m } else { m };
                    let piece: &Material = &ramp.pieces[at];
                    let held = piece.extinction * step;
                    let light = (-depth).exp() * mean_transmittance(held) / count as f64;
                    for (sum, glow) in emission.iter_mut().zip(piece.glow) {
                        *sum += light * glow;
                    }
                    depth += held;
                }
                let mean = mean_transmittance(depth);
                let glow = if count == 0 { ramp.nodes[i].glow } else { emission.map(|e| e / mean) };
                table.push(glow.map(|g| g as f32));
            }
        }
    }
    table
}

/// The largest difference of two tables, as a share of the largest entry.
fn difference<const N: usize>(device: &[f32], host: &[[f32; N]]) -> f64 {
    assert_eq!(device.len(), 4 * host.len());
    let host = || host.iter().flat_map(|texel| &texel[..3]);
    let most = host().copied().fold(0.0, f32::max);
    let pairs = device.chunks(4).flat_map(|texel| &texel[..3]).zip(host());
    let largest =
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, |most: f32, x| if x <= most { most } else { x });
    f64::from(largest / most)
}

/// Not the usual numbers, so that both are seen to arrive.
const PARTS: usize = 3;
const PLANES: usize = 2;

/// The integrators with a table of lengths.
fn both(table_size: usize) -> [Integrator; 2] {
    let oversampling = PARTS;
    [pre_integrated(table_size, oversampling), pre_integrated_cylindrical(table_size, oversampling, PLANES)]
}

fn ready(transfer_function: &TransferFunction, integrator: Integrator) -> Composed {
    let scene = Composed::new(transfer_function, &shading(integrator), &AXES, 0.5, Some(&EXTENT));
    scene.expect("has pieces").expect("in range")
}

#[test]
fn the_device_fills_tables_as_the_host_does() {
    let Some(device) = Device::open() else { return };
    // No multiple of a workgroup, and of 4.
    let side = 27;
    for model in MODELS {
        let transfer_function = scene(model);
        let [table, tiles] = both(side).map(|integrator| {
            let scene = ready(&transfer_function, integrator);
            let buffers = scene.tables(&device);
            let mut found = device.read(&buffers[buffers.len() - 1]);
            // Behind the colours stand the mean extinctions.
            let shader_key = &scene.shader_key;
            let places = Places::new(&transfer_function, &shading(integrator), shader_key.number_count());
            found.truncate(places.first_entry() as usize);
            found
        });
        let host = PreIntegrated::new(&transfer_function, side, PARTS, None, &EXTENT).expect("serves");
        let host_tiles =
            PreIntegrated::new(&transfer_function, side, PARTS, Some(PLANES), &EXTENT).expect("serves");
        let found = [difference(&table, &host.glow), difference(&tiles, &host_tiles.glow)];
        let ramp = Ramp::new(&transfer_function, side, PARTS, &EXTENT).expect("valid");
        let plain = difference(&table, &four_loops(&ramp));
        println!("{model:?}: {found:?}, {plain:e} from the plain loop");
        // A depth of up to 12, a sum of up to 26 PARTS pieces: an ε for each, and 4 for the quotients.
        let most = f64::from(f32::EPSILON) * (12.0 + (26 * PARTS) as f64 + 4.0);
        assert!(found.into_iter().chain([plain]).all(|x| x < most), "{found:?} {plain}");
    }
}

#[test]
fn tables_are_read_as_by_their_truths() {
    let Some(device) = Device::open() else { return };
    let scenes = Scenes::new(device);
    let mut segments = segments(300, LONGEST);
    // Longer than the longest, of no length, and outside the range of the values.
    segments.extend([1.5 * LONGEST, 0.0].map(|length| Segment { length, ..segments[3] }));
    segments.push(Segment { front: [-0.25, 0.0], back: [1.25, 0.0], ..segments[3] });
    for model in MODELS {
        let transfer_function = scene(model);
        for integrator in both(27) {
            let truth = new(&integrator, WidgetBlend::Exact, &transfer_function, &EXTENT).expect("serves");
            let found = scenes.integrate(&ready(&transfer_function, integrator), &segments);
            let mut worst = (0.0, 0);
            for (i, (segment, found)) in segments.iter().zip(found).enumerate() {
                let measure = Measure::new(truth.as_ref(), segment, &stored(&AXES));
                // Entries differ by what the fill may err by; a place errs by an ε of the table's side, and the entries
                // about it may differ by all that glows.
                let exact = numbers(&measure.exact);
                let light = |x: f64| 70.0 * x + 27.0 * segment.length;
                let further = [0.0, light(exact[1]), light(exact[2]), light(exact[3]), 0.0];
                let ratio = measure.ratio(&found, further, 1.0, 2.0);
                if ratio > worst.0 {
                    worst = (ratio, i);
                }
            }
            println!("{} {model:?}: {worst:?}", integrator.name());
            assert!(worst.0 <= 1.0, "{} {model:?}: {worst:?} {:?}", integrator.name(), segments[worst.1]);
        }
    }
}

/// Largest and mean error of (C, A).
fn errors(found: &[Contribution], exact: &[Contribution]) -> [f64; 2] {
    let error = |(a, b): (&Contribution, &Contribution)| {
        let pairs = numbers(a).into_iter().zip(numbers(b)).skip(1);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let all: Vec<f64> = found.iter().zip(exact).map(error).collect();
    [all.iter().copied().fold(0.0, f64::max), all.iter().sum::<f64>() / all.len() as f64]
}

/// `cargo test -p voltet-shaders --test twins figures -- --ignored --nocapture`
#[test]
#[ignore = "prints figures"]
fn figures_of_tables() {
    let Some(device) = Device::open() else { return };
    let scenes = Scenes::new(device);
    let transfer_function = scene(OpticalModel::DensityEmitter);
    let segments = segments(1 << 16, LONGEST);
    let analytic =
        new(&Integrator::ANALYTIC, WidgetBlend::Exact, &transfer_function, &EXTENT).expect("serves");
    let exact: Vec<Contribution> = segments.iter().map(|segment| analytic.integrate(segment)).collect();
    println!("on {}, {} segments, density-emitter", scenes.device.name, segments.len());
    println!(
        "| side | four loops, ms | windows, ms | device, ms | speed-up | table: read, ms | largest | mean | tiles: fill, ms | read, ms | largest | mean |"
    );
    println!("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for side in [32, 64, 128] {
        let ramp = Ramp::new(&transfer_function, side, PARTS, &EXTENT).expect("valid");
        let (plain, _) = timed(|| four_loops(&ramp));
        let (windows, _) =
            timed(|| PreIntegrated::new(&transfer_function, side, PARTS, None, &EXTENT).expect("serves"));
        let mut row = Vec::new();
        for integrator in both(side) {
            let ready = ready(&transfer_function, integrator);
            let prepared = scenes.device.prepare(&ready.resources);
            scenes.device.wait();
            let (fill, ()) = timed(|| {
                scenes.device.fill(&prepared);
                scenes.device.wait();
            });
            let found = scenes.integrate(&ready, &segments);
            let read = scenes.seconds(&ready, &segments, 20);
            row.push((fill, read, errors(&found, &exact)));
        }
        let [(fill, read, [most, mean]), (tile_fill, tile_read, [tile_most, tile_mean])] = row[..] else {
            unreachable!("two integrators")
        };
        let ms = 1e3;
        println!(
            "| {side} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {most:.1e} | {mean:.1e} | {:.1} | {:.1} | \
             {tile_most:.1e} | {tile_mean:.1e} |",
            plain * ms,
            windows * ms,
            fill * ms,
            plain / fill,
            read * ms,
            tile_fill * ms,
            tile_read * ms,
        );
    }
}
