//! The kernels of a tile: each is compiled once a lane set; everything between them is plain code.

use crate::composite::lists::{Lists, Next, Overflow};
use crate::fragments::batch::{Batch, LANES_MOST};
use crate::fragments::crossing::Group;
use crate::fragments::spans::{Edges, Fragments};
use crate::project::record::TILE;
use crate::sample::Frame;
use crate::shade::light::Rays;
use crate::shade::shaded::Shaded;
use std::ops::Range;
use voltet_simd::{Kernel, Lanes};

pub(crate) struct Cover<'a> {
    pub frame: &'a Frame<'a>,
    pub cells: &'a [u32],
    /// The entries after these: their records are asked for one by one, so that the requests do not queue up.
    pub ahead: &'a [u32],
    pub left: usize,
    pub top: usize,
    pub right: usize,
    pub rows: Range<usize>,
    /// The next free slots of the pixels' lists, where fragments go to lists.
    pub next: Option<&'a mut Next>,
    pub group: &'a mut Group,
    pub edges: &'a mut Edges,
    pub fragments: &'a mut Fragments,
}

impl Kernel for Cover<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        for (lane, &entry) in self.cells.iter().enumerate() {
            if let Some(&next) = self.ahead.get(lane) {
                self.frame.prefetch_corners(next);
            }
            if let Some(&later) = self.ahead.get(L::WIDTH + lane) {
                self.frame.prefetch(later);
            }
            let (record, attributes, corners) = self.frame.record(entry);
            self.group.take(lane, record, attributes);
            self.edges.take(lane, corners);
        }
        self.group.turn::<L>(self.left, self.top);
        self.edges.find::<L>(self.left, self.top, &self.rows);
        let width = self.right - self.left;
        let Cover { cells, edges, fragments, next, .. } = self;
        fragments.cover::<L>(edges, cells.len(), width, next);
    }
}

pub(crate) struct Evaluate<'a> {
    pub frame: &'a Frame<'a>,
    pub group: &'a Group,
    pub codes: &'a [u16],
    pub count: usize,
    pub stretch: &'a [f32; TILE * TILE],
    pub batch: &'a mut Batch,
}

impl Kernel for Evaluate<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Evaluate { frame, group, codes, count, stretch, batch } = self;
        // Rays that end ask for depths, too.
        let ordered = frame.shader.one_color.is_none() || frame.ends.is_some();
        if frame.view.perspective {
            group.evaluate::<L, true>(codes, count, stretch, frame.near, ordered, batch);
        } else {
            group.evaluate::<L, false>(codes, count, stretch, frame.near, ordered, batch);
        }
    }
}

pub(crate) struct Illuminate<'a> {
    pub frame: &'a Frame<'a>,
    pub batch: &'a Batch,
    pub count: usize,
    pub rays: &'a Rays,
    pub shaded: &'a mut Shaded,
}

impl Kernel for Illuminate<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.frame.shader.light::<L>(self.batch, self.count, self.rays, self.shaded);
    }
}

pub(crate) struct Append<'a> {
    pub frame: &'a Frame<'a>,
    pub group: &'a Group,
    pub fragments: &'a Fragments,
    pub lists: &'a mut Lists,
}

impl Kernel for Append<'_> {
    /// Fragments that cross their cells.
    type Output = Result<u64, Overflow>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<u64, Overflow> {
        let Append { frame, group, fragments, lists } = self;
        let Fragments { codes, places, count, .. } = fragments;
        let (places, near, fours) = (&places[..count + LANES_MOST], frame.near, &mut lists.fours);
        let hits = if frame.view.perspective {
            group.append::<L, true>(codes, places, near, fours)
        } else {
            group.append::<L, false>(codes, places, near, fours)
        };
        if lists.is_over_full() { Err(Overflow) } else { Ok(hits) }
    }
}

pub(crate) struct Arrange<'a> {
    pub lists: &'a mut Lists,
    pub row: usize,
    pub sorted: bool,
}

impl Kernel for Arrange<'_> {
    /// Pixels whose segments are not in order.
    type Output = u64;
    #[inline(always)]
    fn run<L: Lanes>(self) -> u64 {
        self.lists.arrange::<L>(self.row, self.sorted)
    }
}

pub(crate) struct Fill<'a> {
    pub lists: &'a Lists,
    pub row: usize,
    pub slices: Range<usize>,
    pub stretch: &'a [f32; TILE * TILE],
    pub places: bool,
    pub batch: &'a mut Batch,
}

impl Kernel for Fill<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Fill { lists, row, slices, stretch, places, batch } = self;
        lists.fill::<L>(row, slices, stretch, places, batch);
    }
}
