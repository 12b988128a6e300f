//! The passes, the cache and the wiring, on node types that only count.

mod exhaustive;
mod faults;
mod feeding;
mod given;
mod methods;
mod optional_inputs;
mod places;
mod preview;
mod shared;

use super::*;
use crate::pipeline::Pipeline;
use glam::DVec3;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection as Rays};
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

thread_local! {
    /// Count of runs of each node type on this thread.
    static RUNS: RefCell<BTreeMap<&'static str, usize>> = const { RefCell::new(BTreeMap::new()) };
    /// The demand on the grid at its last run.
    static ASKED: RefCell<Demand> = RefCell::new(Demand::default());
}

fn count(name: &'static str) {
    RUNS.with_borrow_mut(|runs| *runs.entry(name).or_default() += 1);
}

/// The runs since the last call.
fn runs() -> Vec<(&'static str, usize)> {
    RUNS.with_borrow_mut(|runs| std::mem::take(runs).into_iter().collect())
}

const fn port(name: &'static str, port_type: PortType) -> Port {
    Port { name, port_type, summary: "a port" }
}

const fn number(name: &'static str, standard: DefaultValue) -> Parameter {
    Parameter {
        name,
        parameter_type: ParameterType::Number(Range::at_least(0.0)),
        unit: "m",
        default: standard,
        help: "help",
    }
}

const GRID: Node = Node {
    name: "grid",
    summary: "Gives a grid.",
    outputs: &[port("grid", PortType::Grid)],
    parameters: &[number("size", DefaultValue::Number(1.0))],
    run: &|call| {
        count("grid");
        ASKED.with_borrow_mut(|asked| *asked = call.demand.clone());
        let scalar = Some(SharedSlice::from(vec![call.parameters.number("size")?]));
        Ok(vec![Value::Grid(Arc::new(Grid { scalar, ..Grid::default() }))])
    },
    ..Node::BLANK
};

const GRADIENT: Node = Node {
    name: "gradient",
    summary: "Gives a volume.",
    inputs: &[port("grid", PortType::Grid)],
    outputs: &[port("volume", PortType::Volume)],
    demand: &|asking| {
        if !asking.asked.gradient_magnitude {
            asking.notes.record_skipped("gradient", "nobody asks", None);
        }
        asking.ask("grid", &Demand { arrays: asking.asked.arrays.clone(), ..Demand::default() })
    },
    run: &|call| {
        count("gradient");
        let grid = call.grid("grid")?;
        let scalar = grid.scalar.clone().unwrap();
        let gradient_magnitude = call.demand.gradient_magnitude.then(|| scalar.clone());
        Ok(vec![Value::Volume(Arc::new(Volume { grid, scalar, gradient: None, gradient_magnitude }))])
    },
    ..Node::BLANK
};

const LOOK: Node = Node {
    name: "look",
    summary: "Gives a transfer function.",
    outputs: &[port("look", PortType::TransferFunction)],
    parameters: &[number("unit", DefaultValue::Required)],
    early: true,
    run: &|call| {
        count("look");
        let unit_distance = call.parameters.number("unit")?;
        let model = OpticalModel::DensityEmitter;
        let transfer_function =
            TransferFunction { model, unit_distance, widgets: Vec::new(), axes: Default::default() };
        Ok(vec![Value::TransferFunction(Arc::new(TransferFunctionSpec::new(transfer_function, false)))])
    },
    ..Node::BLANK
};

const CAMERA: Node = Node {
    name: "camera",
    summary: "Gives a camera.",
    outputs: &[port("camera", PortType::Camera)],
    early: true,
    run: &|_| {
        let projection = Rays::Perspective { fov_y: 30.0 };
        let (eye, target, up) = (DVec3::ZERO, DVec3::X, DVec3::Z);
        Ok(vec![Value::Camera(Arc::new(Camera {
            eye,
            target,
            up,
            projection,
            near: 0.0,
            size: [1, 1],
            samples: 1,
        }))])
    },
    ..Node::BLANK
};

/// Draws; asks for g when the transfer function's unit is above 1.
const DRAW: Node = Node {
    name: "draw",
    summary: "Gives an image.",
    inputs: &[port("volume", PortType::Volume), port("look", PortType::TransferFunction)],
    outputs: &[port("image", PortType::Image), port("depth", PortType::Image)],
    parameters: &[number("tolerance", DefaultValue::Number(0.5))],
    demand: &|asking| {
        let unit = asking.look("look").unwrap().transfer_function.unit_distance;
        let mut demand = Demand { gradient_magnitude: unit > 1.0, ..Demand::default() };
        demand.arrays.named.insert("p".into());
        asking.ask("volume", &demand)
    },
    run: &|call| {
        count("draw");
        let volume = call.volume("volume")?;
        let kept = call.keep(call.revision("volume")?, || {
            count("kept");
            Ok(volume.scalar[0])
        })?;
        call.notes.counts.insert("segments", *kept as u64);
        let image = Value::Image(Arc::new(Picture::transparent(1, 1)));
        Ok(vec![image.clone(), image])
    },
    ..Node::BLANK
};

const WRITE: Node = Node {
    name: "write",
    summary: "Writes.",
    inputs: &[port("image", PortType::Image)],
    parameters: &[Parameter {
        name: "path",
        parameter_type: ParameterType::OutputPath,
        unit: "",
        default: DefaultValue::Required,
        help: "help",
    }],
    prepare: &|preparation| match preparation.path("path")?.ends_with("bad") {
        true => Err(Error::usage("the path is bad").at_item("path")),
        false => Ok(()),
    },
    run: &|_| {
        count("write");
        Ok(Vec::new())
    },
    ..Node::BLANK
};

fn registry() -> Registry {
    let mut registry = Registry::new();
    for node in [&GRID, &GRADIENT, &LOOK, &CAMERA, &DRAW, &WRITE] {
        registry.add(node).unwrap();
    }
    registry
}

const SCENE: &str = r#"
[pipeline]
format = 1
[nodes.grid]
type = "grid"
size = 3
[nodes.gradient]
type = "gradient"
inputs = { grid = "grid" }
[nodes.look]
type = "look"
unit = 2.0
[nodes.picture]
type = "draw"
inputs = { volume = "gradient", look = "look" }
[nodes.file]
type = "write"
path = "a"
inputs = { image = "picture.image" }
"#;

fn graph(text: &str) -> Result<Graph> {
    Pipeline::parse(text)?.graph(&registry(), PathBuf::from("folder"))
}

fn session() -> Session {
    Session::new(|_| None)
}

/// The message of the error in a text made from the scene.
fn error_of(text: &str) -> String {
    let error = match graph(text) {
        Ok(graph) => session().run(&graph, &NoObserver).unwrap_err(),
        Err(error) => error,
    };
    pipeline::locate(error, text, "f".as_ref()).to_string()
}

#[test]
fn a_second_run_repeats_nothing_and_a_changed_parameter_only_what_depends_on_it() {
    let mut session = session();
    session.run(&graph(SCENE).unwrap(), &NoObserver).unwrap();
    assert_eq!(runs(), [("draw", 1), ("gradient", 1), ("grid", 1), ("kept", 1), ("look", 1), ("write", 1)]);

    let report = session.run(&graph(SCENE).unwrap(), &NoObserver).unwrap();
    assert_eq!(runs(), []);
    assert!(report.nodes.iter().all(|n| n.reused && n.seconds == 0.0));
    assert_eq!(report.counts["segments"], 3, "counts of former runs are reported again");

    let look = SCENE.replace("unit = 2.0", "unit = 3.0");
    session.run(&graph(&look).unwrap(), &NoObserver).unwrap();
    assert_eq!(
        runs(),
        [("draw", 1), ("look", 1), ("write", 1)],
        "what was kept for the volume is still there"
    );

    let grid = look.replace("size = 3", "size = 4");
    session.run(&graph(&grid).unwrap(), &NoObserver).unwrap();
    assert_eq!(runs(), [("draw", 1), ("gradient", 1), ("grid", 1), ("kept", 1), ("write", 1)]);

    let path = grid.replace("\"a\"", "\"b\"");
    session.run(&graph(&path).unwrap(), &NoObserver).unwrap();
    assert_eq!(runs(), [("write", 1)]);
}

#[test]
fn another_pipeline_shares_what_is_made_from_the_same() {
    let mut session = session();
    session.run(&graph(SCENE).unwrap(), &NoObserver).unwrap();
    runs();
    let renamed = SCENE.replace("nodes.grid", "nodes.mesh").replace("\"grid\" }", "\"mesh\" }");
    session.run(&graph(&renamed).unwrap(), &NoObserver).unwrap();
    assert_eq!(runs(), []);
}

#[test]
fn what_nobody_asks_for_is_left_out_and_made_once_it_is_asked_for() {
    let mut session = session();
    let without = SCENE.replace("unit = 2.0", "unit = 1.0");
    let report = session.run(&graph(&without).unwrap(), &NoObserver).unwrap();
    assert_eq!(report.skipped.len(), 1);
    assert_eq!((report.skipped[0].node.as_str(), report.skipped[0].what.as_str()), ("gradient", "gradient"));
    assert!(ASKED.with_borrow(|asked| asked.arrays.contains("p") && !asked.gradient_magnitude));
    runs();

    let report = session.run(&graph(SCENE).unwrap(), &NoObserver).unwrap();
    let left_out: Vec<[&str; 2]> = report.skipped.iter().map(|left| [&*left.node, &*left.what]).collect();
    assert_eq!(left_out, [["grid", "repetition"]]);
    let expected = [("draw", 1), ("gradient", 1), ("kept", 1), ("look", 1), ("write", 1)];
    assert_eq!(runs(), expected, "the grid serves again, the volume is new");
}

#[test]
fn a_grid_serves_as_a_volume_unless_its_gradient_is_asked_for() {
    let direct = SCENE.replace("volume = \"gradient\"", "volume = \"grid\"");
    let without = direct.replace("unit = 2.0", "unit = 1.0");
    let built = graph(&without).unwrap();
    assert_eq!(built.warnings.len(), 1, "the gradient node is not used");
    session().run(&built, &NoObserver).unwrap();
    let message = error_of(&direct);
    assert!(message.contains("gives a grid without gradient") && message.contains("f:15:21"), "{message}");
}

#[test]
fn mistakes_are_placed_and_the_nearest_name_is_given() {
    for (from, to, wanted, place) in [
        ("size = 3", "sise = 3", "unknown parameter 'sise'; expected 'size'", "f:6:1"),
        ("size = 3", "size = \"x\"", "wrong type: found \"x\"; expected number 0 or more (m)", "f:6:8"),
        ("size = 3", "size = -1", "out of range: found -1; expected number 0 or more (m)", "f:6:8"),
        ("size = 3", "size = inf", "out of range: found inf", "f:6:8"),
        ("size = 3", "size = nan", "out of range: found nan", "f:6:8"),
        ("unit = 2.0", "", "the parameter 'unit' is missing", "f:10:8"),
        (
            "\"gradient\"\ni",
            "\"gradeint\"\ni",
            "unknown node type 'gradeint'; expected 'gradient', the nearest",
            "f:8:8",
        ),
        ("{ grid = \"grid\" }", "{ gird = \"grid\" }", "has no input 'gird'; expected 'grid'", "f:9:12"),
        (
            "{ grid = \"grid\" }",
            "{ grid = \"gird\" }",
            "there is no node 'gird'; expected 'grid', the nearest",
            "f:9:19",
        ),
        ("{ grid = \"grid\" }", "{}", "the input 'grid' is not wired", "f:7:8"),
        (
            "{ grid = \"grid\" }",
            "{ grid = \"look\" }",
            "found a transfer-function from 'look'; expected a grid",
            "f:9:19",
        ),
        ("{ grid = \"grid\" }", "{ grid = 3 }", "must name the node that feeds it: found 3", "f:9:19"),
        (
            "\"picture.image\"",
            "\"picture\"",
            "has several outputs; expected \"picture.image\" or \"picture.depth\"",
            "f:19:20",
        ),
        (
            "\"picture.image\"",
            "\"picture.imag\"",
            "has no output 'imag'; expected 'image', the nearest",
            "f:19:20",
        ),
        ("\"picture.image\"", "\"file\"", "the node 'file' has no output", "f:19:20"),
        ("\"a\"", "\"bad\"", "the path is bad", "f:18:8"),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let message = error_of(&SCENE.replacen(from, to, 1));
        assert!(message.contains(wanted) && message.contains(place), "{to}: {message}");
    }
}

#[test]
fn cycles_are_named() {
    const LOOP: Node = Node {
        name: "loop",
        summary: "Takes a grid, gives a grid.",
        inputs: &[port("grid", PortType::Grid)],
        outputs: &[port("grid", PortType::Grid)],
        ..Node::BLANK
    };
    let mut registry = registry();
    registry.add(&LOOP).unwrap();
    let text = "[pipeline]\nformat = 1\n\
        [nodes.a]\ntype = \"loop\"\ninputs = { grid = \"b\" }\n\
        [nodes.b]\ntype = \"loop\"\ninputs = { grid = \"c\" }\n\
        [nodes.c]\ntype = \"loop\"\ninputs = { grid = \"b\" }\n";
    let error = Pipeline::parse(text).unwrap().graph(&registry, PathBuf::new()).unwrap_err();
    assert_eq!(error.got.as_deref(), Some("c → b → c"));
    let itself = text.replace("grid = \"c\"", "grid = \"b\"");
    let error = Pipeline::parse(&itself).unwrap().graph(&registry, PathBuf::new()).unwrap_err();
    assert_eq!(error.got.as_deref(), Some("b → b"));
}

#[test]
fn a_pipeline_without_sink_is_refused_and_several_sinks_run() {
    let (without, _) = SCENE.split_at(SCENE.find("[nodes.file]").unwrap());
    assert!(error_of(without).contains("the pipeline writes nothing"));
    let second = "[nodes.again]\ntype = \"write\"\npath = \"./a\"\ninputs = { image = \"picture.depth\" }\n";
    let two = format!("{SCENE}{}", second.replace("./a", "b"));
    session().run(&graph(&two).unwrap(), &NoObserver).unwrap();
    assert!(runs().contains(&("write", 2)), "several sinks are allowed");
}

#[test]
fn a_run_can_be_stopped_between_nodes() {
    struct Impatient;
    impl Observer for Impatient {
        fn cancelled(&self) -> bool {
            RUNS.with_borrow(|runs| runs.contains_key("gradient"))
        }
    }
    let error = session().run(&graph(SCENE).unwrap(), &Impatient).unwrap_err();
    assert_eq!(error.kind, voltet_core::error::ErrorKind::Cancelled);
    assert!(!runs().iter().any(|(name, _)| matches!(*name, "draw" | "write")));
}

#[test]
fn the_registry_refuses_what_contradicts_itself() {
    let mut registry = registry();
    assert!(registry.add(&GRID).is_err());
    const TWICE: Node =
        Node { parameters: &[number("inputs", DefaultValue::Required)], name: "twice", ..GRID };
    assert!(registry.add(&TWICE).unwrap_err().what.contains("'inputs' twice"));
    assert_eq!(registry.names().count(), 6);
}
