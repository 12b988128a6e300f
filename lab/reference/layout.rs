//! A segment laid out: its breakpoints, where a widget changes its character, the stretches between them, and what each widget is on them.

use crate::linear_on_segment::{LinearOnSegment, Place, Wide};
use crate::part::Part;
use crate::term::Term;
use std::cell::LazyCell;
use voltet_core::Result;

/// Two features nearer to each other than this share of their distance from the nearer end are one that was found in
/// two ways: eight bits above the rounding of places.
const ONE_PLACE: f64 = 1.3e-29;

/// Features that are nearer to each other than this, but not one, are told from one another with fewer than twelve
/// digits.
const TOO_NEAR: f64 = 1e-19;

#[derive(Debug, Clone, Copy)]
struct Cut {
    place: Place,
    /// True if something begins, ends or breaks there; else the cut only helps the quadrature.
    firm: bool,
}

pub(crate) struct Cuts {
    list: Vec<Cut>,
    /// Interval of the widget: cuts outside are of no use to it.
    window: [Place; 2],
}

/// A place where one stretch ends and the next begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct End {
    pub(crate) place: Place,
    /// Something else begins or ends so near before it that the distance is not known well.
    pub(crate) blurred: bool,
}

impl Default for Cuts {
    fn default() -> Self {
        Cuts { list: Vec::new(), window: [Place::FRONT, Place::BACK] }
    }
}

impl Cuts {
    pub(crate) fn clear(&mut self) {
        self.list.clear();
    }

    /// The cuts to come belong to a widget that is between these places only.
    pub(crate) fn begin(&mut self, window: [Place; 2]) {
        self.window = window;
        for end in window {
            if end != Place::FRONT && end != Place::BACK {
                self.list.push(Cut { place: end, firm: true });
            }
        }
    }

    pub(crate) fn window(&self) -> [Place; 2] {
        self.window
    }

    /// Something begins, ends or breaks here.
    pub(crate) fn firm(&mut self, place: Option<Place>) {
        self.push(place, true);
    }

    /// The quadrature is helped by a cut here.
    pub(crate) fn soft(&mut self, place: Option<Place>) {
        self.push(place, false);
    }

    fn push(&mut self, place: Option<Place>, firm: bool) {
        let [from, to] = self.window;
        if let Some(place) = place.filter(|place| from.is_before(*place) && place.is_before(to)) {
            self.list.push(Cut { place, firm });
        }
    }

    /// The ends of all stretches in their order, the front's and the back's among them.
    pub(crate) fn ends(&mut self, ends: &mut Vec<End>) {
        ends.clear();
        ends.push(End { place: Place::FRONT, blurred: false });
        self.list.sort_unstable_by(|a, b| a.place.order(b.place));
        let mut last = Cut { place: Place::FRONT, firm: true };
        let mut last_firm = Place::FRONT;
        let back = Cut { place: Place::BACK, firm: true };
        for cut in self.list.iter().copied().chain([back]) {
            let apart = relative_distance(last.place, cut.place);
            if cut.firm {
                if !last.firm && apart < TOO_NEAR {
                    ends.pop();
                }
                let from_firm = relative_distance(last_firm, cut.place);
                last = Cut { place: last_firm, firm: true };
                if from_firm < ONE_PLACE {
                    continue;
                }
                last_firm = cut.place;
                ends.push(End { place: cut.place, blurred: from_firm < TOO_NEAR });
            } else if apart < if last.firm { TOO_NEAR } else { ONE_PLACE } {
                continue;
            } else {
                ends.push(End { place: cut.place, blurred: false });
            }
            last = cut;
        }
    }
}

/// The distance of two places, as a share of their distance from the nearer end.
fn relative_distance(a: Place, b: Place) -> f64 {
    let distance: Wide = a.distance_to(b);
    distance.value() / a.nearer_end().max(b.nearer_end())
}

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
