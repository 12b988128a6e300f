//! The rows of a panel, made from the declarations that ship.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use voltet_document::Document;
use voltet_document::panel::{Control, DataExtent, Row, Scale, first_field, to_text, typed};
use voltet_graph::{DefaultValue, LocatedValue, Parameter, ParameterType, ParameterValue, Range, Registry};

const FILE: &str = r#"
[pipeline]
format = 1
[nodes.grid]
type = "reader"
path = "a.vtu"
[nodes.gradient]
type = "gradient-magnitude"
method = "array"
[nodes.look]
type = "transfer-function"
[[nodes.look.widgets]]
kind = "gaussian"
centre = ["p90", 2.0]
[[nodes.look.widgets]]
kind = "strange"
[nodes.view]
type = "camera"
fov_y = 30.0
[nodes.file]
type = "image-writer"
[nodes.none]
type = "nobody knows"
"#;

fn registry() -> Registry {
    voltet_nodes::registry().unwrap()
}

fn rows(node: &str) -> Vec<Row> {
    Document::from_text(FILE.into(), None).rows(&registry(), node)
}

fn row(node: &str, name: &str) -> Row {
    rows(node).into_iter().find(|row| row.parameter.name == name).unwrap()
}

fn numbers(list: &[f64]) -> ParameterValue {
    ParameterValue::List(list.iter().map(|x| LocatedValue::from(ParameterValue::Number(*x))).collect())
}

#[test]
fn a_row_says_what_holds_and_whether_the_file_says_so() {
    let fov = row("view", "fov_y");
    assert_eq!(
        (fov.set_value.clone(), fov.value().cloned()),
        (Some(ParameterValue::Number(30.0)), Some(ParameterValue::Number(30.0)))
    );
    let up = row("view", "up");
    assert!(up.set_value.is_none() && up.value().is_some() && !up.is_missing());
    assert!(row("file", "path").is_missing());
    assert_eq!(row("look", "widgets").default_text(), "no widgets: an empty picture");
    assert!(rows("none").is_empty() && rows("nowhere").is_empty());
    // What the filter declares stands beside the word that names it.
    let names: Vec<&str> = rows("gradient").iter().map(|row| row.parameter.name).collect();
    assert!(names.contains(&"method") && names.contains(&"array"), "{names:?}");
}

#[test]
fn controls_are_by_kind() {
    assert!(matches!(row("view", "fov_y").control, Control::Number { scale: Scale::Linear, word: None, .. }));
    let unit = row("look", "unit_distance").control;
    assert!(
        matches!(unit, Control::Number { scale: Scale::Logarithmic, word: Some("auto"), .. }),
        "{unit:?}"
    );
    assert!(matches!(row("view", "size").control, Control::Vector { count: Some(2), whole: true, .. }));
    assert!(matches!(row("file", "background").control, Control::Colour { most: 1.0 }));
    assert!(matches!(row("grid", "path").control, Control::InputFile));
    assert!(matches!(row("file", "path").control, Control::OutputFile));
    assert!(matches!(row("grid", "scalar").control, Control::Array));
    let Control::Choice(filters) = row("gradient", "method").control else { panic!("a choice") };
    assert!(filters.iter().any(|(word, meaning)| *word == "least-squares" && !meaning.is_empty()));
    let widgets = row("look", "widgets");
    let kinds: Vec<Option<&str>> =
        widgets.entries.iter().map(|entry| entry.kind.map(|kind| kind.name)).collect();
    assert_eq!(kinds, [Some("gaussian"), None]);
    let centre = widgets.entries[0].rows.iter().find(|row| row.parameter.name == "centre").unwrap();
    assert!(matches!(centre.control, Control::Vector { relative: true, .. }), "{:?}", centre.control);
    assert_eq!(centre.path, "widgets.0.centre".into());
    let color = widgets.entries[0].rows.iter().find(|row| row.parameter.name == "color").unwrap();
    assert!(matches!(color.control, Control::Colour { most: f64::INFINITY }));
}

/// A new text that names arrays, or a colour, must be known as such: what is plain is listed here.
#[test]
fn every_text_and_every_three_numbers_are_told_apart() {
    let registry = registry();
    let mut plain = Vec::new();
    for node in registry.iter() {
        let text = format!("[pipeline]\nformat = 1\n[nodes.a]\ntype = \"{}\"\n", node.name);
        for row in Document::from_text(text, None).rows(&registry, "a") {
            let inner = row.rows.clone();
            for row in [row].into_iter().chain(inner) {
                let is_plain = matches!(
                    row.control,
                    Control::Text | Control::Texts | Control::Vector { count: Some(3), .. }
                );
                if is_plain && !plain.contains(&row.parameter.name) {
                    plain.push(row.parameter.name);
                }
            }
        }
    }
    plain.sort();
    assert_eq!(
        plain,
        [
            "adapter",
            "arrays",
            "bar_title",
            "blocks",
            "centre",
            "direction",
            "eye",
            "high",
            "layers",
            "length_unit",
            "low",
            "name",
            "normal",
            "origin",
            "resolution",
            "target",
            "text",
            "title",
            "unit",
            "units",
            "up",
        ]
    );
}

#[test]
fn what_is_typed_is_read_as_it_is_meant_or_refused_in_words() {
    let unit = row("look", "unit_distance");
    assert_eq!(typed(&unit, " .5 ").unwrap(), ParameterValue::Number(0.5));
    assert_eq!(typed(&unit, "3").unwrap(), ParameterValue::Integer(3));
    assert_eq!(typed(&unit, "auto").unwrap(), ParameterValue::Text("auto".into()));
    let widgets = row("look", "widgets");
    let centre = widgets.entries[0].rows.iter().find(|row| row.parameter.name == "centre").unwrap();
    assert_eq!(to_text(centre.value().unwrap()), "p90, 2.0");
    let relative = ParameterValue::List(vec![
        ParameterValue::Text("25 %".into()).into(),
        ParameterValue::Number(1e-3).into(),
    ]);
    assert_eq!(typed(centre, "25 %, 1e-3").unwrap(), relative);
    assert_eq!(typed(centre, "25 % 1e-3").unwrap(), relative);
    let eye = row("view", "eye");
    for text in ["1.0 2.0 3.5", "[1.0, 2.0, 3.5]", "1.0,2.0,3.5,"] {
        assert_eq!(typed(&eye, text).unwrap(), numbers(&[1.0, 2.0, 3.5]), "{text}");
    }
    assert_eq!(typed(&row("grid", "scalar"), "1.5").unwrap(), ParameterValue::Text("1.5".into()));
    for (row, text, wanted) in [
        (row("view", "fov_y"), "200", "'fov_y' is out of range: found 200"),
        (row("view", "fov_y"), "12,5", "a number has a point, not a comma: found 12,5; expected 12.5"),
        (row("view", "fov_y"), "wide", "'fov_y' is of the wrong type: found \"wide\""),
        (row("view", "eye"), "1 2", "expected 3 numbers"),
        (row("view", "size"), "1.5 2", "whole numbers"),
        (row("file", "background"), "2 0 0", "out of range"),
        (
            row("gradient", "method"),
            "least-square",
            "'method' does not know this word: found \"least-square\"; expected 'least-squares'",
        ),
        (row("grid", "path"), " ", "'path' is empty"),
    ] {
        let error = typed(&row, text).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    // What is shown can be typed again.
    let document = Document::from_text(FILE.into(), None);
    for row in ["grid", "gradient", "view", "look"].iter().flat_map(|node| document.rows(&registry(), node)) {
        if let Some(value) = row.value().filter(|_| row.entries.is_empty()) {
            assert_eq!(&typed(&row, &to_text(value)).unwrap(), value, "{}", row.path);
        }
    }
}

/// Values to begin with are for what is known by name, type and unit: a number made up for another one would be a wrong picture.
#[test]
fn what_is_not_known_gets_no_value_to_begin_with() {
    let extent = DataExtent { bounds: [[0.0; 3], [4.0, 4.0, 8.0]], forward: [0.0, 0.0, -1.0] };
    let parameter = |name, parameter_type, unit| Parameter {
        name,
        parameter_type,
        unit,
        default: DefaultValue::Required,
        help: "of a plug-in",
    };
    let number = ParameterType::Number(Range::ANY);
    let three = ParameterType::Numbers(Some(3), Range::ANY);
    let first = |name, parameter_type, unit| {
        first_field(&parameter(name, parameter_type, unit), &extent).map(|field| field.setting.datum)
    };
    let known = first("centre", three, "world units").unwrap();
    assert_eq!(to_text(&known), "2.0, 2.0, 4.0");
    assert!(first("radius", number, "world units").is_some());
    for (name, parameter_type, unit) in [
        ("radius", number, "pixels"),
        ("radius", ParameterType::Integer(Range::ANY), "world units"),
        ("radius", ParameterType::Number(Range::within(0.0, 1.0)), "world units"),
        ("points", ParameterType::Rows(Some(5)), "world units"),
        ("points", ParameterType::Rows(Some(3)), "(s, linear RGB, per unit_distance)"),
        ("centre", three, "pixels"),
        ("size", three, "world units"),
        ("centre", number, "units of s"),
        ("values", ParameterType::Numbers(None, Range::ANY), ""),
        ("extinction", number, "per metre"),
        ("depth", number, "world units"),
    ] {
        assert_eq!(first(name, parameter_type, unit), None, "{name} {parameter_type:?} {unit}");
    }
}

/// A direction has no length in the units of the data, and begins along the view.
#[test]
fn directions_have_no_unit_of_length() {
    fn of(parameters: &[Parameter], found: &mut Vec<Parameter>) {
        for parameter in parameters {
            match parameter.parameter_type {
                ParameterType::Table(within) => of(within, found),
                ParameterType::Kinds(kinds) => kinds.iter().for_each(|kind| of(kind.parameters, found)),
                _ if ["normal", "direction"].contains(&parameter.name) => found.push(*parameter),
                _ => {}
            }
        }
    }
    let mut found = Vec::new();
    voltet_nodes::registry().unwrap().iter().for_each(|node| of(node.parameters, &mut found));
    assert!(found.len() > 5, "{}", found.len());
    let other: Vec<_> = found.iter().filter(|parameter| parameter.unit != "world space").collect();
    assert!(other.is_empty(), "{other:?}");
}
