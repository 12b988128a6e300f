//! Table widgets and pre-integrated tables, against their 64-bit truths.

use crate::device::Device;
use crate::integrators::{shading, stored};
use crate::scene::{Composed, Scenes};
use voltet_core::transfer::{Profile, Region, Widget};
use voltet_integrators::riemann;
use voltet_optics::integrators::{Extent, Integrator, new};
use voltet_optics::{CompiledTransferFunction, WidgetBlend};
use voltet_shaders::Axis;
use voltet_testing::segment_twin::{Measure, change_of_places, numbers};
use voltet_testing::segments::{MODELS, image, look, segments, widget};

pub const UNIT: [Axis; 2] = [Axis { offset: 0.0, scale: 1.0 }; 2];

fn gaussian(s: f64, g_row: f64, color: [f64; 3]) -> Widget {
    let matrix = [[4.0, 0.0], [0.0, g_row]];
    widget(Profile::Gaussian { centre: [s, 0.5], matrix }, color, 2.0)
}

/// Scenes with tables: alone, of one texel and of one row, in a region, with another widget, and two of them.
fn scenes() -> Vec<Vec<Widget>> {
    let triangle = Region { corners: vec![[0.25, 0.0], [1.0, 0.25], [0.25, 1.0]] };
    vec![
        vec![image(5, 4)],
        vec![image(1, 1)],
        vec![image(7, 1)],
        vec![Widget { region: Some(triangle), ..image(24, 17) }],
        vec![gaussian(0.5, 2.0, [0.5, 1.0, 0.25]), image(5, 4)],
        vec![image(3, 6), image(5, 4)],
    ]
}

#[test]
fn table_widgets_are_twins_of_their_truth() {
    let Some(device) = Device::open() else { return };
    let scenes_on = Scenes::new(device);
    let segments = segments(160, 2.0);
    // The software driver needs a fifth of it; the rest is left to devices whose quotients err by 2.5 units in the last
    // place and exponentials by 3 + 2|x|. Panels of 8 points between texel lines leave less.
    let integrators = [
        (Integrator::ANALYTIC, vec![], 4.0),
        (riemann(9), (0..9).map(|i| (f64::from(i) + 0.5) / 9.0).collect(), 4.0),
        (voltet_integrators::segments(5, 17), (0..6).map(|i| f64::from(i) / 5.0).collect(), 16.0),
    ];
    let mut broken = Vec::new();
    for (model, widgets) in MODELS.iter().flat_map(|model| scenes().into_iter().map(move |w| (*model, w))) {
        let transfer_function = look(model, widgets);
        let prepared = CompiledTransferFunction::new(&transfer_function).expect("valid");
        for (integrator, places, tolerance) in &integrators {
            let extent = Extent { scalar: [0.0, 1.0], longest: 2.0 };
            let truth = new(integrator, WidgetBlend::Exact, &transfer_function, &extent).expect("serves");
            let scene = Composed::new(&transfer_function, &shading(*integrator), &UNIT, 1.0, None)
                .expect("has pieces")
                .expect("in range");
            let mut worst = (0.0, 0);
            for (i, (segment, found)) in
                segments.iter().zip(scenes_on.integrate(&scene, &segments)).enumerate()
            {
                let measure = Measure::new(truth.as_ref(), segment, &stored(&UNIT));
                let further = change_of_places(&prepared, segment, places, numbers(&measure.exact));
                let ratio = measure.ratio(&found, further, *tolerance, 2.0);
                if ratio > worst.0 {
                    worst = (ratio, i);
                }
                if ratio > 1.0 {
                    broken.push(format!("{segment:?}: {ratio:.2}: {found:?} for {:?}", measure.exact));
                }
            }
            println!(
                "{} {model:?}, {} widgets: {worst:?}",
                integrator.name(),
                transfer_function.widgets.len()
            );
        }
    }
    assert!(broken.is_empty(), "{}\n{}", broken.len(), broken[..broken.len().min(20)].join("\n"));
}
