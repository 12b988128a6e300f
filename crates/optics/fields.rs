//! Widgets over a list of fields of their own (Kniss et al. 2003, Eq. 11 and 12): K (v − v₀) along a segment.

use super::Segment;
use voltet_core::transfer::MAX_FIELDS;

/// The fields of a widget, its centre and K.
#[derive(Debug, Clone)]
pub(super) struct Fields {
    /// Indices of its fields among the segment's.
    slots: [usize; MAX_FIELDS],
    count: usize,
    centre: [f64; MAX_FIELDS],
    matrix: [[f64; MAX_FIELDS]; MAX_FIELDS],
}

/// Field values at the ends of a segment; unused components are 0.
pub(super) struct Ends {
    /// K (v_f − v₀).
    pub front: [f64; MAX_FIELDS],
    /// K (v_b − v₀).
    pub back: [f64; MAX_FIELDS],
    /// K (v_b − v_f), from the raw difference.
    pub along: [f64; MAX_FIELDS],
}

impl Fields {
    /// `names` are the widget's fields, `fields` those of the segments.
    pub fn new(names: &[String], centre: &[f64], matrix: &[Vec<f64>], fields: &[&str]) -> Self {
        let mut own = Fields {
            slots: [0; MAX_FIELDS],
            count: names.len(),
            centre: [0.0; MAX_FIELDS],
            matrix: [[0.0; MAX_FIELDS]; MAX_FIELDS],
        };
        for (i, name) in names.iter().enumerate() {
            own.slots[i] = slot(name, fields);
            own.centre[i] = centre[i];
            own.matrix[i][..names.len()].copy_from_slice(&matrix[i]);
        }
        own
    }

    /// Along a segment.
    pub fn ends(&self, segment: &Segment) -> Ends {
        let n = self.count;
        let none = [0.0; MAX_FIELDS];
        let mut ends = Ends { front: none, back: none, along: none };
        for j in 0..n {
            let slot = self.slots[j];
            let (f, b) = (segment.fields_front[slot], segment.fields_back[slot]);
            let (from_f, from_b, delta) = (f - self.centre[j], b - self.centre[j], b - f);
            for i in 0..n {
                ends.front[i] += self.matrix[i][j] * from_f;
                ends.back[i] += self.matrix[i][j] * from_b;
                ends.along[i] += self.matrix[i][j] * delta;
            }
        }
        ends
    }
}

/// Index of a field among the segments'; the transfer function lists all that its widgets read.
pub(super) fn slot(name: &str, fields: &[&str]) -> usize {
    fields.iter().position(|field| *field == name).unwrap_or(0)
}
