//! Properties of whole transfer functions.

use super::*;

fn widget(profile: Profile, color: [f64; 3], extinction: f64) -> Widget {
    Widget { profile, color, extinction, region: None }
}

fn of(widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction {
        model: OpticalModel::DensityEmitter,
        unit_distance: 1.0,
        widgets,
        axes: Default::default(),
    }
}

fn gaussian(color: [f64; 3], extinction: f64) -> Widget {
    widget(Profile::Gaussian { centre: [3.0, 1.0], matrix: [[1.0, 0.0], [0.0, 2.0]] }, color, extinction)
}

const RED: [f64; 3] = [1.0, 0.0, 0.0];
const GREEN: [f64; 3] = [0.0, 1.0, 0.0];

#[test]
fn what_draws_nothing_has_no_say_in_the_one_colour() {
    let point = |s: f64, color, extinction| ControlPoint { s, color, extinction };
    let points = |rows| widget(Profile::PiecewiseLinear { points: rows }, [0.0; 3], 0.0);
    let thin = points(vec![point(0.0, GREEN, 0.0), point(1.0, RED, 0.0)]);
    assert_eq!(of(vec![]).uniform_color(), Some([0.0; 3]));
    assert_eq!(of(vec![gaussian(GREEN, 0.0), thin, gaussian(RED, 1.0)]).uniform_color(), Some(RED));
    assert_eq!(of(vec![gaussian(GREEN, 1.0), gaussian(RED, 1.0)]).uniform_color(), None);
    // Its extinction is that of its points, whatever the widget's own says.
    let ramp = points(vec![point(0.0, RED, 0.0), point(1.0, RED, 2.0)]);
    assert_eq!(of(vec![ramp.clone(), gaussian(RED, 1.0)]).uniform_color(), Some(RED));
    assert_eq!(of(vec![ramp, gaussian(GREEN, 1.0)]).uniform_color(), None);
    let model = OpticalModel::ConstantEmitter { cutoff: 0.1 };
    assert_eq!(TransferFunction { model, ..of(vec![gaussian(RED, 1.0)]) }.uniform_color(), None);
}

#[test]
fn axes_are_counted_from_a_single_centre_and_widths_from_zero() {
    let triangular = widget(Profile::TriangularGaussian { centre: 2.0, sigma: 0.5 }, RED, 1.0);
    let (alone, both) = (of(vec![gaussian(RED, 1.0)]), of(vec![gaussian(RED, 1.0), triangular.clone()]));
    assert_eq!([0, 1].map(|axis| alone.axis_origin(axis)), [Some(3.0), Some(1.0)]);
    assert_eq!([0, 1].map(|axis| both.axis_origin(axis)), [Some(2.5), Some(0.0)]);
    assert_eq!([0, 1].map(|axis| of(vec![triangular.clone()]).axis_origin(axis)), [Some(2.0), Some(0.0)]);
    // Corners of regions are places like centres, but a centre that is alone goes first.
    let region = Some(Region { corners: vec![[1.0, -4.0], [9.0, 0.0], [2.0, f64::INFINITY]] });
    let cut = Widget { region, ..gaussian(RED, 1.0) };
    let even = Widget { profile: Profile::Uniform, ..cut.clone() };
    let (cut, even, two) = (of(vec![cut]), of(vec![even.clone()]), of(vec![gaussian(RED, 1.0), even]));
    assert_eq!([0, 1].map(|axis| cut.axis_origin(axis)), [Some(3.0), Some(1.0)]);
    assert_eq!([0, 1, 2].map(|axis| even.axis_origin(axis)), [Some(5.0), Some(0.0), None]);
    assert_eq!([0, 1].map(|axis| two.axis_origin(axis)), [Some(5.0), Some(-1.5)]);
    // Of places of very different sizes the smaller keeps its digits.
    let region = Some(Region::rectangle([1e-3, 1e4], [5.0, 1e3]));
    let far = of(vec![Widget { profile: Profile::Uniform, region, ..gaussian(RED, 1.0) }]);
    assert_eq!([0, 1].map(|axis| far.axis_origin(axis)), [Some(0.0), Some(502.5)]);
    // Fields are counted in the order of their names, a widget's own in the order that it names them.
    let fields = ["q", "p"].map(String::from).to_vec();
    let matrix = vec![vec![1.0, 0.0], vec![0.0, 1.0]];
    let nd = of(vec![widget(Profile::GaussianNd { fields, centre: vec![7.0, 8.0], matrix }, RED, 1.0)]);
    assert_eq!([0, 1, 2, 3].map(|axis| nd.axis_origin(axis)), [None, None, Some(8.0), Some(7.0)]);
}
