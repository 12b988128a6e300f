//! Sessions that leave nothing out.

use super::*;

#[test]
fn a_thorough_session_asks_for_everything_and_uses_nothing_again() {
    let mut session = session().leaving_nothing_out();
    let without = graph(&SCENE.replace("unit = 2.0", "unit = 1.0")).unwrap();
    let first = session.run(&without, &Unobserved).unwrap();
    assert!(first.left_out.is_empty(), "{:?}", first.left_out);
    let expected = runs();
    assert!(expected.contains(&("gradient", 1)), "{expected:?}");
    assert!(session.run(&without, &Unobserved).unwrap().left_out.is_empty());
    assert_eq!(runs(), expected);
    // A grid in place of a volume has no gradient to give, and none is asked for.
    let direct =
        SCENE.replace("volume = \"gradient\"", "volume = \"grid\"").replace("unit = 2.0", "unit = 1.0");
    session.run(&graph(&direct).unwrap(), &Unobserved).unwrap();
}
