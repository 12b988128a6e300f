//! The other integrators, composed, against their own 64-bit truths.

use crate::device::Device;
use crate::scene::{Composed, Scenes};
use voltet_integrators::{riemann, segments};
use voltet_judge::segment_cases;
use voltet_judge::segment_twin::{Measure, change_of_places, numbers};
use voltet_optics::integrators::{Extent, new};
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{CompiledTransferFunction, WidgetBlend};
use voltet_shaders::Axis;
use voltet_shaders::segment_list::{axes, holds, origin};

pub fn shading(integrator: Integrator) -> Shading {
    Shading { integrator, overlap: WidgetBlend::Exact, silhouette: None, light: None }
}

/// Change of a stored value by rounding, by the axes.
pub fn stored(axes: &[Axis]) -> impl Fn(usize, f64) -> f64 {
    |a, v| axes.get(a).map_or(0.0, |axis| v - axis.offset)
}

#[test]
fn sampling_integrators_are_twins_of_their_truths() {
    let Some(device) = Device::open() else { return };
    let scenes = Scenes::new(device);
    // 13 samples: groups of four, and one over.
    let all = [riemann(13), segments(6, 33)];
    let places = [
        (0..13).map(|i| (f64::from(i) + 0.5) / 13.0).collect::<Vec<f64>>(),
        (0..7).map(|i| f64::from(i) / 6.0).collect(),
    ];
    let mut broken = Vec::new();
    let mut worst = [(0.0, String::new()), (0.0, String::new())];
    let (mut judged, mut categories) = (0, std::collections::BTreeMap::<String, usize>::new());
    for (n, (id, category, case)) in segment_cases().expect("well formed").into_iter().enumerate() {
        let which = n % all.len();
        let integrator = all[which];
        let (transfer_function, segment) = (&case.transfer_function, case.segment());
        let extent = Extent { scalar: [0.0, 1.0], longest: segment.length };
        let truth = new(&integrator, WidgetBlend::Exact, transfer_function, &extent).expect("serves");
        let axes = axes(transfer_function, &segment);
        let scene = Composed::new(transfer_function, &shading(integrator), &axes, segment.length, None);
        let Ok(scene) = scene.expect("has pieces") else { continue };
        if holds(&scene.shader_key, transfer_function, &segment).is_err() {
            continue;
        }
        let found = scenes.integrate(&scene, &[segment])[0];
        let scale = if case.density() { 1.0 } else { segment.length / transfer_function.unit_distance };
        let brightest = case.brightest() * scale;
        if !(origin(&case.transfer_function.widgets).is_some() || case.conditions().values_keep_digits()) {
            // Values near 1e8, raw: no digit of the samples is left.
            assert!((0.0..=1.0).contains(&found.opacity), "{id}: {found:?}");
            continue;
        }
        let prepared = CompiledTransferFunction::new(transfer_function).expect("valid");
        let measure = Measure::new(truth.as_ref(), &segment, &stored(&axes));
        let further = change_of_places(&prepared, &segment, &places[which], numbers(&measure.exact));
        let ratio = measure.ratio(&found, further, TOLERANCE, brightest);
        if ratio > worst[which].0 {
            worst[which] = (ratio, id.clone());
        }
        if ratio > 1.0 {
            broken.push(format!("{} {id}: {ratio:.2}: {found:?} for {:?}", integrator.name(), measure.exact));
        }
        judged += 1;
        *categories.entry(category).or_default() += 1;
    }
    println!("{judged} cases, {} shaders, worst {worst:?}, {categories:?}", scenes.count());
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
    assert!(judged > 900 && categories.len() > 7, "{judged} cases: {categories:?}");
}

const TOLERANCE: f64 = 16.0;
