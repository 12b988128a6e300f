//! Every mistake of a file, each at its node and its part.

use super::*;

#[test]
fn every_mistake_has_its_place_and_the_first_is_the_one_that_a_build_names() {
    let text = SCENE
        .replace("size = 3", "size = -1\nsise = 3")
        .replace("unit = 2.0", "unit = \"x\"\nunits = 1")
        .replace("type = \"gradient\"", "type = \"gradeint\"")
        .replace("volume = \"gradient\", look", "volume = \"look\", luk")
        .replace("path = \"a\"", "")
        .replace("picture.image", "picture.imag");
    let entries = Pipeline::parse(&text).unwrap().nodes;
    let faults = Graph::faults(&entries, &registry(), PathBuf::new());
    let found: Vec<(&str, DiagnosticTarget)> =
        faults.iter().map(|fault| (&*fault.node, fault.part.clone())).collect();
    let parameter = |name: &str| DiagnosticTarget::Parameter(name.into());
    let input = |name: &str| DiagnosticTarget::Input(name.into());
    let wanted = [
        ("grid", parameter("size")),
        ("grid", parameter("sise")),
        ("gradient", DiagnosticTarget::Node),
        ("look", parameter("unit")),
        ("look", parameter("units")),
        ("file", parameter("path")),
        ("picture", input("volume")),
        ("picture", input("luk")),
        ("picture", input("look")),
        ("file", input("image")),
    ];
    assert_eq!(found, wanted);
    let placed = |fault: &Diagnostic| {
        fault.error.location.node.as_deref() == Some(&*fault.node) && fault.error.location.span.is_some()
    };
    assert!(faults.iter().all(placed));
    let first = graph(&text).unwrap_err().to_string();
    assert!(first.starts_with("'size' is out of range"), "{first}");
    assert!(Graph::faults(&Pipeline::parse(SCENE).unwrap().nodes, &registry(), PathBuf::new()).is_empty());
}

#[test]
fn what_a_node_of_an_unknown_type_feeds_is_not_blamed_for_it() {
    let text = SCENE.replace("type = \"gradient\"", "type = \"gradeint\"");
    let faults = Graph::faults(&Pipeline::parse(&text).unwrap().nodes, &registry(), PathBuf::new());
    assert_eq!(faults.iter().map(|fault| &*fault.node).collect::<Vec<_>>(), ["gradient"]);
}
