//! Single edits, in every way in which files are written.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use voltet_document::{AnnotationId, Document, Edit, Path};
use voltet_graph::{LocatedValue, ParameterValue};

const FILE: &str = "\
# A file.

[pipeline]
format = 1

# What is read.
[nodes.grid]
type = \"reader\" # a reader
path = \"a.vtu\"

[nodes.gradient]
type = \"gradient-magnitude\"
inputs = { grid = \"grid\" } # fed

# By itself.

[nodes.look]
type = \"transfer-function\"

# The first.
[[nodes.look.widgets]]
kind = \"uniform\" # all
color = [1, 2.0, 3]

[[nodes.look.widgets]]
kind = \"gaussian\"
centre = [
  1.0, # s
  2.0, # g
]
# end of look

# The last.
[nodes.view]
type = \"camera\"
size = [8, 6]
";

fn number(x: f64) -> ParameterValue {
    ParameterValue::Number(x)
}

fn list(parts: &[f64]) -> ParameterValue {
    ParameterValue::List(parts.iter().map(|x| LocatedValue::from(ParameterValue::Number(*x))).collect())
}

/// Carries edits out and holds what changed, line by line, against what is wanted: lines with - are gone, with + new.
fn changes(text: &str, edits: &[Edit], wanted: &str) {
    let mut document = Document::from_text(text.to_string(), None);
    for edit in edits {
        document.edit(edit).unwrap_or_else(|error| panic!("{edit:?}: {error}"));
    }
    let after = document.text().to_string();
    let difference = difference(text, &after);
    assert_eq!(difference, wanted, "the whole:\n{after}");
    while document.undo() {}
    assert_eq!(document.text(), text);
    while document.redo() {}
    assert_eq!(document.text(), after);
}

/// The lines that differ, by the longest common sequence.
fn difference(old: &str, new: &str) -> String {
    let (a, b): (Vec<&str>, Vec<&str>) = (old.split('\n').collect(), new.split('\n').collect());
    let mut length = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in (0..a.len()).rev() {
        for k in (0..b.len()).rev() {
            length[i][k] =
                if a[i] == b[k] { length[i + 1][k + 1] + 1 } else { length[i + 1][k].max(length[i][k + 1]) };
        }
    }
    let (mut i, mut k, mut text) = (0, 0, String::new());
    while i < a.len() || k < b.len() {
        if i < a.len() && k < b.len() && a[i] == b[k] {
            (i, k) = (i + 1, k + 1);
        } else if i < a.len() && (k == b.len() || length[i + 1][k] >= length[i][k + 1]) {
            text += &format!("-{}\n", a[i]);
            i += 1;
        } else {
            text += &format!("+{}\n", b[k]);
            k += 1;
        }
    }
    text
}

#[test]
fn values_change_where_they_stand() {
    changes(
        FILE,
        &[Edit::set("grid", "path", ParameterValue::Text("b c.vtu".into()))],
        "-path = \"a.vtu\"\n+path = \"b c.vtu\"\n",
    );
    changes(FILE, &[Edit::set("look", "widgets.1.centre.1", number(2.5))], "-  2.0, # g\n+  2.5, # g\n");
    changes(
        FILE,
        &[Edit::set("look", "widgets.1.centre", list(&[1.0, 2.5, 7.0]))],
        "-  2.0, # g\n+  2.5, # g\n+  7.0,\n",
    );
    changes(
        FILE,
        &[Edit::set("look", "widgets.0.color", list(&[1.0, 2.0, 3.5]))],
        "-color = [1, 2.0, 3]\n+color = [1.0, 2.0, 3.5]\n",
    );
}

#[test]
fn new_keys_stand_before_what_feeds_the_node_and_in_the_table_that_is_there() {
    changes(
        FILE,
        &[Edit::set("gradient", "method", ParameterValue::Text("quadratic-fit".into()))],
        "+method = \"quadratic-fit\"\n",
    );
    let text = after(FILE, &[Edit::set("gradient", "method", ParameterValue::Text("x".into()))]);
    assert!(text.contains("type = \"gradient-magnitude\"\nmethod = \"x\"\ninputs ="), "{text}");
    changes(FILE, &[Edit::set("look", "widgets.1.sigma.low", number(1.0))], "+sigma = { low = 1.0 }\n");
    changes(FILE, &[Edit::set("view", "light.a.b", number(1.0))], "+light = { a = { b = 1.0 } }\n");
    changes(FILE, &[Edit::Title(Some("T".into()))], "+title = \"T\"\n");
}

#[test]
fn a_node_goes_with_its_own_comments_and_wires_and_nobody_else_s() {
    let gone = "-# What is read.\n-[nodes.grid]\n-type = \"reader\" # a reader\n-path = \"a.vtu\"\n-\n-inputs = { grid = \"grid\" } # fed\n";
    changes(FILE, &[Edit::RemoveNodes(vec!["grid".into()])], gone);
    let look = after(FILE, &[Edit::RemoveNodes(vec!["look".into()])]);
    assert!(
        look.ends_with(
            "# fed\n\n# By itself.\n\n# The last.\n[nodes.view]\ntype = \"camera\"\nsize = [8, 6]\n"
        ),
        "{look}"
    );
    let view = after(FILE, &[Edit::RemoveNodes(vec!["view".into()])]);
    assert!(view.ends_with("]\n# end of look\n"), "{view}");
}

#[test]
fn wires_follow_a_name_and_lists_of_them_grow_and_shrink() {
    let rename = Edit::Rename { node: "grid".into(), to: "my grid".into() };
    let wanted = "-[nodes.grid]\n+[nodes.\"my grid\"]\n-inputs = { grid = \"grid\" } # fed\n+inputs = { grid = \"my grid\" } # fed\n";
    changes(FILE, &[rename], wanted);
    let connect = |source: &str| Edit::Connect {
        node: "look".into(),
        port: "widgets".into(),
        source: source.into(),
        beside: true,
    };
    changes(FILE, &[connect("a")], "+inputs = { widgets = \"a\" }\n");
    changes(FILE, &[connect("a"), connect("b"), connect("b")], "+inputs = { widgets = [\"a\", \"b\"] }\n");
    let disconnect = |source: Option<&str>| Edit::Disconnect {
        node: "look".into(),
        port: "widgets".into(),
        source: source.map(str::to_string),
    };
    changes(FILE, &[connect("a"), connect("b"), disconnect(Some("a"))], "+inputs = { widgets = [\"b\"] }\n");
    changes(FILE, &[connect("a"), connect("b"), disconnect(None)], "");
}

#[test]
fn widgets_come_and_go_with_their_comments() {
    let list = || "widgets".into();
    let remove = Edit::Unset { node: "look".into(), path: "widgets.0".into() };
    let without = after(FILE, &[remove]);
    assert!(
        without.contains("type = \"transfer-function\"\n\n[[nodes.look.widgets]]\nkind = \"gaussian\""),
        "{without}"
    );
    assert!(!without.contains("# The first."), "{without}");
    let twice = after(FILE, &[Edit::Duplicate { node: "look".into(), list: list(), place: 0 }]);
    let first = "# The first.\n[[nodes.look.widgets]]\nkind = \"uniform\" # all\ncolor = [1, 2.0, 3]\n\n";
    assert_eq!(twice, FILE.replace(first, &first.repeat(2)));
    let moved = after(FILE, &[Edit::MoveEntry { node: "look".into(), list: list(), from: 1, to: 0 }]);
    let (gaussian, other) = (moved.find("gaussian").unwrap(), moved.find("# The first.").unwrap());
    assert!(
        gaussian < moved.find("# end of look").unwrap() && moved.find("# end of look").unwrap() < other,
        "{moved}"
    );
    let entry = ParameterValue::Table(vec![voltet_graph::Field {
        name: "kind".into(),
        origin: Default::default(),
        setting: ParameterValue::Text("new".into()).into(),
    }]);
    let insert = |place| Edit::Insert { node: "look".into(), list: list(), place, entry: entry.clone() };
    let last = after(FILE, &[insert(2)]);
    assert!(
        last.contains("# end of look\n\n[[nodes.look.widgets]]\nkind = \"new\"\n\n# The last."),
        "{last}"
    );
    let new = "[[nodes.look.widgets]]\nkind = \"new\"\n\n";
    assert_eq!(after(FILE, &[insert(0)]), FILE.replace(first, &format!("{new}{first}")));
}

#[test]
fn the_view_takes_one_line_a_node_and_all_others_keep_their_places() {
    let mut document = Document::from_text(FILE.into(), None);
    let before = document.position("view");
    document.edit(&Edit::MoveNodes(vec![("grid".into(), [10.4, -3.0])])).unwrap();
    assert_eq!((document.position("grid"), document.position("view")), ([10.0, -3.0], before));
    let added = difference(FILE, document.text());
    assert_eq!(added.lines().count(), 6, "{added}");
    assert!(added.contains("+[editor.nodes]\n") && added.contains("+grid = [10, -3]\n"), "{added}");
    // A new node stands with the nodes, before what the editor keeps.
    document
        .edit(&Edit::AddNode {
            name: "n".into(),
            node_type: "t".into(),
            settings: Vec::new(),
            at: Some([1.0, 2.0]),
        })
        .unwrap();
    let text = document.text();
    assert!(text.find("[nodes.n]").unwrap() < text.find("[editor.nodes]").unwrap(), "{text}");
    assert!(text.contains("size = [8, 6]\n\n[nodes.n]\ntype = \"t\"\n\n[editor.nodes]\n"), "{text}");
}

#[test]
fn what_cannot_be_done_says_why_and_changes_nothing() {
    let mut document = Document::from_text(FILE.into(), None);
    for (edit, wanted) in [
        (Edit::set("gird", "a", number(1.0)), "there is no node 'gird'; expected 'grid', the nearest"),
        (Edit::set("grid", "path.x", number(1.0)), "no parts"),
        (Edit::set("look", "widgets.7.kind", number(1.0)), "no such entry"),
        (Edit::Rename { node: "grid".into(), to: "view".into() }, "there is a node 'view' already"),
        (Edit::Rename { node: "grid".into(), to: "".into() }, "needs a name"),
        (Edit::MoveEntry { node: "look".into(), list: "widgets".into(), from: 0, to: 2 }, "no such entry"),
        (Edit::RemoveAnnotation(AnnotationId::Frame(0)), "no such thing"),
    ] {
        let error = document.edit(&edit).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    // The first of several that can be done is undone with the second.
    let both = [Edit::Title(Some("a".into())), Edit::RemoveAnnotation(AnnotationId::Frame(0))];
    assert!(document.edit_all("both".into(), &both, None).is_err());
    assert_eq!((document.text(), document.revision(), document.history().position()), (FILE, 0, (0, 0)));
}

#[test]
fn keys_with_points_within_a_value_are_left_to_hands() {
    let text =
        "pipeline = { format = 1 }\nnodes = { a.type = \"x\", a.path = \"y\", b = { type = \"z\" } }\n";
    let mut document = Document::from_text(text.into(), None);
    for edit in [
        Edit::RemoveNodes(vec!["a".into()]),
        Edit::Rename { node: "a".into(), to: "c".into() },
        Edit::set("a", "more", number(1.0)),
    ] {
        let error = document.edit(&edit).unwrap_err().to_string();
        assert!(error.contains("by keys with points within a value: found a.type"), "{error}");
        assert_eq!(document.text(), text);
    }
    document.edit(&Edit::set("a", "path", ParameterValue::Text("w".into()))).unwrap();
    assert_eq!(document.text(), text.replace("\"y\"", "\"w\""));
}

#[test]
fn a_text_that_is_no_toml_can_be_mended() {
    let broken = FILE.replace("size = [8, 6]", "size = [8, ");
    let mut document = Document::from_text(broken.clone(), None);
    assert!(!document.is_toml());
    assert_eq!(document.text(), broken);
    assert_eq!(document.pipeline().nodes.len(), 4, "what stands before can be read");
    let error = document.edit(&Edit::Title(None)).unwrap_err().to_string();
    assert!(error.contains("not valid TOML"), "{error}");
    document.edit(&Edit::Text(FILE.into())).unwrap();
    assert!(document.is_toml());
    document.edit(&Edit::Title(Some("t".into()))).unwrap();
    while document.undo() {}
    assert_eq!(document.text(), broken);
}

/// The text after edits.
fn after(text: &str, edits: &[Edit]) -> String {
    let mut document = Document::from_text(text.to_string(), None);
    edits.iter().for_each(|edit| document.edit(edit).unwrap());
    document.text().to_string()
}

#[test]
fn a_comment_above_or_behind_names_a_part_of_a_node() {
    let text = "[nodes.look]\ntype = \"transfer-function\"\n\n# of nobody\n\n# Bone: hard.\n# And white.\n[[nodes.look.widgets]]\nkind = \"a\"\n\
                \n[[nodes.look.widgets]] # skin\nkind = \"b\" # not this\n\n[[nodes.look.widgets]]\nkind = \"c\" # fat\n\n[[nodes.look.widgets]]\nkind = \"# no comment\"\n\
                \n[nodes.other]\nwidgets = [\n  { kind = \"d\" }, # muscle\n  # blood\n  { kind = \"e\" },\n]\n";
    let document = Document::from_text(text.into(), None);
    let comment = |node: &str, place: usize| document.comment(node, &Path::from("widgets").with(place));
    let of_look: Vec<_> = (0..5).map(|place| comment("look", place)).collect();
    let wanted = [Some("Bone: hard. And white."), Some("skin"), Some("fat"), None, None];
    assert_eq!(of_look, wanted.map(|words| words.map(String::from)));
    assert_eq!(
        [0, 1].map(|place| comment("other", place)),
        ["muscle", "blood"].map(|words| Some(words.into()))
    );
}

#[test]
fn what_is_no_prose_and_stands_above_several_entries_names_none() {
    let text = "[nodes.look]\n# Bone\nwidgets = [{ kind = \"a\" }, { kind = \"b\" }]\n\n[nodes.other]\nwidgets = [\n  # fat\n  \
                { kind = \"a\" }, { kind = \"b\" },\n  # -----\n  # extinction = 3.0\n  { kind = \"c\" },\n  # skin\n  # =====\n  \
                # 5.0\n  { kind = \"d\" },\n  # s = 3 is where it begins\n  { kind = \"e\" },\n  # { kind = \"f\" },\n  { kind = \"g\" },\n]\n";
    let document = Document::from_text(text.into(), None);
    let names = |node: &str, count: usize| -> Vec<_> {
        (0..count).map(|place| document.comment(node, &Path::from("widgets").with(place))).collect()
    };
    assert_eq!(names("look", 2), [None, None]);
    let wanted = [Some("fat"), None, None, Some("skin"), None, None];
    assert_eq!(names("other", 6), wanted.map(|words| words.map(String::from)));
}
