//! Several sessions in several threads, on one grid that is lent: `tests/c/threads.cpp`, which says what failed.

use crate::library::{Installed, succeed};

#[test]
fn sessions_in_several_threads_draw_the_same_grid() {
    let installed = Installed::new();
    let Some(program) = installed.program(&["crates/capi/tests/c/threads.cpp"]) else { return };
    let said = succeed(&program, &[]);
    assert!(said.ends_with("all as it should be\n"), "{said}");
}
