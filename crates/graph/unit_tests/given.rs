//! Work of a program in place of a node's own.

use super::*;

/// A grid whose scalar is this number, and where it goes when nobody holds it.
fn given(number: f64, keep: &Arc<()>) -> NodeOverride {
    let keep = keep.clone();
    NodeOverride::new(move |_| {
        let _ = &keep;
        count("given");
        let scalar = Some(SharedSlice::from(vec![number]));
        Ok(vec![Value::Grid(Arc::new(Grid { scalar, ..Grid::default() }))])
    })
}

#[test]
fn what_a_program_gives_stands_for_the_node_and_is_used_again_until_it_is_another() {
    let mut session = session();
    let [first, second] = [Arc::new(()), Arc::new(())];
    let of_first = given(7.0, &first);
    let run = |session: &mut Session, given: Option<&NodeOverride>| {
        let mut graph = graph(SCENE).unwrap();
        if let Some(given) = given {
            graph.give("grid", given.clone()).unwrap();
        }
        session.run(&graph, &NoObserver).unwrap();
        let runs = runs();
        ["given", "grid", "gradient"].map(|name| runs.iter().find(|run| run.0 == name).map_or(0, |run| run.1))
    };
    assert_eq!(run(&mut session, None), [0, 1, 1]);
    assert_eq!(run(&mut session, Some(&of_first)), [1, 0, 1]);
    assert_eq!(run(&mut session, Some(&of_first)), [0, 0, 0]);
    assert_eq!(run(&mut session, Some(&given(8.0, &second))), [1, 0, 1]);
    // What the former one gave is gone with it.
    assert_eq!((Arc::strong_count(&first), Arc::strong_count(&second)), (2, 2));
    assert_eq!(run(&mut session, Some(&of_first)), [1, 0, 1]);
    assert_eq!(Arc::strong_count(&second), 1);
    assert_eq!(run(&mut session, None), [0, 1, 1]);
}

#[test]
fn a_session_that_forgets_holds_nothing_that_it_was_given() {
    let mut session = session();
    let held = Arc::new(());
    let mut graph = graph(SCENE).unwrap();
    graph.give("grid", given(7.0, &held)).unwrap();
    session.run(&graph, &NoObserver).unwrap();
    drop(graph);
    assert_eq!(Arc::strong_count(&held), 2);
    session.forget();
    assert_eq!(Arc::strong_count(&held), 1);
}

#[test]
fn a_node_that_is_not_there_is_named() {
    let error = graph(SCENE).unwrap().give("gird", given(7.0, &Arc::new(()))).unwrap_err();
    assert!(error.to_string().starts_with("there is no node 'gird'; expected 'grid'"), "{error}");
}

#[test]
fn former_outputs_of_one_are_not_those_of_another() {
    let mut session = session();
    let held = Arc::new(());
    // Feeding a node forgets nothing between.
    let mut scalar = |given: &NodeOverride| {
        let mut graph = graph(SCENE).unwrap();
        graph.give("grid", given.clone()).unwrap();
        let place = graph.nodes.iter().position(|node| node.name == "gradient").unwrap();
        let (values, _) = session.feed(&graph, place, &Demand::default(), &NoObserver).unwrap();
        values[0].volume().unwrap().unwrap().scalar[0]
    };
    let [first, second] = [7.0, 8.0].map(|number| given(number, &held));
    assert_eq!([&first, &second, &first].map(&mut scalar), [7.0, 8.0, 7.0]);
    assert_eq!(runs(), [("given", 2), ("look", 1)]);
}
