//! Segments along logarithmic axes: closed forms of 64 bits in straight pieces, and values in closed form, against quadrature.

use voltet_core::transfer::{
    AxisScale, ControlPoint, OpticalModel, Profile, Region, TransferFunction, Wave, Widget,
};
use voltet_optics::trace::{CellCrossing, SegmentIntegral};
use voltet_optics::{CompiledTransferFunction, Contribution};
use voltet_reference::CurvedQuadrature;

const LOG: [AxisScale; 2] = [AxisScale::Log, AxisScale::Log];

fn look(axes: [AxisScale; 2], widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets, axes }
}

fn widget(profile: Profile, extinction: f64, color: [f64; 3]) -> Widget {
    Widget { profile, color, extinction, region: None }
}

fn gaussian(centre: [f64; 2], sigma: [f64; 2], extinction: f64, color: [f64; 3]) -> Widget {
    let [a, b] = sigma.map(|sigma| 1.0 / (2f64.sqrt() * sigma));
    widget(Profile::Gaussian { centre, matrix: [[a, 0.0], [0.0, b]] }, extinction, color)
}

/// ∫ exp(−(ln s − m)²/2σ²) ds over all s > 0 is σ √2π exp(m + σ²/2): a cell over twelve decades around the centre.
#[test]
fn a_log_normal_has_its_area() {
    let (sigma, centre) = (0.2, 2.0);
    let wide = gaussian([centre, 0.0], [sigma, f64::INFINITY], 1e-4, [1.0; 3]);
    let function = look([AxisScale::Log, AxisScale::Linear], vec![wide]);
    let (m, width) = (centre * std::f64::consts::LN_10, sigma * std::f64::consts::LN_10);
    let area = width * (2.0 * std::f64::consts::PI).sqrt() * (m + 0.5 * width * width).exp();
    let exact = 1e-4 * area;
    // From 1e-4 to 1e6, a length unit for each unit of s.
    let ends = [[1e-4, 0.0], [1e6, 0.0]];
    let length = 1e6 - 1e-4;
    let reference = CurvedQuadrature::new(&function).expect("valid");
    let found = reference.integrate(length, &ends[0], &ends[1]).expect("converges");
    assert!((found.optical_depth / exact - 1.0).abs() < 1e-9, "{} {exact}", found.optical_depth);
    let compiled = CompiledTransferFunction::new(&function).expect("valid");
    let found = SegmentIntegral::integrate(&compiled, length, &ends[0], &ends[1]).expect("integrates");
    assert!((found.optical_depth / exact - 1.0).abs() < 1e-4, "{} {exact}", found.optical_depth);
}

fn rectangle(mut widget: Widget, s: [f64; 2], g: [f64; 2]) -> Widget {
    widget.region = Some(Region::rectangle(s, g));
    widget
}

/// Straight pieces keep within 1e-4 of every channel's light, whatever the widgets, models and lengths.
#[test]
fn straight_pieces_are_near_the_quadrature() {
    let point = |s, extinction, r, g| ControlPoint { s, color: [r, g, 0.3], extinction };
    let symlog = [AxisScale::SymLog { linear_below: 1e-2 }, AxisScale::Linear];
    let wave = Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period: 0.7, band_width: 0.8 };
    let looks = [
        look(LOG, vec![gaussian([1.0, 0.0], [0.3, 0.5], 2.0, [1.0, 0.5, 0.1])]),
        look(
            LOG,
            vec![
                gaussian([1.0, 0.0], [0.3, 0.5], 2.0, [1.0, 0.5, 0.1]),
                gaussian([1.4, 0.3], [0.05, 0.6], 30.0, [0.1, 0.5, 0.9]),
            ],
        ),
        look(LOG, vec![rectangle(widget(Profile::Uniform, 3.0, [1.0, 0.2, 0.1]), [0.0, 1.1], [-0.5, 2.0])]),
        look(
            [AxisScale::Log, AxisScale::Linear],
            vec![widget(
                Profile::PiecewiseLinear {
                    points: vec![
                        point(-6.0, 0.0, 1.0, 0.0),
                        point(-1.0, 0.5, 0.0, 1.0),
                        point(-1.0, 2.0, 0.0, 0.2),
                        point(0.5, 0.0, 0.4, 0.2),
                        point(4.0, 9.0, 1.0, 1.0),
                    ],
                },
                1.0,
                [0.0; 3],
            )],
        ),
        look(
            [AxisScale::Log, AxisScale::Linear],
            vec![widget(Profile::SineWave(wave), 4.0, [1.0, 0.8, 0.1])],
        ),
        look(symlog, vec![gaussian([0.5, 0.0], [0.3, f64::INFINITY], 3.0, [1.0, 0.5, 0.1])]),
    ];
    let segments = [
        [[1.0, 1.0], [1.2, 0.9]],
        [[10.0, 1.0], [11.0, 1.4]],
        [[1e-6, 1e-3], [1e6, 10.0]],
        [[1e3, 2.0], [0.5, 2.0]],
        [[-1.0, 1.0], [30.0, 1.0]],
        [[5.0, 0.0], [5.0, 10.0]],
        [[20.0, 3.0], [0.0, 0.1]],
    ];
    let mut worst = 0f64;
    for function in &looks {
        for model in [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 0.1 }] {
            let function = TransferFunction { model, ..function.clone() };
            let reference = CurvedQuadrature::new(&function).expect("valid");
            let compiled = CompiledTransferFunction::new(&function).expect("valid");
            for [front, back] in segments {
                for length in [0.01, 1.0, 100.0, 1e6] {
                    let exact = reference.integrate(length, &front, &back).expect("converges");
                    let found =
                        SegmentIntegral::integrate(&compiled, length, &front, &back).expect("integrates");
                    let scale = exact.color.iter().fold(1.0f64, |most, c| most.max(*c));
                    let apart = (0..3).map(|c| (found.color[c] - exact.color[c]).abs() / scale);
                    let apart = apart.fold((found.opacity - exact.opacity).abs(), f64::max);
                    worst = worst.max(apart);
                }
            }
        }
    }
    println!("worst {worst:.2e}");
    assert!(worst < 1e-4, "{worst:.2e}");
}

/// Each widget by itself: together they are the optical depth of all.
#[test]
fn widgets_add_up() {
    let function = look(
        LOG,
        vec![
            gaussian([1.0, 0.0], [0.3, 0.5], 2.0, [1.0, 0.5, 0.1]),
            rectangle(widget(Profile::Uniform, 3.0, [1.0, 0.2, 0.1]), [0.0, 1.1], [-0.5, 2.0]),
        ],
    );
    let (front, back) = (vec![0.3, 2.0], vec![50.0, 0.4]);
    let all = CurvedQuadrature::new(&function).expect("valid").integrate(0.7, &front, &back);
    let all = all.expect("converges").optical_depth;
    let cell = CellCrossing {
        cell: 3,
        distance: [1.0, 1.7],
        length: 0.7,
        front,
        back,
        silhouette: 1.0,
        light: 1.0,
        part: Contribution::default(),
        transmittance: 1.0,
    };
    let each = voltet_reference::widget_depths(&function, &[cell]).expect("converges");
    assert!(each[0].iter().all(|depth| *depth > 0.1), "{each:?}");
    assert!((each[0].iter().sum::<f64>() / all - 1.0).abs() < 1e-9, "{each:?} {all}");
}
