//! Every wrong use has its error and no other consequence: `tests/c/wrong.c`, which says what failed.

use crate::library::{Installed, succeed};

#[test]
fn every_wrong_use_has_its_error() {
    let installed = Installed::new();
    let Some(program) = installed.program(&["crates/capi/tests/c/wrong.c"]) else { return };
    let said = succeed(&program, &[]);
    assert!(said.ends_with("all as it should be\n"), "{said}");
}
