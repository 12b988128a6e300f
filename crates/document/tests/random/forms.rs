//! The texts that are edited: those that ship, and others written in every way that TOML allows.

use std::path::Path;

pub fn shipped() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    let read = |path: &std::path::PathBuf| std::fs::read_to_string(path).unwrap();
    files.iter().map(|path| (path.display().to_string(), read(path))).collect()
}

pub fn unusual() -> Vec<(&'static str, String)> {
    let quickstart = shipped().into_iter().find(|(name, _)| name.ends_with("quickstart.toml")).unwrap().1;
    vec![
        ("CRLF", quickstart.replace('\n', "\r\n")),
        ("no line end at the end", quickstart.trim_end().to_string()),
        ("both line ends", quickstart.replacen('\n', "\r\n", 30)),
        ("nodes in one line", IN_ONE_LINE.into()),
        ("nodes as one table", ONE_TABLE.into()),
        ("keys with points", POINTS.into()),
        ("sub-tables", SUB_TABLES.into()),
        ("lists over lines", OVER_LINES.into()),
        ("names with points and spaces", QUOTED.into()),
    ]
}

const IN_ONE_LINE: &str = r#"pipeline = { format = 1 }
nodes = { grid = { type = "reader", path = "a.vtu" }, look = { type = "transfer-function", widgets = [{ kind = "uniform", color = [1, 2, 3] }, { kind = "b" }] }, view = { type = "camera" }, picture = { type = "renderer", inputs = { volume = "grid", camera = "view", transfer_function = "look" } } } # all
"#;

const ONE_TABLE: &str = r#"
pipeline.format = 1

[nodes] # all of them
# the grid
grid = { type = "reader", path = "a.vtu" }
look.type = "transfer-function"
look.widgets = [
  { kind = "uniform" },
]
view = { type = "camera", size = [1, 2] }
picture.type = "renderer"
picture.inputs.volume = "grid"
picture.inputs.camera = "view"
"#;

const POINTS: &str = r#"pipeline.format = 1
nodes.grid.type = "reader"
nodes.grid.path = "a.vtu"
# the look
nodes.look.type = "transfer-function"
nodes.look.widgets = [ { kind = "uniform", region = { s = [1, 2] } }, { kind = "x" } ]
nodes.picture.type = "renderer"
nodes.picture.inputs.volume = "grid"
nodes.picture.inputs.transfer_function = "look"
nodes.picture.shading.light.direction = [1, 0, 0]
"#;

const SUB_TABLES: &str = r#"
[pipeline]
format = 1

[nodes.picture.inputs]   # before its node
volume = "grid"          # from the reader
camera = "view"

[nodes.picture]
type = "renderer"

[nodes.grid]
type = "reader"

  [nodes.look]
  type = "transfer-function"

  # one
  [[nodes.look.widgets]]
  kind = "uniform"

    [nodes.look.widgets.region]
    s = [1, 2]

  # two
  [[nodes.look.widgets]]
  kind = "gaussian"
  region.s = [3, 4]
  region.g = [3, 4]

[nodes.view]
type = "camera"

[editor.nodes]
grid = [1, 2] # here
view = { at = [3, 4], strange = 1979-05-27 }

[editor]
frames = [{ title = "f", at = [0, 0], size = [10, 10] }]
other = "kept"
"#;

const OVER_LINES: &str = r#"[pipeline]
format = 1
title = """
over
lines [nodes.no]
# no comment
"""

[nodes.grid]
type = "reader"
arrays = [
  # first
  "a", # of a
  "b"  # of b
  # last
]

[nodes.look]
type = "transfer-function"
points = [[0, 0], [1, 1], # two
  [2, 2],]
widgets = [
  { kind = "uniform", color = [
    1, 2,
    3,
  ] }, # one
  # before two
  { kind = "gaussian" }
]
inputs = { widgets = [ "p", "q.transfer_function", ], volume = "grid" }

[nodes.p]
type = "probe"
inputs = { volume = "grid" }
# of p

# of nobody

[nodes.q]
type = "probe"
inputs = { volume = "grid", }
"#;

const QUOTED: &str = r#"
[pipeline]
format = 1

[nodes."a.b"]
type = "reader"
"odd key" = 1

[nodes.'a b']
type = "gradient-magnitude"
inputs.grid = "a.b"

[nodes.a]
type = "histogram"
inputs = { volume = 'a b' }

["nodes".c]
"type" = "image-writer"
inputs."image" = "a.image"

[nodes."q\"\u00e9"]
type = "report-writer"
inputs = { report = "a.report" }
"#;
