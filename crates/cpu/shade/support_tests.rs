//! Support bounds: outside them a widget changes a segment by next to nothing.

use crate::attribute::Attribute;
use crate::shade::context::WidgetContext;
use crate::shade::region::{SupportBounds, ValueRange};
use crate::shade::segment_lanes::SegmentLanes;
use crate::tolerances::NEGLIGIBLE_DEPTH;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};
use voltet_simd::{Float, Kernel, LaneSet, Lanes, Mask, dispatch};

/// True if support bounds meet a segment, by its stored ends.
struct Ask<'a> {
    reach: &'a SupportBounds,
    ends: [[f64; 2]; 2],
    attributes: &'a [Attribute<'a>],
}

impl Kernel<bool> for Ask<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        let stored = |end: usize, a: usize| {
            let Attribute { offset, scale, .. } = self.attributes[a];
            L::F::splat(((self.ends[end][a] - offset) / scale) as f32)
        };
        let segments = SegmentLanes::<L> {
            length: L::F::splat(1.0),
            crossing: L::F::splat(0.0).lt(L::F::splat(1.0)),
            front: [stored(0, 0), stored(0, 1)],
            back: [stored(1, 0), stored(1, 1)],
        };
        self.reach.meets::<L>(&ValueRange::new(&segments)).any()
    }
}

fn widgets() -> Vec<Widget> {
    let widget = |profile, extinction, region| Widget { profile, color: [0.9, 0.5, 3.0], extinction, region };
    let gaussian = |centre, matrix| Profile::Gaussian { centre, matrix };
    let point = |s, extinction| ControlPoint { s, color: [1.0; 3], extinction };
    let hat = vec![point(0.3, 0.0), point(0.4, 7.0), point(0.45, 0.0)];
    let wave = Wave { origin: [0.1, 0.0], angle: 0.3, scale: [1.0; 2], period: 0.4, band_width: 0.7 };
    let rectangle = Some(Region::rectangle([0.1, 0.4], [0.2, f64::INFINITY]));
    let triangle = Some(Region { corners: vec![[0.2, 0.1], [0.7, 0.2], [0.3, 0.6]] });
    let open = Some(Region::rectangle([f64::NEG_INFINITY, 0.35], [f64::NEG_INFINITY, f64::INFINITY]));
    vec![
        widget(gaussian([0.4, 0.3], [[30.0, 0.0], [0.0, 12.0]]), 5.0, None),
        widget(gaussian([0.4, 0.3], [[30.0, 0.0], [0.0, 0.0]]), 1e-9, None),
        widget(gaussian([0.6, 0.7], [[25.0, -18.0], [3.0, 9.0]]), 1e6, None),
        widget(gaussian([0.1, 0.5], [[300.0, 0.0], [0.0, 1.0]]), 40.0, rectangle.clone()),
        widget(gaussian([0.5, 0.5], [[2.0, 0.0], [0.0, 2.0]]), 1.0, triangle.clone()),
        widget(Profile::TriangularGaussian { centre: 0.7, sigma: 0.05 }, 3.0, None),
        widget(Profile::Uniform, 2.0, triangle),
        widget(Profile::Uniform, 2.0, open),
        widget(Profile::SineWave(wave), 2.0, rectangle),
        widget(Profile::PiecewiseLinear { points: hat }, 1.0, None),
    ]
}

#[test]
fn what_no_widget_is_asked_of_is_less_than_may_be_left_out() {
    // Offsets and scales as a volume has them, and one that takes digits.
    let axis =
        |offset: f64, scale: f64| Attribute { values: &[], stride: 1, offset, scale, range: [0.0, 1.0] };
    for attributes in [[axis(0.5, 1.0), axis(0.5, 1.0)], [axis(-3.0, 64.0), axis(0.125, 0.5)]] {
        for (number, widget) in widgets().into_iter().enumerate() {
            let context = WidgetContext {
                attributes: &attributes,
                fields: &[],
                density_scale: 1.0,
                model: OpticalModel::DensityEmitter,
                left_out: Some(NEGLIGIBLE_DEPTH),
            };
            let reach =
                SupportBounds::new(&widget, &context, NEGLIGIBLE_DEPTH).expect("it is not everywhere");
            let max = NEGLIGIBLE_DEPTH * widget.peak().min(1.0);
            let look = TransferFunction {
                model: OpticalModel::DensityEmitter,
                unit_distance: 1.0,
                widgets: vec![widget],
                axes: Default::default(),
            };
            let exact = CompiledTransferFunction::new(&look).expect("valid");
            let (mut state, mut passed) = (number as u64 + 1, 0);
            let mut random = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 33) as f64 / (1_u64 << 31) as f64
            };
            for k in 0..3000 {
                // Short ones and long ones; some reach just beyond an edge.
                let size = [1.0, 0.1, 1e-3][k % 3];
                let front = [random(), random()];
                let back = front.map(|x| (x + size * (random() - 0.5)).clamp(0.0, 1.0));
                let found = exact.integrate(
                    &Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] },
                    WidgetBlend::Exact,
                );
                let ends = [front, back];
                let met = dispatch(
                    LaneSet::detect().expect("there are lanes"),
                    Ask { reach: &reach, ends, attributes: &attributes },
                );
                if !met {
                    passed += 1;
                    let lost = found.color.into_iter().fold(found.optical_depth, f64::max);
                    assert!(lost <= max, "widget {number}: {lost:e} is left out from {front:?} to {back:?}");
                }
            }
            assert!((150..2950).contains(&passed), "widget {number}: not asked of {passed} segments of 3000");
        }
    }
}
