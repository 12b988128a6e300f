//! What a widget is at a place: what a segment that stays there absorbs, by the closed forms.

use crate::{CompiledTransferFunction, Segment, WidgetBlend};
use proptest::prelude::*;
use voltet_core::transfer::{OpticalModel, TransferFunction};

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(600) })]

    #[test]
    fn a_segment_that_stays_at_a_place_absorbs_what_the_widget_is_there(
        widget in voltet_testing::random::widget(),
        v in proptest::array::uniform2(0.0..1.0_f64),
        values in proptest::array::uniform3(0.0..1.0_f64),
    ) {
        let value = |name: &str| values[["a", "b", "c"].iter().position(|known| *known == name).unwrap()];
        let peak = widget.peak();
        let own: Vec<f64> = widget.profile.properties().fields.into_iter().map(value).collect();
        let found = peak * widget.weight_at(v, &own);
        let look = TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: 1.0,
            widgets: vec![widget], axes: Default::default(),
        };
        let all: Vec<f64> = look.fields().into_iter().map(value).collect();
        let segment = Segment { length: 1.0, front: v, back: v, fields_front: &all, fields_back: &all };
        let depth = CompiledTransferFunction::new(&look).unwrap().integrate(&segment, WidgetBlend::Exact).optical_depth;
        // Texels are 32-bit numbers, and near the foot of a narrow band digits cancel.
        prop_assert!((depth - found).abs() <= 1e-6 * peak, "{depth} by the closed form, {found}");
    }
}

#[test]
fn the_middle_of_a_texel_is_the_texel_and_the_rim_holds_on() {
    let table = voltet_core::transfer::Table {
        width: 2,
        height: 2,
        texels: vec![[1.0, 0.0, 0.0, 0.25], [0.0, 1.0, 0.0, 0.5], [0.0, 0.0, 1.0, 0.75], [1.0; 4]],
        s: [10.0, 14.0],
        g: [0.0, 2.0],
    };
    assert_eq!(table.at([11.0, 1.5]), [1.0, 0.0, 0.0, 0.25], "row 0 is at the largest g");
    assert_eq!(table.at([13.0, 0.5]), [1.0; 4]);
    assert_eq!(table.at([10.0, 2.0]), [1.0, 0.0, 0.0, 0.25], "the rim");
    assert_eq!(table.at([12.0, 1.5]), [0.5, 0.5, 0.0, 0.375], "between two");
    assert_eq!(table.at([9.9, 1.5]), [0.0; 4], "outside");
}
