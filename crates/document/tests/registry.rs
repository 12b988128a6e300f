//! Documents with the node types that ship: faults at their places, what fits, copies, the order of the view.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::PathBuf;
use voltet_document::{Diagnostic, Document, Edit, FaultTarget, Group, arrange, giving, search, taking};
use voltet_graph::{Graph, PortType, Registry};

fn registry() -> Registry {
    voltet_nodes::registry().unwrap()
}

fn shipped(name: &str) -> Document {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines");
    Document::open(&folder.join(name)).unwrap()
}

/// Node, part and message of a fault.
fn told(fault: &Diagnostic) -> (Option<&str>, String, String) {
    let part = match &fault.target {
        FaultTarget::Whole => String::new(),
        FaultTarget::Parameter(path) => path.to_string(),
        FaultTarget::Input(port) => format!("→{port}"),
    };
    (fault.node.as_deref(), part, fault.error.to_string())
}

#[test]
fn every_mistake_of_a_file_is_at_its_place_and_the_rest_can_be_built() {
    let document = shipped("quickstart.toml");
    let registry = registry();
    assert!(document.faults(&registry).is_empty());
    let text = document
        .text()
        .replace("[pipeline]\nformat = 1", "[pipeline]\nformat = 9")
        .replace("type = \"image-writer\"", "type = \"image-riter\"")
        .replace("extinction = 60.0", "extinction = -60.0\ncolour = 3")
        .replace("sigma = [0.35, 0.025]", "sigma = [0.35, \"x\"]")
        .replace("fov_y = 24.5", "fov_y = 24.5\nnear = 1979-05-27")
        .replace("camera = \"view\"", "camera = \"veiw\"")
        .replace("transfer_function = \"look\", ", "");
    let broken = Document::from_text(text.clone(), Some("p.toml".into()));
    assert_eq!(broken.text(), text);
    let faults = broken.faults(&registry);
    let told: Vec<_> = faults.iter().map(told).collect();
    for (node, part, wanted) in [
        (None, "", "does not know the format: found 9"),
        (Some("view"), "near", "not a date"),
        (Some("look"), "widgets.3.extinction", "'extinction' is out of range"),
        (Some("look"), "widgets.3.colour", "unknown parameter 'colour'"),
        (Some("look"), "widgets.3.sigma.1", "no number relative to data"),
        (Some("file"), "", "unknown node type 'image-riter'"),
        (Some("picture"), "→camera", "there is no node 'veiw'"),
        (Some("picture"), "→transfer_function", "the input 'transfer_function' is not wired"),
    ] {
        let found =
            told.iter().filter(|told| told.0 == node && told.1 == part && told.2.contains(wanted)).count();
        assert_eq!(found, 1, "{node:?} {part} {wanted}: {told:#?}");
    }
    assert_eq!(faults.len(), 8, "{told:#?}");
    // Of one node: its own, and those of the text.
    let of_look = broken.faults_of(&["look"], &registry);
    let own = of_look.iter().filter(|fault| fault.node.as_deref() == Some("look")).count();
    assert_eq!((own, of_look.len()), (3, 5), "{:#?}", of_look.iter().map(self::told).collect::<Vec<_>>());
    assert!(told.iter().all(|told| told.2.contains("p.toml:")), "{told:#?}");
    // What feeds the gradient is whole.
    let fed = voltet_document::links::upstream(&broken.pipeline().nodes, "gradient");
    let nodes: Vec<_> =
        broken.pipeline().nodes.iter().filter(|node| fed.contains(&node.name)).cloned().collect();
    assert!(Graph::faults(&nodes, &registry, PathBuf::new()).is_empty());
}

#[test]
fn every_node_type_has_its_group_and_is_found_by_words() {
    let registry = registry();
    let of = |group: Group| -> Vec<&str> {
        registry.iter().filter(|node| Group::from_node(node) == group).map(|node| node.name).collect()
    };
    assert_eq!(of(Group::Sources), ["reader", "wavelet"]);
    assert_eq!(of(Group::Filters), ["calculator", "gradient-magnitude", "multi-gradient", "threshold"]);
    assert_eq!(of(Group::Surfaces), ["contour", "slice", "boundary", "edges", "surface-reader"]);
    assert_eq!(of(Group::Findings), ["histogram", "bands"]);
    assert_eq!(of(Group::TransferFunctions), ["probe", "transfer-function"]);
    assert_eq!(of(Group::Cameras), ["camera"]);
    assert_eq!(of(Group::Drawing), ["renderer", "gpu-renderer", "slice-image", "annotation"]);
    assert_eq!(of(Group::Stages), ["cull", "sort", "project", "composite"]);
    assert_eq!(of(Group::Writers), ["grid-writer", "image-writer", "report-writer"]);
    let names = |text: &str| -> Vec<&str> { search(&registry, text).iter().map(|node| node.name).collect() };
    assert_eq!(names("").len(), registry.iter().count());
    assert_eq!(names("rend")[..2], ["renderer", "gpu-renderer"]);
    assert_eq!(names("transfer function")[0], "transfer-function");
    assert_eq!(names("writer image")[0], "image-writer");
    assert!(names("clip").contains(&"renderer"), "by a parameter");
    assert_eq!(names("rendrer"), ["renderer"]);
    assert!(names("zzzzzz").is_empty());
    let fitting = |all: Vec<voltet_document::Fitting>| -> Vec<(&str, &str)> {
        all.iter().map(|fitting| (fitting.node.name, fitting.port.name)).collect()
    };
    assert_eq!(
        fitting(taking(&registry, PortType::Image)),
        [("annotation", "image"), ("image-writer", "image")]
    );
    assert!(
        fitting(taking(&registry, PortType::Grid)).contains(&("renderer", "volume")),
        "a grid serves as a volume"
    );
    assert!(!fitting(taking(&registry, PortType::Volume)).contains(&("gradient-magnitude", "grid")));
    assert_eq!(fitting(giving(&registry, PortType::Camera)), [("camera", "camera")]);
    assert!(fitting(giving(&registry, PortType::Image)).contains(&("histogram", "image")));
}

#[test]
fn what_cannot_be_joined_says_why() {
    let registry = registry();
    let mut document = shipped("probe.toml");
    let no = |document: &Document, from, to, wanted: &str| {
        let error = document.join(&registry, from, to).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    };
    no(&document, ("view", "camera"), ("picture", "volume"), "'volume' takes a volume: found a camera");
    no(&document, ("view", "camera"), ("picture", "camera"), "joined already");
    no(
        &document,
        ("look", "transfer_function"),
        ("look", "widgets"),
        "'look' would feed itself: found look → look",
    );
    no(&document, ("view", "cam"), ("picture", "camera"), "has no port 'cam'");
    document
        .edit(&Edit::AddNode {
            name: "more".into(),
            node_type: "transfer-function".into(),
            settings: Vec::new(),
            at: None,
        })
        .unwrap();
    let join = document.join(&registry, ("look", "transfer_function"), ("more", "widgets")).unwrap();
    document.edit(&join).unwrap();
    no(&document, ("more", "transfer_function"), ("look", "widgets"), "found look → more → look");
    // One more beside those that are there, and one in place of another.
    document.edit(&Edit::Disconnect { node: "more".into(), port: "widgets".into(), source: None }).unwrap();
    let beside = document.join(&registry, ("more", "transfer_function"), ("look", "widgets")).unwrap();
    document.edit(&beside).unwrap();
    assert!(
        document.text().contains("[\"pads\", \"pipes\", \"pins\", \"board\", \"more\"]"),
        "{}",
        document.text()
    );
    let other = document.join(&registry, ("grid", "grid"), ("picture", "volume")).unwrap();
    let Edit::Connect { beside, .. } = other else { panic!("{other:?}") };
    assert!(!beside, "it takes the place of the gradient");
    // An output of several is named.
    document
        .edit(&Edit::AddNode {
            name: "h".into(),
            node_type: "histogram".into(),
            settings: Vec::new(),
            at: None,
        })
        .unwrap();
    let image = document.join(&registry, ("h", "image"), ("file", "image")).unwrap();
    document.edit(&image).unwrap();
    assert!(document.text().contains("inputs = { image = \"h.image\" }"));
    assert_eq!(document.faults(&registry).len(), 1, "the histogram is not fed yet");
}

#[test]
fn copies_keep_their_words_and_the_wires_among_them() {
    let registry = registry();
    let mut document = shipped("probe.toml");
    let whole = document.text().to_string();
    let names = ["pins".to_string(), "look".to_string()];
    let text = document.copy(&names);
    assert!(text.starts_with("# Some pins only: a region and no mask."), "{text}");
    assert!(text.contains("# Widgets stated by hand go together"), "{text}");
    let fresh = document.paste(&text, [1000.0, 50.0]).unwrap();
    assert_eq!(fresh, ["pins_2", "look_2"]);
    let added = &document.text()[document.text().find("[nodes.pins_2]").unwrap()..];
    assert!(added.contains("widgets = [\"pads\", \"pipes\", \"pins_2\", \"board\"]"), "{added}");
    assert!(added.contains("inputs = { volume = \"gradient\" }"), "{added}");
    let corner =
        |axis: usize| fresh.iter().map(|name| document.position(name)[axis]).fold(f64::INFINITY, f64::min);
    assert_eq!((corner(0), corner(1)), (1000.0, 50.0));
    assert!(document.faults(&registry).is_empty(), "{:?}", document.faults(&registry));
    assert_eq!(document.history().undo_label(), Some("paste"));
    document.undo();
    assert_eq!(document.text(), whole);

    // Into an empty window: wires that lead nowhere stay behind.
    let mut other = Document::new();
    assert_eq!(other.paste(&text, [0.0, 0.0]).unwrap(), names);
    assert!(other.text().contains("widgets = [\"pins\"]"), "{}", other.text());
    assert!(!other.text().contains("gradient"), "{}", other.text());
    let copies = document.duplicate(&["view".into(), "picture".into()]).unwrap();
    assert_eq!(copies, ["view_2", "picture_2"]);
    let fed = "inputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view_2\" }";
    assert!(document.text().contains(fed), "{}", document.text());
    assert!(document.duplicate(&["nobody".into()]).is_err());
    assert!(document.paste("no nodes", [0.0; 2]).is_err());
}

#[test]
fn layers_lead_from_left_to_right_and_do_not_overlap() {
    for name in ["probe.toml", "stages.toml", "quickstart.toml"] {
        let document = shipped(name);
        let nodes = &document.pipeline().nodes;
        let size = |name: &str| [150.0, if name.len().is_multiple_of(2) { 90.0 } else { 200.0 }];
        let places = arrange::tidy(nodes, &size);
        assert_eq!(places, arrange::tidy(nodes, &size), "the same again");
        let at = |name: &str| places[nodes.iter().position(|node| node.name == name).unwrap()];
        for node in nodes {
            for source in node.inputs.iter().flat_map(voltet_document::links::sources) {
                let from = voltet_document::links::source(source, nodes).0;
                assert!(at(from)[0] + 150.0 < at(&node.name)[0], "{from} → {}", node.name);
            }
        }
        for (i, a) in nodes.iter().enumerate() {
            for b in &nodes[..i] {
                let apart = (at(&a.name)[0] - at(&b.name)[0]).abs() >= 150.0
                    || at(&a.name)[1] >= at(&b.name)[1] + size(&b.name)[1]
                    || at(&b.name)[1] >= at(&a.name)[1] + size(&a.name)[1];
                assert!(apart, "{name}: {} {}", a.name, b.name);
            }
        }
    }
}

/// Chains that share a camera.
#[test]
fn a_hundred_nodes_are_grouped_by_chains_side_by_side() {
    let chain = |i: usize| {
        format!(
            "[nodes.grid{i}]\ntype = \"wavelet\"\n[nodes.gradient{i}]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid{i}\" }}\n\
             [nodes.picture{i}]\ntype = \"renderer\"\ninputs = {{ volume = \"gradient{i}\", camera = \"view\" }}\n"
        )
    };
    let chains: String = (0..33).map(chain).collect();
    let document = Document::from_text(format!("[nodes.view]\ntype = \"camera\"\n{chains}"), None);
    let nodes = &document.pipeline().nodes;
    assert_eq!(nodes.len(), 100);
    let size = |name: &str| [150.0, if name.len().is_multiple_of(2) { 90.0 } else { 200.0 }];
    let places = arrange::tidy(nodes, &size);
    let corners = |range: std::ops::Range<usize>| {
        range.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], i| {
            let end = [0, 1].map(|k: usize| places[i][k] + size(&nodes[i].name)[k]);
            [[0, 1].map(|k: usize| low[k].min(places[i][k])), [0, 1].map(|k: usize| high[k].max(end[k]))]
        })
    };
    let boxes: Vec<_> =
        std::iter::once(corners(0..1)).chain((0..33).map(|i| corners(3 * i + 1..3 * i + 4))).collect();
    for (i, [low, high]) in boxes.iter().enumerate() {
        for [other_low, other_high] in &boxes[..i] {
            assert!(
                (0..2).any(|k| low[k] >= other_high[k] || other_low[k] >= high[k]),
                "chain {i} lies on another"
            );
        }
    }
    let [low, high] = corners(0..100);
    let aspect = (high[0] - low[0]) / (high[1] - low[1]);
    assert!((0.7..3.0).contains(&aspect), "{aspect}");
}

/// Pictures of one gradient, each with a transfer function and a writer; and surfaces of one picture.
#[test]
fn chains_of_one_node_and_nodes_of_one_layer_fill_a_rectangle() {
    let chain = |i: usize| {
        format!(
            "[nodes.look{i}]\ntype = \"transfer-function\"\n[nodes.picture{i}]\ntype = \"renderer\"\n\
             inputs = {{ volume = \"gradient\", transfer_function = \"look{i}\", camera = \"view\" }}\n\
             [nodes.file{i}]\ntype = \"image-writer\"\ninputs = {{ image = \"picture{i}\" }}\n"
        )
    };
    let head = "[nodes.view]\ntype = \"camera\"\n[nodes.grid]\ntype = \"wavelet\"\n[nodes.gradient]\n\
                type = \"gradient-magnitude\"\ninputs = { grid = \"grid\" }\n";
    let chains = head.to_string() + &(0..60).map(chain).collect::<String>();
    let surface =
        |i: usize| format!("[nodes.level{i}]\ntype = \"contour\"\ninputs = {{ volume = \"gradient\" }}\n");
    let names: Vec<String> = (0..60).map(|i| format!("\"level{i}\"")).collect();
    let layer = head.to_string()
        + &(0..60).map(surface).collect::<String>()
        + &format!(
            "[nodes.picture]\ntype = \"renderer\"\ninputs = {{ surfaces = [{}] }}\n",
            names.join(", ")
        );
    let size = [170.0, 130.0];
    for (text, count) in [(chains, 183), (layer, 64)] {
        let document = Document::from_text(text, None);
        let nodes = &document.pipeline().nodes;
        assert_eq!(nodes.len(), count);
        let places = arrange::tidy(nodes, &|_| size);
        for (i, a) in places.iter().enumerate() {
            let is_apart = |b: &[f64; 2]| (0..2).any(|k| (a[k] - b[k]).abs() >= size[k]);
            assert!(places[..i].iter().all(is_apart), "'{}' lies on another", nodes[i].name);
        }
        let length = |k: usize| {
            let along = || places.iter().map(|at| at[k]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min) + size[k]
        };
        let aspect = length(0) / length(1);
        assert!((0.7..3.0).contains(&aspect), "{count}: {} by {}", length(0), length(1));
    }
}

#[test]
fn nodes_are_brought_in_line() {
    use arrange::{Align, PlacedNode, align};
    let node =
        |name: &str, at: [f64; 2], size: [f64; 2]| PlacedNode { name: name.into(), position: at, size };
    let nodes = [
        node("a", [0.0, 0.0], [10.0, 10.0]),
        node("b", [50.0, 5.0], [30.0, 20.0]),
        node("c", [15.0, 40.0], [20.0, 10.0]),
    ];
    let moved =
        |how| align(&nodes, how).into_iter().map(|(name, at)| (name, at[0], at[1])).collect::<Vec<_>>();
    let at = |name: &str, x: f64, y: f64| (name.to_string(), x, y);
    assert_eq!(moved(Align::Left), [at("c", 0.0, 40.0), at("b", 0.0, 5.0)]);
    assert_eq!(moved(Align::Right), [at("a", 70.0, 0.0), at("c", 60.0, 40.0)]);
    assert_eq!(moved(Align::Top), [at("b", 50.0, 0.0), at("c", 15.0, 0.0)]);
    assert_eq!(moved(Align::Bottom), [at("a", 0.0, 40.0), at("b", 50.0, 30.0)]);
    assert_eq!(moved(Align::Centre), [at("a", 35.0, 0.0), at("c", 30.0, 40.0), at("b", 25.0, 5.0)]);
    assert_eq!(moved(Align::Middle), [at("a", 0.0, 20.0), at("b", 50.0, 15.0), at("c", 15.0, 20.0)]);
    assert_eq!(moved(Align::Across), [at("c", 20.0, 40.0)]);
    assert_eq!(moved(Align::Down), [at("b", 50.0, 15.0)]);
}
