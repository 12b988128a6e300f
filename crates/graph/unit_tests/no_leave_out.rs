//! Sessions that leave nothing out.

use super::*;

#[test]
fn a_session_that_leaves_nothing_out_asks_for_everything_and_uses_nothing_again() {
    let mut session = session().exhaustive();
    let without = graph(&SCENE.replace("unit = 2.0", "unit = 1.0")).unwrap();
    let first = session.run(&without, &NoObserver).unwrap();
    assert!(first.left_out.is_empty(), "{:?}", first.left_out);
    assert!(ASKED.with_borrow(|asked| asked.arrays.and_all_others() && asked.cell_arrays.and_all_others()));
    assert!(ASKED.with_borrow(|asked| asked.arrays.named().eq(["p"])));
    let expected = runs();
    assert!(expected.contains(&("gradient", 1)), "{expected:?}");
    assert!(session.run(&without, &NoObserver).unwrap().left_out.is_empty());
    assert_eq!(runs(), expected);
    // A grid in place of a volume has no gradient to give, and none is asked for.
    let direct =
        SCENE.replace("volume = \"gradient\"", "volume = \"grid\"").replace("unit = 2.0", "unit = 1.0");
    session.run(&graph(&direct).unwrap(), &NoObserver).unwrap();
}

#[test]
fn leave_to_leave_something_out_is_given_but_where_nothing_may_be() {
    thread_local! {
        /// Whether it was given while planning, and while running.
        static GIVEN: RefCell<[Option<bool>; 2]> = const { RefCell::new([None; 2]) };
    }
    const ASKS: Node = Node {
        name: "asks",
        demand: &|asking| {
            GIVEN.with_borrow_mut(|given| given[0] = Some(asking.may_leave_out().is_some()));
            asking.pass_on()
        },
        run: &|call| {
            GIVEN.with_borrow_mut(|given| given[1] = Some(call.may_leave_out().is_some()));
            Ok(Vec::new())
        },
        foresee: &|foresight| {
            foresight.notes.record_skipped(foresight.leave, "layers", "the header says so", None);
            match foresight.parameters.text("path")? {
                "a" => Ok(()),
                _ => Err(Error::run("there is no such file")),
            }
        },
        ..WRITE
    };
    let mut registry = registry();
    registry.add(&ASKS).unwrap();
    let asking = SCENE.replace("type = \"write\"", "type = \"asks\"");
    for (mut session, given) in [(session(), true), (session().exhaustive(), false)] {
        for (path, unknown) in [("a", 0), ("b", 1)] {
            let text = asking.replace("path = \"a\"", &format!("path = \"{path}\""));
            let graph = Pipeline::parse(&text).unwrap().graph(&registry, PathBuf::new()).unwrap();
            session.run(&graph, &NoObserver).unwrap();
            assert_eq!(GIVEN.with_borrow(|given| *given), [Some(given); 2]);
            let mut plan = session.plan(&graph).unwrap();
            assert_eq!(plan.foresee(&graph).len(), if given { unknown } else { 0 });
            assert_eq!(plan.notes[4].left_out.iter().any(|left| left.what == "layers"), given);
        }
    }
}
