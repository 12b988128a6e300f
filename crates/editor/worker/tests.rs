use super::tests_superseding::worker_with_own;
use super::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Duration;
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{
    ArrayRef, Graph, LocatedValue, NoObserver, Node, NodeEntry, Observer, ParameterValue, Port, PortType,
};

/// The scene of the tests by hand, drawn stage by stage.
static TEXT: LazyLock<String> = LazyLock::new(|| {
    let scene = include_str!("../ui_tests/scene.toml");
    let (before, after) = scene.split_once("[nodes.picture]").unwrap();
    let (_, after) = after.split_once("[nodes.file]").unwrap();
    format!(
        "{before}[nodes.cells]
type = \"cull\"
inputs = {{ volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}
[nodes.order]
type = \"sort\"
inputs = {{ cells = \"cells\", camera = \"view\" }}
[nodes.cover]
type = \"project\"
inputs = {{ cells = \"order\", camera = \"view\" }}
[nodes.picture]
type = \"composite\"
inputs = {{ projection = \"cover\", transfer_function = \"look\" }}
[nodes.file]{after}"
    )
});

pub(super) fn nodes(text: &str) -> Vec<NodeEntry> {
    Pipeline::parse(text).unwrap().nodes
}

pub(super) fn wanted(nodes: Vec<NodeEntry>, folder: &std::path::Path) -> RenderRequest {
    RenderRequest { folder: folder.to_path_buf(), ..RenderRequest::of_picture(nodes) }
}

fn worker() -> Worker {
    Worker::start(&voltet_nodes::registry().unwrap(), Arc::new(|| {})).unwrap()
}

/// Waits until nothing is made any more.
pub(super) fn settle(worker: &Worker) {
    for _ in 0..6000 {
        if worker.shown(|shown| !shown.is_busy) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("the worker does not come to an end");
}

fn set(nodes: &mut [NodeEntry], node: &str, path: &[&str], datum: ParameterValue) {
    let node = nodes.iter_mut().find(|entry| entry.name == node).unwrap();
    node.set(path[0], &path[1..], LocatedValue::from(datum)).unwrap();
}

/// The names of the nodes that ran in the last full run.
fn ran(worker: &Worker) -> Vec<String> {
    worker.shown(|shown| {
        let report = shown.report.as_ref().unwrap();
        report.nodes.iter().filter(|node| !node.reused).map(|node| node.name.clone()).collect()
    })
}

#[test]
fn the_picture_is_that_of_a_run_bit_for_bit_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let worker = worker();
    let number = worker.draw(RenderRequest { coarse_first: true, ..wanted(nodes(&TEXT), folder.path()) });
    settle(&worker);
    let drawn = worker.shown(|shown| shown.pixels.clone().unwrap());
    assert_eq!((drawn.divisor, drawn.number, drawn.size()), (1, number, [160, 120]));
    assert!(!folder.path().join("picture.png").exists());
    let registry = voltet_nodes::registry().unwrap();
    let graph = Pipeline::parse(&TEXT).unwrap().graph(&registry, folder.path().to_path_buf()).unwrap();
    let report = voltet_nodes::session().run(&graph, &NoObserver).unwrap();
    assert_eq!(report.pictures.last().unwrap().1, drawn.picture);
    assert!(folder.path().join("picture.png").exists(), "a run writes");
}

/// However its widgets were moved before, and whatever the engine kept meanwhile.
#[test]
fn at_last_the_picture_is_that_of_a_run_bit_for_bit() {
    let worker = worker();
    let mut nodes = nodes(include_str!("../ui_tests/scene.toml"));
    let folder = tempfile::tempdir().unwrap();
    let mut passed = 0;
    for step in 0..24 {
        let centre = [140.0 + f64::from(step), 22.0].map(|x| LocatedValue::from(ParameterValue::Number(x)));
        set(&mut nodes, "look", &["widgets", "0", "centre"], ParameterValue::List(centre.to_vec()));
        let wanted = RenderRequest { coarse_first: true, ..wanted(nodes.clone(), folder.path()) };
        let number = worker.draw(wanted);
        let drawn = || worker.shown(|shown| shown.pixels.clone().filter(|pixels| pixels.number == number));
        while drawn().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        passed += u32::from(drawn().is_some_and(|pixels| pixels.is_preview));
        // Sometimes the hand rests.
        if step % 8 == 7 {
            settle(&worker);
            assert!(drawn().is_some_and(|pixels| pixels.is_full()));
        }
    }
    assert!(passed > 0, "no picture was a preview");
    let shown = worker.shown(|shown| shown.pixels.clone().unwrap());
    let graph = Graph::build(&nodes, &voltet_nodes::registry().unwrap(), folder.path().into()).unwrap();
    let report = voltet_nodes::session().run(&graph, &NoObserver).unwrap();
    assert_eq!(report.pictures.last().unwrap().1, shown.picture);
}

/// The nodes that ran, and what they counted that is no part of drawing.
fn ran_of_a_moved_widget(text: &str) -> (Vec<String>, Vec<&'static str>) {
    let worker = worker();
    let mut nodes = nodes(text);
    worker.draw(wanted(nodes.clone(), &PathBuf::new()));
    settle(&worker);
    assert!(ran(&worker).iter().any(|name| name == "gradient"));
    let centre =
        ParameterValue::List([140.0, 22.0].map(|x| LocatedValue::from(ParameterValue::Number(x))).to_vec());
    set(&mut nodes, "look", &["widgets", "0", "centre"], centre);
    worker.draw(wanted(nodes, &PathBuf::new()));
    settle(&worker);
    let counted = worker.shown(|shown| {
        let report = shown.report.clone().unwrap();
        let fresh = report.nodes.iter().filter(|node| !node.reused);
        let counts =
            fresh.flat_map(|node| node.counts.iter().filter(|(_, n)| **n > 0).map(|(name, _)| *name));
        let of_data = ["arrays_decoded", "gradients_computed", "cells_sorted"];
        counts.filter(|name| of_data.contains(name)).collect()
    });
    (ran(&worker), counted)
}

#[test]
fn of_a_moved_widget_the_drawing_alone_is_made_again() {
    // Stage by stage: which cells are drawn is another for another widget; nothing is read, no gradient is found, nothing sorted.
    let (ran, counted) = ran_of_a_moved_widget(&TEXT);
    assert_eq!(
        (ran, counted),
        (["look", "cells", "order", "cover", "picture"].map(String::from).to_vec(), vec![])
    );
    let i = TEXT.find("[nodes.cells]").unwrap();
    let one = format!(
        "{}[nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
         inputs = {{ volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}\n",
        &TEXT[..i]
    );
    let (ran, counted) = ran_of_a_moved_widget(&one);
    assert_eq!((ran, counted), (["look", "picture"].map(String::from).to_vec(), vec![]));
}

#[test]
fn of_what_follows_from_a_change_alone_is_said_that_it_is_stale() {
    let mut shown = WorkerOutput::default();
    let mut nodes = nodes(&TEXT);
    shown.begin(1, &wanted(nodes.clone(), &PathBuf::new()));
    let names: Vec<String> = shown.nodes.keys().cloned().collect();
    names.iter().for_each(|name| shown.done(name, 0.5));
    set(&mut nodes, "look", &["unit_distance"], ParameterValue::Number(3.0));
    shown.begin(2, &wanted(nodes, &PathBuf::new()));
    let stale: Vec<&str> = shown
        .nodes
        .iter()
        .filter(|(_, s)| s.state == NodeState::Stale)
        .map(|(name, _)| name.as_str())
        .collect();
    assert_eq!(stale, ["cells", "cover", "look", "order", "picture"]);
}

#[test]
fn nodes_that_do_not_feed_the_picture_may_be_broken() {
    let worker = worker();
    let text = format!("{}\n[nodes.broken]\ntype = \"no-such\"\n[nodes.other]\ntype = \"renderer\"\n", *TEXT);
    worker.draw(wanted(nodes(&text), &PathBuf::new()));
    settle(&worker);
    worker.shown(|shown| {
        assert!(shown.failure.is_none(), "{:?}", shown.failure);
        assert!(shown.pixels.is_some());
        assert!(!shown.nodes.contains_key("broken"));
        assert!(shown.values["gradient.volume"].contains("tetrahedra"), "{:?}", shown.values);
    });
}

#[test]
fn an_error_stands_at_its_node_and_the_next_picture_comes() {
    let worker = worker();
    let mut broken = nodes(&TEXT);
    set(&mut broken, "grid", &["resolution"], ParameterValue::Text("large".into()));
    worker.draw(wanted(broken, &PathBuf::new()));
    settle(&worker);
    worker.shown(|shown| {
        let error = shown.failure.as_ref().unwrap();
        assert_eq!(error.location.node.as_deref(), Some("grid"));
        assert!(matches!(shown.nodes["grid"].state, NodeState::Failed(_)));
    });
    worker.draw(wanted(nodes(&TEXT), &PathBuf::new()));
    settle(&worker);
    assert!(worker.shown(|shown| shown.failure.is_none() && shown.pixels.is_some()));
}

pub(super) const IMAGE: &[Port] = &[Port { name: "image", port_type: PortType::Image, summary: "a picture" }];

pub(super) static PANICS: Node = Node {
    name: "panics",
    summary: "Ends by a mistake.",
    outputs: IMAGE,
    demand: &|_| Ok(()),
    run: &|_| panic!("index out of bounds"),
    ..Node::BLANK
};

#[test]
fn a_panic_is_the_error_of_its_node() {
    let worker = worker_with_own();
    worker.draw(wanted(nodes("[pipeline]\nformat = 1\n[nodes.picture]\ntype = \"panics\""), &PathBuf::new()));
    settle(&worker);
    worker.shown(|shown| {
        let error = shown.failure.as_ref().unwrap();
        assert_eq!(error.location.node.as_deref(), Some("picture"));
        assert!(error.to_string().contains("index out of bounds"), "{error}");
    });
    worker.draw(wanted(nodes(&TEXT), &PathBuf::new()));
    settle(&worker);
    assert!(worker.shown(|shown| shown.pixels.is_some()));
}

#[test]
fn the_distribution_comes_late_and_leaves_the_picture_as_it_is() {
    let worker = worker();
    // Of s alone: nobody but the distribution asks for a gradient.
    let mut one_dimensional = nodes(&TEXT);
    let sigma = ParameterValue::List(
        [60.0, f64::INFINITY].map(|x| LocatedValue::from(ParameterValue::Number(x))).to_vec(),
    );
    set(&mut one_dimensional, "look", &["widgets", "0", "sigma"], sigma);
    worker.draw(wanted(one_dimensional.clone(), &PathBuf::new()));
    let nodes = one_dimensional.clone();
    let source = VolumeSource { nodes, folder: PathBuf::new(), output: "gradient".into() };
    let axes = ["s", "g"].map(ArrayRef::Named);
    let scales = Default::default();
    let query = DistributionQuery {
        scope: voltet_nodes::relative::DataScope::Step,
        source,
        axes,
        scales,
        fields: Vec::new(),
    };
    worker.ask(|output| &mut output.distribution, query);
    settle(&worker);
    let before = worker.shown(|shown| shown.pixels.clone().unwrap().picture);
    for _ in 0..6000 {
        if worker.shown(|shown| shown.distribution.answer().is_some()) {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let distributed = worker.shown(|shown| shown.distribution.answer().cloned()).unwrap().unwrap();
    let found = &distributed.histogram;
    let sum: f64 = found.volumes.iter().sum();
    // The box is 20 wide; a thousandth of it, the steepest, lies beyond the axis of g.
    assert!(((sum + found.outside) / 8000.0 - 1.0).abs() < 1e-9, "{sum}");
    assert!(found.outside > 0.0 && found.outside / 8000.0 <= 1e-3, "{}", found.outside);
    assert!(found.axes[1].high > 1.0, "g is known");
    worker.draw(wanted(one_dimensional, &PathBuf::new()));
    settle(&worker);
    assert_eq!(worker.shown(|shown| shown.pixels.clone().unwrap().picture), before);
}

/// However far it has come when its document is forgotten.
#[test]
fn a_forgotten_picture_does_not_come_after_all() {
    let folder = tempfile::tempdir().unwrap();
    let worker = worker();
    let mut missing = nodes(&TEXT);
    missing[0] =
        nodes("[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"none.vtu\"").remove(0);
    for step in 0..40 {
        worker.draw(RenderRequest { coarse_first: true, ..wanted(nodes(&TEXT), folder.path()) });
        let query = RenderRequest { node: "picture".into(), ..wanted(nodes(&TEXT), folder.path()) };
        worker.ask(|output| output.preview("picture"), PreviewQuery(query));
        std::thread::sleep(Duration::from_millis(step));
        worker.forget();
        worker.draw(wanted(missing.clone(), folder.path()));
        settle(&worker);
        worker.shown(|shown| {
            assert!(shown.pixels.is_none() && shown.report.is_none() && shown.previews.is_empty());
            assert!(shown.failure.is_some());
        });
    }
}

#[test]
fn output_of_a_document_takes_no_picture_of_the_one_before() {
    let folder = tempfile::tempdir().unwrap();
    let worker = worker();
    worker.draw(wanted(nodes(&TEXT), folder.path()));
    settle(&worker);
    let pixels = worker.shown(|shown| shown.pixels.clone().unwrap());
    let report = worker.shown(|shown| shown.report.clone().unwrap());
    let mut output = WorkerOutput::from(pixels.number + 1);
    output.finished(pixels.clone(), &report, None, 0.1);
    assert!(output.pixels.is_none() && output.report.is_none() && output.since(pixels.number).is_none());
    output.finished(Pixels { number: pixels.number + 1, ..pixels }, &report, None, 0.1);
    assert!(output.pixels.is_some() && output.report.is_some());
}

#[test]
fn memory_is_what_the_program_may_take() {
    let never = |_: &dyn Fn() -> Option<String>| false;
    let shared = Shared::new(Arc::default(), Arc::new(|| {}));
    let following = work::Following::new(&shared, &never, work::RunView::Nodes);
    assert_eq!(Observer::memory_left(&following).is_some(), voltet_io::memory::available().is_some());
}

/// As of an edit that is undone while the run looks: what is left out by then is missing in the end.
#[test]
fn a_stop_is_not_taken_back() {
    let asked = AtomicUsize::new(0);
    let once = |_: &dyn Fn() -> Option<String>| asked.fetch_add(1, Ordering::SeqCst) == 1;
    let shared = Shared::new(Arc::default(), Arc::new(|| {}));
    let following = work::Following::new(&shared, &once, work::RunView::Nodes);
    assert_eq!([(); 4].map(|()| Observer::cancelled(&following)), [false, true, true, true]);
}
