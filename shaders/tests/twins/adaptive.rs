//! The tolerance of `adaptive` is met, within the rounding of 32 bits.

use crate::device::Device;
use crate::integrators::{shading, stored};
use crate::scene::{Composed, Scenes};
use crate::tables::UNIT;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_judge::segment_cases;
use voltet_judge::segment_twin::Measure;
use voltet_optics::integrators::{Extent, Integrator, new};
use voltet_optics::{Contribution, WidgetBlend};
use voltet_shaders::segment_list::{axes, holds, origin};
use voltet_shaders::{compose, compose_pieces, piece};
use voltet_testing::segments::{MODELS, look, overlapping, segments};

const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Tolerance (multiples of ε (4 |truth| + change)): walks of 8-point panels leave 1e-5.
const ROUNDING: f64 = 32.0;

/// |found − truth| as a share of the tolerance and the rounding of 32 bits; A and T keep the latter.
fn ratio(measure: &Measure, found: &Contribution, tolerance: f64, brightest: f64) -> f64 {
    let color = tolerance / (ROUNDING * f64::from(f32::EPSILON));
    measure.ratio(found, [0.0, color, color, color, 0.0], ROUNDING, brightest)
}

#[test]
fn the_tolerance_is_met_on_the_exact_cases() {
    let Some(device) = Device::open() else { return };
    let scenes = Scenes::new(device);
    let (mut broken, mut worst, mut judged) = (Vec::new(), (0.0, String::new()), 0);
    for (n, (id, category, case)) in segment_cases().expect("well formed").into_iter().enumerate() {
        // Every other case, each with one of the tolerances: all categories meet all of them.
        let tolerance = TOLERANCES[n / 2 % TOLERANCES.len()];
        if n % 2 == 1 {
            continue;
        }
        let integrator = Integrator::adaptive(tolerance);
        let (transfer_function, segment) = (&case.transfer_function, case.segment());
        let axes = axes(transfer_function, &segment);
        let scene = Composed::new(transfer_function, &shading(integrator), &axes, segment.length, None);
        let Ok(scene) = scene.expect("has pieces") else { continue };
        // Where 32 bits hold no digits (narrow widgets among them), or the exact value jumps, no tolerance can be met.
        let known = category != "narrow" && case.condition.iter().all(|k| k.is_some_and(|k| k < 1e4));
        if holds(&scene.shader_key, transfer_function, &segment).is_err()
            || !(origin(&case.transfer_function.widgets).is_some() || case.conditions().values_keep_digits())
            || !known
        {
            continue;
        }
        let extent = Extent { scalar: [0.0, 1.0], longest: segment.length };
        let truth =
            new(&Integrator::ANALYTIC, WidgetBlend::Exact, transfer_function, &extent).expect("serves");
        let found = scenes.integrate(&scene, &[segment])[0];
        let scale = if case.density() { 1.0 } else { segment.length / transfer_function.unit_distance };
        let measure = Measure::new(truth.as_ref(), &segment, &stored(&axes));
        let ratio = ratio(&measure, &found, tolerance, case.brightest() * scale);
        if ratio > worst.0 {
            worst = (ratio, id.clone());
        }
        if ratio > 1.0 {
            broken.push(format!("{id} {tolerance}: {ratio:.2}: {found:?} for {:?}", measure.exact));
        }
        judged += 1;
    }
    println!("{judged} cases, {} shaders, worst {worst:?}", scenes.count());
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
    assert!(judged > 500, "only {judged} cases were judged");
}

fn scenes() -> Vec<TransferFunction> {
    let all = |model: OpticalModel| {
        [0.1, 3.0, 300.0].into_iter().flat_map(overlapping).map(move |widgets| look(model, widgets))
    };
    MODELS.into_iter().flat_map(all).collect()
}

fn ready(transfer_function: &TransferFunction, tolerance: f64) -> Composed {
    let integrator = if tolerance > 0.0 { Integrator::adaptive(tolerance) } else { Integrator::ANALYTIC };
    let shading = shading(integrator);
    Composed::new(transfer_function, &shading, &UNIT, 1.0, None).expect("has pieces").expect("in range")
}

#[test]
fn the_tolerance_is_met_where_widgets_overlap() {
    let Some(device) = Device::open() else { return };
    let on = Scenes::new(device);
    let (mut broken, mut worst) = (Vec::new(), [0.0_f64; TOLERANCES.len() + 1]);
    let segments = segments(96, 2.0);
    for transfer_function in scenes() {
        let extent = Extent { scalar: [0.0, 1.0], longest: 2.0 };
        let truth =
            new(&Integrator::ANALYTIC, WidgetBlend::Exact, &transfer_function, &extent).expect("serves");
        let measure = |segment| Measure::new(truth.as_ref(), segment, &stored(&UNIT));
        let measures: Vec<Measure> = segments.iter().map(measure).collect();
        // Without a tolerance: the ordered integral of the closed forms.
        for (worst, tolerance) in worst.iter_mut().zip(TOLERANCES.into_iter().chain([0.0])) {
            let found = on.integrate(&ready(&transfer_function, tolerance), &segments);
            for ((segment, measure), found) in segments.iter().zip(&measures).zip(found) {
                let ratio = ratio(measure, &found, tolerance, 2.0);
                *worst = worst.max(ratio);
                if ratio > 1.0 {
                    broken.push(format!(
                        "{tolerance}: {ratio:.2} {transfer_function:?} {segment:?}: {found:?} for {:?}",
                        measure.exact
                    ));
                }
            }
        }
    }
    println!("worst {worst:?}");
    assert!(broken.is_empty(), "{}\n{}", broken.len(), broken[..broken.len().min(5)].join("\n"));
}

/// In the place of `march`, the share in that of the tolerance: the largest difference between 4 points and 8, as a share
/// of the stake of a panel.
const OBSERVER: &str = "
fn observe(members: Members, depth: f32, share: f32, brightest: f32) -> vec3f {
    var walk = walk_start();
    var before = MarchStep(0.0, -1.0);
    var worst = 0.0;
    for (var i = 0u; i < PANELS_MOST && walk_is_open(walk); i++) {
        let next = members_next_break(members, walk.t);
        let dt = march_panel(walk, next, share, before);
        let values = members_light(members, vec4f(walk.t) + dt * FOUR_NODES);
        let held = dt * dot(values[3], FOUR_WEIGHTS);
        before = MarchStep(0.0, -1.0);
        if walk_shortens(&walk, dt, held, share) {
            continue;
        }
        let seen = brightest * exponential(-walk.depth);
        let stake = seen * panel_stake(dt, held);
        let color = four_points_light(values, dt, walk.depth);
        let exact = ordered_panel(members, &walk, next, dt);
        before = MarchStep(dt, next);
        // Below, rounding, also that of the places where a region or a glow ends.
        let places = 4.0 * PASSED / max(dt, PASSED) * max(stake, seen * stretch_light(dt, held));
        let error = abs(color - exact) - 1e-6 * (abs(exact) + vec3f(stake)) - vec3f(places);
        worst = max(worst, max(error.r, max(error.g, error.b)) / max(stake, 1e-12));
    }
    return vec3f(worst);
}
";

#[test]
fn four_points_err_by_less_than_their_constant() {
    let Some(device) = Device::open() else { return };
    let on = Scenes::new(device);
    let segments = segments(512, 2.0);
    let eight = piece("overlap/panel").expect("is a piece").text;
    for share in [1.0_f64, 0.7, 0.5] {
        let mut worst = 0.0_f64;
        for transfer_function in scenes() {
            let scene = ready(&transfer_function, share);
            let text = compose(&scene.shader_key).text;
            // Closed forms need no panels.
            if !text.contains("march(members, ") {
                continue;
            }
            // The share itself, also where the mix would do.
            let text = text.replace("= march(members, ", "= observe(members, ");
            let text = text.replace("* march(members, ", "* observe(members, ");
            let text = text.replace("return march(members, ", "return observe(members, ");
            let text = text.replace("scene.tolerance / max(glow_scale(part_0), 1e-37)", "scene.tolerance");
            let text = text.replace("if scene.tolerance < ", "if -1.0 < ") + OBSERVER + eight;
            let found = on.integrate_by(&scene, &compose_pieces(&text, &[]), &segments);
            for (segment, found) in segments.iter().zip(found) {
                let constant = scene.shader_key.constant_emitter;
                let scale = if constant { segment.length } else { 1.0 };
                worst = found.color.iter().fold(worst, |worst, c| worst.max(c / scale));
            }
        }
        println!("4 points err by {worst:e} of a panel's stake, over {share} of the way to a break");
        assert!(5.0 * worst <= 5e-3 * share.powi(8), "{share}: {worst}");
        assert!(share < 1.0 || worst > 0.0, "nothing was measured");
    }
}

/// `cargo test -p voltet-shaders --test twins figures -- --ignored --nocapture`
#[test]
#[ignore = "prints figures"]
fn figures_of_tolerances() {
    let Some(device) = Device::open() else { return };
    let on = Scenes::new(device);
    println!("on {}, nanoseconds a segment by tolerance, then by the ordered integral", on.device.name);
    println!("| model | depth | 1e-1 | 1e-2 | 1e-3 | 1e-4 | 1e-5 | 1e-6 | ordered |");
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for (model, name) in MODELS.into_iter().zip(["density-emitter", "constant-emitter"]) {
        // Cells are short: depths of a segment from thin to opaque.
        for longest in [0.02, 0.2, 2.0] {
            let segments = segments(1 << 15, longest);
            let widgets = overlapping(3.0).swap_remove(0);
            let transfer_function = look(model, widgets);
            let time = |tolerance| on.seconds(&ready(&transfer_function, tolerance), &segments, 24);
            let times = TOLERANCES.into_iter().chain([0.0]).map(time);
            let nanoseconds = times.map(|time| format!("{:.0}", time * 1e9 / segments.len() as f64));
            println!("| {name} | {:.2} | {} |", 3.0 * longest, nanoseconds.collect::<Vec<_>>().join(" | "));
        }
    }
}
