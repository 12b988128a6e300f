use super::super::images::Images;
use super::super::plane::{Change, Handle, Plane, S_AND_G, list, rows};
use super::super::relative::PlaneAxes;
use super::*;
use crate::worker::DataScales;
use voltet_core::probing::Axis;
use voltet_core::transfer::AxisScale;
use voltet_graph::ParameterValue;

fn field(name: &str, datum: ParameterValue) -> Field {
    Field { name: name.into(), origin: Default::default(), setting: datum.into() }
}

fn gaussian_widget() -> Vec<Field> {
    vec![
        field("kind", ParameterValue::Text("gaussian".into())),
        field("color", list(&[1.0, 0.5, 0.25])),
        field("extinction", ParameterValue::Number(7.0)),
        field("centre", list(&[10.0, 2.0])),
        field("sigma", list(&[0.5, 0.25])),
    ]
}

/// The table with changes carried out, for keys without points.
fn changed(mut fields: Vec<Field>, changes: Vec<Change>) -> Vec<Field> {
    for (key, value) in changes {
        fields.retain(|field| field.name != key);
        fields.extend(value.map(|value| field(key, value)));
    }
    fields
}

const EXTENT: [f64; 2] = [100.0, 10.0];
const PLANE: Plane =
    Plane { rect: Rect::ZERO, extent: EXTENT, shown: [[0.0, 100.0], [0.0, 10.0]], peak: 50.0 };

fn read(fields: &[Field]) -> ScreenWidget {
    read_with(fields, None)
}

fn read_with(fields: &[Field], known: Option<&DataScales>) -> ScreenWidget {
    read_on(fields, known, Default::default())
}

fn read_on(fields: &[Field], known: Option<&DataScales>, scales: [AxisScale; 2]) -> ScreenWidget {
    let images = Images::default();
    let on = PlaneContext { axes: &S_AND_G, scales, extent: EXTENT, known, images: &images };
    ScreenWidget::new(fields, &on)
}

fn linear(step: &dyn Fn(&ArrayRef) -> f64) -> PlaneAxes<'_> {
    PlaneAxes { scales: Default::default(), step }
}

/// Positions of its handles.
fn places(drawn: &ScreenWidget) -> Vec<[f64; 2]> {
    drawn.handles(&PLANE).into_iter().map(|(_, at)| at).collect()
}

fn assert_near(found: &[[f64; 2]], wanted: &[[f64; 2]]) {
    assert_eq!(found.len(), wanted.len());
    for (a, b) in found.iter().zip(wanted) {
        assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-5 * EXTENT[k]), "{found:?}, not {wanted:?}");
    }
}

/// Fields common to all widgets.
fn look() -> [Field; 2] {
    [field("color", list(&[1.0, 0.5, 0.25])), field("extinction", ParameterValue::Number(7.0))]
}

#[test]
fn a_handle_goes_where_the_hand_brings_it() {
    let fields = gaussian_widget();
    let drawn = read(&fields);
    let moves =
        [(Handle::Centre, [12.0, 3.0]), (Handle::Width(0), [13.0, 2.0]), (Handle::Width(1), [10.0, 4.5])];
    for (handle, to) in moves {
        let after = read(&changed(fields.clone(), drawn.moved(handle, to, &PLANE)));
        let (_, at) = after.handles(&PLANE).into_iter().find(|(other, _)| *other == handle).unwrap();
        assert!((at[0] - to[0]).abs() < 1e-6 && (at[1] - to[1]).abs() < 1e-6, "{handle:?}: {at:?}");
    }
}

/// Turned and turned back, the widget is as before, and written with sigma.
#[test]
fn a_turned_gaussian_is_a_matrix_and_an_upright_one_is_not() {
    let fields = gaussian_widget();
    let drawn = read(&fields);
    // 30° in the plane where both axes are as long.
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let to = [10.0 + 5.0 * cos * EXTENT[0], 2.0 + 5.0 * sin * EXTENT[1]];
    let turned = changed(fields.clone(), drawn.moved(Handle::Angle, to, &PLANE));
    assert!(
        turned.iter().any(|field| field.name == "matrix")
            && !turned.iter().any(|field| field.name == "sigma")
    );
    let again = read(&turned);
    // At one half axis along 30° the strength is that of one deviation.
    let length = 0.5 / EXTENT[0];
    let on_axis = [10.0 + length * cos * EXTENT[0], 2.0 + length * sin * EXTENT[1]];
    assert!((again.strength(on_axis) - (-0.5f64).exp()).abs() < 1e-4, "{}", again.strength(on_axis));
    let upright = changed(turned, drawn.moved(Handle::Angle, [60.0, 2.01], &PLANE));
    assert!(upright.iter().any(|field| field.name == "sigma") && upright.len() == 5);
    assert_near(&places(&read(&upright)), &places(&drawn));
}

#[test]
fn a_matrix_and_its_half_axes_say_the_same() {
    let k = [[1.3, -0.4], [0.2, 0.9]];
    let [color, extinction] = look();
    let fields = [
        field("kind", ParameterValue::Text("gaussian".into())),
        field("centre", list(&[0.0, 0.0])),
        field("matrix", rows(&k)),
        color,
        extinction,
    ];
    let drawn = read(&fields);
    // At the ends of its half axes it is at one standard deviation.
    let ends = drawn.handles(&PLANE).into_iter().filter(|(handle, _)| matches!(handle, Handle::Width(_)));
    for (_, at) in ends {
        assert!((drawn.strength(at) - (-0.5f64).exp()).abs() < 1e-12, "{at:?}");
    }
    for v in [[0.3, 0.1], [-0.7, 0.4], [0.0, 1.0]] {
        let kv = [k[0][0] * v[0] + k[0][1] * v[1], k[1][0] * v[0] + k[1][1] * v[1]];
        let exact = (-(kv[0] * kv[0] + kv[1] * kv[1])).exp();
        assert!((drawn.strength(v) - exact).abs() < 1e-12, "{v:?}: {} for {exact}", drawn.strength(v));
    }
}

#[test]
fn an_infinite_deviation_has_no_handle_and_stays() {
    let mut fields = gaussian_widget();
    fields[4] = field("sigma", list(&[0.5, f64::INFINITY]));
    let drawn = read(&fields);
    let handles: Vec<Handle> = drawn.handles(&PLANE).into_iter().map(|(handle, _)| handle).collect();
    assert_eq!(handles, [Handle::Centre, Handle::Width(0)]);
    let after = changed(fields, drawn.moved(Handle::Width(0), [11.5, 2.0], &PLANE));
    let sigma = after.iter().find(|field| field.name == "sigma").unwrap().setting.numbers().unwrap();
    assert_eq!(sigma, [1.5, f64::INFINITY]);
}

#[test]
fn points_of_a_curve_keep_their_order_and_reach_zero() {
    let points = [[0.0, 1.0, 0.0, 0.0, 0.0], [5.0, 1.0, 1.0, 0.0, 8.0], [9.0, 1.0, 1.0, 1.0, 2.0]];
    let fields =
        vec![field("kind", ParameterValue::Text("piecewise-linear".into())), field("points", rows(&points))];
    let drawn = read(&fields);
    let (_, at) = drawn.handles(&Plane { peak: 8.0, ..PLANE })[1];
    assert_eq!(at, [5.0, 10.0]);
    let after =
        read(&changed(fields, drawn.moved(Handle::Point(1), [20.0, 0.02], &Plane { peak: 8.0, ..PLANE })));
    let [s, height] = places(&after)[1];
    assert!(s < 9.0 && s > 8.9);
    assert_eq!(height, 0.0);
}

/// Six digits of a place far from 0 are none of the range that it lies in.
#[test]
fn what_is_not_moved_is_written_as_it_was_and_what_is_as_finely_as_a_point_shows() {
    let rect = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 200.0));
    let plane = Plane { rect, shown: [[101_325.0, 101_325.02], [0.0, 10.0]], ..PLANE };
    let points = [[101_325.001_234_567_89, 0.123_456_789, 0.0, 0.0, 2.0], [101_325.01, 1.0, 1.0, 0.0, 8.0]];
    let fields =
        vec![field("kind", ParameterValue::Text("piecewise-linear".into())), field("points", rows(&points))];
    let to = plane.moved_place([101_325.01, 1.0], [0.003_000_1, 0.0]);
    assert_eq!(to, [101_325.013, 1.0]);
    let changes = read(&fields).moved(Handle::Point(1), to, &plane);
    let written = relative::as_written(
        &fields,
        None,
        &linear(&|_| f64::INFINITY),
        "points",
        changes[0].1.clone().unwrap(),
    );
    let found = LocatedValue::from(written).list().unwrap().to_vec();
    assert_eq!(found[0].numbers().unwrap(), points[0]);
    assert_eq!(found[1].numbers().unwrap()[0], 101_325.013);
    // A place that is moved to its own six digits was moved.
    let fields = changed(gaussian_widget(), vec![("centre", Some(list(&[101_325.012_3, 2.0])))]);
    let to = list(&[101_325.0, 2.0]);
    assert_eq!(relative::as_written(&fields, None, &linear(&|_| f64::INFINITY), "centre", to.clone()), to);
}

#[test]
fn regions_follow_their_corners_and_the_widget() {
    let region = ParameterValue::Table(vec![field("s", list(&[1.0, 3.0])), field("g", list(&[0.0, 2.0]))]);
    let mut fields = vec![field("kind", ParameterValue::Text("uniform".into())), field("region", region)];
    fields.extend(look());
    let drawn = read(&fields);
    assert_eq!(drawn.strength([2.0, 1.0]), 1.0);
    assert_eq!(drawn.strength([3.5, 1.0]), 0.0);
    // Past the other corner, the ends change places.
    let changes = drawn.moved(Handle::Corner(2), [0.5, 1.0], &PLANE);
    assert_eq!(changes[0], ("region.s", Some(list(&[0.5, 1.0]))));
    assert_eq!(drawn.shifted([1.0, 0.5], &PLANE)[1], ("region.g", Some(list(&[0.5, 2.5]))));
}

#[test]
fn sides_move_alone_and_a_polygon_stays_convex() {
    let region = ParameterValue::Table(vec![field("s", list(&[1.0, 3.0]))]);
    let mut fields = vec![field("kind", ParameterValue::Text("uniform".into())), field("region", region)];
    fields.extend(look());
    let drawn = read(&fields);
    let handles: Vec<Handle> = drawn.handles(&PLANE).into_iter().map(|(handle, _)| handle).collect();
    assert_eq!(handles, [Handle::Side(0, false), Handle::Side(0, true)], "there is no limit of g");
    assert_eq!(
        drawn.moved(Handle::Side(0, true), [7.0, 4.0], &PLANE),
        [("region.s", Some(list(&[1.0, 7.0])))]
    );
    let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0]];
    let region = ParameterValue::Table(vec![field("polygon", rows(&corners))]);
    let mut fields = vec![field("kind", ParameterValue::Text("uniform".into())), field("region", region)];
    fields.extend(look());
    let drawn = read(&fields);
    assert!(drawn.moved(Handle::Corner(2), [1.0, 1.0], &PLANE).is_empty(), "it would be dented");
    // A point near the right side goes there, one outside stays where it is.
    let (changes, handle) = drawn.with_point([9.0, 2.0], &PLANE).unwrap();
    assert_eq!(handle, Handle::Corner(2));
    let Some(ParameterValue::List(polygon)) = changes[0].1.clone() else { panic!("no polygon") };
    assert_eq!(polygon[2].numbers().unwrap(), [10.0, 2.0]);
    let (changes, _) = drawn.with_point([11.0, 2.0], &PLANE).unwrap();
    let Some(ParameterValue::List(polygon)) = changes[0].1.clone() else { panic!("no polygon") };
    assert_eq!(polygon[2].numbers().unwrap(), [11.0, 2.0]);
    assert!(drawn.without_point(Handle::Corner(0)).is_some_and(|changes| changes.len() == 1));
}

#[test]
fn bands_are_as_wide_as_the_profile_says() {
    for kind in ["triangle-wave", "sine-wave"] {
        let mut fields = vec![
            field("kind", ParameterValue::Text(kind.into())),
            field("origin", list(&[10.0, 0.0])),
            field("period", ParameterValue::Number(20.0)),
        ];
        fields.extend(look());
        let drawn = read(&fields);
        assert!((drawn.strength([20.0, 3.0]) - 1.0).abs() < 1e-12, "{kind}: the peak of the first band");
        let changes = drawn.moved(Handle::Band, [24.0, 1.0], &PLANE);
        fields.push(field("band_width", changes[0].1.clone().unwrap()));
        let narrow = read(&fields);
        // It ends where the hand is.
        let place = narrow.handles(&PLANE).into_iter().find(|(handle, _)| *handle == Handle::Band).unwrap().1;
        assert!((place[0] - 24.0).abs() < 1e-3, "{kind}: {place:?}");
        assert!(narrow.strength([24.1, 0.0]) == 0.0 && narrow.strength([23.0, 0.0]) > 0.0, "{kind}");
    }
}

/// The axis is 0 to 100, half of the volume below 20.
fn known() -> DataScales {
    let spread =
        crate::worker::Spread { values: vec![0.0, 20.0, 100.0], below: vec![0.0, 0.5, 1.0], total: 1.0 };
    let [s, g] = S_AND_G;
    DataScales {
        ranges: [(s.clone(), [0.0, 100.0]), (g, [0.0, 10.0])].into(),
        spreads: [(s, spread)].into(),
        ..DataScales::default()
    }
}

#[test]
fn relative_numbers_stay_relative_and_others_as_they_are_written() {
    let text = |text: &str| LocatedValue::from(ParameterValue::Text(text.into()));
    let mut fields = gaussian_widget();
    fields[3] = field("centre", ParameterValue::List(vec![text("p50"), text("25 %")]));
    fields[4] =
        field("sigma", ParameterValue::List(vec![text("10 %"), ParameterValue::Number(0.123456789).into()]));
    let known = known();
    let drawn = read_with(&fields, Some(&known));
    assert_eq!(places(&drawn)[..3], [[20.0, 2.5], [30.0, 2.5], [20.0, 2.5 + 0.123456789]]);
    let written = |changes: Vec<Change>, key: &str| {
        let change = changes.into_iter().find(|(name, _)| *name == key).unwrap();
        let datum =
            relative::as_written(&fields, Some(&known), &linear(&|_| f64::INFINITY), key, change.1.unwrap());
        datum.to_string()
    };
    assert_eq!(written(drawn.moved(Handle::Centre, [60.0, 5.0], &PLANE), "centre"), "[\"p75.0\", \"50 %\"]");
    assert_eq!(written(drawn.moved(Handle::Centre, [60.0, 2.5], &PLANE), "centre"), "[\"p75.0\", \"25 %\"]");
    let wider = drawn.moved(Handle::Width(0), [60.0, 2.5], &PLANE);
    assert_eq!(written(wider, "sigma"), "[\"40 %\", 0.123456789]");
    // Turned, it is a matrix whose first column stays relative, and the same widget.
    let turned = drawn.moved(Handle::Angle, [60.0, 7.0], &PLANE);
    let matrix = written(turned.clone(), "matrix");
    assert_eq!(matrix.matches('%').count(), 2, "{matrix}");
    let as_written = |key: &str, change: Option<ParameterValue>| {
        change.map(|new| relative::as_written(&fields, Some(&known), &linear(&|_| f64::INFINITY), key, new))
    };
    let changes = turned.iter().map(|(key, change)| (*key, as_written(key, change.clone()))).collect();
    let mut after = changed(fields.clone(), changes);
    let in_numbers = changed(fields.clone(), turned.clone());
    assert_near(&places(&read_with(&after, Some(&known))), &places(&read_with(&in_numbers, Some(&known))));
    // On data of twice the range it is twice as wide.
    let mut wider = known.clone();
    wider.ranges.insert(ArrayRef::Named("s"), [0.0, 200.0]);
    let strength = |of: &DataScales, s: f64| read_with(&after, Some(of)).strength([20.0 + s, 2.5]);
    assert!(strength(&known, 1.0) < 0.9 && strength(&known, 1.0) > 0.3, "{}", strength(&known, 1.0));
    assert!((strength(&known, 1.0) / strength(&wider, 2.0) - 1.0).abs() < 1e-9);
    // Upright again, the deviations are relative as they were.
    let drawn = read_with(&after, Some(&known));
    let ring = drawn.handles(&PLANE).into_iter().find(|(handle, _)| *handle == Handle::Angle).unwrap().1;
    let slope = |at: [f64; 2]| (at[1] - 2.5) / (at[0] - 20.0);
    assert!(
        (slope(ring) / slope([60.0, 7.0]) - 1.0).abs() < 1e-3 && ring[0] > 20.0,
        "the ring is where it was left"
    );
    let upright = drawn.moved(Handle::Angle, [60.0, 2.51], &PLANE);
    let sigma = relative::as_written(
        &after,
        Some(&known),
        &linear(&|_| f64::INFINITY),
        "sigma",
        upright[0].1.clone().unwrap(),
    );
    assert_eq!(sigma.to_string(), "[\"10 %\", 0.123457]");
    after.retain(|field| field.name != "matrix");
    assert_eq!(
        relative::as_written(&after, Some(&known), &linear(&|_| f64::INFINITY), "sigma", list(&[1.0, 2.0])),
        list(&[1.0, 2.0])
    );
    // Where the pointer resolves a ten-millionth of the range, so do the numbers.
    let [s, g] = [20.0 + 3e-5, 2.5 - 3e-6];
    let fine = relative::as_written(&fields, Some(&known), &linear(&|_| 1e-6), "centre", list(&[s, g]));
    fields[3] = field("centre", fine.clone());
    let [at, ..] = places(&read_with(&fields, Some(&known)))[..] else { panic!("no handles") };
    assert!((at[0] - s).abs() <= 1e-6 && (at[1] - g).abs() <= 1e-6, "{at:?}: {fine}");
    // Where nothing is known of the data, it is not drawn, and says why.
    let unknown = read(&fields);
    assert!(unknown.shape.is_none() && unknown.fault.is_some());
}

/// A picture of 2 × 1 texels over [2, 6] × [1, 5]: read by a thread of its own.
#[test]
fn a_table_is_drawn_as_its_picture_and_moved_and_scaled_by_its_ranges() {
    let folder = tempfile::tempdir().unwrap();
    let png = include_bytes!("two_texels.png");
    std::fs::write(folder.path().join("look.png"), png).unwrap();
    let images = Images::default().in_folder(&Default::default(), folder.path().to_path_buf());
    let mut fields = vec![
        field("kind", ParameterValue::Text("table".into())),
        field("extinction", ParameterValue::Number(7.0)),
        field("image", ParameterValue::Text("look.png".into())),
        field("s", list(&[2.0, 6.0])),
        field("g", list(&[1.0, 5.0])),
    ];
    let read = |fields: &[Field]| {
        ScreenWidget::new(
            fields,
            &PlaneContext {
                axes: &S_AND_G,
                scales: Default::default(),
                extent: EXTENT,
                known: None,
                images: &images,
            },
        )
    };
    let begun = std::time::Instant::now();
    while !matches!(images.get("look.png"), Some(Ok(_))) {
        assert!(begun.elapsed().as_secs() < 60, "{:?}", images.get("look.png").map(|found| found.err()));
        read(&fields);
        std::thread::yield_now();
    }
    let drawn = read(&fields);
    assert!(drawn.fault.is_none() && format!("{:?}", drawn.shape).contains("Some("), "{:?}", drawn.shape);
    // Red at the left, clear green at the right.
    assert_eq!(drawn.color, [1.0, 0.0, 0.0]);
    assert_eq!([drawn.strength([2.5, 2.0]), drawn.strength([5.5, 2.0])], [1.0, 0.0]);
    assert_eq!(drawn.strength([4.0, 3.0]), 0.5, "between the texels");
    assert_eq!(
        drawn.moved(Handle::Rim(2), [8.0, 7.0], &PLANE),
        [("s", Some(list(&[2.0, 8.0]))), ("g", Some(list(&[1.0, 7.0])))]
    );
    assert_eq!(drawn.moved(Handle::Edge(0, true), [9.0, 77.0], &PLANE), [("s", Some(list(&[2.0, 9.0])))]);
    assert_eq!(drawn.moved(Handle::Centre, [5.0, 3.0], &PLANE), [("s", Some(list(&[3.0, 7.0])))]);
    assert_eq!(drawn.moved(Handle::Edge(0, true), [2.0, 3.0], &PLANE), [], "a range would be empty");
    // Without its picture it can still be moved, and says what is wrong.
    fields[2] = field("image", ParameterValue::Text("none.png".into()));
    while !matches!(images.get("none.png"), Some(Err(_))) {
        assert!(begun.elapsed().as_secs() < 60);
        std::thread::yield_now();
    }
    let drawn = read(&fields);
    assert!(drawn.fault.as_ref().is_some_and(|fault| fault.contains("none.png")), "{:?}", drawn.fault);
    assert_eq!(drawn.shifted([1.0, 0.0], &PLANE), [("s", Some(list(&[3.0, 7.0])))]);
}

/// Places are decades, and what is written are values; widths are decades in the file too.
#[test]
fn along_a_logarithmic_axis_a_hand_moves_decades_and_the_file_has_values() {
    let text = |text: &str| LocatedValue::from(ParameterValue::Text(text.into()));
    let scales = [AxisScale::Log, AxisScale::Linear];
    let mut known = known();
    known.axes = scales;
    known.ranges.insert(ArrayRef::Named("s"), [1.0, 1e6]);
    let axes = PlaneAxes { scales, step: &|_| 1e-3 };
    let mut fields = gaussian_widget();
    fields[3] = field("centre", list(&[100.0, 2.0]));
    fields.push(field("region", ParameterValue::Table(vec![field("s", list(&[10.0, 1e4]))])));
    let written = |fields: &[Field], (key, new): Change| {
        relative::as_written(fields, Some(&known), &axes, key, new.unwrap()).to_string()
    };
    let one = |changes: Vec<Change>| changes.into_iter().next().unwrap();
    let drawn = read_on(&fields, Some(&known), scales);
    assert_eq!(places(&drawn)[..2], [[2.0, 2.0], [2.5, 2.0]]);
    assert_eq!(drawn.region, Region::Box([[1.0, 4.0], [f64::NEG_INFINITY, f64::INFINITY]]));
    assert!(drawn.strength([2.1, 2.0]) > 0.9 && drawn.strength([4.1, 2.0]) == 0.0);
    assert_eq!(written(&fields, one(drawn.moved(Handle::Centre, [3.0, 2.0], &PLANE))), "[1000.0, 2.0]");
    assert_eq!(written(&fields, one(drawn.moved(Handle::Centre, [2.5, 2.0], &PLANE))), "[316.2, 2.0]");
    assert_eq!(written(&fields, one(drawn.moved(Handle::Width(0), [4.0, 2.0], &PLANE))), "[2.0, 0.25]");
    let wider = one(drawn.moved(Handle::Side(0, true), [5.0, 0.0], &PLANE));
    assert_eq!((wider.0, written(&fields, wider)), ("region.s", "[10.0, 100000.0]".to_string()));
    // Shares are shares of the decades.
    fields[3] = field("centre", ParameterValue::List(vec![text("50 %"), ParameterValue::Number(2.0).into()]));
    let drawn = read_on(&fields, Some(&known), scales);
    assert!((places(&drawn)[0][0] - 3.0).abs() < 1e-12);
    assert_eq!(written(&fields, one(drawn.moved(Handle::Centre, [4.5, 2.0], &PLANE))), "[\"75 %\", 2.0]");
    // What has no place is said.
    fields[3] = field("centre", list(&[-1.0, 2.0]));
    let fault = read_on(&fields, Some(&known), scales).fault.unwrap();
    assert!(fault.contains("logarithmic axis"), "{fault}");
}

#[test]
fn crowded_handles_are_told_apart_and_points_lie_where_they_are() {
    let plane = Plane { rect: Rect::from_min_size(Pos2::ZERO, vec2(400.0, 200.0)), ..PLANE };
    let points = [[50.0, 0.5, 0.5, 0.5, 0.1], [50.1, 0.5, 0.5, 0.5, 0.2], [50.2, 0.5, 0.5, 0.5, 0.3]];
    let curve =
        vec![field("kind", ParameterValue::Text("piecewise-linear".into())), field("points", rows(&points))];
    for Grip { handle, at, place } in read(&curve).grips(&plane) {
        assert_eq!(place, plane.to_window(at), "{handle:?}");
    }
    let grips = read(&gaussian_widget()).grips(&plane);
    assert!(grips.len() >= 3);
    for (i, grip) in grips.iter().enumerate() {
        assert!(grips[..i].iter().all(|other| other.place.distance(grip.place) >= APART - 0.01));
    }
}

/// Every grip changes its widget, and to one that is sound.
#[test]
fn each_grip_acts() {
    let plane = Plane { rect: Rect::from_min_size(Pos2::ZERO, vec2(400.0, 200.0)), ..PLANE };
    let of_kind = |kind: &str, own: Vec<Field>| -> Vec<Field> {
        let color = (kind != "gaussian-colormap").then(|| field("color", list(&[1.0, 0.5, 0.25])));
        let first = [field("kind", kind.into()), field("extinction", 7.0.into())];
        first.into_iter().chain(color).chain(own).collect()
    };
    let centre = || field("centre", list(&[40.0, 4.0]));
    let sigma = || field("sigma", list(&[5.0, 1.0]));
    let wave = || vec![field("origin", list(&[40.0, 4.0])), field("period", 10.0.into())];
    for (fields, count) in [
        (of_kind("gaussian", vec![centre(), sigma()]), 4),
        // It has no matrix, and cannot be turned.
        (of_kind("gaussian-colormap", vec![centre(), sigma(), field("range", list(&[0.0, 100.0]))]), 3),
        (of_kind("triangular-gaussian", vec![field("centre", 40.0.into()), field("sigma", 2.0.into())]), 2),
        (of_kind("triangle-wave", wave()), 3),
        (of_kind("sine-wave", wave()), 3),
    ] {
        let drawn = read(&fields);
        let grips = drawn.grips(&plane);
        assert_eq!((&drawn.fault, grips.len()), (&None, count), "{}", drawn.kind);
        for Grip { handle, at, .. } in grips {
            let changes = drawn.moved(handle, [at[0] + 3.0, at[1] + 0.5], &plane);
            let after = changed(fields.clone(), changes);
            let found = read(&after);
            assert!(found.fault.is_none(), "{} {handle:?}: {:?}", drawn.kind, found.fault);
            assert_ne!(after, fields, "{} {handle:?}", drawn.kind);
        }
    }
}

#[test]
fn the_held_share_is_of_the_widget_the_data_and_the_axes_at_hand() {
    let data = |volumes: &[f64; 4]| {
        let axis = |high| Axis { low: 0.0, high, bins: 2 };
        let (axes, volumes) = ([axis(40.0), axis(8.0)], volumes.to_vec());
        let histogram = Histogram { axes, volumes, total: 4.0, outside: 0.0, not_finite: 0.0 };
        Arc::new(Distribution { histogram, known: DataScales::default(), scalar: "T".into() })
    };
    let (first, second) = (data(&[1.0, 1.0, 1.0, 1.0]), data(&[3.0, 1.0, 0.0, 0.0]));
    let mut fields = gaussian_widget();
    let (here, axes) = (read(&fields), (S_AND_G, Default::default()));
    fields[3] = field("centre", list(&[30.0, 2.0]));
    let there = read(&fields);
    let mut held = HeldVolume::default();
    // Of the middles of bins, 10 and 30 by 2 and 6, each lies on one.
    for (widget, data, share) in
        [(&here, &first, 0.25), (&here, &second, 0.75), (&there, &second, 0.25), (&here, &second, 0.75)]
    {
        assert_eq!(held.share(widget, data, &axes), Some(share));
    }
    // Drawn on other axes, of which one is none of its own; and on these again.
    let (other, images) = ([S_AND_G[0].clone(), ArrayRef::Array("p".into())], Images::default());
    let on = PlaneContext { axes: &other, scales: axes.1, extent: EXTENT, known: None, images: &images };
    let elsewhere = ScreenWidget::new(&gaussian_widget(), &on);
    assert_eq!(held.share(&elsewhere, &second, &(other.clone(), axes.1)), None);
    assert_eq!(held.share(&here, &second, &axes), Some(0.75));
    // Along a logarithm of s, where its bin lies elsewhere.
    let scales = [AxisScale::Log, AxisScale::Linear];
    let bent = read_on(&gaussian_widget(), None, scales);
    assert_eq!(held.share(&bent, &second, &(S_AND_G, scales)), Some(0.0));
}
