use super::*;

const TEXT: &str = r#"
[pipeline]
format = 1
title = "A \"title\"\nof two lines"

[nodes.z]
type = "reader"
path = "a.vtu"

[nodes."with space"]
type = "transfer-function"
unit_distance = "auto"
light = { direction = [0, 1.5, 1e-300], on = true, far = inf }

[[nodes."with space".widgets]]
kind = "gaussian"
centre = [1, 2.0]
region = { polygon = [[0, 0], [1, 0], [0, 1]] }

[[nodes."with space".widgets]]
kind = "uniform"

[nodes.a]
type = "sort"
inputs = { cells = "z", camera = "with space" }
"#;

#[test]
fn a_pipeline_written_and_read_again_is_equal() {
    let first = Pipeline::parse(TEXT).unwrap();
    assert_eq!(first.nodes.iter().map(|n| n.name.as_str()).collect::<Vec<_>>(), ["z", "with space", "a"]);
    let text = first.to_string();
    assert_eq!(Pipeline::parse(&text).unwrap(), first, "{text}");
}

#[test]
fn mistakes_in_the_frame_of_the_file_are_placed() {
    for (from, to, wanted, place) in [
        ("format = 1", "format = 2", "does not know the format: found 2; expected 1", (3, 10)),
        ("format = 1", "fromat = 1", "unknown key 'fromat' in [pipeline]; expected 'format'", (3, 1)),
        ("format = 1", "", "does not state its format", (2, 2)),
        ("title = ", "title = 3 #", "the title must be text", (4, 9)),
        ("[nodes.z]", "[node.z]", "unknown key 'node' in a pipeline file; expected 'nodes'", (6, 2)),
        ("[nodes.z]", "[nodes.z", "not valid TOML", (6, 9)),
        ("type = \"reader\"", "typ = 3", "the node 'z' has no type", (6, 8)),
        ("path = \"a.vtu\"", "path = 1979-05-27", "not a date", (8, 8)),
        ("path = \"a.vtu\"", "path = 1e999", "at most 1.8e308", (8, 8)),
        ("path = \"a.vtu\"", "path = 99999999999999999999", "at most 64 bits", (8, 8)),
        ("path = \"a.vtu\"", "path = 1\npath = 2", "not valid TOML", (9, 1)),
    ] {
        assert!(TEXT.contains(from), "{from}");
        let error = Pipeline::parse(&TEXT.replacen(from, to, 1)).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(wanted), "{to}: {message}");
        assert_eq!(error.location.line_column, Some(place), "{to}: {message}");
    }
    assert!(Pipeline::parse("").unwrap_err().what.contains("does not state its format"));
    assert!(Pipeline::parse("[pipeline]\nformat = 1").unwrap_err().what.contains("no nodes"));
}

#[test]
fn options_change_parameters_and_parts_of_them() {
    let mut pipeline = Pipeline::parse(TEXT).unwrap();
    let text_of = |pipeline: &Pipeline, key: &str| {
        let fields = pipeline.nodes.iter().flat_map(|n| &n.settings);
        fields.filter(|f| f.name == key).map(|f| f.setting.datum.to_string()).collect::<String>()
    };
    pipeline.set("z.path=b c.vtu").unwrap();
    assert_eq!(text_of(&pipeline, "path"), "\"b c.vtu\"");
    pipeline.set("z.path = \"d\"").unwrap();
    assert_eq!(text_of(&pipeline, "path"), "\"d\"");
    pipeline.set("z.subdivision=3").unwrap();
    assert_eq!(text_of(&pipeline, "subdivision"), "3");
    pipeline.set("with space.widgets.0.centre=[3, 4]").unwrap();
    pipeline.set("with space.widgets.0.centre.1=5.5").unwrap();
    assert!(text_of(&pipeline, "widgets").contains("centre = [3, 5.5]"));
    pipeline.set("with space.light.ambient=0.5").unwrap();
    assert!(text_of(&pipeline, "light").contains("ambient = 0.5"));
}

#[test]
fn wrong_options_name_themselves() {
    for (option, wanted) in [
        ("z.path", "has no '='"),
        ("z=3", "names no parameter"),
        ("z.=3", "names no parameter"),
        ("y.path=3", "no node 'y'"),
        ("z.type=sort", "'type' cannot be set"),
        ("with space.widgets.2.kind=x", "no such entry in the list: found 2; expected a number below 2"),
        ("z.path.x=3", "has no parts"),
    ] {
        let error = Pipeline::parse(TEXT).unwrap().set(option).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(wanted) && message.contains(&format!("--set {option}")), "{message}");
    }
}

#[test]
fn a_value_that_is_no_toml_is_text() {
    assert_eq!(value("[1, 2").map(|s| s.datum), None);
    assert_eq!(value("1\nx = 2").map(|s| s.datum), None);
    assert_eq!(value("true").map(|s| s.datum), Some(ParameterValue::Boolean(true)));
}

#[test]
fn what_belongs_to_the_editor_is_of_no_account() {
    // A date, and names that nothing knows: none of it is looked at.
    let editor = "\n[editor.nodes]\nz = [1, 2]\nnowhere = 1979-05-27\n\n[[editor.frames]]\ntitle = 3\n";
    let text = format!("{TEXT}{editor}");
    assert_eq!(Pipeline::parse(&text).unwrap(), Pipeline::parse(TEXT).unwrap());
    let survey = Pipeline::survey(&text);
    let names: Vec<&str> = survey.editor.iter().map(|field| field.name.as_str()).collect();
    assert_eq!((names, survey.faults.len()), (vec!["nodes", "frames"], 0));
    assert!(Pipeline::parse(&text.replace("[editor.nodes]", "[editors.nodes]")).is_err());
}

#[test]
fn every_mistake_is_found_and_the_rest_is_read() {
    let text = TEXT
        .replace("format = 1", "format = 2\nfrmat = 1")
        .replace("path = \"a.vtu\"", "path = 1979-05-27")
        .replace("type = \"sort\"\n", "")
        .replace("[nodes.z]", "[nodes]\nb = 3\n\n[nodes.z]");
    let survey = Pipeline::survey(&text);
    let found: Vec<String> = survey.faults.iter().map(|fault| fault.to_string()).collect();
    for (wanted, fault) in
        ["not a date", "unknown key 'frmat'", "does not know the format", "must be a table", "has no type"]
            .iter()
            .zip(&found)
    {
        assert!(fault.contains(wanted), "{fault}");
    }
    assert_eq!(found.len(), 5, "{found:?}");
    assert!(survey.faults.iter().all(|fault| fault.location.line_column.is_some()));
    assert_eq!(survey.pipeline.nodes.len(), 3);
    assert_eq!(survey.pipeline.nodes[2].inputs.len(), 2);
    // What is no TOML hides no more than it must.
    let survey = Pipeline::survey(&TEXT.replace("path = \"a.vtu\"", "path = "));
    assert!(!survey.is_toml && survey.pipeline.nodes.len() == 3);
    assert_eq!(survey.faults[0].location.line_column, Some((8, 8)));
}
