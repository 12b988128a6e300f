//! Runs that others follow at once.

use super::*;

/// Draws a preview where it may, but not of tolerance 0.
const PASSES: Node = Node {
    name: "passes",
    run: &|call| {
        if call.allows_preview() && call.parameters.number("tolerance")? > 0.0 {
            call.mark_preview();
        }
        (DRAW.run)(call)
    },
    ..DRAW
};

fn preview(tolerance: f64) -> Graph {
    let text = SCENE.replace("type = \"draw\"", &format!("type = \"passes\"\ntolerance = {tolerance:.1}"));
    let mut registry = registry();
    registry.add(&PASSES).unwrap();
    Pipeline::parse(&text).unwrap().graph(&registry, PathBuf::from("folder")).unwrap()
}

#[test]
fn what_passed_and_what_was_made_of_it_serve_no_later_run() {
    let (mut session, graph) = (session(), preview(0.5));
    assert!(session.run_preview(&graph, &NoObserver).unwrap().is_preview);
    runs();
    // Once more, and at last by itself.
    assert!(session.run_preview(&graph, &NoObserver).unwrap().is_preview);
    assert_eq!(runs(), [("draw", 1), ("write", 1)]);
    assert!(!session.run(&graph, &NoObserver).unwrap().is_preview);
    assert_eq!(runs(), [("draw", 1), ("write", 1)]);
    // What stays serves a preview, too.
    assert!(!session.run_preview(&graph, &NoObserver).unwrap().is_preview);
    assert_eq!(runs(), []);
}

#[test]
fn what_did_not_change_since_a_preview_serves() {
    let (mut session, graph) = (session(), preview(0.0));
    assert!(!session.run_preview(&graph, &NoObserver).unwrap().is_preview);
    runs();
    assert!(!session.run(&graph, &NoObserver).unwrap().is_preview);
    assert_eq!(runs(), []);
}

#[test]
fn no_run_is_a_preview_where_nothing_is_left_out() {
    let mut session = session().exhaustive();
    assert!(!session.run_preview(&preview(0.5), &NoObserver).unwrap().is_preview);
}
