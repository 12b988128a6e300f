//! The part of a segment inside a convex region. Twin of `optics::clip`.
//!
//! Works on the signed distances of both ends from each edge, positive inside; an end on an edge is inside. The
//! distances are formed in 64 bits, or from coordinates that 32 bits hold, before they come here.

use crate::{Float, Lanes, Mask};

/// A part [t₀, t₁] of each lane's segment, with the complements 1 − t known by themselves.
#[derive(Clone, Copy)]
pub struct LaneStretch<L: Lanes> {
    /// t₀.
    pub start: L::F,
    /// 1 − t₀.
    pub start_to_back: L::F,
    /// t₁.
    pub end: L::F,
    /// 1 − t₁.
    pub end_to_back: L::F,
    /// t₁ − t₀; ≤ 0 where nothing is inside.
    pub length: L::F,
}

impl<L: Lanes> LaneStretch<L> {
    /// The whole segment.
    #[inline(always)]
    pub fn whole() -> Self {
        let (zero, one) = (L::F::splat(0.0), L::F::splat(1.0));
        LaneStretch { start: zero, start_to_back: one, end: one, end_to_back: zero, length: one }
    }

    /// Cuts by one edge.
    #[inline(always)]
    #[must_use]
    pub fn cut(self, front: L::F, back: L::F) -> Self {
        let zero = L::F::splat(0.0);
        let (front_out, back_out) = (front.lt(zero), back.lt(zero));
        let inverse = L::F::splat(1.0) / (front - back);
        // Share of the crossing from the front and to the back.
        let (t, u) = (front * inverse, -(back * inverse));
        let entry = front_out.and(back_out.not()).and(self.start.lt(t));
        let exit = back_out.and(front_out.not()).and(t.lt(self.end));
        let none = front_out.and(back_out);
        let start = L::F::select(entry, t, self.start);
        let start_to_back = L::F::select(entry, u, self.start_to_back);
        let end = L::F::select(none, -L::F::splat(1.0), L::F::select(exit, t, self.end));
        let end_to_back = L::F::select(none, L::F::splat(2.0), L::F::select(exit, u, self.end_to_back));
        // The difference of the smaller numbers rounds less.
        let near_back = L::F::splat(0.5).lt(start);
        let length = L::F::select(near_back, start_to_back - end_to_back, end - start);
        LaneStretch { start, start_to_back, end, end_to_back, length }
    }

    /// The value at the start of what is `front` and `back` at the segment's ends.
    #[inline(always)]
    pub fn at_start(&self, front: L::F, back: L::F) -> L::F {
        front.mul_add(self.start_to_back, back * self.start)
    }

    /// The value at the end.
    #[inline(always)]
    pub fn at_end(&self, front: L::F, back: L::F) -> L::F {
        front.mul_add(self.end_to_back, back * self.end)
    }
}
