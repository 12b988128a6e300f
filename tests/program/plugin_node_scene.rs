//! A pipeline whose reader, grid filter and image filter are one plug-in's.

const SCENE: &str = r#"[pipeline]
format = 1

[nodes.grid]
type = "WORD-reader"
path = "any.WORD"
scalar = "s"

[nodes.moved]
type = "WORD-grid"
inputs = { grid = "grid" }

[nodes.look]
type = "transfer-function"
unit_distance = 0.5

[[nodes.look.widgets]]
kind = "uniform"
color = [0.5, 1.0, 0.25]
extinction = 1.0
region = { s = [-10.0, 20.0] }

[nodes.view]
type = "camera"
eye = [-3.0, 0.4, 0.3]
target = [0.5, 0.5, 0.5]
size = [SIDE, SIDE]

[nodes.picture]
type = "renderer"
engine = "cpu"
inputs = { volume = "moved", transfer_function = "look", camera = "view" }

[nodes.toned]
type = "WORD-image"
inputs = { image = "picture" }

[nodes.file]
type = "image-writer"
path = "picture.exr"
inputs = { image = "toned" }
"#;

/// Its nodes' types begin with `word`, which is also the ending of the file that is read; the picture is a square of `side` pixels.
pub fn scene(word: &str, side: usize) -> String {
    SCENE.replace("WORD", word).replace("SIDE", &side.to_string())
}
