//! Relative numbers of widgets.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use voltet_core::parameters::{ArrayRef, LocatedValue, ParameterValue, Parameters};
use voltet_core::transfer::*;
use voltet_core::{Error, Result};
use voltet_graph::pipeline::Pipeline;

/// s from 10 to 30, g from 0 to 8, p from 100 to 200, m from 0 to 4, c the same everywhere; percentiles along these.
struct Known;

impl DataStatistics for Known {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        match quantity {
            ArrayRef::Named("s") => Ok([10.0, 30.0]),
            ArrayRef::Named("g") => Ok([0.0, 8.0]),
            ArrayRef::Array(name) if name == "p" => Ok([100.0, 200.0]),
            ArrayRef::Array(name) if name == "m" => Ok([0.0, 4.0]),
            ArrayRef::Array(name) if name == "c" => Ok([7.0, 7.0]),
            other => Err(Error::run(format!("no {other}"))),
        }
    }

    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64> {
        let [low, high] = self.range(quantity)?;
        Ok(low + (high - low) * percent / 100.0)
    }
}

/// The keys of one widget.
fn keys(text: &str) -> Result<(&'static str, Parameters)> {
    let text = format!("[pipeline]\nformat = 1\n[nodes.a]\ntype = \"b\"\n[[nodes.a.widgets]]\n{text}\n");
    let pipeline = Pipeline::parse(&text)?;
    let fields = pipeline.nodes[0].settings[0].setting.list().unwrap()[0].table().unwrap().to_vec();
    let kind = fields[0].setting.text().unwrap();
    let kind = WIDGET_KINDS.iter().find(|known| known.name == kind).unwrap();
    let origin = voltet_core::parameters::SourceSpan::Nowhere;
    Ok((kind.name, Parameters::check(kind.parameters, &fields, &origin, &["kind"])?))
}

/// The widget with plain numbers.
fn assert_becomes(relative: &str, typed: &str) {
    let (kind, p) = keys(relative).unwrap();
    let found = read(kind, &resolved(&p, &Known).unwrap(), &UnreadFiles).unwrap();
    let (kind, p) = keys(typed).unwrap();
    assert_eq!(resolved(&p, &Known).unwrap(), p, "numbers stay as they are");
    assert!(statistics_request(&p).is_empty());
    assert_eq!(found, read(kind, &p, &UnreadFiles).unwrap(), "{relative}");
}

const LOOK: &str = "color = [1, 0, 0]\nextinction = 2";

#[test]
fn every_kind_takes_shares_and_percentiles() {
    let gaussian = |numbers: &str| format!("kind = \"gaussian\"\n{LOOK}\n{numbers}");
    assert_becomes(
        &gaussian("centre = [\"25 %\", \"p50\"]\nsigma = [\"5%\", \"100 %\"]"),
        &gaussian("centre = [15, 4]\nsigma = [1, 8]"),
    );
    // So much of the range is one unit of a row of K.
    assert_becomes(
        &gaussian("centre = [1, 1]\nmatrix = [[\"5 %\", \"-25 %\"], [0, \"50 %\"]]"),
        &gaussian("centre = [1, 1]\nmatrix = [[1, -0.5], [0, 0.25]]"),
    );
    // Beyond the range, and beside numbers.
    assert_becomes(
        &gaussian(
            "centre = [\"-50 %\", 2.5]\nsigma = [inf, \"12.5 %\"]\nregion = { s = [\"0 %\", \"110 %\"], g = [1, inf] }",
        ),
        &gaussian("centre = [0, 2.5]\nsigma = [inf, 1]\nregion = { s = [10, 32], g = [1, inf] }"),
    );
    assert_becomes(
        &gaussian(
            "centre = [1, 1]\nsigma = [1, 1]\nregion = { polygon = [[\"0 %\", 0], [\"p100\", \"0 %\"], [10, \"50 %\"]] }",
        ),
        &gaussian("centre = [1, 1]\nsigma = [1, 1]\nregion = { polygon = [[10, 0], [30, 0], [10, 4]] }"),
    );
    let nd = |numbers: &str| format!("kind = \"gaussian-nd\"\n{LOOK}\nfields = [\"p\", \"c\"]\n{numbers}");
    assert_becomes(
        &nd("centre = [\"p75\", \"30 %\"]\nsigma = [\"2 %\", 1]"),
        &nd("centre = [175, 7]\nsigma = [2, 1]"),
    );
    let triangular = |numbers: &str| format!("kind = \"triangular-gaussian\"\n{LOOK}\n{numbers}");
    assert_becomes(
        &triangular("centre = \"50 %\"\nsigma = \"10 %\""),
        // A tenth of 20 units of s per 8 units of g.
        &triangular("centre = 20\nsigma = 0.25"),
    );
    let triangular = |numbers: &str| {
        format!("kind = \"triangular-gaussian-nd\"\n{LOOK}\nfields = [\"p\"]\nmagnitude = \"m\"\n{numbers}")
    };
    assert_becomes(
        &triangular("centre = [\"50 %\"]\nsigma = [\"8 %\"]"),
        &triangular("centre = [150]\nsigma = [2]"),
    );
    let points = |rows: &str| format!("kind = \"piecewise-linear\"\npoints = {rows}");
    assert_becomes(
        &points("[[\"0 %\", 1, 1, 1, 0], [15, 1, 1, 1, 2], [\"p90\", 0, 0, 0, 0]]"),
        &points("[[10, 1, 1, 1, 0], [15, 1, 1, 1, 2], [28, 0, 0, 0, 0]]"),
    );
    let map = |numbers: &str| format!("kind = \"colormap\"\n{numbers}");
    assert_becomes(&map("steps = 2"), &map("range = [10, 30]\nsteps = 2"));
    assert_becomes(&map("range = [\"p10\", \"50 %\"]"), &map("range = [12, 20]"));
    assert_becomes(&map("centre = \"25 %\""), &map("range = [10, 30]\ncentre = 15"));
    let table = |numbers: &str| format!("kind = \"table\"\nextinction = 1\nimage = \"a.png\"\n{numbers}");
    assert_becomes(
        &table("s = [\"p10\", \"p90\"]\ng = [\"0 %\", \"50 %\"]"),
        &table("s = [12, 28]\ng = [0, 4]"),
    );
}

#[test]
fn periods_are_shares_of_what_the_bands_run_across() {
    let wave = |numbers: &str| format!("kind = \"sine-wave\"\n{LOOK}\n{numbers}");
    assert_becomes(&wave("origin = [\"0 %\", 0]\nperiod = \"10 %\""), &wave("origin = [10, 0]\nperiod = 2"));
    assert_becomes(&wave("angle = 90\nperiod = \"25 %\""), &wave("angle = 90\nperiod = 2"));
    // A tenth of the range of s counts as 1, and of g a quarter: both directions run over 10 and 4.
    assert_becomes(
        &wave("scale = [\"10 %\", \"25 %\"]\nperiod = \"50 %\""),
        &wave("scale = [0.5, 0.5]\nperiod = 5"),
    );
    let (_, p) = keys(&wave("angle = 45\nperiod = \"10 %\"")).unwrap();
    let period = resolved(&p, &Known).unwrap().number("period").unwrap();
    assert!((period - 2.8 / std::f64::consts::SQRT_2).abs() < 1e-15, "{period}");
    let (_, p) = keys(&wave("scale = [0, 1]\nperiod = \"10 %\"")).unwrap();
    assert!(resolved(&p, &Known).unwrap_err().to_string().contains("has no bands"));
}

#[test]
fn only_what_the_numbers_need_is_asked_of_the_data() {
    let asked = |text: &str| {
        let request = statistics_request(&keys(text).unwrap().1);
        let ranges: Vec<String> = request.ranges.iter().map(ArrayRef::to_string).collect();
        let percentiles = request.percentiles.iter().flat_map(|(quantity, percents)| {
            percents.iter().map(move |&bits| format!("{quantity} {}", f64::from_bits(bits)))
        });
        (ranges.join(", "), percentiles.collect::<Vec<_>>().join(", "))
    };
    let wave = format!("kind = \"sine-wave\"\n{LOOK}\n");
    assert_eq!(asked(&format!("{wave}period = \"10 %\"")), ("s".into(), String::new()));
    assert_eq!(asked(&format!("{wave}angle = 90\nperiod = \"10 %\"")), ("g".into(), String::new()));
    assert_eq!(asked(&format!("{wave}origin = [\"p5\", 0]\nperiod = 1")), (String::new(), "s 5".into()));
    let nd = format!("kind = \"gaussian-nd\"\n{LOOK}\nfields = [\"p\", \"T\"]\n");
    assert_eq!(
        asked(&format!("{nd}centre = [1, \"p50\"]\nsigma = [\"1 %\", 1]")),
        ("'p'".into(), "'T' 50".into())
    );
}

#[test]
fn a_constant_quantity_has_places_but_no_widths() {
    let nd = format!("kind = \"gaussian-nd\"\n{LOOK}\nfields = [\"c\"]\ncentre = [\"40 %\"]\n");
    let (_, p) = keys(&format!("{nd}sigma = [\"5 %\"]")).unwrap();
    let error = resolved(&p, &Known).unwrap_err();
    assert!(error.to_string().contains("'c' is the same everywhere"), "{error}");
    assert!(error.to_string().contains("found 'c' = 7.0"), "{error}");
    assert!(error.location.span.is_some(), "{error}");
}

#[test]
fn before_the_data_are_known_only_what_is_sure_is_judged() {
    let judged = |text: &str| -> Result<Widget> {
        let (kind, p) = keys(text)?;
        read(kind, &with_placeholders(&p)?, &UnreadFiles)
    };
    let region = |s: &str| format!("kind = \"uniform\"\n{LOOK}\nregion = {{ s = {s} }}");
    for sure in ["[\"90 %\", \"10 %\"]", "[\"p90\", \"p10\"]"] {
        assert!(judged(&region(sure)).unwrap_err().to_string().contains("is empty"), "{sure}");
    }
    for open in ["[\"90 %\", 10]", "[500, \"p1\"]", "[\"p10\", \"9 %\"]", "[\"10 %\", inf]"] {
        let widget = judged(&region(open)).unwrap_or_else(|error| panic!("{open}: {error}"));
        assert!(widget.region.is_some_and(|region| !region.depends_on_g()));
    }
    let points = |rows: &str| format!("kind = \"piecewise-linear\"\npoints = {rows}");
    let row = |s: &str| format!("[{s}, 1, 1, 1, 1]");
    let rows = |s: [&str; 3]| points(&format!("[{}]", s.map(row).join(", ")));
    assert!(
        judged(&rows(["\"50 %\"", "\"20 %\"", "\"90 %\""])).unwrap_err().to_string().contains("do not rise")
    );
    judged(&rows(["\"50 %\"", "-3", "\"p90\""])).unwrap();
    let polygon = |corners: &str| format!("kind = \"uniform\"\n{LOOK}\nregion = {{ polygon = {corners} }}");
    let flat = "[[\"0 %\", \"0 %\"], [\"50 %\", \"50 %\"], [\"100 %\", \"100 %\"]]";
    assert!(judged(&polygon(flat)).unwrap_err().to_string().contains("convex"));
    judged(&polygon("[[\"p1\", 3], [\"p50\", \"50 %\"], [7, \"100 %\"]]")).unwrap();
}

#[test]
fn wrong_texts_say_what_would_be_right_and_where() {
    let gaussian = |numbers: &str| format!("kind = \"gaussian\"\n{LOOK}\n{numbers}");
    for (text, wanted, found) in [
        (
            gaussian("centre = [\"p50\", 1]\nsigma = [\"p50\", 1]"),
            "a percentile is a value of the data",
            "\"p50\"",
        ),
        (gaussian("centre = [\"p101\", 1]\nsigma = [1, 1]"), "no number relative to data", "\"p101\""),
        (
            gaussian("centre = [\"half\", 1]\nsigma = [1, 1]"),
            "or \"25 %\" of the range, \"p90\" by volume",
            "\"half\"",
        ),
        (gaussian("centre = [1, 1]\nsigma = [\"0 %\", 1]"), "a percentage above 0", "\"0 %\""),
        (gaussian("centre = [1]\nsigma = [1, 1]"), "2 numbers", "[1]"),
        (
            "kind = \"piecewise-linear\"\npoints = [[1, \"50 %\", 1, 1, 1]]".into(),
            "list of rows of 5 numbers",
            "",
        ),
    ] {
        let error = keys(&text).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(wanted) && message.contains(found), "{message}");
        assert!(error.location.span.is_some(), "{message}");
    }
}

#[test]
fn numbers_replaced_keep_their_places() {
    let (_, p) =
        keys(&format!("kind = \"gaussian\"\n{LOOK}\ncentre = [\"p50\", 1]\nsigma = [1, 1]")).unwrap();
    let known = resolved(&p, &Known).unwrap();
    let [before, after] = [&p, &known].map(|p| p.optional("centre").unwrap().list().unwrap()[0].clone());
    let LocatedValue { datum: ParameterValue::Number(20.0), origin } = after else { panic!("{after:?}") };
    assert_eq!(format!("{origin:?}"), format!("{:?}", before.origin));
    assert!(known.is_set("centre") && !known.is_set("region"));
}
