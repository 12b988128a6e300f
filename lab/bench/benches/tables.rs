//! Errors of tables against their size, and what every integrator costs and misses, as Markdown tables.
//!
//! `cargo bench --bench tables`. The segments are a fixed pseudo-random set; errors are those of (C, A), against the
//! closed forms and the ordered integral.

use std::hint::black_box;
use std::time::Instant;
use voltet::core::Result;
use voltet::core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet::optics::integrators::{Extent, Integrator, SegmentIntegrator, can_serve, new};
use voltet::optics::linear::{emission_weights, front_back};
use voltet::optics::{Contribution, Segment, WidgetBlend};
use voltet_integrators::{PartialTable, PreIntegrated, Segments};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, segments};
use voltet_reference::REFERENCE;

const SEGMENTS: usize = 20_000;
const LONGEST: f64 = 2.0;
const EXTENT: Extent = Extent { scalar: [0.0, 1.0], longest: LONGEST };
const DENSITY: OpticalModel = OpticalModel::DensityEmitter;
const CONSTANT: OpticalModel = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };

fn main() -> Result<()> {
    partial_table();
    print_pre_integrated()?;
    for (model, name) in [(DENSITY, "density-emitter"), (CONSTANT, "constant-emitter")] {
        integrators(&format!("piecewise-linear, {name}"), &piecewise_linear(model))?;
        integrators(&format!("two Gaussians, {name}"), &gaussians(model))?;
    }
    Ok(())
}

/// Numbers in [0, 1): SplitMix64 (Steele, Lea & Flood 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Ends of neighbouring values, as in cells: half of the segments span under a tenth of the range.
fn random_segments() -> Vec<Segment<'static>> {
    let mut numbers = Numbers(1);
    let mut segment = || {
        let front: [f64; 2] = std::array::from_fn(|_| numbers.next());
        let reach = if numbers.next() < 0.5 { 0.1 } else { 1.0 };
        let back = front.map(|v| (v + reach * (numbers.next() - 0.5)).clamp(0.0, 1.0));
        let length = LONGEST * numbers.next();
        Segment { length, front, back, fields_front: &[], fields_back: &[] }
    };
    (0..SEGMENTS).map(|_| segment()).collect()
}

fn piecewise_linear(model: OpticalModel) -> TransferFunction {
    let point = |s, extinction, color| ControlPoint { s, color, extinction };
    let points = vec![
        point(0.1, 0.0, [0.1, 0.2, 0.9]),
        point(0.3, 1.0, [0.1, 0.8, 0.9]),
        point(0.55, 0.3, [0.9, 0.7, 0.1]),
        point(0.9, 6.0, [1.0, 0.1, 0.1]),
    ];
    let profile = Profile::PiecewiseLinear { points };
    let widget = Widget { profile, color: [0.0; 3], extinction: 6.0, region: None };
    TransferFunction { model, unit_distance: 1.0, widgets: vec![widget], axes: Default::default() }
}

fn gaussians(model: OpticalModel) -> TransferFunction {
    let gaussian = |centre, matrix, color| Widget {
        profile: Profile::Gaussian { centre, matrix },
        color,
        extinction: 4.0,
        region: None,
    };
    let widgets = vec![
        gaussian([0.4, 0.5], [[5.0, 0.0], [0.0, 2.0]], [1.0, 0.5, 0.1]),
        gaussian([0.55, 0.6], [[4.0, 1.5], [-1.0, 3.0]], [0.1, 0.5, 1.0]),
    ];
    TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() }
}

fn milliseconds<T>(make: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let made = make();
    (start.elapsed().as_secs_f64() * 1e3, made)
}

/// Nanoseconds of one of `count` calls, the least of 5 runs.
fn nanoseconds(count: usize, mut run: impl FnMut()) -> f64 {
    let once = |_| milliseconds(&mut run).0;
    (0..5).map(once).fold(f64::INFINITY, f64::min) * 1e6 / count as f64
}

fn partial_table() {
    let depth = |k: usize| 10.0_f64.powf(-6.0 + k as f64 / 20.0);
    let pairs: Vec<(f64, f64)> = (0..200).flat_map(|i| (0..200).map(move |j| (depth(i), depth(j)))).collect();
    println!("\nThe partial pre-integration table, pieces of depth 1e-6 to 1e4\n");
    println!("| weights | side | KiB | fill, ms | largest error | look-up, ns | closed form, ns |");
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: |");
    for (density, name) in [(true, "front's share of the light"), (false, "F and B")] {
        let exact = |a, b| if density { emission_weights(a, b) } else { front_back(a, b) };
        let closed = nanoseconds(pairs.len(), || {
            pairs.iter().for_each(|&(a, b)| {
                black_box(exact(a, b));
            });
        });
        for side in [16, 32, 64, 128, 256, 512, 1024] {
            let (fill, table) = milliseconds(|| PartialTable::new(density, side));
            let error = |&(a, b): &(f64, f64)| {
                let (found, exact) = (table.weights(a, b), exact(a, b));
                let scale = if density { exact.0 + exact.1 } else { 1.0 };
                (found.0 - exact.0).abs().max((found.1 - exact.1).abs()) / scale
            };
            let worst = pairs.iter().map(error).fold(0.0, f64::max);
            let look_up = nanoseconds(pairs.len(), || {
                pairs.iter().for_each(|&(a, b)| {
                    black_box(table.weights(a, b));
                });
            });
            let kib = table.bytes() / 1024;
            println!("| {name} | {side} | {kib} | {fill:.1} | {worst:.1e} | {look_up:.0} | {closed:.0} |");
        }
    }
}

/// Largest and mean error of (C, A) over the segments.
fn errors(found: &dyn SegmentIntegrator, exact: &[Contribution]) -> (f64, f64) {
    let error = |(segment, exact): (&Segment, &Contribution)| {
        let found = found.integrate(segment);
        let colors = found.color.iter().zip(exact.color).map(|(a, b)| (a - b).abs());
        colors.fold((found.opacity - exact.opacity).abs(), f64::max)
    };
    let all: Vec<f64> = random_segments().iter().zip(exact).map(error).collect();
    (all.iter().copied().fold(0.0, f64::max), all.iter().sum::<f64>() / all.len() as f64)
}

fn exact(transfer_function: &TransferFunction) -> Result<Vec<Contribution>> {
    let analytic = new(&Integrator::ANALYTIC, WidgetBlend::Exact, transfer_function, &EXTENT)?;
    Ok(random_segments().iter().map(|segment| analytic.integrate(segment)).collect())
}

fn print_pre_integrated() -> Result<()> {
    println!("\nPre-integration of a piecewise-linear function, density-emitter: largest and mean error\n");
    println!("| side | MiB | fill, ms | table | | tiles, fill, ms | tiles | |");
    println!("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    let transfer_function = piecewise_linear(DENSITY);
    let exact = exact(&transfer_function)?;
    for side in [16, 32, 64, 128, 256] {
        let (fill, table) = milliseconds(|| PreIntegrated::new(&transfer_function, side, 2, None, &EXTENT));
        let table = table?;
        let (largest, mean) = errors(&table, &exact);
        let mib = table.table_bytes() as f64 / f64::from(1 << 20);
        drop(table);
        let (tile_fill, tiles) =
            milliseconds(|| PreIntegrated::new(&transfer_function, side, 2, Some(1), &EXTENT));
        let (tile_largest, tile_mean) = errors(&tiles?, &exact);
        println!(
            "| {side} | {mib:.1} | {fill:.0} | {largest:.1e} | {mean:.1e} | {tile_fill:.0} | {tile_largest:.1e} \
             | {tile_mean:.1e} |"
        );
    }
    Ok(())
}

fn integrators(name: &str, transfer_function: &TransferFunction) -> Result<()> {
    let list = random_segments();
    let exact = exact(transfer_function)?;
    println!("\n{name}\n\n| integrator | ns a segment | largest error | mean error |");
    println!("| --- | ---: | ---: | ---: |");
    let row = |label: &str, made: &dyn SegmentIntegrator| {
        let (largest, mean) = errors(made, &exact);
        let time = nanoseconds(list.len(), || {
            list.iter().for_each(|segment| {
                black_box(made.integrate(segment));
            });
        });
        println!("| {label} | {time:.0} | {largest:.1e} | {mean:.1e} |");
    };
    row("analytic", new(&Integrator::ANALYTIC, WidgetBlend::Exact, transfer_function, &EXTENT)?.as_ref());
    row("analytic, mix", new(&Integrator::ANALYTIC, WidgetBlend::Mix, transfer_function, &EXTENT)?.as_ref());
    for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6] {
        let made = new(&Integrator::adaptive(tolerance), WidgetBlend::Exact, transfer_function, &EXTENT)?;
        row(&format!("adaptive, {tolerance:.0e}"), made.as_ref());
    }
    for count in [4, 16, 64] {
        let integrator = segments(count, 256);
        let made = new(&integrator, WidgetBlend::Exact, transfer_function, &EXTENT)?;
        row(&format!("segments, {count}"), made.as_ref());
    }
    row("segments, 16, closed forms", &Segments::new(transfer_function, 16, None)?);
    for count in [4, 16, 64] {
        let made = new(&riemann(count), WidgetBlend::Exact, transfer_function, &EXTENT)?;
        row(&format!("riemann, {count}"), made.as_ref());
    }
    for integrator in [pre_integrated(128, 2), pre_integrated_cylindrical(128, 2, 1), REFERENCE] {
        if can_serve(&integrator, transfer_function).is_ok() {
            row(
                integrator.name(),
                new(&integrator, WidgetBlend::Exact, transfer_function, &EXTENT)?.as_ref(),
            );
        }
    }
    Ok(())
}
