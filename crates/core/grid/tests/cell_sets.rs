//! Sets of cells: cells added, and some of them taken.

use super::*;

#[test]
fn cells_of_one_type_are_the_same_at_once_and_added() {
    for count in [0, 3, 8, 10] {
        let corners: Vec<u32> = (0..count).collect();
        let mut added = CellSet::default();
        added.push_all(code::TETRA, 4, &corners);
        assert_eq!(added, CellSet::of_type(code::TETRA, 4, corners));
        assert_eq!(added.offsets.last(), Some(&(added.connectivity.len() as u64)));
    }
}

#[test]
fn a_part_of_a_set_with_damaged_offsets_has_cells_without_points() {
    let mut set = CellSet::of_type(code::TETRA, 4, (0..12).collect());
    set.offsets[2] = 99;
    let part = set.subset(&[0, 1, 2], |point| point);
    assert_eq!(part.offsets, [0, 4, 4, 4]);
}
