//! What is kept between pictures: whatever was drawn before, what is culled is what would be culled at first.

use super::*;
use voltet_core::camera::Projection;
use voltet_core::grid::Array;
use voltet_core::transfer::{Corners, OpticalModel, Support};
use voltet_cpu::{CellSelection, Cells, CullSample, ENGINE, VolumeCache, draw};
use voltet_optics::engine::AdapterRequest;
use voltet_optics::scene_parts::{PartTally, SceneExtent};

/// 20³ cubes: 40,000 tetrahedra and more, so that a sample is taken.
fn bivariate() -> Volume {
    bivariate_of(20)
}

/// So many cubes a side, with g and two further fields.
fn bivariate_of(side: usize) -> Volume {
    let mut grid = cube([side; 3], 0.2);
    let field = |f: &dyn Fn(&DVec3) -> f64| grid.points.iter().map(f).collect::<Vec<f64>>();
    let [a, b, g] = [field(&|p| p.y), field(&|p| p.z), field(&|p| (p - DVec3::splat(0.5)).length())];
    for (name, values) in [("a", a), ("b", b)] {
        let array = Array { component_count: 1, values: values.into() };
        grid.point_arrays.insert(name.into(), Arc::new(array));
    }
    let scalar = grid.points.iter().map(|p| p.x).collect();
    Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: Some(g.into()) }
}

fn gaussian(centre: [f64; 2], sigma: f64) -> Widget {
    let k = std::f64::consts::FRAC_1_SQRT_2 / sigma;
    let profile = Profile::Gaussian { centre, matrix: [[k, 0.0], [0.0, k]] };
    Widget { profile, color: [0.9, 0.5, 0.2], extinction: 3.0, region: None }
}

fn of_field(name: &str) -> Widget {
    let profile =
        Profile::GaussianNd { fields: vec![name.into()], centre: vec![0.3], matrix: vec![vec![20.0]] };
    Widget { profile, ..gaussian([0.0; 2], 1.0) }
}

fn culled(cells: &Cells) -> (&[u32], u64, u64, &[usize], Option<CullSample>) {
    let CellSelection {
        ids,
        culled_by_transfer_function,
        culled_by_frustum,
        inactive_widgets,
        culling_skipped,
        ..
    } = &cells.selection;
    (ids, *culled_by_transfer_function, *culled_by_frustum, inactive_widgets, *culling_skipped)
}

/// Transfer functions that differ from their neighbours in one thing each.
fn looks() -> Vec<TransferFunction> {
    let narrow = gaussian([0.3, 0.2], 0.01);
    let white = Widget { color: [1.0; 3], ..narrow.clone() };
    let bright = Widget { color: [9.0; 3], ..narrow.clone() };
    let moved = gaussian([0.31, 0.2], 0.01);
    let faint = |extinction| Widget { extinction, ..moved.clone() };
    let line = Profile::Gaussian { centre: [0.6, 0.0], matrix: [[30.0, 0.0], [0.0, 0.0]] };
    let line = Widget { profile: line, ..moved.clone() };
    let within = Widget { region: Some(Region::rectangle([0.55, 0.62], [0.3, 0.5])), ..line.clone() };
    let far = gaussian([9.0, 9.0], 0.1);
    let mut looks: Vec<TransferFunction> =
        [narrow, white, bright, moved.clone(), faint(0.0), faint(1e-8), faint(1.0), line, within]
            .into_iter()
            .map(|widget| look(vec![widget]))
            .collect();
    let further = [
        vec![of_field("a")],
        vec![of_field("b")],
        vec![uniform([0.0, 0.02], 1.0, [1.0; 3]), far, moved, of_field("a")],
        vec![gaussian([0.5, 0.4], 0.5)],
        vec![uniform([0.0, 0.9], 1.0, [1.0; 3])],
        vec![uniform([0.0, 0.99], 1.0, [1.0; 3])],
    ];
    looks.extend(further.map(look));
    let model = OpticalModel::ConstantEmitter { cutoff: 1e-3 };
    let glowing = looks.iter().map(|look| TransferFunction { model, ..look.clone() });
    let glowing: Vec<_> = glowing.filter(|look| look.widgets.len() == 1).collect();
    [looks, glowing].concat()
}

#[test]
fn what_was_drawn_before_changes_nothing_that_is_kept() {
    let volume = Arc::new(bivariate());
    let known = VolumeCache::new(&volume).expect("has an extent");
    let whole = along(DVec3::Y);
    let narrow = Camera { projection: Projection::Orthographic { height: 0.3 }, ..whole };
    let mut not_worth = 0;
    for look in looks() {
        // The same twice, another camera, and back.
        for camera in [whole, whole, narrow, whole] {
            let now = known.cull(&look, &camera, &NoProgress).expect("culls");
            let first = voltet_cpu::cull(&volume, &look, &camera, &NoProgress).expect("culls");
            assert_eq!(culled(&now), culled(&first), "{look:?}");
            not_worth += u32::from(now.culling_skipped.is_some());
        }
    }
    assert!(not_worth > 0, "culling was worth it every time");
}

#[test]
fn every_cell_that_is_touched_is_kept_and_hardly_another() {
    let volume = Arc::new(bivariate());
    let known = VolumeCache::new(&volume).expect("has an extent");
    let least = 1e-7 / 3f64.sqrt();
    for look in looks() {
        let cells = known.cull(&look, &along(DVec3::Y), &NoProgress).expect("culls");
        let support = Support::new(&look).expect("valid");
        let stepped = support.clone().in_steps(least);
        let g = volume.gradient_magnitude.as_ref().expect("has g");
        let fields: Vec<_> =
            look.fields().iter().map(|name| &volume.grid.point_arrays[*name].values).collect();
        let mut kept = cells.ids.iter().copied().peekable();
        for (id, corners) in volume.grid.tetrahedra.iter().enumerate() {
            let at = |values: &[f64]| corners.map(|p| values[p as usize]);
            let (s, fields) =
                (at(&volume.scalar), fields.iter().map(|values| at(values)).collect::<Vec<_>>());
            let g = if look.uses_gradient_magnitude() { at(g) } else { [0.0; 4] };
            let is_kept = kept.next_if_eq(&(id as u32)).is_some();
            let corners = Corners { s: &s, g: &g, fields: &fields };
            let touched = |support: &Support| support.first_overlapping_widget(0, &corners, least).is_some();
            assert!(is_kept || !touched(&support), "cell {id} of {look:?}");
            // An extinction counts for up to twice as much.
            let spared = cells.culling_skipped.is_some();
            assert!(!is_kept || spared || touched(&stepped), "cell {id} of {look:?}");
        }
        for widget in 0..look.widgets.len() {
            let touched = |corners: &[u32; 4]| {
                let at = |values: &[f64]| corners.map(|p| values[p as usize]);
                let fields: Vec<_> = fields.iter().map(|values| at(values)).collect();
                let g = if look.uses_gradient_magnitude() { at(g) } else { [0.0; 4] };
                let corners = Corners { s: &at(&volume.scalar), g: &g, fields: &fields };
                stepped.widget_touches(widget, &corners, least)
            };
            let any = volume.grid.tetrahedra.iter().any(touched);
            assert_eq!(cells.inactive_widgets.contains(&widget), !any, "widget {widget} of {look:?}");
        }
    }
}

/// A widget that is met outside of the view alone is left out, also where it was met before the camera turned.
#[test]
fn widgets_are_kept_that_the_view_shows() {
    let volume = Arc::new(bivariate());
    let known = VolumeCache::new(&volume).expect("has an extent");
    let [low, high] = [[0.0, 0.05], [0.95, 1.0]].map(|range| uniform(range, 1.0, [1.0; 3]));
    let look = look(vec![low, high]);
    let whole = along(DVec3::Y);
    let part = |x: f64| Camera {
        projection: Projection::Orthographic { height: 0.1 },
        eye: DVec3::new(x, -5.0, 0.5),
        target: DVec3::new(x, 0.5, 0.5),
        ..whole
    };
    for (camera, untouched) in
        [(whole, vec![]), (part(0.02), vec![1]), (part(0.98), vec![0]), (whole, vec![])]
    {
        let cells = known.cull(&look, &camera, &NoProgress).expect("culls");
        assert_eq!(cells.inactive_widgets, untouched, "from {}", camera.eye);
    }
}

/// Values are rounded otherwise where a widget with an edge is left out, although it stands where the others do.
#[test]
fn edges_that_no_cell_touches_count_for_a_grid_in_parts() {
    let volume = Arc::new(bivariate_of(3));
    let plain = gaussian([0.3, 0.4], 0.1);
    let cut = Widget { region: Some(Region::rectangle([0.2, 0.4], [0.3, 0.5])), ..plain.clone() };
    let whole = SceneExtent::of_part(&volume, &[], &along(DVec3::Y)).expect("has an extent");
    let choices = |other: &Widget| {
        let look = look(vec![plain.clone(), other.clone()]);
        let tally = PartTally { active_widgets: vec![true, false], ..PartTally::default() };
        let engine = ENGINE.open(&AdapterRequest::default()).expect("opens");
        engine.choices(&whole, &look, &tally).expect("has an extent")
    };
    assert_eq!(choices(&plain).inactive_widgets, [0; 0]);
    assert_eq!(choices(&cut).inactive_widgets, [1]);
}

/// Nothing is asked where a sample says that it drops less than one cell in twenty; the picture is the same to rounding.
#[test]
fn culling_that_would_not_pay_is_not_done() -> voltet_core::Result<()> {
    let volume = Arc::new(bivariate());
    let camera = along(DVec3::Y);
    for (share, worth) in [(0.955, false), (0.85, true)] {
        let look = look(vec![uniform([0.0, share], 1.0, [1.0, 0.5, 0.2])]);
        let cells = voltet_cpu::cull(&volume, &look, &camera, &NoProgress).expect("culls");
        let total = volume.grid.tetrahedra.len();
        assert_eq!(cells.ids.len() == total, !worth, "{share}");
        match cells.culling_skipped {
            Some(CullSample { tested: asked, dropped }) => {
                assert!(!worth && asked as usize * 64 <= total && dropped * 20 < asked);
            }
            None => assert!(worth),
        }
        // Who wants to know which are kept gets each asked, also after a picture that did not.
        let known = VolumeCache::new(&volume)?;
        let whole = Camera { projection: Projection::Orthographic { height: 2.0 }, ..camera };
        let few = known.cull(&look, &whole, &NoProgress)?;
        let each = known.cull_exact(&look, &whole, &NoProgress)?;
        let is_touched = |&id: &u32| {
            let s = volume.grid.tetrahedra[id as usize].map(|p| volume.scalar[p as usize]);
            s.into_iter().fold(f64::INFINITY, f64::min) <= share
        };
        let expected: Vec<u32> = (0..total as u32).filter(is_touched).collect();
        assert!(expected.len() < total && *each.ids == expected, "{share}");
        assert!(few.ids.len() >= each.ids.len() && each.culling_skipped.is_none(), "{share}");
        let all = VolumeCache::new(&volume).and_then(|cache| cache.all(&look, &camera)).expect("keeps all");
        let pictures =
            [cells, all].map(|cells| draw(&cells, &look, &camera, &SHADING, &NoProgress).expect("draws").0);
        let difference = largest_difference(&pictures[0], &pictures[1]);
        assert!(difference <= 1e-6, "{share}: a pixel changes by {difference:e}");
    }
    Ok(())
}

/// Asking all cells of a small grid takes no time, whatever few of them are culled.
#[test]
fn small_grids_are_kept_cell_by_cell() {
    let volume = Arc::new(bivariate_of(12));
    let look = look(vec![uniform([0.0, 0.92], 1.0, [1.0; 3])]);
    let cells = voltet_cpu::cull(&volume, &look, &along(DVec3::Y), &NoProgress).expect("culls");
    let total = volume.grid.tetrahedra.len() as u64;
    let is_beyond = |corners: &[u32; 4]| corners.iter().all(|&p| volume.scalar[p as usize] > 0.92);
    let few = volume.grid.tetrahedra.iter().filter(|corners| is_beyond(corners)).count() as u64;
    assert!(0 < few && 20 * few < total, "{few} of {total}");
    assert_eq!((cells.culled_by_transfer_function, cells.culling_skipped), (few, None));
}

/// The same of cells out of view.
#[test]
fn cells_out_of_view_stay_where_they_are_few() -> voltet_core::Result<()> {
    let volume = Arc::new(bivariate());
    let look = look(vec![uniform([-1.0, 2.0], 1.0, [1.0, 0.5, 0.2])]);
    let total = volume.grid.tetrahedra.len() as u64;
    for (height, few) in [(0.975, true), (0.955, false), (0.7, false)] {
        let camera = Camera { projection: Projection::Orthographic { height }, ..along(DVec3::Y) };
        let known = VolumeCache::new(&volume)?;
        let (usual, each) =
            (known.cull(&look, &camera, &NoProgress)?, known.cull_exact(&look, &camera, &NoProgress)?);
        let out = each.culled_by_frustum;
        assert!(0 < out && (20 * out < total) == few, "{height}: {out} of {total}");
        assert_eq!(usual.culled_by_frustum, if few { 0 } else { out }, "{height}");
        let pictures =
            [usual, each].map(|cells| draw(&cells, &look, &camera, &SHADING, &NoProgress).expect("draws").0);
        let difference = largest_difference(&pictures[0], &pictures[1]);
        assert!(difference <= 1e-6, "{height}: a pixel changes by {difference:e}");
    }
    Ok(())
}
