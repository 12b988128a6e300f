//! Closed forms of overlapping widgets, compared with quadrature.

use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Widget};
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};

/// All light comes from 3e-8 of the segment, along which one widget falls off: still in order, by quadrature.
#[test]
fn places_within_a_hundred_millionth_are_told_apart() {
    let k = 1.0 / 2e-8;
    let profile = Profile::Gaussian { centre: [0.5, 0.0], matrix: [[k, 0.0], [0.0, 0.0]] };
    let behind = Some(Region::rectangle([0.5, 2.0], [f64::NEG_INFINITY, f64::INFINITY]));
    let widget = |profile, color, region: &Option<Region>| {
        let region = region.clone();
        Widget { profile, color, extinction: 1e8, region }
    };
    let widgets =
        vec![widget(profile, [1.0, 0.0, 0.0], &behind), widget(Profile::Uniform, [0.0, 1.0, 0.0], &behind)];
    let look = TransferFunction {
        model: OpticalModel::DensityEmitter,
        unit_distance: 1.0,
        widgets,
        axes: Default::default(),
    };
    let (front, back) = ([0.0; 2], [1.0, 0.0]);
    let segment = Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
    let found = CompiledTransferFunction::new(&look).expect("valid").integrate(&segment, WidgetBlend::Exact);
    let exact = voltet_reference::integrate(&segment, &look, WidgetBlend::Exact).expect("integrates");
    for (found, exact) in found.color.into_iter().zip(exact.color) {
        // Places are known to 1e-16 by 2e-8 of a width.
        assert!((found - exact).abs() < 1e-7, "{found} for {exact}");
    }
}
