//! Breakpoints of a segment: every place where a widget changes its character.

use crate::linear_on_segment::{Place, Wide};

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
