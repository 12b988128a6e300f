//! Gaussians over a list of fields of their own (Kniss et al. 2003, Eq. 11 and 12): the path in widths.

use super::Segment;
use super::gaussian::GaussianPath;
use crate::transfer::FIELDS_MOST;

/// A gaussian-nd widget made ready.
#[derive(Debug, Clone)]
pub(super) struct GaussianNd {
    /// Where its fields lie in the segment's.
    slots: [usize; FIELDS_MOST],
    count: usize,
    centre: [f64; FIELDS_MOST],
    matrix: [[f64; FIELDS_MOST]; FIELDS_MOST],
}

impl GaussianNd {
    /// `names` are the widget's fields, `fields` those of the segments.
    pub fn new(names: &[String], centre: &[f64], matrix: &[Vec<f64>], fields: &[&str]) -> Self {
        let mut nd = GaussianNd {
            slots: [0; FIELDS_MOST],
            count: names.len(),
            centre: [0.0; FIELDS_MOST],
            matrix: [[0.0; FIELDS_MOST]; FIELDS_MOST],
        };
        for (i, name) in names.iter().enumerate() {
            nd.slots[i] = fields.iter().position(|f| f == name).unwrap_or(0);
            nd.centre[i] = centre[i];
            nd.matrix[i][..names.len()].copy_from_slice(&matrix[i]);
        }
        nd
    }

    /// Along a segment.
    pub fn path(&self, segment: &Segment) -> GaussianPath {
        let n = self.count;
        let (mut front, mut back, mut along) = ([0.0; FIELDS_MOST], [0.0; FIELDS_MOST], [0.0; FIELDS_MOST]);
        for j in 0..n {
            let slot = self.slots[j];
            let (f, b) = (segment.fields_front[slot], segment.fields_back[slot]);
            let (from_f, from_b, delta) = (f - self.centre[j], b - self.centre[j], b - f);
            for i in 0..n {
                front[i] += self.matrix[i][j] * from_f;
                back[i] += self.matrix[i][j] * from_b;
                along[i] += self.matrix[i][j] * delta;
            }
        }
        GaussianPath::new(front, back, along)
    }
}
