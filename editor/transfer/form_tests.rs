use super::super::moved::{Change, Handle, list, rows};
use super::*;
use voltet_core::graph::Datum;

fn field(name: &str, datum: Datum) -> Field {
    Field { name: name.into(), origin: Default::default(), setting: datum.into() }
}

fn gaussian_widget() -> Vec<Field> {
    vec![
        field("kind", Datum::Text("gaussian".into())),
        field("color", list(&[1.0, 0.5, 0.25])),
        field("extinction", Datum::Number(7.0)),
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
const BOUNDS: [f64; 2] = [10.0, 50.0];

#[test]
fn a_handle_goes_where_the_hand_brings_it() {
    let fields = gaussian_widget();
    let drawn = Drawn::read(&fields, None, EXTENT);
    let moves =
        [(Handle::Centre, [12.0, 3.0]), (Handle::Width(0), [13.0, 2.0]), (Handle::Width(1), [10.0, 4.5])];
    for (handle, to) in moves {
        let after =
            Drawn::read(&changed(fields.clone(), drawn.moved(handle, to, EXTENT, BOUNDS)), None, EXTENT);
        let (_, at) = after.handles(10.0, 50.0).into_iter().find(|(other, _)| *other == handle).unwrap();
        assert!((at[0] - to[0]).abs() < 1e-6 && (at[1] - to[1]).abs() < 1e-6, "{handle:?}: {at:?}");
    }
}

/// Turned and turned back, the widget is as before, and written with sigma.
#[test]
fn a_turned_gaussian_is_a_matrix_and_an_upright_one_is_not() {
    let fields = gaussian_widget();
    let drawn = Drawn::read(&fields, None, EXTENT);
    // 30° in the plane where both axes are as long.
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let to = [10.0 + 5.0 * cos * EXTENT[0], 2.0 + 5.0 * sin * EXTENT[1]];
    let turned = changed(fields.clone(), drawn.moved(Handle::Angle, to, EXTENT, BOUNDS));
    assert!(
        turned.iter().any(|field| field.name == "matrix")
            && !turned.iter().any(|field| field.name == "sigma")
    );
    let again = Drawn::read(&turned, None, EXTENT);
    // At one half axis along 30° the strength is that of one deviation.
    let length = 0.5 / EXTENT[0];
    let on_axis = [10.0 + length * cos * EXTENT[0], 2.0 + length * sin * EXTENT[1]];
    assert!((again.strength(on_axis) - (-0.5f64).exp()).abs() < 1e-4, "{}", again.strength(on_axis));
    let upright = changed(turned, drawn.moved(Handle::Angle, [60.0, 2.01], EXTENT, BOUNDS));
    assert_eq!(Drawn::read(&upright, None, EXTENT), drawn);
}

#[test]
fn a_matrix_and_its_half_axes_say_the_same() {
    let k = [[1.3, -0.4], [0.2, 0.9]];
    let fields = [
        field("kind", Datum::Text("gaussian".into())),
        field("centre", list(&[0.0, 0.0])),
        field("matrix", rows(&k)),
    ];
    let drawn = Drawn::read(&fields, None, EXTENT);
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
    let drawn = Drawn::read(&fields, None, EXTENT);
    let handles: Vec<Handle> = drawn.handles(10.0, 50.0).into_iter().map(|(handle, _)| handle).collect();
    assert_eq!(handles, [Handle::Centre, Handle::Width(0)]);
    let after = changed(fields, drawn.moved(Handle::Width(0), [11.5, 2.0], EXTENT, BOUNDS));
    let sigma = after.iter().find(|field| field.name == "sigma").unwrap().setting.numbers().unwrap();
    assert_eq!(sigma, [1.5, f64::INFINITY]);
}

#[test]
fn points_of_a_curve_keep_their_order_and_reach_zero() {
    let points = [[0.0, 1.0, 0.0, 0.0, 0.0], [5.0, 1.0, 1.0, 0.0, 8.0], [9.0, 1.0, 1.0, 1.0, 2.0]];
    let fields = vec![field("kind", Datum::Text("piecewise-linear".into())), field("points", rows(&points))];
    let drawn = Drawn::read(&fields, None, EXTENT);
    let (_, at) = drawn.handles(10.0, 8.0)[1];
    assert_eq!(at, [5.0, 10.0]);
    let after = Drawn::read(
        &changed(fields, drawn.moved(Handle::Point(1), [20.0, 0.02], EXTENT, [10.0, 8.0])),
        None,
        EXTENT,
    );
    let Form::Points(points) = after.form else { panic!("no curve") };
    assert!(points[1][0] < 9.0 && points[1][0] > 8.9);
    assert_eq!(points[1][4], 0.0);
}

#[test]
fn regions_follow_their_corners_and_the_widget() {
    let region = Datum::Table(vec![field("s", list(&[1.0, 3.0])), field("g", list(&[0.0, 2.0]))]);
    let fields = vec![field("kind", Datum::Text("uniform".into())), field("region", region)];
    let drawn = Drawn::read(&fields, None, EXTENT);
    assert_eq!(drawn.strength([2.0, 1.0]), 1.0);
    assert_eq!(drawn.strength([3.5, 1.0]), 0.0);
    // Past the other corner, the ends change places.
    let changes = drawn.moved(Handle::Corner(2), [0.5, 1.0], EXTENT, BOUNDS);
    assert_eq!(changes[0], ("region.s", Some(list(&[0.5, 1.0]))));
    assert_eq!(drawn.shifted([1.0, 0.5], EXTENT, BOUNDS)[1], ("region.g", Some(list(&[0.5, 2.5]))));
}
