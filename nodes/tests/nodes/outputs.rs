//! Files of `image-writer` that hold more than a picture: layers, and annotations as shapes.

use super::graph;
use std::path::Path;
use voltet_core::Result;
use voltet_graph::{NoObserver, RunReport};

/// The run of a pipeline with these lines of the writer, and these further nodes.
fn run(folder: &Path, writer: &str, more: &str) -> Result<RunReport> {
    let text = format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"wavelet\"\nresolution = [4, 4, 4]\n\
         [nodes.look]\ntype = \"transfer-function\"\ninputs = {{ volume = \"grid\" }}\n\
         [[nodes.look.widgets]]\nkind = \"colormap\"\nextinction = 1.0\n\
         [nodes.view]\ntype = \"camera\"\nview = \"isometric\"\nzoom = 0.8\nsize = [400, 300]\n\
         inputs = {{ volume = \"grid\" }}\n\
         [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
         inputs = {{ volume = \"grid\", transfer_function = \"look\", camera = \"view\" }}\n\
         [nodes.figure]\ntype = \"annotation\"\ntitle = \"{{scalar}}\"\naxes = \"box\"\n\
         inputs = {{ image = \"picture\", transfer_function = \"look\", volume = \"grid\", camera = \"view\" }}\n\
         [nodes.file]\ntype = \"image-writer\"\n{writer}\n{more}\n"
    );
    voltet_nodes::session().run(&graph(&text, folder)?, &NoObserver)
}

fn stages(report: &RunReport) -> Vec<&str> {
    let picture = report.nodes.iter().find(|node| node.name == "picture").unwrap();
    picture.stages.keys().map(String::as_str).collect()
}

#[test]
fn layers_are_computed_where_a_file_holds_them_alone() {
    let folder = tempfile::tempdir().unwrap();
    let figure = "inputs = { image = \"figure\" }";
    let plain = run(folder.path(), &format!("path = \"plain.exr\"\n{figure}"), "").unwrap();
    assert!(!stages(&plain).contains(&"layers"), "{:?}", stages(&plain));
    let writer = format!("path = \"layers.exr\"\nlayers = [\"depth\", \"cell\"]\n{figure}");
    let beside =
        "[nodes.beside]\ntype = \"image-writer\"\npath = \"beside.exr\"\ninputs = { image = \"figure\" }";
    let report = run(folder.path(), &writer, beside).unwrap();
    assert!(stages(&report).contains(&"layers"), "{:?}", stages(&report));
    let holds = |name: &str, channel: &str| {
        let file = std::fs::read(folder.path().join(name)).unwrap();
        let header = &file[..file.len().min(2000)];
        header.windows(channel.len() + 2).any(|part| part == format!("\0{channel}\0").as_bytes())
    };
    for (name, has_layers) in [("plain.exr", false), ("layers.exr", true), ("beside.exr", false)] {
        assert_eq!(["depth", "cell"].map(|channel| holds(name, channel)), [has_layers; 2], "{name}");
        assert!(!holds(name, "first_hit"), "{name}");
    }
}

#[test]
fn layers_that_no_picture_or_file_has_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |writer: &str, more: &str| run(folder.path(), writer, more).unwrap_err().to_string();
    let figure = "inputs = { image = \"figure\" }";
    let wrong = refused(&format!("path = \"a.exr\"\nlayers = [\"detph\"]\n{figure}"), "");
    assert!(wrong.contains("no such layer") && wrong.contains("'depth'"), "{wrong}");
    let wrong = refused(&format!("path = \"a.png\"\nlayers = [\"depth\"]\n{figure}"), "");
    assert!(wrong.contains("png holds no layers") && wrong.contains(".exr"), "{wrong}");
    let plane = "[nodes.plane]\ntype = \"histogram\"\ninputs = { volume = \"g\" }\n\
                 [nodes.g]\ntype = \"gradient-magnitude\"\ninputs = { grid = \"grid\" }";
    let wrong =
        refused("path = \"a.exr\"\nlayers = [\"depth\"]\ninputs = { image = \"plane.image\" }", plane);
    assert!(wrong.contains("the picture has no layers") && wrong.contains("renderer"), "{wrong}");
}

#[test]
fn a_drawing_has_its_annotation_as_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let count = |text: &str, element: &str| text.matches(element).count();
    run(folder.path(), "path = \"bare.svg\"\ninputs = { image = \"picture\" }", "").unwrap();
    let bare = read("bare.svg");
    assert_eq!([count(&bare, "<image"), count(&bare, "<path"), count(&bare, "<rect")], [1, 0, 0]);
    let more = "[nodes.again]\ntype = \"annotation\"\ntitle = \"\"\n\
                texts = [{ kind = \"border\", text = \"by {scalar}\", at = \"bottom-left\" }]\n\
                inputs = { image = \"figure\", volume = \"grid\" }\n\
                [nodes.both]\ntype = \"image-writer\"\npath = \"both.svg\"\ninputs = { image = \"again\" }";
    run(folder.path(), "path = \"figure.svg\"\ninputs = { image = \"figure\" }", more).unwrap();
    let (figure, both) = (read("figure.svg"), read("both.svg"));
    assert_eq!(count(&figure, "<image"), 1);
    // Ticks, letters and the box, and a rectangle for each pixel of the bar.
    assert!(count(&figure, "<path") > 40 && count(&figure, "<rect") > 100, "{figure}");
    // An annotation over another adds its shapes: rim and ink of one line.
    assert_eq!(count(&both, "<path"), count(&figure, "<path") + 2);
    assert!(figure.contains("<voltet:pipeline>[pipeline]"), "{figure}");
}

#[test]
fn texts_of_ones_own_are_checked_and_give_way() {
    let folder = tempfile::tempdir().unwrap();
    let with = |texts: &str| {
        let more = format!(
            "[nodes.again]\ntype = \"annotation\"\ntexts = [{texts}]\n\
             inputs = {{ image = \"figure\", volume = \"grid\" }}"
        );
        run(folder.path(), "path = \"a.png\"\ninputs = { image = \"again\" }", &more)
    };
    let corner = "{ kind = \"border\", text = \"corner\", at = \"top-right\" }";
    let report = with(&format!("{corner}, {corner}")).unwrap();
    assert_eq!(report.warnings, Vec::<String>::new());
    let point = "{ kind = \"point\", text = \"point\", at = [0.5, 0.5], align = \"middle\" }";
    let report = with(&format!("{point}, {point}")).unwrap();
    assert!(
        matches!(&report.warnings[..], [one] if one.contains("no room for the text 'point'")),
        "{:?}",
        report.warnings
    );
    for (text, wanted) in [
        ("{ kind = \"border\", text = \"{tme}\" }", "{time}"),
        ("{ kind = \"border\", text = \"{time}\" }", "a file that says its time"),
        ("{ kind = \"point\", text = \"a\", at = [0.5, 1.5] }", "from 0 to 1"),
        ("{ kind = \"border\" }", "text"),
    ] {
        let error = with(text).unwrap_err().to_string();
        assert!(error.contains(wanted), "{text}: {error}");
    }
}
