//! Segments that are kept of a view while its widgets change: whatever was drawn before, a picture is that of the cells.

use super::*;
use voltet_core::transfer::{ControlPoint, OpticalModel, Region};
use voltet_cpu::ENGINE;
use voltet_integrators::{VERTEX_SAMPLED, pre_integrated, riemann};
use voltet_optics::engine::{AdapterRequest, PreparedVolume, RenderOptions, RenderOutput, Stage};
use voltet_optics::shading::{Integrator, Shading};
use voltet_testing::pictures::looks::perspective;

fn bivariate() -> Arc<Volume> {
    let grid = cube([14; 3], 0.2);
    let scalar = grid.points.iter().map(|p| p.x + 0.3 * (5.0 * p.y).sin()).collect();
    let g: Vec<f64> = grid.points.iter().map(|p| (p - DVec3::splat(0.5)).length()).collect();
    Arc::new(Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: Some(g.into()) })
}

fn gaussian(centre: [f64; 2], sigma: f64, color: [f64; 3], extinction: f64) -> Widget {
    let k = std::f64::consts::FRAC_1_SQRT_2 / sigma;
    let profile = Profile::Gaussian { centre, matrix: [[k, 0.0], [0.0, k]] };
    Widget { profile, color, extinction, region: None }
}

fn piecewise(extinction: f64) -> Widget {
    let point = |s: f64, color, extinction| ControlPoint { s, color, extinction };
    let points = vec![
        point(0.1, [0.9, 0.1, 0.1], 0.0),
        point(0.5, [0.1, 0.8, 0.2], extinction),
        point(0.9, [0.2, 0.2, 0.9], 0.3 * extinction),
    ];
    let profile = Profile::PiecewiseLinear { points };
    Widget { profile, ..gaussian([0.0; 2], 1.0, [1.0; 3], 0.0) }
}

/// Transfer functions that are served, in an order in which each differs from the one before: of one colour, of several, overlapping
/// and dense, glowing.
fn looks() -> Vec<TransferFunction> {
    let orange = |s: f64, extinction| gaussian([s, 0.4], 0.2, [0.9, 0.5, 0.2], extinction);
    let blue = |extinction| gaussian([0.6, 0.5], 0.3, [0.1, 0.4, 0.9], extinction);
    let green = gaussian([0.2, 0.3], 0.15, [0.2, 0.9, 0.1], 4.0);
    let mut looks: Vec<_> = [
        vec![orange(0.3, 3.0)],
        vec![orange(0.4, 3.0)],
        vec![orange(0.4, 2.0), blue(1.0)],
        vec![orange(0.5, 2.0), blue(1.0), green],
        vec![orange(0.5, 30.0), blue(20.0)],
        vec![orange(0.5, 3000.0), blue(2000.0)],
        vec![orange(0.5, 1e-6), blue(1e-6)],
    ]
    .map(look)
    .into();
    let model = OpticalModel::ConstantEmitter { cutoff: 1e-3 };
    looks.push(TransferFunction { model, ..looks[2].clone() });
    looks.extend([1.0, 8.0, 30.0, 500.0].map(|extinction| look(vec![piecewise(extinction)])));
    looks
}

fn prepared(volume: &Arc<Volume>) -> Arc<dyn PreparedVolume> {
    let engine = ENGINE.open(&AdapterRequest::default()).expect("opens");
    engine.prepare(volume).expect("has an extent")
}

fn drawn(prepared: &dyn PreparedVolume, scene: &Scene) -> RenderOutput {
    prepared.draw(scene, &RenderOptions::default(), &NoProgress).expect("draws")
}

fn preview_of(prepared: &dyn PreparedVolume, scene: &Scene) -> RenderOutput {
    prepared
        .draw(scene, &RenderOptions { preview: true, ..RenderOptions::default() }, &NoProgress)
        .expect("draws")
}

/// Whether it was drawn from what was kept.
fn is_kept(drawn: &RenderOutput) -> bool {
    let left_out = drawn.notes.skipped.iter().any(|left| left.what == "culling, projecting and sorting");
    assert_eq!(left_out, drawn.is_preview);
    left_out
}

fn cameras() -> [Camera; 2] {
    let within = perspective([0.5, 0.45, 0.5], [0.7, 0.9, 0.6], 80.0, [40, 33]);
    [Camera { size: [40, 33], ..along(DVec3::Y) }, within]
}

#[test]
fn kept_segments_give_the_picture_of_the_cells() {
    let volume = bivariate();
    for camera in cameras() {
        let changing = prepared(&volume);
        let mut served = 0;
        for look in looks().into_iter().chain(looks()) {
            let scene = scene(volume.clone(), look, camera);
            let kept = preview_of(&*changing, &scene);
            let fresh = drawn(&*prepared(&volume), &scene);
            assert!(!is_kept(&fresh));
            served += u32::from(is_kept(&kept));
            let difference = largest_difference(&kept.picture, &fresh.picture);
            assert!(difference < 5e-6, "{difference:e} from {:?}", scene.transfer_function);
        }
        // All but those before the second change, and between those that look at g and those that do not.
        assert!(served > 20, "{served} pictures were drawn from what was kept");
    }
}

/// The narrower a widget, the less of it 32 bits hold that are counted from the middle of the range; narrower than a 2000th of that it is
/// drawn from the cells.
#[test]
fn narrow_widgets_beside_wide_ones_are_served_as_far_as_32_bits_hold_them() {
    let (volume, camera) = (bivariate(), cameras()[0]);
    let range = voltet_core::grid::extent::range(&volume.scalar).expect("has values");
    for (share, most) in [(1.0 / 45.0, 5e-6), (1.0 / 300.0, 5e-6), (1.0 / 1900.0, 1e-5), (1.0 / 2100.0, 5e-6)]
    {
        let sigma = share * (range[1] - range[0]);
        let changing = prepared(&volume);
        let (mut worst, mut served): (f32, bool) = (0.0, false);
        for k in 0..6 {
            let narrow = gaussian([0.3 + 0.05 * f64::from(k), 0.4], 1.0, [0.2, 0.9, 0.4], 40.0);
            let k = std::f64::consts::FRAC_1_SQRT_2;
            let matrix = [[k / sigma, 0.0], [0.0, k / 0.3]];
            let Profile::Gaussian { centre, .. } = narrow.profile else { unreachable!() };
            let narrow = Widget { profile: Profile::Gaussian { centre, matrix }, ..narrow };
            let wide = gaussian([0.5, 0.4], 0.4, [0.9, 0.5, 0.2], 0.3);
            let scene = scene(volume.clone(), look(vec![narrow, wide]), camera);
            let (kept, fresh) = (preview_of(&*changing, &scene), drawn(&*prepared(&volume), &scene));
            worst = worst.max(largest_difference(&kept.picture, &fresh.picture));
            served |= is_kept(&kept);
        }
        assert!(worst <= most && served == (share > 1.0 / 2000.0), "{share}: {worst:e}");
    }
}

/// On a field of steps between plateaus, too, on whose values regions end: both are rounded alike.
#[test]
fn regions_that_end_on_plateaus_are_those_of_the_cells() {
    let smooth = bivariate();
    let steps: Vec<f64> = smooth.scalar.iter().map(|s| (s * 10.0).round() / 10.0).collect();
    let plateaus = Arc::new(Volume { scalar: steps.into(), ..(*smooth).clone() });
    let (camera, open) = (cameras()[0], [f64::NEG_INFINITY, f64::INFINITY]);
    // A value is off by 2⁻²⁴ of the range, 1e-7: of a segment whose ends differ by a step, 0.1, that is 1e-6, and a ray crosses an
    // edge some ten times.
    for volume in [smooth, plateaus] {
        let changing = prepared(&volume);
        let mut served = 0;
        for k in 0..16 {
            let [low, middle, high] = [0, 3, 5].map(|step| f64::from(k % 8 + step) / 10.0);
            let bounded = |widget: Widget, s, g| Widget { region: Some(Region::rectangle(s, g)), ..widget };
            let look = look(vec![
                bounded(gaussian([0.5, 0.4], 0.4, [0.9, 0.5, 0.2], 4.0), [low, middle], open),
                bounded(gaussian([0.3, 0.4], 0.1, [0.2, 0.5, 0.9], 9.0), [-4.0, 8.0], [0.3, 100.0]),
                uniform([middle, high], 1.0, [0.1, 0.9, 0.3]),
            ]);
            let scene = scene(volume.clone(), look, camera);
            let (kept, fresh) = (preview_of(&*changing, &scene), drawn(&*prepared(&volume), &scene));
            served += u32::from(is_kept(&kept));
            let difference = largest_difference(&kept.picture, &fresh.picture);
            assert!(difference < 2e-5, "{difference:e} from {low}");
        }
        assert!(served > 12, "{served} pictures were drawn from what was kept");
    }
}

/// Other integrators look at the same segments; those whose tables the cells bound draw the cells.
#[test]
fn integrators_are_served_by_what_was_kept() {
    let (volume, camera) = (bivariate(), cameras()[0]);
    let table = pre_integrated(16, 2);
    for (looks, integrators) in
        [(&looks()[2..4], [riemann(5), VERTEX_SAMPLED]), (&looks()[8..10], [riemann(5), table])]
    {
        let changing = prepared(&volume);
        for (k, integrator) in
            [integrators.as_slice(), &[Integrator::ANALYTIC]].concat().into_iter().enumerate()
        {
            for look in looks {
                let shading = Shading { integrator, ..SHADING };
                let scene = Scene { shading, ..scene(volume.clone(), look.clone(), camera) };
                let kept = preview_of(&*changing, &scene);
                let fresh = drawn(&*prepared(&volume), &scene);
                let difference = largest_difference(&kept.picture, &fresh.picture);
                assert!(difference < 5e-6, "{difference:e} by {integrator:?}");
                assert!(k < 2 || is_kept(&kept), "{integrator:?} by the cells");
            }
        }
    }
}

/// What 32 bits counted from the middle of a range do not hold is drawn from the cells: very narrow widgets; so are narrow ones alone, what was
/// projected for less density, and whatever nobody asked for a second time.
#[test]
fn what_was_kept_is_left_where_it_does_not_serve() {
    let (volume, camera) = (bivariate(), cameras()[0]);
    let wide = |s: f64| look(vec![gaussian([s, 0.4], 0.2, [0.9, 0.5, 0.2], 3.0)]);
    let narrow = |s: f64| look(vec![gaussian([s, 0.4], 0.01, [0.9, 0.5, 0.2], 3.0)]);
    let thin = Region::rectangle([0.2, 0.2005], [0.0, 1.0]);
    let edged = look(vec![Widget { region: Some(thin), ..wide(0.3).widgets[0].clone() }]);
    let dense = look(vec![gaussian([0.3, 0.4], 0.2, [0.9, 0.5, 0.2], 300.0)]);
    let changing = prepared(&volume);
    let is_kept_of = |look: &TransferFunction, camera| {
        is_kept(&preview_of(&*changing, &scene(volume.clone(), look.clone(), camera)))
    };
    assert!(!is_kept_of(&wide(0.3), camera), "at first");
    assert!(!is_kept_of(&wide(0.3), camera), "the same again");
    assert!(!is_kept_of(&wide(0.4), camera), "another widget");
    assert!(is_kept_of(&wide(0.45), camera), "and another");
    assert!(is_kept_of(&wide(0.45), camera), "the same again");
    assert!(!is_kept_of(&narrow(0.4), camera), "a narrow one");
    let both = |s: f64| look([narrow(s).widgets, wide(s).widgets].concat());
    assert!(is_kept_of(&both(0.5), camera), "a narrow one and a wide one");
    assert!(!is_kept_of(&edged, camera), "one in a narrow region");
    assert!(is_kept_of(&wide(0.5), camera), "a wide one");
    assert!(!is_kept_of(&wide(0.6), cameras()[1]), "another view");
    assert!(is_kept_of(&wide(0.6), camera), "the view before");
    // Kept anew, for more.
    let of_dense = preview_of(&*changing, &scene(volume.clone(), dense, camera));
    let is_anew = of_dense.stages.iter().any(|timed| timed.stage == Stage::Project && timed.seconds > 0.0);
    assert!(is_kept(&of_dense) && is_anew, "a hundred times as dense");
    assert!(is_kept_of(&wide(0.6), camera), "and back");
}

/// Cached segments serve previews alone: any other has the same bits whatever was drawn before.
#[test]
fn a_picture_that_stays_is_that_of_the_cells() {
    let (volume, camera) = (bivariate(), cameras()[0]);
    let (changing, mut kept) = (prepared(&volume), 0);
    for look in looks() {
        let scene = scene(volume.clone(), look, camera);
        kept += u32::from(is_kept(&preview_of(&*changing, &scene)));
        let [now, fresh] = [&changing, &prepared(&volume)].map(|prepared| drawn(&**prepared, &scene));
        assert!(!is_kept(&now) && now.picture.rgba == fresh.picture.rgba, "{:?}", scene.transfer_function);
    }
    assert!(kept > 5, "{kept} of the pictures that passed were drawn from what was kept");
}
