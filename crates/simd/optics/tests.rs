//! Every twin against its 64-bit truth, on every lane set that the processor has.

use super::clip::LaneStretch;
use super::elementary::{dawson, erfcx, exp, mean_transparency, one_minus_exp, power};
use super::gaussian::{LaneGaussianPath, LaneGaussianSteps, LaneGaussianTrack, mean_profile};
use super::linear::{deep_piece_weights, front_back, middling_piece_weights, piece_weights};
use super::overlap::{AnyLaneTrack, LaneMember, ordered};
use super::piecewise_linear::{LanePiecewiseTrack, LanePoints};
use super::triangular_gaussian::{self, LaneTriangularPath};
use super::wave::{LaneBell, LanePhase};
use crate::{Float, Kernel, LaneSet, Lanes, dispatch};
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
use voltet_optics::clip::ClippedSpan;
use voltet_optics::kinds::gaussian::GaussianPath;
use voltet_optics::kinds::triangular_gaussian::TriangularPath;
use voltet_optics::kinds::wave::Bell;
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend, linear, special};
use voltet_testing::twin::{self, INPUTS, Range};

#[derive(Debug, Clone, Copy, PartialEq)]
enum Formula {
    Exp,
    Opacity,
    MeanTransparency,
    Erfcx,
    Power,
    Gaussian,
    /// In the fourth of equal steps.
    GaussianSteps,
    /// Piece of linear extinction and colour: the front and back colour's weights, the opacity.
    PieceFront,
    PieceBack,
    PieceOpacity,
    /// Deep piece of linear extinction and colour.
    MiddlingPieceFront,
    MiddlingPieceBack,
    DeepPieceFront,
    DeepPieceBack,
    DeepPieceOpacity,
    /// Its back, or its front, is deeper by a part.
    LevelPieceBack,
    FallingPieceBack,
    /// Piece of linear extinction and emission: the weights of the emission at its front and at its back.
    EmissionFront,
    EmissionBack,
    Dawson,
    Triangle(f64),
    Sine(f64),
    ClipLength,
    /// Segment that enters, or leaves, a corner of a region by two edges.
    ClipCorner,
    /// Its σ is 1.
    TriangularGaussian,
    /// Over three fields, with a width of 1 at the back.
    TriangularGaussianNd,
    /// Light of one Gaussian alone, walked over many widths.
    GaussianWalked,
    /// Three widgets at once; of the constant-emitter or not. Sum of the channels.
    Ordered(bool),
}

/// A twin: its inputs' ranges, and the error allowed in units of ε (4 + k), k the condition number measured on
/// the truth.
struct Twin {
    formula: Formula,
    inputs: &'static [Range],
    tolerance: f64,
    /// Reason of the tolerance.
    reason: &'static str,
}

const SHALLOW: Range = Range::Log(-12.0, 0.0);
/// A piece that is deep at one end, and what the other may be.
const DEEP: Range = Range::Log(0.0, 6.0);
/// From 1 to 4, and up to that.
const MIDDLING: Range = Range::Log(0.0, 0.602);
const UNDER_MIDDLING: Range = Range::Log(-3.0, 0.602);
const SIZE: Range = Range::Log(-6.0, 6.0);
/// By which part the one end is deeper.
const TILT: Range = Range::Log(-9.0, 0.0);
const PHASE: Range = Range::Even(-30.0, 30.0);
const NEAR: Range = Range::Even(-4.0, 4.0);
const STEP: Range = Range::Even(-0.36, 0.36);
const WIDTH: Range = Range::Even(0.0, 3.0);
const SPAN: Range = Range::Even(-1.0, 3.0);
const FAR: Range = Range::Even(-12.0, 12.0);
const INSIDE: Range = Range::Even(0.1, 1.0);
const OUTSIDE: Range = Range::Even(-1.0, 0.0);

#[rustfmt::skip]
const TWINS: [Twin; 41] = [
    Twin { formula: Formula::Exp, inputs: &[Range::Even(-87.0, 87.0)], tolerance: 1.0, reason: "2 ulp" },
    Twin { formula: Formula::Opacity, inputs: &[Range::Log(-30.0, 2.0)], tolerance: 1.0, reason: "3 ulp" },
    Twin { formula: Formula::MeanTransparency, inputs: &[Range::Log(-30.0, 2.0)], tolerance: 1.0, reason: "4 ulp" },
    Twin { formula: Formula::Erfcx, inputs: &[Range::Log(-6.0, 6.0)], tolerance: 1.0, reason: "fit of 2e-7" },
    Twin { formula: Formula::Power, inputs: &[Range::Log(-9.0, 0.0), Range::Log(-2.0, 0.9)], tolerance: 1.0, reason: "ln and exp" },
    Twin { formula: Formula::Gaussian, inputs: &[NEAR, NEAR, NEAR, NEAR], tolerance: 2.0, reason: "sums of 2 erfcx and exp" },
    Twin { formula: Formula::GaussianSteps, inputs: &[NEAR, NEAR, STEP, STEP], tolerance: 2.0, reason: "3 ratios, 3 changes of them" },
    Twin { formula: Formula::PieceFront, inputs: &[SHALLOW, SHALLOW], tolerance: 1.0, reason: "5 points: 5e-7" },
    Twin { formula: Formula::PieceBack, inputs: &[SHALLOW, SHALLOW], tolerance: 1.0, reason: "what the front leaves of the opacity" },
    Twin { formula: Formula::PieceOpacity, inputs: &[SHALLOW, SHALLOW], tolerance: 1.0, reason: "3 ulp" },
    Twin { formula: Formula::Dawson, inputs: &[SIZE], tolerance: 3.0, reason: "18 terms of both signs: 2e-6" },
    Twin { formula: Formula::MiddlingPieceFront, inputs: &[UNDER_MIDDLING, MIDDLING], tolerance: 4.0, reason: "ψ within 3e-7, 1 − ψ over ¼" },
    Twin { formula: Formula::MiddlingPieceFront, inputs: &[MIDDLING, UNDER_MIDDLING], tolerance: 4.0, reason: "the same" },
    Twin { formula: Formula::MiddlingPieceBack, inputs: &[UNDER_MIDDLING, MIDDLING], tolerance: 4.0, reason: "the same" },
    Twin { formula: Formula::MiddlingPieceBack, inputs: &[MIDDLING, UNDER_MIDDLING], tolerance: 4.0, reason: "the same" },
    Twin { formula: Formula::DeepPieceFront, inputs: &[SIZE, DEEP], tolerance: 4.0, reason: "ψ within 5e-7, 1 − ψ over ¼" },
    Twin { formula: Formula::DeepPieceFront, inputs: &[DEEP, SIZE], tolerance: 4.0, reason: "the same" },
    Twin { formula: Formula::DeepPieceBack, inputs: &[SIZE, DEEP], tolerance: 4.0, reason: "the same" },
    Twin { formula: Formula::DeepPieceBack, inputs: &[DEEP, SIZE], tolerance: 4.0, reason: "the same" },
    Twin { formula: Formula::LevelPieceBack, inputs: &[DEEP, TILT], tolerance: 6.0, reason: "and a slope of a millionth: 7e-7" },
    Twin { formula: Formula::FallingPieceBack, inputs: &[DEEP, TILT], tolerance: 6.0, reason: "the same" },
    Twin { formula: Formula::DeepPieceOpacity, inputs: &[DEEP, SIZE], tolerance: 1.0, reason: "3 ulp" },
    Twin { formula: Formula::EmissionFront, inputs: &[SHALLOW, SHALLOW], tolerance: 2.0, reason: "4 points up to ½: 1e-7" },
    Twin { formula: Formula::EmissionFront, inputs: &[SIZE, DEEP], tolerance: 2.0, reason: "panels of 8 points" },
    Twin { formula: Formula::EmissionFront, inputs: &[DEEP, SIZE], tolerance: 2.0, reason: "the same" },
    Twin { formula: Formula::EmissionBack, inputs: &[SHALLOW, SHALLOW], tolerance: 2.0, reason: "the same" },
    Twin { formula: Formula::EmissionBack, inputs: &[SIZE, DEEP], tolerance: 2.0, reason: "the same" },
    Twin { formula: Formula::EmissionBack, inputs: &[DEEP, SIZE], tolerance: 2.0, reason: "the same" },
    Twin { formula: Formula::Triangle(1.0), inputs: &[PHASE, PHASE], tolerance: 1.0, reason: "sums of positive areas" },
    Twin { formula: Formula::Triangle(0.01), inputs: &[PHASE, PHASE], tolerance: 1.0, reason: "the same" },
    Twin { formula: Formula::Sine(1.0), inputs: &[PHASE, PHASE], tolerance: 1.0, reason: "the same" },
    Twin { formula: Formula::Sine(0.3), inputs: &[PHASE, PHASE], tolerance: 1.0, reason: "the same" },
    Twin { formula: Formula::Sine(0.001), inputs: &[PHASE, PHASE], tolerance: 1.0, reason: "1 − X/w near the reach" },
    Twin { formula: Formula::ClipLength, inputs: &[OUTSIDE, INSIDE], tolerance: 1.0, reason: "one quotient" },
    Twin { formula: Formula::ClipCorner, inputs: &[INSIDE, OUTSIDE, INSIDE, OUTSIDE], tolerance: 1.0, reason: "the same" },
    Twin { formula: Formula::ClipCorner, inputs: &[OUTSIDE, INSIDE, OUTSIDE, INSIDE], tolerance: 1.0, reason: "the same" },
    Twin { formula: Formula::TriangularGaussian, inputs: &[NEAR, NEAR, WIDTH, WIDTH], tolerance: 2.0, reason: "up to 24 panels of 8 points: 1e-6" },
    Twin { formula: Formula::TriangularGaussianNd, inputs: &[NEAR, NEAR, NEAR, WIDTH], tolerance: 2.0, reason: "the same, and the line of q/m" },
    Twin { formula: Formula::GaussianWalked, inputs: &[FAR, FAR], tolerance: 16.0, reason: "depth within a panel from 8 rates: 1e-5" },
    Twin { formula: Formula::Ordered(false), inputs: &[SPAN, SPAN], tolerance: 16.0, reason: "depth within a panel from 8 rates: 1e-5" },
    Twin { formula: Formula::Ordered(true), inputs: &[SPAN, SPAN], tolerance: 16.0, reason: "the same" },
];

/// Position of the step.
const PLACE: f64 = 0.3;

/// Rate of what is walked alone, where it is densest.
const PEAK: f64 = 3.0;

/// So little light that nothing of it is resolved: e^(−49), of what lies seven widths away, is far less.
const UNSEEN: f64 = 1e-12;

/// Share of the peak above which the constant-emitter glows.
const CUTOFF: f64 = 0.01;

fn wave(band_width: f64) -> Wave {
    Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period: 1.0, band_width }
}

fn exact(formula: Formula, x: &[f64; INPUTS]) -> f64 {
    let band = |bell: Bell| bell.path([x[0], 0.0], [x[1], 0.0]).integral(&ClippedSpan::WHOLE);
    match formula {
        Formula::Exp => x[0].exp(),
        Formula::Opacity => special::opacity(x[0]),
        Formula::MeanTransparency => special::opacity(x[0]) / x[0],
        Formula::Erfcx => special::erfcx(x[0]),
        Formula::Power => x[0].powf(x[1]),
        Formula::Gaussian => {
            let along = [x[2] - x[0], x[3] - x[1]];
            GaussianPath::new([x[0], x[1]], [x[2], x[3]], along).optical_depth(1.0, &ClippedSpan::WHOLE)
        }
        Formula::GaussianSteps => {
            let q = [x[0] + (3.0 + PLACE) * x[2], x[1] + (3.0 + PLACE) * x[3]];
            (-q[0] * q[0] - q[1] * q[1]).exp()
        }
        Formula::PieceFront => linear::emission_weights(x[0], x[1]).0,
        Formula::PieceBack => linear::emission_weights(x[0], x[1]).1,
        Formula::PieceOpacity => special::opacity(0.5 * (x[0] + x[1])),
        Formula::MiddlingPieceFront => linear::emission_weights(x[0], x[1]).0,
        Formula::MiddlingPieceBack => linear::emission_weights(x[0], x[1]).1,
        Formula::DeepPieceFront => linear::emission_weights(x[0], x[1]).0,
        Formula::DeepPieceBack => linear::emission_weights(x[0], x[1]).1,
        Formula::DeepPieceOpacity => special::opacity(0.5 * (x[0] + x[1])),
        Formula::LevelPieceBack => linear::emission_weights(x[0], x[0] * (1.0 + x[1])).1,
        Formula::FallingPieceBack => linear::emission_weights(x[0] * (1.0 + x[1]), x[0]).1,
        Formula::EmissionFront => linear::front_back(x[0], x[1]).0,
        Formula::EmissionBack => linear::front_back(x[0], x[1]).1,
        Formula::Dawson => special::dawson(x[0]),
        Formula::Triangle(width) => band(Bell::triangle(&wave(width))),
        Formula::Sine(width) => band(Bell::sine(&wave(width))),
        Formula::ClipLength => x[1] / (x[1] - x[0]),
        Formula::ClipCorner => {
            let inside = |a: f64, b: f64| a.max(b) / (a - b).abs();
            inside(x[0], x[1]).min(inside(x[2], x[3]))
        }
        Formula::GaussianWalked => {
            let depth =
                GaussianPath::new([x[0]], [x[1]], [x[1] - x[0]]).optical_depth(1.0, &ClippedSpan::WHOLE);
            UNSEEN + special::opacity(PEAK * depth)
        }
        Formula::TriangularGaussian => {
            TriangularPath::new([x[0], x[1]], [x[2], x[3]], 1.0).optical_depth(&ClippedSpan::WHOLE)
        }
        Formula::TriangularGaussianNd => {
            let (front, back) = ([x[0], x[1], 0.3], [x[2], -0.5, 0.7]);
            let along = [0, 1, 2].map(|i| back[i] - front[i]);
            TriangularPath::over_fields(front, back, along, [x[3], 1.0], 1.0)
                .optical_depth(&ClippedSpan::WHOLE)
        }
        Formula::Ordered(constant) => {
            let segment = Segment {
                length: 1.0,
                front: [x[0], 0.5],
                back: [x[1], 0.5],
                fields_front: &[],
                fields_back: &[],
            };
            let model = if constant {
                OpticalModel::ConstantEmitter { cutoff: CUTOFF }
            } else {
                OpticalModel::DensityEmitter
            };
            let prepared = CompiledTransferFunction::new(&several(model)).expect("a valid transfer function");
            prepared.integrate(&segment, WidgetBlend::Exact).color.into_iter().sum()
        }
    }
}

/// Three widgets, one of each kind that is walked, of s where g = ½; one has a region.
fn several(model: OpticalModel) -> TransferFunction {
    let point = |s, extinction, r| ControlPoint { s, color: [r, 0.5, 0.1], extinction };
    let profiles = [
        Profile::Uniform,
        Profile::Gaussian { centre: [0.7, 0.5], matrix: [[4.0, 0.0], [0.0, 1.0]] },
        Profile::PiecewiseLinear {
            points: vec![point(0.0, 0.0, 1.0), point(1.0, 2.0, 0.2), point(1.5, 0.5, 0.4)],
        },
    ];
    let widgets = profiles.into_iter().enumerate().map(|(i, profile)| Widget {
        region: (profile == Profile::Uniform).then(|| Region::rectangle([0.3, 1.2], [0.0, 1.0])),
        profile,
        color: [0.2 * i as f64, 1.0 - 0.1 * i as f64, 0.3],
        extinction: 1.0 + i as f64,
    });
    TransferFunction { model, unit_distance: 1.0, widgets: widgets.collect(), axes: Default::default() }
}

/// The light of one widget of colour 1, walked in panels, and [`UNSEEN`].
#[inline(always)]
fn walked<L: Lanes>(track: AnyLaneTrack<L>) -> L::F {
    let splat = L::F::splat;
    let member = LaneMember {
        track,
        range: [splat(0.0), splat(1.0)],
        window: [splat(-1.0), splat(2.0)],
        color: [1.0; 3],
        threshold: 0.0,
        unit_rate: splat(1.0),
    };
    ordered::<L>(&[member], None).0[0] + splat(UNSEEN as f32)
}

/// [`several`] in lanes.
#[inline(always)]
fn ordered_sum<L: Lanes>(front: L::F, back: L::F, constant: bool) -> L::F {
    let splat = L::F::splat;
    let (zero, cutoff) = (splat(0.0), constant.then_some(CUTOFF));
    let functions = several(OpticalModel::DensityEmitter);
    let Profile::PiecewiseLinear { points } = &functions.widgets[2].profile else { unreachable!() };
    let points = LanePoints::new(points, cutoff);
    let less = |centre: f32| [front - splat(centre), back - splat(centre)];
    let level = -CUTOFF.ln() as f32;
    let [a, b] = less(0.7).map(|x| [x * splat(4.0)]);
    let path = LaneGaussianPath::<L>::new::<1>(a, b);
    let cut = LaneStretch::<L>::whole()
        .cut(front - splat(0.3), back - splat(0.3))
        .cut(splat(1.2) - front, splat(1.2) - back);
    let all = [splat(-1.0), splat(2.0)];
    let tracks = [
        (AnyLaneTrack::Uniform(splat(1.0)), all),
        (AnyLaneTrack::Gaussian(LaneGaussianTrack::new(&path, splat(2.0))), path.window_ends(level)),
        (
            AnyLaneTrack::Piecewise(LanePiecewiseTrack { points: &points, front, back, scale: splat(1.0) }),
            all,
        ),
    ];
    let threshold = [0.0, 0.0, 2.0 * CUTOFF as f32];
    let unit = [1.0, 2.0, 1.0];
    let member = |i: usize| LaneMember::<L> {
        track: tracks[i].0,
        range: if i == 0 { [cut.start, cut.end] } else { [zero, splat(1.0)] },
        window: if constant { tracks[i].1 } else { all },
        color: functions.widgets[i].color.map(|c| c as f32),
        threshold: threshold[i],
        unit_rate: splat(unit[i]),
    };
    let (color, _) = ordered::<L>(&[member(0), member(1), member(2)], cutoff.map(|_| splat(1.0)));
    color[0] + color[1] + color[2]
}

/// A kernel for each formula: in one, the compiler would take minutes. `$x` are the inputs, `$constants` the formula's own.
macro_rules! twin_on_lanes {
    ($call:expr, |$L:ident, $x:ident, $constants:pat_param| $value:expr) => {{
        struct Run<'a>(Call<'a>);
        impl Kernel for Run<'_> {
            #[inline(always)]
            fn run<$L: Lanes>(self) {
                let $constants = self.0.constants;
                let mut column = [[0f32; 16]; INPUTS];
                for (inputs, out) in self.0.inputs.chunks($L::WIDTH).zip(self.0.out.chunks_mut($L::WIDTH)) {
                    for (k, row) in inputs.iter().enumerate() {
                        for (column, x) in column.iter_mut().zip(row) {
                            column[k] = *x as f32;
                        }
                    }
                    let $x: [$L::F; INPUTS] = std::array::from_fn(|i| $L::F::load(&column[i]));
                    let mut lanes = [f32::NAN; 16];
                    $value.store(&mut lanes);
                    out.copy_from_slice(&lanes[..out.len()]);
                }
            }
        }
        let call = $call;
        dispatch(call.lanes, Run(call))
    }};
}

/// Inputs of a kernel.
struct Call<'a> {
    lanes: LaneSet,
    constants: [f64; 2],
    inputs: &'a [[f64; INPUTS]],
    out: &'a mut [f32],
}

/// Whole and rest of a phase.
#[inline(always)]
fn phase<L: Lanes>(x: L::F) -> LanePhase<L> {
    LanePhase { nearest: x.round(), offset: x - x.round() }
}

/// The values of a twin.
fn values(formula: Formula, lanes: LaneSet, inputs: &[[f64; INPUTS]]) -> Vec<f32> {
    let mut out = vec![f32::NAN; inputs.len()];
    let constants = match formula {
        Formula::Triangle(a) | Formula::Sine(a) => [a, 0.0],
        _ => [0.0; 2],
    };
    let call = Call { lanes, constants, inputs, out: &mut out };
    match formula {
        Formula::Exp => twin_on_lanes!(call, |L, x, _| exp::<L>(x[0])),
        Formula::Opacity => twin_on_lanes!(call, |L, x, _| one_minus_exp::<L>(x[0])),
        Formula::MeanTransparency => twin_on_lanes!(call, |L, x, _| mean_transparency::<L>(x[0])),
        Formula::Erfcx => twin_on_lanes!(call, |L, x, _| erfcx::<L>(x[0])),
        Formula::Power => twin_on_lanes!(call, |L, x, _| power::<L>(x[0], x[1])),
        Formula::Gaussian => {
            twin_on_lanes!(call, |L, x, _| mean_profile::<L, 2>([x[0], x[1]], [x[2], x[3]]))
        }
        Formula::GaussianSteps => twin_on_lanes!(call, |L, x, _| {
            let (place, peak) = ([PLACE as f32], L::F::splat(1.0));
            let steps = LaneGaussianSteps::<L, 1>::new([x[0], x[1]], [x[2], x[3]], place, peak);
            steps.next().next().next().values[0]
        }),
        Formula::PieceFront => twin_on_lanes!(call, |L, x, _| piece_weights::<L>(x[0], x[1]).0),
        Formula::PieceBack => twin_on_lanes!(call, |L, x, _| piece_weights::<L>(x[0], x[1]).1),
        Formula::PieceOpacity => twin_on_lanes!(call, |L, x, _| piece_weights::<L>(x[0], x[1]).2),
        Formula::MiddlingPieceFront => {
            twin_on_lanes!(call, |L, x, _| middling_piece_weights::<L>(x[0], x[1]).0)
        }
        Formula::MiddlingPieceBack => {
            twin_on_lanes!(call, |L, x, _| middling_piece_weights::<L>(x[0], x[1]).1)
        }
        Formula::DeepPieceFront => twin_on_lanes!(call, |L, x, _| deep_piece_weights::<L>(x[0], x[1]).0),
        Formula::DeepPieceBack => twin_on_lanes!(call, |L, x, _| deep_piece_weights::<L>(x[0], x[1]).1),
        Formula::DeepPieceOpacity => twin_on_lanes!(call, |L, x, _| deep_piece_weights::<L>(x[0], x[1]).2),
        Formula::LevelPieceBack => {
            twin_on_lanes!(call, |L, x, _| deep_piece_weights::<L>(x[0], x[0].mul_add(x[1], x[0])).1)
        }
        Formula::FallingPieceBack => {
            twin_on_lanes!(call, |L, x, _| deep_piece_weights::<L>(x[0].mul_add(x[1], x[0]), x[0]).1)
        }
        Formula::EmissionFront => twin_on_lanes!(call, |L, x, _| front_back::<L>(x[0], x[1]).0),
        Formula::EmissionBack => twin_on_lanes!(call, |L, x, _| front_back::<L>(x[0], x[1]).1),
        Formula::Dawson => twin_on_lanes!(call, |L, x, _| dawson::<L>(x[0])),
        Formula::Triangle(_) => twin_on_lanes!(call, |L, x, [width, _]| {
            LaneBell::triangle(&wave(width)).mean::<L>(phase(x[0]), phase(x[1]))
        }),
        Formula::Sine(_) => twin_on_lanes!(call, |L, x, [width, _]| {
            LaneBell::sine(&wave(width)).mean::<L>(phase(x[0]), phase(x[1]))
        }),
        Formula::ClipLength => {
            twin_on_lanes!(call, |L, x, _| LaneStretch::<L>::whole().cut(x[0], x[1]).length)
        }
        Formula::ClipCorner => twin_on_lanes!(call, |L, x, _| {
            LaneStretch::<L>::whole().cut(x[0], x[1]).cut(x[2], x[3]).length
        }),
        Formula::GaussianWalked => twin_on_lanes!(call, |L, x, _| {
            let path = LaneGaussianPath::<L>::new::<1>([x[0]], [x[1]]);
            walked::<L>(AnyLaneTrack::Gaussian(LaneGaussianTrack::new(&path, L::F::splat(PEAK as f32))))
        }),
        Formula::TriangularGaussian => twin_on_lanes!(call, |L, x, _| {
            triangular_gaussian::mean_profile::<L>([x[0], x[1]], [x[2], x[3]])
        }),
        Formula::TriangularGaussianNd => twin_on_lanes!(call, |L, x, _| {
            let splat = L::F::splat;
            let (front, back) = ([x[0], x[1], splat(0.3)], [x[2], splat(-0.5), splat(0.7)]);
            LaneTriangularPath::<L>::over_fields(front, back, [x[3], splat(1.0)]).mean()
        }),
        Formula::Ordered(false) => {
            twin_on_lanes!(call, |L, x, _| ordered_sum::<L>(x[0], x[1], false));
        }
        Formula::Ordered(true) => {
            twin_on_lanes!(call, |L, x, _| ordered_sum::<L>(x[0], x[1], true));
        }
    }
    out
}

#[test]
fn every_twin_keeps_its_tolerance_on_every_lane_set() {
    const COUNT: usize = 4000;
    for twin in &TWINS {
        let inputs: Vec<[f64; INPUTS]> = (0..COUNT)
            .map(|i| {
                let mut row = twin::inputs(twin.inputs, i);
                // Some flat segments.
                if i % 16 == 0 && matches!(twin.formula, Formula::Triangle(_) | Formula::Sine(_)) {
                    row[1] = row[0];
                }
                row
            })
            .collect();
        for lanes in LaneSet::ALL {
            if !lanes.is_supported() {
                println!("skipped: this processor has no {}", lanes.name());
                continue;
            }
            let out = values(twin.formula, lanes, &inputs);
            let mut worst = (0.0, 0);
            for (i, (x, found)) in inputs.iter().zip(&out).enumerate() {
                let truth = |x: &[f64; INPUTS]| exact(twin.formula, x);
                let ratio = twin::error_ratio(truth, x, twin.inputs.len(), *found, twin.tolerance);
                if ratio > worst.0 {
                    worst = (ratio, i);
                }
            }
            let (ratio, i) = worst;
            let line = format!(
                "{:?} on {}: {ratio:.2} of {} ε (4 + k) ({}) at {:?}: {} for {}",
                twin.formula,
                lanes.name(),
                twin.tolerance,
                twin.reason,
                &inputs[i][..twin.inputs.len()],
                out[i],
                exact(twin.formula, &inputs[i]),
            );
            println!("{line}");
            assert!(ratio <= 1.0, "{line}");
        }
    }
}
