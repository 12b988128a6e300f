//! Inputs of a node, without the node.

use super::*;

#[test]
fn what_feeds_a_node_runs_once_and_nothing_else_does() {
    let graph = graph(SCENE).unwrap();
    let place = graph.nodes.iter().position(|node| node.name == "picture").unwrap();
    let mut session = session();
    session.plan(&graph).unwrap();
    runs();
    let (inputs, _) = session.feed(&graph, place, &Demand::default(), &NoObserver).unwrap();
    let types: Vec<PortType> = inputs.iter().map(Value::port_type).collect();
    assert_eq!(types, [PortType::Volume, PortType::TransferFunction]);
    assert_eq!(inputs[0].volume().unwrap().unwrap().scalar[0], 3.0);
    assert!(inputs[1].volume().is_none());
    assert_eq!(runs(), [("gradient", 1), ("grid", 1)]);
    // The outputs are there for the next run.
    session.feed(&graph, place, &Demand::default(), &NoObserver).unwrap();
    assert_eq!(runs(), []);
}
