//! Spans of single cells, against the crossings that precise cells use.

use super::spans::{Edges, Fragments};
use crate::fragments::spans::{DUMMY_SLOT, NextSlots};
use crate::project::edge_on::crossing_of_row;
use crate::tile::TILE;
use crate::view::ScreenVertex;
use proptest::prelude::*;
use voltet_simd::{Kernel, LaneSet, Lanes, dispatch};

/// The fragments of one cell on a tile.
struct Spans<'a> {
    corners: [&'a ScreenVertex; 4],
    tile: [usize; 2],
}

impl Kernel<Vec<u16>> for Spans<'_> {
    fn run<L: Lanes>(self) -> Vec<u16> {
        let (mut edges, mut fragments) = (Edges::new(), Fragments::new(L::WIDTH));
        edges.take(0, self.corners);
        edges.find::<L>(self.tile[0], self.tile[1], &(0..TILE));
        fragments.cover::<L>(&edges, 1, TILE, None);
        fragments.codes[..fragments.count].to_vec()
    }
}

/// The fragments of some cells, one after another, with their places in lists.
struct Listed<'a> {
    cells: &'a [[ScreenVertex; 4]],
}

impl Kernel<Vec<(u16, u32)>> for Listed<'_> {
    fn run<L: Lanes>(self) -> Vec<(u16, u32)> {
        let (mut edges, mut fragments) = (Edges::new(), Fragments::new(L::WIDTH));
        let (mut next, mut all) = (NextSlots::default(), Vec::new());
        for cells in self.cells.chunks(L::WIDTH) {
            for (lane, [a, b, c, d]) in cells.iter().enumerate() {
                edges.take(lane, [a, b, c, d]);
            }
            edges.find::<L>(0, 0, &(0..TILE));
            fragments.cover::<L>(&edges, cells.len(), TILE, Some(&mut next));
            let codes = fragments.codes.iter().map(|code| code & 255);
            all.extend(codes.zip(fragments.slots.iter().copied()).take(fragments.count));
            assert!(fragments.slots[fragments.count..][..L::WIDTH].iter().all(|place| *place == DUMMY_SLOT));
        }
        all
    }
}

/// Fragments from each row's crossings.
fn expected(corners: [&ScreenVertex; 4], tile: [usize; 2]) -> Vec<u16> {
    let mut codes = Vec::new();
    for row in 0..TILE {
        let pairs = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
        let crossings: Vec<f32> = pairs
            .iter()
            .filter_map(|ends| crossing_of_row(ends.map(|k| corners[k]), [tile[0], tile[1] + row]))
            .collect();
        let bound = |x: f32| x.ceil().clamp(0.0, TILE as f32) as u16;
        let from = crossings.iter().copied().fold(f32::INFINITY, f32::min);
        let to = crossings.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        codes.extend((bound(from)..bound(to)).map(|column| (row as u16) << 4 | column));
    }
    codes
}

/// Pixel coordinates about a tile: anywhere, on centres, next to them.
fn coordinate() -> impl Strategy<Value = f64> {
    let near = (0..80i32, -3..4i32).prop_map(|(n, step)| f64::from(n) + f64::from(step) * 2f64.powi(-24));
    prop_oneof![-50.0..120.0, near, (0..80i32).prop_map(f64::from)]
}

proptest! {
    /// Bit for bit, so that a face seen edge-on gives its pixels to one of two cells, whichever way they are drawn.
    #[test]
    fn one_rule_for_records_and_cells_in_64_bits(
        places in prop::array::uniform4((coordinate(), coordinate())),
        tile in (0..4usize, 0..4usize),
    ) {
        let seen = places.map(|(x, y)| ScreenVertex { x, y, z: 1.0 });
        let corners = [&seen[0], &seen[1], &seen[2], &seen[3]];
        let tile = [tile.0 * TILE, tile.1 * TILE];
        let expected = expected(corners, tile);
        for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
            prop_assert_eq!(dispatch(lanes, Spans { corners, tile }), expected.clone());
        }
    }

    /// Each fragment takes the next free place of its pixel, in the order of cells.
    #[test]
    fn fragments_take_the_next_places_of_their_pixels(
        cells in prop::collection::vec(prop::array::uniform4((-5.0..21.0, -5.0..21.0)), 1..20),
    ) {
        let cells: Vec<[ScreenVertex; 4]> =
            cells.into_iter().map(|places| places.map(|(x, y)| ScreenVertex { x, y, z: 1.0 })).collect();
        let mut next = NextSlots::default();
        let mut all = Vec::new();
        for [a, b, c, d] in &cells {
            for code in expected([a, b, c, d], [0; 2]) {
                let next = &mut next.0[usize::from(code)];
                all.push((code, *next));
                *next += 1;
            }
        }
        for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
            let found = dispatch(lanes, Listed { cells: &cells });
            prop_assert_eq!(found, all.clone(), "{}", lanes.name());
        }
    }

    /// The three edges of a face seen edge-on lie on one line: where that comes by the middle of a pixel each of them does,
    /// though each is rounded in its own way.
    #[test]
    fn edges_on_one_line_cross_a_row_at_one_place(
        pixel in (0..64usize, 0..64usize),
        step in (-1_000_000..1_000_000i32, 1000..1_000_000i32),
        along in prop::array::uniform3(-60..60i32),
    ) {
        let place = |n: i32| {
            let [x, y] = [step.0, step.1].map(|step| f64::from(n) * f64::from(step) * 2f64.powi(-20));
            ScreenVertex { x: x + pixel.0 as f64, y: y + pixel.1 as f64, z: 1.0 }
        };
        let corners = along.map(place);
        for [a, b] in [[0, 1], [0, 2], [1, 2]] {
            if let Some(x) = crossing_of_row([&corners[a], &corners[b]], [pixel.0, pixel.1]) {
                prop_assert_eq!(x, (pixel.0 % TILE) as f32);
            }
        }
    }
}
