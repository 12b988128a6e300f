//! Boundary hits: the boundary faces by which the rays of a tile enter and exit.

use super::edge_functions::{Offset, edge_function, edges_inside, moved_by_depth};
use super::half_faces::EXIT_FLAG;
use super::points::Points;
use super::ray_caster::RayCaster;
use crate::fragments::batch::MAX_LANES;
use crate::tile::{PIXELS, TILE, TileRect};
use voltet_simd::{Float, Kernel, LaneSet, Lanes, Mask, Unsigned, array, dispatch, inlined, mask_of};

/// Entry of a ray.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry {
    /// Depth (steps).
    pub depth: u32,
    /// Number of the boundary face.
    pub face: u32,
}

/// Boundary faces by which the rays of a tile enter and exit.
#[derive(Debug)]
pub(crate) struct BoundaryHits {
    /// Entries in the order of faces, with the pixels.
    unsorted: Vec<(u8, Entry)>,
    /// First entry of each pixel; then the end of the last.
    starts: [u32; PIXELS + 1],
    /// Entries pixel by pixel, by depth.
    entries: Vec<Entry>,
    /// Sum of the numbers of the half-faces by which each pixel's ray exits, each with [`EXIT_FLAG`].
    exit_checksum: [u32; PIXELS],
}

impl Default for BoundaryHits {
    fn default() -> BoundaryHits {
        BoundaryHits {
            unsorted: Vec::new(),
            starts: [0; PIXELS + 1],
            entries: Vec::new(),
            exit_checksum: [0; PIXELS],
        }
    }
}

impl BoundaryHits {
    /// Finds the hits of a tile's rays.
    pub fn find(&mut self, caster: &RayCaster, lanes: LaneSet, rect: TileRect) {
        self.unsorted.clear();
        self.exit_checksum = [0; PIXELS];
        let BoundaryHits { unsorted, exit_checksum, .. } = self;
        dispatch(lanes, FindHits { caster, rect, unsorted, exit_checksum });
        let mut next = [0u32; PIXELS + 1];
        for (pixel, _) in &self.unsorted {
            next[usize::from(*pixel) + 1] += 1;
        }
        for pixel in 0..PIXELS {
            next[pixel + 1] += next[pixel];
        }
        self.starts = next;
        self.entries.resize(self.unsorted.len(), Entry::default());
        for &(pixel, entry) in &self.unsorted {
            let slot = &mut next[usize::from(pixel)];
            self.entries[*slot as usize] = entry;
            *slot += 1;
        }
        for pixel in 0..PIXELS {
            self.entries[self.starts[pixel] as usize..self.starts[pixel + 1] as usize].sort_unstable();
        }
    }

    /// Entries of a pixel's ray, the nearest first.
    pub(super) fn entries_of(&self, pixel: usize) -> &[Entry] {
        &self.entries[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }

    /// Sum of the numbers of the half-faces by which a pixel's ray exits, each with [`EXIT_FLAG`].
    pub fn exit_checksum(&self, pixel: usize) -> u32 {
        self.exit_checksum[pixel]
    }
}

struct FindHits<'a> {
    caster: &'a RayCaster,
    rect: TileRect,
    unsorted: &'a mut Vec<(u8, Entry)>,
    exit_checksum: &'a mut [u32; PIXELS],
}

impl Kernel for FindHits<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let FindHits { caster, rect, unsorted, exit_checksum } = self;
        let TileRect { tile, left, top, size } = rect;
        let points = &caster.points;
        let Points { pixel_bits: bits, pixel, ray_spacing, ray_spread, .. } = *points;
        for &number in caster.boundary.faces_of(tile) {
            let face = caster.half_faces.boundary[number as usize];
            let corner = |k: usize| {
                let [x, y, depth, _] = points.quads[0][face.corners[k] as usize];
                [x.to_bits(), y.to_bits(), depth.to_bits()]
            };
            let corners = [corner(0), corner(1), corner(2)];
            // From the tile's first row, in whole rows.
            let tile_top = (top << bits) as u32;
            let row_of = |k: usize| i64::from(corners[k][1].wrapping_sub(tile_top) as i32) >> bits;
            let (a, b, c) = (row_of(0), row_of(1), row_of(2));
            let [first, last] = if ray_spread == 0 {
                [a.min(b).min(c), a.max(b).max(c) + 1]
                    .map(inlined!(|row: i64| row.clamp(0, size[1] as i64) as usize))
            } else {
                [0, size[1]]
            };
            for row in first..last {
                for half in (0..size[0]).step_by(L::WIDTH) {
                    let column = L::U::iota() + L::U::splat((left + half) as u32);
                    let spacing = L::U::splat(ray_spacing);
                    let of_ray = [column, L::U::splat((top + row) as u32)];
                    let at: [Offset<L>; 3] = array!(|k| {
                        let scaled = inlined!(|axis: usize| {
                            let mut position = L::U::splat(corners[k][axis]) - of_ray[axis] * spacing;
                            if ray_spread != 0 {
                                let spread = of_ray[axis] * L::U::splat(ray_spread);
                                let moved = moved_by_depth::<L>(L::U::splat(corners[k][2]), spread);
                                position = position - moved;
                            }
                            position.to_float() * L::F::splat(pixel)
                        });
                        [scaled(0), scaled(1)]
                    });
                    let edges = [[at[0], at[1]], [at[1], at[2]], [at[2], at[0]]];
                    let functions = [
                        edge_function::<L>(at[0], at[1]),
                        edge_function::<L>(at[1], at[2]),
                        edge_function::<L>(at[2], at[0]),
                    ];
                    let (side_0, side_1, side_2) = edges_inside::<L>(functions, edges);
                    let valid = u32::MAX >> (32 - L::WIDTH.min(size[0] - half));
                    let mut in_by = side_0.and(side_1).and(side_2).bits() & valid;
                    let out_by = side_0.or(side_1).or(side_2).not();
                    let first = row * TILE + half;
                    if out_by.bits() & valid != 0 {
                        let of_half = &mut exit_checksum[first..];
                        let (sum, more) = (L::U::load(of_half), L::U::splat(EXIT_FLAG | face.half_face));
                        let out_by = mask_of::<L>(out_by.bits() & valid);
                        L::U::select(out_by, sum + more, sum).store(of_half);
                    }
                    if in_by == 0 {
                        continue;
                    }
                    // Each corner's weight is the edge function of the other two. From the nearest corner, so that nothing is less than 0.
                    let total =
                        (functions[0] + functions[1] + functions[2]).max(L::F::splat(f32::MIN_POSITIVE));
                    let nearest = corners[0][2].min(corners[1][2]).min(corners[2][2]);
                    let farther = inlined!(|k: usize| L::F::splat((corners[k][2] - nearest) as f32));
                    let above = functions[1]
                        .mul_add(farther(0), functions[2].mul_add(farther(1), functions[0] * farther(2)));
                    let mut depths = [0; MAX_LANES];
                    (L::U::splat(nearest) + (above / total).to_unsigned()).store(&mut depths);
                    while in_by != 0 {
                        let lane = in_by.trailing_zeros() as usize;
                        unsorted.push(((first + lane) as u8, Entry { depth: depths[lane], face: number }));
                        in_by &= in_by - 1;
                    }
                }
            }
        }
    }
}
