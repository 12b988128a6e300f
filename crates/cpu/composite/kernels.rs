//! Kernels of a tile: each is compiled once a lane set; everything between them is plain code.

use crate::composite::fragment_lists::{FragmentLists, Overflow};
use crate::composite::frame::FrameContext;
use crate::fragments::batch::{Batch, MAX_LANES};
use crate::fragments::crossing::CellPacket;
use crate::fragments::slots::NextSlots;
use crate::fragments::spans::{Edges, Fragments};
use crate::project::tile_bins::TileBins;
use crate::shade::light::Rays;
use crate::shade::shaded_batch::ShadedBatch;
use crate::tile::{PIXELS, TileRect};
use crate::view::ScreenVertex;
use std::ops::Range;
use voltet_simd::{Kernel, Lanes, prefetch};

/// Finds the pixels that some cells cover.
pub(crate) struct Cover<'a> {
    pub bins: &'a TileBins,
    pub screen_vertices: &'a [ScreenVertex],
    pub cells: &'a [u32],
    /// Entries after these: their cells are prefetched one by one, so that the requests do not queue up.
    pub ahead: &'a [u32],
    pub rect: TileRect,
    pub rows: Range<usize>,
    /// Next free slots of the pixels' lists, where fragments go to lists.
    pub next: Option<&'a mut NextSlots>,
    pub packet: &'a mut CellPacket,
    pub edges: &'a mut Edges,
    pub fragments: &'a mut Fragments,
}

impl Kernel for Cover<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Cover { bins, screen_vertices, cells, ahead, rect, rows, next, packet, edges, fragments } = self;
        let TileRect { left, top, size, .. } = rect;
        for (lane, &entry) in cells.iter().enumerate() {
            if let Some(&next) = ahead.get(lane) {
                for corner in bins.cell(next).corners() {
                    prefetch(screen_vertices.as_ptr().wrapping_add(corner as usize));
                }
            }
            if let Some(&later) = ahead.get(L::WIDTH + lane) {
                bins.cell(later).prefetch();
            }
            let cell = bins.cell(entry);
            packet.take(lane, cell.planes(), cell.attributes());
            edges.take(lane, cell.corners().map(|p| &screen_vertices[p as usize]));
        }
        packet.transpose::<L>(left, top);
        edges.find::<L>(left, top, &rows);
        fragments.cover::<L>(edges, cells.len(), size[0], next);
    }
}

/// Intersects fragments with their cells, into a batch.
pub(crate) struct Evaluate<'a> {
    pub frame: &'a FrameContext<'a>,
    pub packet: &'a CellPacket,
    pub codes: &'a [u16],
    pub count: usize,
    pub length_per_depth: &'a [f32; PIXELS],
    pub batch: &'a mut Batch,
}

impl Kernel for Evaluate<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Evaluate { frame, packet, codes, count, length_per_depth, batch } = self;
        // Rays that end need depths, too.
        let ordered = frame.shader.one_color.is_none() || frame.depth_limit.is_some();
        if frame.view.perspective {
            packet.evaluate::<L, true>(codes, count, length_per_depth, frame.near, ordered, batch);
        } else {
            packet.evaluate::<L, false>(codes, count, length_per_depth, frame.near, ordered, batch);
        }
    }
}

/// Applies silhouettes and light to shaded segments.
pub(crate) struct Illuminate<'a> {
    pub frame: &'a FrameContext<'a>,
    pub batch: &'a Batch,
    pub count: usize,
    pub rays: &'a Rays,
    pub shaded: &'a mut ShadedBatch,
}

impl Kernel for Illuminate<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.frame.shader.light::<L>(self.batch, self.count, self.rays, self.shaded);
    }
}

/// Intersects fragments with their cells, into lists.
pub(crate) struct Append<'a> {
    pub frame: &'a FrameContext<'a>,
    pub packet: &'a CellPacket,
    pub fragments: &'a Fragments,
    pub lists: &'a mut FragmentLists,
}

impl Kernel for Append<'_> {
    /// Fragments that cross their cells.
    type Output = Result<u64, Overflow>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<u64, Overflow> {
        let Append { frame, packet, fragments, lists } = self;
        let Fragments { codes, slots, count, .. } = fragments;
        let (slots, near, quads) = (&slots[..count + MAX_LANES], frame.near, &mut lists.quads);
        let hits = if frame.view.perspective {
            packet.append::<L, true>(codes, slots, near, quads)
        } else {
            packet.append::<L, false>(codes, slots, near, quads)
        };
        if lists.is_over_full() { Err(Overflow) } else { Ok(hits) }
    }
}

/// Sorts a row of lists.
pub(crate) struct Arrange<'a> {
    pub lists: &'a mut FragmentLists,
    pub row: usize,
    pub sorted: bool,
}

impl Kernel for Arrange<'_> {
    /// Pixels whose segments are not in order.
    type Output = u64;
    #[inline(always)]
    fn run<L: Lanes>(self) -> u64 {
        self.lists.sort_row::<L>(self.row, self.sorted)
    }
}

/// Fills a batch from a row of lists.
pub(crate) struct Fill<'a> {
    pub lists: &'a FragmentLists,
    pub row: usize,
    pub slices: Range<usize>,
    pub length_per_depth: &'a [f32; PIXELS],
    pub depths: bool,
    pub batch: &'a mut Batch,
}

impl Kernel for Fill<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Fill { lists, row, slices, length_per_depth, depths, batch } = self;
        lists.fill::<L>(row, slices, length_per_depth, depths, batch);
    }
}
