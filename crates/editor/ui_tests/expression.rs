use super::*;

/// A calculator over arrays of a file.
const CALCULATOR: &str = "[pipeline]\nformat = 1\n\n[nodes.grid]\ntype = \"reader\"\npath = \"data.vtk\"\n\n[nodes.sum]\ntype = \"calculator\"\n\
                          expression = \"T\"\nname = \"sum\"\ninputs = { grid = \"grid\" }\n";

/// A grid with a scalar and a vector.
const DATA: &str = "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n\
                    CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS T double 1\nLOOKUP_TABLE default\n1 2 3 4\n\
                    VECTORS Velocity double\n1 0 0 0 1 0 0 0 1 1 1 1\n";

/// Before the field, with the cursor at its end.
fn in_field() -> Hand {
    let mut hand = Hand::with_file(CALCULATOR, "data.vtk", DATA);
    hand.editor.selection = ["sum".to_string()].into();
    hand.frames(3);
    until(&mut hand, "the arrays are found", |hand| {
        let document = hand.editor.document();
        let registry = voltet_nodes::registry().unwrap();
        !hand.editor.arrays.feeding(&hand.ctx, document, &registry, "sum").choices().is_empty()
    });
    hand.click_on("sum.expression");
    hand.key(Key::End, Modifiers::NONE);
    hand
}

fn stated(hand: &Hand) -> String {
    let nodes = &hand.editor.document().pipeline().nodes;
    let node = nodes.iter().find(|node| node.name == "sum").unwrap();
    node.setting("expression").unwrap().text().unwrap().to_string()
}

#[test]
fn names_and_functions_are_completed_by_keys_and_by_the_mouse() {
    let mut hand = in_field();
    hand.typed("*ma");
    hand.frames(2);
    // "max(a, b)" comes before "mag(V)".
    assert!(!hand.shown_beginning("max(a, b)").is_empty() && !hand.shown_beginning("mag(V)").is_empty());
    hand.key(Key::ArrowDown, Modifiers::NONE);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.typed("vel");
    hand.frames(2);
    assert!(hand.shown_beginning("Velocity:magnitude").is_empty(), "the function takes the vector");
    assert!(!hand.texts("Velocity").is_empty());
    hand.key(Key::Tab, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.texts("Velocity").is_empty(), "the list is closed");
    hand.typed(") + sq");
    hand.frames(2);
    let offer = hand.shown_beginning("sqrt(a)")[0];
    hand.click(offer);
    hand.frames(2);
    hand.typed("T)");
    hand.frames(2);
    assert_eq!(stated(&hand), "T", "it is still being typed");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(stated(&hand), "T*mag(Velocity) + sqrt(T)");
    assert_eq!(hand.steps(), 1);
}

#[test]
fn keys_that_leave_the_field_change_nothing_where_nothing_was_typed() {
    let mut hand = Hand::with_file(&CALCULATOR.replace("\"T\"", "\"mag(Velocity)\""), "data.vtk", DATA);
    hand.editor.selection = ["sum".to_string()].into();
    hand.frames(3);
    hand.click_on("sum.expression");
    hand.key(Key::End, Modifiers::NONE);
    for _ in 0..4 {
        hand.key(Key::ArrowLeft, Modifiers::NONE);
    }
    hand.frames(2);
    hand.key(Key::Tab, Modifiers::NONE);
    hand.frames(2);
    assert_eq!((stated(&hand).as_str(), hand.steps()), ("mag(Velocity)", 0));
    // Escape closes the list that something typed opens, and Enter then takes what stands there.
    let mut hand = in_field();
    hand.typed(" + Ve");
    hand.frames(2);
    assert!(!hand.shown_beginning("Velocity:").is_empty());
    hand.key(Key::Escape, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.shown_beginning("Velocity:").is_empty());
    hand.typed("locity:0");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(stated(&hand), "T + Velocity:0");
}

#[test]
fn a_fault_is_pointed_at_where_it_is() {
    let mut hand = in_field();
    hand.typed(" + (T");
    hand.frames(2);
    assert!(hand.texts("^").is_empty(), "the end may come");
    hand.typed("] * 2");
    hand.frames(2);
    let field = hand.rect("sum.expression");
    let [caret] = hand.texts("^")[..] else { panic!("one caret") };
    assert!(field.x_range().contains(caret.x) && caret.y > field.center().y, "{caret} {field}");
    assert!(!hand.shown_beginning("the expression cannot be read: found ']' at character 7").is_empty());
    for _ in 0.."] * 2".len() {
        hand.key(Key::Backspace, Modifiers::NONE);
    }
    hand.typed(")");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!((stated(&hand).as_str(), hand.texts("^").len()), ("T + (T)", 0));
}

#[test]
fn a_fault_is_said_at_the_expression_alone() {
    let mut hand = in_field();
    hand.typed(" + ] * 2");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(3);
    assert!(stated(&hand).ends_with("] * 2") && !hand.editor.scene().faults.is_empty());
    let above = |text: &str| text.starts_with("sum: the expression cannot be read");
    assert_eq!((hand.shown(&above).len(), hand.texts("^").len()), (0, 1));
}

/// There is no character to point at.
#[test]
fn that_an_expression_is_empty_is_said_above_the_parameters() {
    let mut hand = Hand::with_file(&CALCULATOR.replace("\"T\"", "\"\""), "data.vtk", DATA);
    hand.editor.selection = ["sum".to_string()].into();
    hand.frames(3);
    let above = |text: &str| text.starts_with("sum: the expression");
    assert_eq!((hand.shown(&above).len(), hand.texts("^").len()), (1, 0), "{:?}", hand.editor.scene().faults);
}

#[test]
fn a_function_under_the_pointer_shows_its_signature() {
    let mut hand = Hand::with_file(&CALCULATOR.replace("\"T\"", "\"atan2(T, T)\""), "data.vtk", DATA);
    hand.editor.selection = ["sum".to_string()].into();
    hand.frames(3);
    let field = hand.rect("sum.expression");
    hand.move_to(field.left_center() + vec2(16.0, 0.0), Modifiers::NONE);
    hand.pause = 2.0;
    hand.frames(4);
    assert!(!hand.shown_beginning("atan2(y, x): angle").is_empty());
}

/// The arrays of the data come with units, and those of calculators before this one with the calculator.
#[test]
fn arrays_show_units_and_calculators() {
    let data =
        "4 1 1 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n1 0 tet 1 2 3 4\n1 1\nT, K\n1 1\n2 2\n3 3\n4 4\n";
    let text = CALCULATOR.replace("data.vtk", "data.inp")
        + "\n[nodes.more]\ntype = \"calculator\"\nexpression = \"T\"\n\
                                                             inputs = { grid = \"sum\" }\n";
    let mut hand = Hand::with_file(&text, "data.inp", data);
    let document = hand.editor.document().clone();
    let registry = voltet_nodes::registry().unwrap();
    let labels = |hand: &Hand, node: &str| {
        let found = hand.editor.arrays.feeding(&hand.ctx, &document, &registry, node);
        found.choices().iter().map(|choice| choice.label.clone()).collect::<Vec<_>>()
    };
    let of_file = "T  (points, 1 to 4 K)".to_string();
    until(&mut hand, "the arrays are found", |hand| labels(hand, "sum").contains(&of_file));
    let [all, before] = ["more", "sum"].map(|node| labels(&hand, node));
    assert_eq!(all, [before, vec!["sum  (computed by sum)".to_string()]].concat());
    // A result of the name of an array takes its place.
    let named = |name: &str| vec![voltet_document::Edit::set("sum", "name", name.into())];
    hand.editor.edit("name".into(), &named("T"));
    let renamed = hand.editor.document().clone();
    let found = hand.editor.arrays.feeding(&hand.ctx, &renamed, &registry, "more");
    let labels: Vec<&str> = found.choices().iter().map(|choice| choice.label.as_str()).collect();
    assert_eq!(labels, ["block  (cells, 0 to 0)", "T  (computed by sum)"]);
    hand.editor.edit("name".into(), &named("sum"));
    hand.editor.selection = ["more".to_string()].into();
    hand.frames(3);
    hand.click_on("more.expression");
    hand.key(Key::End, Modifiers::NONE);
    hand.typed("+su");
    hand.frames(2);
    assert!(!hand.texts("sum  (computed by sum)").is_empty());
}

#[test]
fn arrays_are_offered_where_the_expression_is_computed() {
    let cells = "CELL_DATA 1\nSCALARS Tc double 1\nLOOKUP_TABLE default\n5\n";
    for (association, own, other) in [("", "T  (points", "Tc  (cells"), ("cell", "Tc  (cells", "T  (points")]
    {
        let stated = format!("name = \"sum\"\nassociation = \"{association}\"");
        let text = match association {
            "" => CALCULATOR.to_string(),
            _ => CALCULATOR.replace("name = \"sum\"", &stated).replace("\"T\"", "\"Tc\""),
        };
        let mut hand = Hand::with_file(&text, "data.vtk", &(DATA.to_string() + cells));
        hand.editor.selection = ["sum".to_string()].into();
        hand.frames(3);
        until(&mut hand, "the arrays are found", |hand| {
            let (document, registry) = (hand.editor.document(), voltet_nodes::registry().unwrap());
            hand.editor.arrays.feeding(&hand.ctx, document, &registry, "sum").choices().len() > 4
        });
        hand.click_on("sum.expression");
        hand.key(Key::End, Modifiers::NONE);
        hand.typed(" + t");
        hand.frames(2);
        assert_eq!((hand.shown_beginning(own).len(), hand.shown_beginning(other).len()), (1, 0), "{own}");
    }
}

/// The reader does as it is asked: the wrong name stands in another node.
#[test]
fn an_array_that_is_not_there_is_a_fault_of_the_node_that_names_it() {
    let drawn = TEXT
        .replace(
            "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
            "type = \"reader\"\npath = \"data.vtk\"\nscalar = \"T\"",
        )
        .replace("inputs = { grid = \"grid\" }", "inputs = { grid = \"sum\" }");
    let calculator = |expression: &str| {
        let keys = format!("expression = \"{expression}\"\nname = \"sum\"\ninputs = {{ grid = \"grid\" }}");
        format!("{drawn}\n[nodes.sum]\ntype = \"calculator\"\n{keys}\n")
    };
    let widget = "kind = \"gaussian-nd\"\nfields = [\"Q\"]\ncolor = [1.0, 0.5, 0.15]\nextinction = 4.0\ncentre = [1.0]\n\
                  sigma = [1.0]\n\n[nodes.view]";
    let function = calculator("2*T").replace("[nodes.view]", &format!("[[nodes.look.widgets]]\n{widget}"));
    let method = calculator("2*T")
        .replace("\"gradient-magnitude\"\n", "\"gradient-magnitude\"\nmethod = \"array\"\narray = \"Q\"\n");
    for (text, node) in [(calculator("T + Q"), "sum"), (function, "look"), (method, "gradient")] {
        let mut hand = Hand::with_file(&text, "data.vtk", DATA);
        hand.editor.selection = ["view".to_string()].into();
        hand.frames(3);
        let failure = hand.editor.scene().failure.unwrap_or_else(|| panic!("{node}: nothing fails"));
        assert_eq!(failure.location.node.as_deref(), Some(node), "{failure}");
        assert!(failure.what.contains("'Q'") && hand.sees(&format!("Show '{node}'")), "{failure}");
        assert!(!hand.sees("Show 'grid'"), "{node}");
    }
}
