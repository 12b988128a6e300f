//! A table: which texels a path crosses, and what it is between two lines of their centres.

use crate::cuts::Cuts;
use crate::linear_on_segment::{LinearOnSegment, Place, Wide, quadratic_crossings};
use std::sync::Arc;
use voltet_core::transfer::Table;

pub(crate) struct Texels {
    table: Arc<Table>,
    columns: Axis,
    rows: Axis,
}

/// Lines of texel centres along one axis.
struct Axis {
    start: f64,
    /// From one line to the next; negative for rows, whose first is at the largest g.
    pitch: Wide,
    count: usize,
}

/// Weights of two neighbouring lines at a place.
type Shares = [f64; 2];

impl Axis {
    fn new(start: f64, end: f64, count: usize) -> Axis {
        Axis { start, pitch: Wide::difference(end, start) / Wide::from(count as f64), count }
    }

    fn line(&self, index: usize) -> Wide {
        Wide::from(self.start) + self.pitch * (index as f64 + 0.5)
    }

    /// The number of the line at or before a value, as near as doubles tell.
    fn index(&self, value: Wide) -> usize {
        let index = (value - Wide::from(self.start)).value() / self.pitch.value() - 0.5;
        (index.max(0.0) as usize).min(self.count.saturating_sub(2))
    }

    /// The first of the two lines between which a stretch lies, and their weights at its ends.
    fn between(&self, ends: [Wide; 2]) -> (usize, [Shares; 2]) {
        if self.count == 1 {
            return (0, [[1.0, 0.0]; 2]);
        }
        let middle = (ends[0] + ends[1]).half();
        let mut first = self.index(middle);
        let weights = |first: usize, value: Wide| {
            let pitch = self.pitch.value();
            // Each from its own line: what is 0 at one of them keeps its digits there.
            [(self.line(first + 1) - value).value() / pitch, (value - self.line(first)).value() / pitch]
        };
        let [low, high] = weights(first, middle);
        if high < 0.0 && first > 0 {
            first -= 1;
        } else if low < 0.0 && first + 2 < self.count {
            first += 1;
        }
        // Before the first line and behind the last one the table is constant.
        (first, ends.map(|value| weights(first, value).map(|weight| weight.clamp(0.0, 1.0))))
    }
}

impl Texels {
    pub(crate) fn new(table: Arc<Table>) -> Texels {
        let columns = Axis::new(table.s[0], table.s[1], table.width);
        let rows = Axis::new(table.g[1], table.g[0], table.height);
        Texels { table, columns, rows }
    }

    /// Alpha and colour on a stretch between two lines: quadratic polynomials of u, by their Bernstein coefficients,
    /// none of them negative. `from`, `to`: s and g at its ends.
    pub(crate) fn patch(&self, from: [Wide; 2], to: [Wide; 2]) -> [[f64; 4]; 3] {
        let (column, across) = self.columns.between([from[0], to[0]]);
        let (row, down) = self.rows.between([from[1], to[1]]);
        let texel = |i: usize, j: usize| {
            let Table { width, height, texels, .. } = &*self.table;
            let [r, g, b, alpha] = texels[(row + j).min(height - 1) * width + (column + i).min(width - 1)];
            [alpha, r, g, b].map(f64::from)
        };
        let texels = [[texel(0, 0), texel(1, 0)], [texel(0, 1), texel(1, 1)]];
        let mix = |across: Shares, down: Shares| -> [f64; 4] {
            std::array::from_fn(|c| {
                let row = |j: usize| across[0] * texels[j][0][c] + across[1] * texels[j][1][c];
                down[0] * row(0) + down[1] * row(1)
            })
        };
        let (one, other) = (mix(across[0], down[1]), mix(across[1], down[0]));
        let middle = std::array::from_fn(|c| 0.5 * (one[c] + other[c]));
        [mix(across[0], down[0]), middle, mix(across[1], down[1])]
    }

    /// Lines of texel centres, and where alpha passes the cutoff between them.
    pub(crate) fn features(&self, along: &[LinearOnSegment], cutoff: Option<f64>, cuts: &mut Cuts) {
        let [from, to] = cuts.window();
        let mut places = Vec::new();
        for (axis, along) in [&self.columns, &self.rows].into_iter().zip(along) {
            let ends = [from, to].map(|place| axis.index(along.at(place)));
            let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            // One more on each side than doubles tell.
            for line in low.saturating_sub(1)..=(high + 2).min(axis.count - 1) {
                let place = along.passes(axis.line(line));
                cuts.firm(place);
                places.extend(place.filter(|p| from.is_before(*p) && p.is_before(to)));
            }
        }
        let Some(cutoff) = cutoff else { return };
        places.extend([from, to]);
        places.sort_unstable_by(|a, b| a.order(*b));
        for pair in places.windows(2) {
            let values = |place: Place| [along[0].at(place), along[1].at(place)];
            let [p, q, r] = self.patch(values(pair[0]), values(pair[1])).map(|channels| channels[0] - cutoff);
            quadratic_crossings(p - 2.0 * q + r, q - p, p, |u| {
                if u > 0.0 && u < 1.0 {
                    cuts.firm(Some(pair[0].moved(pair[0].distance_to(pair[1]) * u)));
                }
            });
        }
    }
}
