//! A segment laid out: the stretches between its cuts, and what each widget is on them.

use crate::cuts::{Cuts, End};
use crate::linear_on_segment::{LinearOnSegment, Place, Wide};
use crate::part::Part;
use crate::term::Term;
use std::cell::LazyCell;
use voltet_core::Result;

/// A part of the segment on which every widget is smooth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    /// Share of the segment's length.
    pub(crate) share: f64,
    /// Its begin, as a share of the length: for messages.
    pub(crate) begin: f64,
    /// It lies between two features that are too near to each other for its length to be known.
    pub(crate) blurred: bool,
    first: u32,
    last: u32,
}

/// The widgets that a segment meets, stretch by stretch. Buffers that are kept from segment to segment.
#[derive(Default)]
pub(crate) struct Layout {
    pub(crate) stretches: Vec<Interval>,
    parts: Vec<Part>,
    numbers: Vec<f64>,
    /// Coordinates of the widgets that the segment meets.
    along: Vec<LinearOnSegment>,
    met: Vec<ActiveWidget>,
    cuts: Cuts,
    ends: Vec<End>,
    from: Vec<Wide>,
    to: Vec<Wide>,
}

/// A widget that the segment meets.
struct ActiveWidget {
    term: usize,
    window: [Place; 2],
    /// True if the window is all of the segment.
    everywhere: bool,
    end: usize,
}

impl Layout {
    /// Lays out the segment from `front` to `back` (each [s, g, fields …]); stretches without a widget are left out.
    pub(crate) fn lay_out(
        &mut self,
        terms: &[Term],
        front: &[f64],
        back: &[f64],
        cutoff: Option<f64>,
    ) -> Result<()> {
        self.along.clear();
        self.met.clear();
        self.cuts.clear();
        for (number, term) in terms.iter().enumerate() {
            let Some(window) = term.window(front, back) else { continue };
            let start = self.along.len();
            term.coordinates(front, back, &mut self.along);
            self.cuts.begin(window);
            term.features(&self.along[start..], cutoff, &mut self.cuts)?;
            let everywhere = window == [Place::FRONT, Place::BACK];
            self.met.push(ActiveWidget { term: number, window, everywhere, end: self.along.len() });
        }
        self.cuts.ends(&mut self.ends);
        self.stretches.clear();
        self.parts.clear();
        self.numbers.clear();
        values(&self.along, Place::FRONT, &mut self.to);
        for pair in self.ends.windows(2) {
            let [from, to] = [pair[0].place, pair[1].place];
            std::mem::swap(&mut self.from, &mut self.to);
            values(&self.along, to, &mut self.to);
            let middle = LazyCell::new(|| from.middle(to));
            let parts = self.parts.len();
            let mut start = 0;
            for met in &self.met {
                let range = std::mem::replace(&mut start, met.end)..met.end;
                // Between two cuts no edge is passed, so the middle speaks for the whole stretch.
                if met.everywhere || met.window[0].is_before(*middle) && middle.is_before(met.window[1]) {
                    let ends = [&self.from[range.clone()], &self.to[range]];
                    self.parts.extend(terms[met.term].on_stretch(met.term, ends, cutoff, &mut self.numbers));
                }
            }
            if self.parts.len() > parts {
                self.stretches.push(Interval {
                    share: from.distance_to(to).value(),
                    begin: from.share(),
                    blurred: pair[1].blurred,
                    first: parts as u32,
                    last: self.parts.len() as u32,
                });
            }
        }
        Ok(())
    }

    pub(crate) fn parts(&self, stretch: &Interval) -> &[Part] {
        &self.parts[stretch.first as usize..stretch.last as usize]
    }

    /// The numbers that parts are stated by.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.numbers
    }
}

fn values(along: &[LinearOnSegment], place: Place, out: &mut Vec<Wide>) {
    out.clear();
    out.extend(along.iter().map(|a| a.at(place)));
}
