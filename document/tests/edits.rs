//! Single edits, in every way in which files are written.

use voltet_core::graph::{Datum, Setting};
use voltet_document::{Document, Edit};

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

fn number(x: f64) -> Datum {
    Datum::Number(x)
}

fn list(parts: &[f64]) -> Datum {
    Datum::List(parts.iter().map(|x| Setting::from(Datum::Number(*x))).collect())
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
    while document.undo().unwrap() {}
    assert_eq!(document.text(), text);
    while document.redo().unwrap() {}
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
        &[Edit::set("grid", "path", Datum::Text("b c.vtu".into()))],
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
