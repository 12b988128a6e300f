//! Inputs that may be left out or fed by several nodes, and what stands for values that are made from data.

use super::*;

/// A transfer function made from data: its unit is the scalar's, above 1 as its parameter promises.
const FOUND: Node = Node {
    name: "found",
    summary: "Gives a transfer function.",
    inputs: &[port("volume", PortType::Volume)],
    outputs: &[port("look", PortType::TransferFunction)],
    parameters: &[number("promise", DefaultValue::Required)],
    outline: &|parameters, inputs| {
        assert!(inputs[0].1.is_none(), "the volume is not known while planning");
        Ok(vec![look(parameters.number("promise")?)])
    },
    demand: &|asking| {
        let mut demand = Demand::default();
        demand.cell_arrays.named.insert("zone".into());
        asking.ask("volume", &demand)
    },
    run: &|call| {
        count("found");
        Ok(vec![look(call.volume("volume")?.scalar[0])])
    },
    ..Node::BLANK
};

/// Adds the units of what is wired in to its own.
const SUM: Node = Node {
    name: "sum",
    summary: "Gives a transfer function.",
    optional_inputs: &[port("more", PortType::TransferFunction), port("others", PortType::TransferFunction)],
    outputs: &[port("look", PortType::TransferFunction)],
    parameters: &[number("unit", DefaultValue::Number(0.0))],
    early: true,
    outline: &|parameters, inputs| {
        let unit = |input: &NamedStub| match &input.1 {
            Some(Value::TransferFunction(look)) => look.transfer_function.unit_distance,
            _ => panic!("what stands for an input is not handed on"),
        };
        Ok(vec![look(parameters.number("unit")? + inputs.iter().map(unit).sum::<f64>())])
    },
    run: &|call| {
        count("sum");
        let units = |port: &str| -> Result<f64> {
            Ok(call.looks(port)?.iter().map(|look| look.transfer_function.unit_distance).sum())
        };
        Ok(vec![look(call.parameters.number("unit")? + units("more")? + 100.0 * units("others")?)])
    },
    ..Node::BLANK
};

/// Draws as the scene's node does, and keeps the unit as a count.
const SHOW: Node = Node {
    name: "show",
    run: &|call| {
        let unit = call.look("look")?.transfer_function.unit_distance;
        call.notes.counts.insert("unit", unit as u64);
        (DRAW.run)(call)
    },
    ..DRAW
};

fn look(unit_distance: f64) -> Value {
    let model = OpticalModel::DensityEmitter;
    let transfer_function =
        TransferFunction { model, unit_distance, widgets: Vec::new(), axes: Default::default() };
    Value::TransferFunction(Arc::new(TransferFunctionSpec::new(transfer_function, false)))
}

const MORE: &str = "[nodes.a]\ntype = \"found\"\npromise = 0.5\ninputs = { volume = \"gradient\" }\n\
     [nodes.b]\ntype = \"look\"\nunit = 10.0\n";

/// The scene with a sum in the look's place.
fn scene(inputs: &str) -> String {
    let sum = format!("type = \"sum\"\nunit = 0.25\n{inputs}");
    SCENE.replace("type = \"look\"\nunit = 2.0", &sum).replace("type = \"draw\"", "type = \"show\"") + MORE
}

fn graph(text: &str) -> Result<Graph> {
    let mut registry = registry();
    for node in [&FOUND, &SUM, &SHOW] {
        registry.add(node).unwrap();
    }
    Pipeline::parse(text)?.graph(&registry, PathBuf::from("folder"))
}

#[test]
fn any_number_of_nodes_feeds_an_optional_input() {
    for (inputs, unit) in [
        ("", 0),
        ("inputs = { }", 0),
        ("inputs = { more = \"b\" }", 10),
        ("inputs = { others = [\"b\"] }", 1000),
        ("inputs = { more = [] }", 0),
        // The grid's scalar is 3.
        ("inputs = { more = [\"a\", \"b\"] }", 13),
        ("inputs = { others = [\"a\"], more = [\"b\", \"b\"] }", 320),
    ] {
        let report = session().run(&graph(&scene(inputs)).unwrap(), &NoObserver).unwrap();
        assert_eq!(report.counts["unit"], unit, "{inputs}");
    }
}

#[test]
fn the_port_that_is_fed_belongs_to_what_a_former_run_was_made_from() {
    let mut session = session();
    let mut unit =
        |inputs: &str| session.run(&graph(&scene(inputs)).unwrap(), &NoObserver).unwrap().counts["unit"];
    assert_eq!(unit("inputs = { more = \"b\" }"), 10);
    assert_eq!(unit("inputs = { others = \"b\" }"), 1000);
}

#[test]
fn what_stands_for_a_value_decides_what_is_asked_for() {
    let asked = |inputs: &str| {
        let graph = graph(&scene(inputs)).unwrap();
        let plan = session().plan(&graph).unwrap();
        let of = |name: &str| plan.demands[graph.nodes.iter().position(|n| n.name == name).unwrap()].clone();
        let zone = of("gradient").cell_arrays.contains("zone");
        (of("gradient").gradient_magnitude, zone)
    };
    // The node that draws asks for g when the unit is above 1; the promise alone is 0.5 and 0.25 more.
    assert_eq!(asked(""), (false, false));
    assert_eq!(asked("inputs = { more = \"a\" }"), (false, true));
    assert_eq!(asked("inputs = { more = [\"a\", \"a\"] }"), (true, true));
    assert_eq!(runs().iter().filter(|(name, _)| *name == "found").count(), 0, "planning reads no data");
}

#[test]
fn mistakes_in_optional_inputs_are_shown_where_they_stand() {
    for (inputs, wanted) in [
        ("inputs = { mor = \"b\" }", "has no input 'mor'; expected 'more'"),
        ("inputs = { more = 3 }", "expected \"node\" or \"node.port\", or a list of them"),
        ("inputs = { more = [\"b\", \"c\"] }", "there is no node 'c'"),
        (
            "inputs = { more = [\"grid\"] }",
            "the input 'more' is wired to the wrong type: found a grid from 'grid'",
        ),
        ("inputs = { more = \"look\" }", "the graph has a cycle"),
    ] {
        let text = scene(inputs);
        let error = pipeline::locate(graph(&text).unwrap_err(), &text, "f".as_ref()).to_string();
        assert!(error.contains(wanted), "{inputs}: {error}");
        let line = text.lines().position(|line| line == inputs).unwrap() + 1;
        assert!(error.contains(&format!("f:{line}:")), "{inputs}: {error}");
    }
    let list = SCENE.replace("grid = \"grid\"", "grid = [\"grid\"]");
    let error = graph(&list).unwrap_err().to_string();
    assert!(error.contains("an input must name the node that feeds it"), "{error}");
}
