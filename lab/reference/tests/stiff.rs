//! The referee from thin air to 1e30 of optical depth in one cell: closed forms, properties, and what it refuses.

use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Region, Table, Wave, Widget};
use voltet_optics::CompiledTransferFunction;
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_reference::integrate;

const COLOR: [f64; 3] = [1.0, 0.5, 0.25];
const DEPTHS: [f64; 9] = [1e-12, 1e-6, 1e-2, 1.0, 1e2, 1e6, 1e12, 1e17, 1e30];
/// Widths of features as shares of the segment's values; powers of two, so that places keep their digits.
const WIDTHS: [f64; 4] = [0.25, 1.0 / 1024.0, 1.0 / (1u64 << 30) as f64, 1.0 / (1u64 << 50) as f64];

/// One widget of each kind with its centre at (½, ¼), and the given width and extinction.
fn kinds(width: f64, extinction: f64) -> Vec<Widget> {
    let of = |profile| Widget { profile, color: COLOR, extinction, region: None };
    let k = 1.0 / width;
    let wave = |band_width| Wave {
        origin: [0.5 - 0.5 * width, 0.0],
        angle: 0.0,
        scale: [1.0; 2],
        period: width,
        band_width,
    };
    let only = Region::rectangle([0.5 - 2.0 * width, 0.5 + 2.0 * width], [f64::NEG_INFINITY, f64::INFINITY]);
    let point = |s, extinction| ControlPoint { s, color: COLOR, extinction };
    let points = vec![point(0.5, 0.0), point(0.5 + width, extinction), point(0.5 + 2.0 * width, 0.0)];
    let texel = |alpha| [1.0, 0.5, 0.25, alpha];
    let texels = vec![texel(0.0), texel(1.0), texel(0.5), texel(0.25), texel(0.0), texel(1.0)];
    let range = [0.5 - width, 0.5 + width];
    let table = Table { width: 3, height: 2, texels, s: range, g: [0.0, 1.0] };
    vec![
        Widget { region: Some(only.clone()), ..of(Profile::Uniform) },
        of(Profile::Gaussian { centre: [0.5, 0.25], matrix: [[k, 0.0], [0.5, 1.0]] }),
        of(Profile::GaussianNd { fields: vec!["p".into()], centre: vec![0.5], matrix: vec![vec![k]] }),
        of(Profile::TriangularGaussian { centre: 0.5, sigma: 4.0 * width }),
        Widget { region: Some(only.clone()), ..of(Profile::TriangleWave(wave(1.0))) },
        Widget { region: Some(only.clone()), ..of(Profile::TriangleWave(wave(0.25))) },
        Widget { region: Some(only.clone()), ..of(Profile::SineWave(wave(1.0))) },
        Widget { region: Some(only), ..of(Profile::SineWave(wave(0.25))) },
        of(Profile::PiecewiseLinear { points }),
        of(Profile::Table(Arc::new(table))),
    ]
}

fn look(model: OpticalModel, widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() }
}

/// s from a to b, g = ¼, the field p like s.
fn of_segment(length: f64, a: f64, b: f64, look: &TransferFunction) -> Contribution {
    let segment =
        Segment { length, front: [a, 0.25], back: [b, 0.25], fields_front: &[a], fields_back: &[b] };
    let name = look.widgets[0].profile.name();
    integrate(&segment, look, WidgetBlend::Exact).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Relative error of two numbers, of which the second is right.
fn off(found: f64, exact: f64) -> f64 {
    if found == exact { 0.0 } else { (found / exact - 1.0).abs() }
}

/// T is that of the closed forms (docs/src/explanation/optics.md, section 5; at 30 of depth, where no width is lost) times the extinction, and
/// C = c (1 − e^(−T)). The tolerance of T is ten times the quadrature's. Closed forms lose digits as 1/width where places
/// along the segment are doubles; but what lies wholly within the segment is as deep at every width for its extinction.
#[test]
fn one_colour_is_a_closed_form_at_every_depth() {
    for width in WIDTHS {
        for [a, b] in [[0.0, 1.0], [1.0, 0.0]] {
            for number in 0..kinds(1.0, 1.0).len() {
                for depth in DEPTHS {
                    let extinction = depth / width;
                    let of = |width, extinction| {
                        look(OpticalModel::DensityEmitter, vec![kinds(width, extinction)[number].clone()])
                    };
                    let found = of_segment(1.0, a, b, &of(width, extinction));
                    // The rotated Gaussian's other axis does not scale; its form has a width of its own and loses nothing.
                    let wide = if number == 1 { width } else { width.max(WIDTHS[1]) };
                    let (front, back) = ([a], [b]);
                    let segment = Segment {
                        length: 1.0,
                        front: [a, 0.25],
                        back: [b, 0.25],
                        fields_front: &front,
                        fields_back: &back,
                    };
                    let exact =
                        CompiledTransferFunction::new(&of(wide, 1.0)).expect("valid").optical_depth(&segment)
                            * extinction;
                    let exact = exact * (width / wide);
                    let place =
                        format!("kind {number}, width {width:e}, depth {depth:e}: {found:?}, not {exact:e}");
                    assert!(off(found.optical_depth, exact) < 1e-10, "{place}");
                    let opacity = -(-found.optical_depth).exp_m1();
                    assert_eq!(found.opacity, opacity, "{place}");
                    for (found, color) in found.color.into_iter().zip(COLOR) {
                        assert!(off(found, color * opacity) < 1e-10, "{place}");
                    }
                }
            }
        }
    }
}

/// Segments that lie one behind the other give what they give as one: C = C₁ + e^(−T₁) C₂. Parts end at sixteenths, whose
/// values are exact; a kind lies over another of a tenth of its width, both models.
#[test]
fn parts_composite_to_the_whole() {
    let models = [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 1.0 / 256.0 }];
    for (width, depth) in WIDTHS.into_iter().flat_map(|w| DEPTHS.map(|d| (w, d))) {
        let blue = kinds(0.25, 1.0)[1].clone();
        for (first, model) in
            kinds(width, depth / width).into_iter().flat_map(|k| models.map(|m| (k.clone(), m)))
        {
            let name = first.profile.name();
            let look = look(model, vec![first, Widget { color: [0.0, 0.25, 1.0], ..blue.clone() }]);
            let whole = of_segment(1.0, 0.0, 1.0, &look);
            let mut sum = Contribution::default();
            for k in 0..16 {
                let part = of_segment(1.0 / 16.0, f64::from(k) / 16.0, f64::from(k + 1) / 16.0, &look);
                let light = (-sum.optical_depth).exp();
                (0..3).for_each(|c| sum.color[c] += light * part.color[c]);
                sum.optical_depth += part.optical_depth;
            }
            let place = format!("{name} {model:?}, width {width:e}, depth {depth:e}: {sum:?} {whole:?}");
            assert!(off(sum.optical_depth, whole.optical_depth) < 1e-10, "{place}");
            assert!((0..3).all(|c| off(sum.color[c], whole.color[c]) < 1e-10), "{place}");
        }
    }
}

/// Looked at from behind, a segment is as deep.
#[test]
fn depth_is_the_same_from_behind() {
    for (width, depth) in WIDTHS.into_iter().flat_map(|w| DEPTHS.map(|d| (w, d))) {
        for widget in kinds(width, depth / width) {
            let look = look(OpticalModel::DensityEmitter, vec![widget]);
            for [a, b] in [[0.0, 1.0], [0.5, 0.75], [0.25, 0.5], [0.5, 0.5 + width]] {
                let there = of_segment(1.0, a, b, &look).optical_depth;
                let back = of_segment(1.0, b, a, &look).optical_depth;
                // Each is within 3e-11.
                assert!(off(there, back) < 1e-10, "{:?} {a} {b}: {there:e} {back:e}", look.widgets[0]);
            }
        }
    }
}

/// A haze of depth ln 2 lies in front of a wall: half of its colour is seen, however dense it is. (A depth of the haze
/// that is judged by that of the wall is accepted as it comes.)
#[test]
fn a_wall_does_not_hide_the_haze_in_front() {
    let wall = Region::rectangle([0.75, 2.0], [f64::NEG_INFINITY, f64::INFINITY]);
    for density in DEPTHS.into_iter().filter(|d| *d >= 1e2) {
        let haze = Profile::Gaussian { centre: [0.25, 0.0], matrix: [[80.0, 0.0], [0.0, 0.0]] };
        // ∫ e^(−(80 x)²) over all x.
        let area = std::f64::consts::PI.sqrt() / 80.0;
        let haze = Widget {
            profile: haze,
            color: [0.0; 3],
            extinction: std::f64::consts::LN_2 / area,
            region: None,
        };
        let wall = Widget {
            profile: Profile::Uniform,
            color: [1.0; 3],
            extinction: density,
            region: Some(wall.clone()),
        };
        let found = of_segment(1.0, 0.0, 1.0, &look(OpticalModel::DensityEmitter, vec![haze, wall]));
        let exact = 0.5 * -(-0.25 * density).exp_m1();
        assert!(off(found.color[0], exact) < 1e-10, "{density:e}: {found:?}");
    }
}

/// With a cutoff of 0 a Gaussian glows everywhere, also where its profile is below the least number: C = D/U here.
#[test]
fn a_cutoff_of_nothing_cuts_nothing() {
    let far = Profile::Gaussian { centre: [100.0, 0.0], matrix: [[1.0, 0.0], [0.0, 0.0]] };
    let far = Widget { profile: far, color: [1.0; 3], extinction: 1.0, region: None };
    let found = of_segment(3.0, 0.0, 1.0, &look(OpticalModel::ConstantEmitter { cutoff: 0.0 }, vec![far]));
    assert!(off(found.color[0], 3.0) < 1e-14, "{found:?}");
}

#[test]
fn what_it_cannot_integrate_is_said() {
    let refusal = |length: f64, a: f64, widget: Widget| {
        let look = look(OpticalModel::DensityEmitter, vec![widget]);
        let segment =
            Segment { length, front: [a, 0.25], back: [1.0, 0.25], fields_front: &[], fields_back: &[] };
        integrate(&segment, &look, WidgetBlend::Exact).expect_err("refuses").to_string()
    };
    let of = |profile| Widget { profile, color: COLOR, extinction: 1e30, region: None };
    // Two steps that are 1e-25 apart, in the middle of the segment.
    let points = [[0.0, 0.0], [0.0, 1e30], [1e-25, 1e30], [1e-25, 2e30]];
    let points = points.map(|[s, extinction]| ControlPoint { s, color: COLOR, extinction }).to_vec();
    let message = refusal(1.0, -1.0, of(Profile::PiecewiseLinear { points }));
    assert!(message.contains("too near") && message.contains("0.5 of its length"), "{message}");
    let gaussian = |k: f64| of(Profile::Gaussian { centre: [0.0, 0.25], matrix: [[k, 0.0], [0.0, k]] });
    let message = refusal(1.0, -1.0, gaussian(1e18));
    assert!(message.contains("too narrow") && message.contains("1e17"), "{message}");
    let message = refusal(1e300, -1.0, Widget { extinction: 1e300, ..gaussian(1.0) });
    assert!(message.contains("no number of 64 bits") && message.contains("inf"), "{message}");
    let wave = |period: f64, s0: f64| {
        of(Profile::SineWave(Wave {
            origin: [s0, 0.0],
            angle: 0.0,
            scale: [1.0; 2],
            period,
            band_width: 1.0,
        }))
    };
    assert!(refusal(1.0, 0.0, wave(1e-7, 0.0)).contains("more bands"));
    assert!(refusal(1.0, 0.0, wave(1e-3, 1e13)).contains("too far from its origin"));
    assert!(refusal(1.0, f64::NAN, gaussian(1.0)).contains("no number"));
    let notched = Region { corners: vec![[-2.0, 0.0], [2.0, 0.0], [0.0, 0.1], [-2.0, 1.0]] };
    assert!(
        refusal(1.0, 0.0, Widget { region: Some(notched), ..of(Profile::Uniform) }).contains("not convex")
    );
}
