//! Programs that say themselves what failed: every wrong use has its error and no other consequence (`tests/c/wrong.c`); a grid in
//! pieces is the grid (`tests/c/pieces.c`).

use crate::library::{Installed, succeed};

#[test]
fn every_wrong_use_has_its_error() {
    finds_all_as_it_should_be("wrong.c");
}

#[test]
fn a_grid_in_pieces_is_the_grid() {
    finds_all_as_it_should_be("pieces.c");
}

fn finds_all_as_it_should_be(program: &str) {
    let installed = Installed::new();
    let Some(program) = installed.program(&[&format!("crates/capi/tests/c/{program}")]) else { return };
    let said = succeed(&program, &[]);
    assert!(said.ends_with("all as it should be\n"), "{said}");
}
