//! The kernels of a tile: each is compiled once a lane set; everything between them is plain code.

use crate::composite::lists::{Lists, Overflow, Resolve};
use crate::composite::sinks::TilePicture;
use crate::fragments::batch::Batch;
use crate::fragments::crossing::Group;
use crate::fragments::spans::{Edges, Fragments};
use crate::project::record::TILE;
use crate::sample::Frame;
use crate::shade::light::Rays;
use crate::shade::shaded::Shaded;
use std::ops::Range;
use voltet_lanes::{Kernel, Lanes};

pub(crate) struct Cover<'a> {
    pub frame: &'a Frame<'a>,
    pub cells: &'a [u32],
    /// The entries after these: their records are asked for one by one, so that the requests do not queue up.
    pub ahead: &'a [u32],
    pub left: usize,
    pub top: usize,
    pub right: usize,
    pub rows: Range<usize>,
    /// Pixels that take fragments, a bit a column, where some do not.
    pub open: Option<&'a [u16; TILE]>,
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
        let Cover { cells, edges, fragments, .. } = self;
        match self.open {
            None => fragments.cover::<L, false>(edges, cells.len(), width, &[]),
            Some(open) => fragments.cover::<L, true>(edges, cells.len(), width, open),
        }
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
        // Rays that end and segments that are kept ask for depths, too.
        let ordered = frame.shader.one_color.is_none() || frame.ends.is_some() || frame.keeping.is_some();
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
    pub lists: &'a mut Lists,
    pub batch: &'a Batch,
    pub shaded: &'a Shaded,
    pub count: usize,
}

impl Kernel for Append<'_> {
    type Output = Result<(), Overflow>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Result<(), Overflow> {
        self.lists.take::<L>(self.batch, self.shaded, self.count)
    }
}

pub(crate) struct Arrange<'a> {
    pub lists: &'a mut Lists,
    pub row: usize,
}

impl Kernel for Arrange<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.lists.arrange::<L>(self.row);
    }
}

pub(crate) struct Blend<'a> {
    pub lists: &'a mut Lists,
    pub sorted: bool,
    pub picture: &'a mut TilePicture,
    pub resolve: Resolve<'a>,
}

impl Kernel for Blend<'_> {
    /// Pixels composited out of order.
    type Output = u64;
    #[inline(always)]
    fn run<L: Lanes>(self) -> u64 {
        self.lists.composite::<L>(self.sorted, self.picture, self.resolve)
    }
}
