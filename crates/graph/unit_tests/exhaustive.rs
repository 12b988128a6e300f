//! Exhaustive sessions.

use super::*;

#[test]
fn an_exhaustive_session_requests_everything_and_reuses_nothing() {
    let mut session = session().exhaustive();
    let without = graph(&SCENE.replace("unit = 2.0", "unit = 1.0")).unwrap();
    let first = session.run(&without, &NoObserver).unwrap();
    assert!(first.skipped.is_empty(), "{:?}", first.skipped);
    assert!(ASKED.with_borrow(|asked| asked.arrays.and_all_others && asked.cell_arrays.and_all_others));
    assert!(ASKED.with_borrow(|asked| asked.arrays.named.iter().eq(["p"])));
    let expected = runs();
    assert!(expected.contains(&("gradient", 1)), "{expected:?}");
    assert!(session.run(&without, &NoObserver).unwrap().skipped.is_empty());
    assert_eq!(runs(), expected);
    // A grid in place of a volume has no gradient to give, and none is asked for.
    let direct =
        SCENE.replace("volume = \"gradient\"", "volume = \"grid\"").replace("unit = 2.0", "unit = 1.0");
    session.run(&graph(&direct).unwrap(), &NoObserver).unwrap();
}

#[test]
fn nodes_of_an_exhaustive_session_skip_nothing() {
    thread_local! {
        /// The flag while planning, and while running.
        static FLAGS: RefCell<[Option<bool>; 2]> = const { RefCell::new([None; 2]) };
    }
    const ASKS: Node = Node {
        name: "asks",
        demand: &|asking| {
            FLAGS.with_borrow_mut(|flags| flags[0] = Some(asking.exhaustive()));
            asking.pass_on()
        },
        run: &|call| {
            FLAGS.with_borrow_mut(|flags| flags[1] = Some(call.exhaustive()));
            Ok(Vec::new())
        },
        foresee: &|foresight| {
            foresight.notes.record_skipped("layers", "the header says so", None);
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
    for (mut session, exhaustive) in [(session(), false), (session().exhaustive(), true)] {
        for (path, unknown) in [("a", 0), ("b", 1)] {
            let text = asking.replace("path = \"a\"", &format!("path = \"{path}\""));
            let graph = Pipeline::parse(&text).unwrap().graph(&registry, PathBuf::new()).unwrap();
            session.run(&graph, &NoObserver).unwrap();
            assert_eq!(FLAGS.with_borrow(|flags| *flags), [Some(exhaustive); 2]);
            let mut plan = session.plan(&graph).unwrap();
            assert_eq!(plan.foresee(&graph).len(), if exhaustive { 0 } else { unknown });
            assert_eq!(plan.notes[4].skipped.iter().any(|left| left.what == "layers"), !exhaustive);
        }
    }
}
