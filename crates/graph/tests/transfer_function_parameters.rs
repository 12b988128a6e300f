//! Widgets as a pipeline file states them.

use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Parameters, SourceSpan};
use voltet_core::transfer::*;
use voltet_core::transfer::{ControlPoint, Profile, Wave};
use voltet_graph::pipeline::Pipeline;

const LIST: &[Parameter] = &[Parameter {
    name: "widgets",
    parameter_type: ParameterType::Kinds(WIDGET_KINDS),
    unit: "",
    default: DefaultValue::Required,
    help: "the widgets",
}];

/// The widget that the keys state, or the error's message.
fn stated(keys: &str) -> Result<Widget, String> {
    let text = format!("[pipeline]\nformat = 1\n[nodes.a]\ntype = \"t\"\n[[nodes.a.widgets]]\n{keys}\n");
    let pipeline = Pipeline::parse(&text).map_err(|e| e.to_string())?;
    let convert = || {
        let p = Parameters::check(LIST, &pipeline.nodes[0].settings, &SourceSpan::Nowhere, &[])?;
        let (kind, keys) = p.kinds("widgets")?.remove(0);
        read(kind, &keys, &UnreadFiles)
    };
    convert().map_err(|error| error.to_string())
}

const PEAK: &str = "color = [1, 0.5, 2]\nextinction = 3\n";

#[test]
fn every_kind_of_the_table_is_read() {
    let gaussian =
        stated(&format!("kind = \"gaussian\"\n{PEAK}centre = [1, 2]\nsigma = [0.5, inf]")).unwrap();
    assert_eq!((gaussian.color, gaussian.extinction), ([1.0, 0.5, 2.0], 3.0));
    let k = 1.0 / (std::f64::consts::SQRT_2 * 0.5);
    assert_eq!(gaussian.profile, Profile::Gaussian { centre: [1.0, 2.0], matrix: [[k, 0.0], [0.0, 0.0]] });
    assert!(!gaussian.uses_gradient_magnitude());
    let matrix =
        stated(&format!("kind = \"gaussian\"\n{PEAK}centre = [1, 2]\nmatrix = [[1, 2], [3, 4]]")).unwrap();
    assert_eq!(matrix.profile, Profile::Gaussian { centre: [1.0, 2.0], matrix: [[1.0, 2.0], [3.0, 4.0]] });

    let nd = "kind = \"gaussian-nd\"\nfields = [\"T\", \"p\"]\ncentre = [1, 2]\n";
    let nd = stated(&format!("{nd}{PEAK}matrix = [[1, 0], [0, 2]]")).unwrap();
    let Profile::GaussianNd { fields, centre, matrix } = nd.profile else { panic!() };
    assert_eq!(
        (fields.join(" "), centre, matrix),
        ("T p".into(), vec![1.0, 2.0], vec![vec![1.0, 0.0], vec![0.0, 2.0]])
    );

    let triangular_nd = "kind = \"triangular-gaussian-nd\"\nfields = [\"T\", \"p\"]\ncentre = [1, 2]\n";
    let triangular_nd = stated(&format!("{triangular_nd}{PEAK}sigma = [0.5, inf]")).unwrap();
    let expected = Profile::TriangularGaussianNd {
        fields: vec!["T".into(), "p".into()],
        magnitude: "multi-gradient".into(),
        centre: vec![1.0, 2.0],
        matrix: vec![vec![2.0, 0.0], vec![0.0, 0.0]],
    };
    assert_eq!(triangular_nd.profile, expected);
    assert_eq!(triangular_nd.profile.properties().fields, ["T", "p", "multi-gradient"]);

    let uniform = stated(&format!("kind = \"uniform\"\n{PEAK}region = {{ s = [1, 2] }}")).unwrap();
    let inf = f64::INFINITY;
    assert_eq!(uniform.region.unwrap(), Region::rectangle([1.0, 2.0], [-inf, inf]));

    let triangular =
        stated(&format!("kind = \"triangular-gaussian\"\n{PEAK}centre = 0.6\nsigma = 0.001")).unwrap();
    assert_eq!(triangular.profile, Profile::TriangularGaussian { centre: 0.6, sigma: 0.001 });

    let wave = "origin = [1, 2]\nangle = 90\nscale = [1, 0.15]\nperiod = 1.1\nband_width = 0.4";
    let expected = Wave {
        origin: [1.0, 2.0],
        angle: std::f64::consts::FRAC_PI_2,
        scale: [1.0, 0.15],
        period: 1.1,
        band_width: 0.4,
    };
    let triangle = stated(&format!("kind = \"triangle-wave\"\n{PEAK}{wave}")).unwrap();
    assert_eq!(triangle.profile, Profile::TriangleWave(expected));
    let sine = stated(&format!("kind = \"sine-wave\"\n{PEAK}{wave}")).unwrap();
    assert_eq!(sine.profile, Profile::SineWave(expected));

    let linear = stated("kind = \"piecewise-linear\"\npoints = [[0, 1, 0, 0, 2], [1, 0, 1, 0, 5]]").unwrap();
    assert_eq!(linear.extinction, 5.0);
    let Profile::PiecewiseLinear { points } = linear.profile else { panic!() };
    assert_eq!(points[1], ControlPoint { s: 1.0, color: [0.0, 1.0, 0.0], extinction: 5.0 });

    let table =
        stated("kind = \"table\"\nextinction = 2\nimage = \"a.png\"\ns = [0, 1]\ng = [0, 2]").unwrap();
    let Profile::Table(table) = table.profile else { panic!() };
    assert_eq!((table.width, table.height, table.g), (1, 1, [0.0, 2.0]));
}

#[test]
fn regions_are_rectangles_or_convex_polygons_in_either_direction() {
    let region =
        |text: &str| stated(&format!("kind = \"uniform\"\n{PEAK}region = {text}")).map(|w| w.region.unwrap());
    assert!(region("{ polygon = [[0, 0], [1e-3, 0], [0, 1e9]] }").is_ok());
    assert!(region("{ polygon = [[0, 0], [0, 1], [1, 0]] }").is_ok());
    assert!(region("{ polygon = [[0, 0], [1, 0], [2, 0], [2, 1]] }").is_ok(), "a corner on a straight line");
    let star = "[[0, 1], [0.59, -0.81], [-0.95, 0.31], [0.95, 0.31], [-0.59, -0.81]]";
    for (text, wanted) in [
        (format!("{{ polygon = {star} }}"), "not a convex polygon"),
        ("{ polygon = [[0, 0], [1, 0], [0.1, 0.1], [0, 1]] }".into(), "not a convex polygon"),
        ("{ polygon = [[0, 0], [1, 1], [1, 0], [0, 1]] }".into(), "not a convex polygon"),
        ("{ polygon = [[0, 0], [1, 1]] }".into(), "not a convex polygon"),
        ("{ polygon = [[0, 0], [1, 1], [2, 2]] }".into(), "not a convex polygon"),
        ("{ polygon = [[0, 0], [1, 1], [2]] }".into(), "a row of 'polygon' has the wrong length"),
        ("{ polygon = [[0, 0], [1, 0], [0, 1]], s = [0, 1] }".into(), "exclude each other"),
        ("{ s = [2, 1] }".into(), "the range 's' of the region is empty"),
        ("{ s = [nan, 1] }".into(), "'s' is out of range"),
        ("{}".into(), "the region has no limits"),
    ] {
        let message = region(&text).unwrap_err();
        assert!(message.contains(wanted), "{text}: {message}");
    }
}

#[test]
fn what_no_widget_can_be_is_refused() {
    for (keys, wanted) in [
        ("color = [1, 1, 1]", "has no 'kind'"),
        ("kind = \"gausian\"", "unknown kind: found \"gausian\"; expected 'gaussian', the nearest"),
        ("kind = \"gaussian\"\ncolour = [1, 1, 1]", "unknown parameter 'colour'; expected 'color'"),
        ("kind = \"gaussian\"\nextinction = 1\ncentre = [1, 1]\nsigma = [1, 1]", "'color' is missing"),
        ("kind = \"gaussian\"\ncolor = [1, -1, 1]", "'color' is out of range: found -1"),
        ("kind = \"gaussian\"\ncolor = [1, 1]", "'color' is of the wrong type"),
        ("kind = \"gaussian\"\nextinction = -1", "'extinction' is out of range"),
        ("kind = \"gaussian\"\nsigma = [0, 1]", "'sigma' is out of range"),
        ("kind = \"uniform\"\ncolor = [1, 1, 1]\nextinction = 1", "'region' is missing"),
        ("kind = \"sine-wave\"\nperiod = 0", "'period' is out of range"),
        ("kind = \"sine-wave\"\nband_width = 1.5", "'band_width' is out of range"),
        ("kind = \"piecewise-linear\"\npoints = []", "no control point"),
        (
            "kind = \"piecewise-linear\"\npoints = [[0, 1, 1, 1, 1], [0, 1, 1, 1, 1]]",
            "do not rise in s: found 0 after 0",
        ),
        ("kind = \"piecewise-linear\"\npoints = [[0, 1, 1, 1, -1]]", "negative colour or extinction"),
        ("kind = \"piecewise-linear\"\npoints = [[0, 1, 1, 1]]", "a row of 'points' has the wrong length"),
        ("kind = \"piecewise-linear\"\npoints = [[0, 1, 1, 1, inf]]", "'points' is out of range"),
        ("kind = \"table\"\nextinction = 1\nimage = \"a\"\ns = [1, 1]\ng = [0, 1]", "the range 's' is empty"),
        ("kind = \"table\"\nextinction = 1\nimage = \"\"", "'image' is empty"),
    ] {
        let message = stated(keys).unwrap_err();
        assert!(message.contains(wanted), "{keys}: {message}");
    }
    for (keys, wanted) in [
        (
            "centre = [0, 0]\nsigma = [1, 1]\nmatrix = [[1, 0], [0, 1]]",
            "exclude each other; expected one of them",
        ),
        ("centre = [0, 0]", "needs 'sigma' or 'matrix'; expected sigma"),
        ("centre = [0, 0]\nmatrix = [[1, 0]]", "wrong size: found 1 × 2; expected 2 × 2"),
        ("centre = [0, 0]\nsigma = [1e-310, 1]", "inverse is not finite"),
    ] {
        let message = stated(&format!("kind = \"gaussian\"\n{PEAK}{keys}")).unwrap_err();
        assert!(message.contains(wanted), "{keys}: {message}");
    }
    for (keys, wanted) in [
        ("fields = []\ncentre = []\nsigma = []", "the number of fields is out of range"),
        ("fields = [\"a\"]\ncentre = [1, 2]\nsigma = [1]", "'centre' has the wrong length"),
        ("fields = [\"a\"]\ncentre = [1]\nsigma = [1, 2]", "'sigma' has the wrong size"),
    ] {
        let message = stated(&format!("kind = \"gaussian-nd\"\n{PEAK}{keys}")).unwrap_err();
        assert!(message.contains(wanted), "{keys}: {message}");
    }
    let eight = "fields = [\"a\", \"b\", \"c\", \"d\", \"e\", \"f\", \"g\", \"h\"]";
    for (keys, wanted) in [
        (format!("{eight}\ncentre = []\nsigma = []"), "out of range: found 8; expected 1 to 7 names"),
        ("fields = [\"a\"]\ncentre = [1]\nsigma = [1]\nmagnitude = \"\"".into(), "the magnitude has no name"),
    ] {
        let message = stated(&format!("kind = \"triangular-gaussian-nd\"\n{PEAK}{keys}")).unwrap_err();
        assert!(message.contains(wanted), "{keys}: {message}");
    }
}
