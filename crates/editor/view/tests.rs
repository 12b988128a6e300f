use super::*;
use proptest::prelude::*;

/// The ray through a place of the picture: where it begins, and its unit direction.
fn ray(view: &View, [right, up]: [f64; 2]) -> Option<[DVec3; 2]> {
    let axes = view.axes()?;
    let at = view.target + view.height() * (right * axes.right + up * axes.up);
    match view.projection {
        Projection::Perspective { .. } => Some([view.eye, (at - view.eye).normalize()]),
        Projection::Orthographic { .. } => Some([at - axes.forward * view.distance(), axes.forward]),
    }
}

fn view() -> View {
    let projection = Projection::Perspective { fov_y: 30.0 };
    View { eye: DVec3::new(0.0, -12.0, 6.0), target: DVec3::new(3.0, 0.0, 1.5), up: DVec3::Z, projection }
}

fn parallel() -> View {
    View { projection: Projection::Orthographic { height: 5.0 }, ..view() }
}

/// Position of a point in the picture, in heights of the picture from its middle.
fn seen(view: &View, point: DVec3) -> [f64; 2] {
    let axes = view.axes().unwrap();
    let to = point - view.eye;
    let scale = match view.projection {
        Projection::Perspective { fov_y } => 2.0 * to.dot(axes.forward) * (0.5 * fov_y).to_radians().tan(),
        Projection::Orthographic { height } => height,
    };
    [to.dot(axes.right) / scale, to.dot(axes.up) / scale]
}

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).length() <= 1e-9 * (1.0 + a.length())
}

#[test]
fn an_orbit_keeps_the_distance_and_follows_the_hand() {
    for view in [view(), parallel()] {
        let moved = view.orbited([0.1, 0.2]);
        assert!((moved.distance() - view.distance()).abs() < 1e-12);
        // What is before the target moves with the hand: to the right and up.
        let before = view.target + 0.1 * (view.eye - view.target);
        let [right, up] = seen(&moved, before);
        assert!(right > 0.0 && up > 0.0, "{right} {up}");
        // A whole turn leads back.
        let whole = (0..8).fold(view, |view, _| view.orbited([std::f64::consts::FRAC_PI_4, 0.0]));
        assert!(near(whole.eye, view.eye), "{}", whole.eye);
    }
}

#[test]
fn panning_takes_what_is_at_the_target_along() {
    for view in [view(), parallel()] {
        let moved = view.panned([0.25, -0.1]);
        let [right, up] = seen(&moved, view.target);
        assert!((right - 0.25).abs() < 1e-12 && (up + 0.1).abs() < 1e-12);
    }
}

#[test]
fn zooming_keeps_what_is_under_the_pointer() {
    for view in [view(), parallel()] {
        let at = [0.3, -0.2];
        let [start, direction] = ray(&view, at).unwrap();
        let axes = view.axes().unwrap();
        let depth = (view.target - start).dot(axes.forward) / direction.dot(axes.forward);
        let point = start + depth * direction;
        let moved = view.zoomed(1.7, at);
        assert!((moved.height() - view.height() / 1.7).abs() < 1e-12);
        let now = seen(&moved, point);
        assert!((now[0] - at[0]).abs() < 1e-9 && (now[1] - at[1]).abs() < 1e-9, "{now:?}");
    }
}

#[test]
fn zooming_in_for_ever_stops_before_eye_and_target_meet() {
    let end = (0..2000).fold(view(), |view, _| view.zoomed(1.5, [0.4, 0.1]));
    assert!(end.camera([10, 10]).frame().is_ok());
    assert_eq!(end.zoomed(f64::NAN, [0.0; 2]), end);
}

#[test]
fn a_rolled_picture_turns() {
    let view = view();
    let moved = view.rolled(std::f64::consts::FRAC_PI_2);
    let right = view.axes().unwrap().right;
    let [x, y] = seen(&moved, view.target + right);
    assert!(x.abs() < 1e-9 && y.abs() > 0.1, "{x} {y}");
    assert!(near(moved.eye, view.eye));
}

#[test]
fn home_shows_every_corner_and_not_from_too_far() {
    let bounds = [DVec3::new(-1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 9.0)];
    for view in [view(), parallel()] {
        for size in [[50, 100], [400, 300]] {
            let (home, aspect) = (view.home(bounds, size), f64::from(size[0]) / f64::from(size[1]));
            let corner = |i: usize| {
                let pick = |axis: usize| bounds[(i >> axis) & 1][axis];
                seen(&home, DVec3::new(pick(0), pick(1), pick(2)))
            };
            let corners: Vec<[f64; 2]> = (0..8).map(corner).collect();
            assert!(corners.iter().all(|[x, y]| x.abs() <= 0.5 * aspect && y.abs() <= 0.5), "{corners:?}");
            let largest = corners.iter().map(|[x, y]| (x / aspect).abs().max(y.abs())).fold(0.0, f64::max);
            // Half of the picture without its margin.
            assert!((largest - 0.47).abs() < 1e-9, "{largest}");
        }
    }
}

#[test]
fn an_axis_view_looks_along_it() {
    let view = view().looking_along(DVec3::X, DVec3::Z);
    assert!(near(view.axes().unwrap().forward, -DVec3::X));
    // From above, "up" along z would be no direction.
    let above = view.looking_along(DVec3::Z, DVec3::Z);
    assert_eq!(above, view);
    assert!(near(view.looking_along(DVec3::Z, DVec3::Y).axes().unwrap().forward, -DVec3::Z));
}

#[test]
fn a_node_that_states_a_view_states_it_again() {
    for view in [view(), parallel()] {
        let field = |(name, datum): (&str, ParameterValue)| voltet_graph::Field {
            name: name.into(),
            origin: Default::default(),
            setting: datum.into(),
        };
        let node = NodeEntry {
            name: "view".into(),
            origin: Default::default(),
            node_type: LocatedValue::from(ParameterValue::Text("camera".into())),
            settings: view.settings().into_iter().map(field).collect(),
            inputs: Vec::new(),
        };
        assert_eq!(View::from_camera(&node), Some(view));
    }
    assert_eq!(decimal(1.0 / 3.0, 1e-6), 0.333333);
    assert_eq!(decimal(1e-9, 1e-5), 0.0);
    assert_eq!(decimal(123_456_789.123_456, 1e-3), 123_456_789.123);
    assert_eq!(decimal(123_456_789.123, 100.0), 123_456_800.0);
}

proptest! {
    /// Whatever a hand does, there is a picture.
    #[test]
    fn no_movement_leads_to_a_view_without_a_picture(
        steps in proptest::collection::vec((0..5usize, -4.0..4.0f64, -4.0..4.0f64), 1..60),
        is_parallel in any::<bool>(),
    ) {
        let mut at = if is_parallel { parallel() } else { view() };
        for (what, a, b) in steps {
            at = match what {
                0 => at.orbited([a, b]),
                1 => at.panned([a, b]),
                2 => at.zoomed(a.exp(), [b, a]),
                3 => at.rolled(a),
                _ => at.home([DVec3::splat(a.min(b)), DVec3::splat(a.max(b) + 0.1)], [3, 2]),
            };
            prop_assert!(at.camera([64, 48]).frame().is_ok());
        }
    }
}

/// Points and their places are told from each other, by an independent projection.
#[test]
fn places_and_points_are_inverse() {
    let point = DVec3::new(2.0, 1.0, 2.5);
    for view in [view(), parallel()] {
        let place = view.place(point).unwrap();
        assert!((0..2).all(|k| (place[k] - seen(&view, point)[k]).abs() < 1e-12), "{place:?}");
        assert!(near(view.beside(point, place).unwrap(), point));
        let beside = view.beside(point, [0.1, -0.2]).unwrap();
        assert!((0..2).all(|k| (seen(&view, beside)[k] - [0.1, -0.2][k]).abs() < 1e-12));
        assert!(((beside - point).dot(view.axes().unwrap().forward)).abs() < 1e-9, "as deep");
        // A point of a line is found again by its place, and the nearest one by a place beside the line.
        let (direction, by) = (DVec3::new(0.6, 0.0, 0.8), 0.7);
        let on = view.on_line(point, direction, seen(&view, point + by * direction), 9.0).unwrap();
        assert!(near(on, point + by * direction), "{on}");
        let [eye, sight] = ray(&view, place).unwrap();
        let end_on = view.on_line(point, sight, [place[0], place[1] + 0.1], 9.0).unwrap();
        // A tenth of the height that the picture has at the point.
        let step = view.beside(point, [place[0], place[1] + 0.1]).unwrap().distance(point);
        assert!(near(end_on, point + step * sight), "{eye} {end_on}");
        // A ball: the side on which the other point lies, and its rim for a place beside it.
        let tip = point + 0.5 * direction;
        assert!(near(view.on_ball(point, tip, seen(&view, tip)).unwrap(), tip));
        let rim = view.on_ball(point, tip, [place[0] + 0.4, place[1]]).unwrap();
        assert!((rim.distance(point) - 0.5).abs() < 1e-9 && seen(&view, rim)[0] > place[0], "{rim}");
    }
    assert_eq!(view().place(DVec3::new(0.0, -20.0, 6.0)), None, "behind the eye");
}

/// Whatever the angle between a line and the eye, the point goes one way as the hand does, and stays before the eye and within reach.
#[test]
fn a_point_on_a_line_follows_the_hand_steadily() {
    for view in [view(), parallel()] {
        let axes = view.axes().unwrap();
        let point = view.target;
        for degrees in [0.0, 2.0, 7.9, 8.2, 12.0, 45.0, 90.0, 135.0, 170.0, 172.5, 180.0f64] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let direction = cos * axes.forward + sin * axes.up;
            let along = |up: f64| {
                let to = view.on_line(point, direction, [0.0, up], 30.0).unwrap();
                assert!(view.place(to).is_some(), "{degrees} {up}: behind the eye");
                (to - point).dot(direction)
            };
            assert!(along(0.0).abs() < 1e-9);
            let ups = (-10..=10).map(|step| 0.05 * f64::from(step));
            let found: Vec<f64> = ups.map(along).collect();
            assert!(found.iter().all(|along| along.abs() <= 30.0 + 1e-9), "{degrees}: {found:?}");
            assert!(found.is_sorted() && found[9] < 0.0 && found[11] > 0.0, "{degrees}: {found:?}");
        }
    }
}
