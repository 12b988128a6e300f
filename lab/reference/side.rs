//! A region as an intersection of half planes of the (s, g) plane.

use crate::linear_on_segment::LinearOnSegment;
use crate::wide::Wide;
use voltet_core::transfer::Region;
use voltet_core::{Error, Result};

/// The half plane normal · (v − origin) ≥ 0; its boundary belongs to it.
pub(crate) struct Side {
    origin: [f64; 2],
    normal: [Wide; 2],
}

impl Side {
    /// normal · (v − origin) along a path from `front` to `back`.
    pub(crate) fn on_segment(&self, front: &[f64], back: &[f64]) -> LinearOnSegment {
        LinearOnSegment::new(front, back, (0..2).map(|axis| (axis, self.normal[axis], self.origin[axis])))
    }

    /// The side of the limit on an axis (0: s, 1: g) where values are larger, or smaller.
    fn of_limit(axis: usize, limit: f64, larger: bool) -> Side {
        let mut side = Side { origin: [0.0; 2], normal: [Wide::ZERO; 2] };
        side.origin[axis] = limit;
        side.normal[axis] = Wide::from(if larger { 1.0 } else { -1.0 });
        side
    }
}

/// The half planes of a rectangle; infinite limits give none.
fn sides_of_rectangle(limits: [[f64; 2]; 2]) -> Vec<Side> {
    let mut sides = Vec::new();
    for (axis, [low, high]) in limits.into_iter().enumerate() {
        let limits = [(low, true), (high, false)].into_iter().filter(|(limit, _)| limit.is_finite());
        sides.extend(limits.map(|(limit, larger)| Side::of_limit(axis, limit, larger)));
    }
    sides
}

/// The half planes of a region. Rectangles may have infinite limits, which give none.
pub(crate) fn sides_of(region: &Region) -> Result<Vec<Side>> {
    let corners = &region.corners;
    let refuse = |what: &str| Err(Error::usage(what.to_owned()).got(format!("{corners:?}")));
    if corners.len() < 3 || corners.iter().flatten().any(|c| c.is_nan()) {
        return refuse("a region has fewer than three corners, or one that is not a number");
    }
    if let Some(limits) = rectangle(corners) {
        return Ok(sides_of_rectangle(limits));
    }
    if !corners.iter().flatten().all(|c| c.is_finite()) {
        return refuse("a region that is not a rectangle has an infinite corner");
    }
    let twice_area: f64 = (1..corners.len() - 1)
        .map(|k| {
            let from_first = |c: [f64; 2]| [c[0] - corners[0][0], c[1] - corners[0][1]];
            let (a, b) = (from_first(corners[k]), from_first(corners[k + 1]));
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    if twice_area == 0.0 {
        return refuse("a region has no area");
    }
    let edge = |k: usize| {
        // Counted from the same corner in every region that has this edge, so that all pass it at one place.
        let ends = [corners[k], corners[(k + 1) % corners.len()]];
        let [a, b] = if ends[0] <= ends[1] { ends } else { [ends[1], ends[0]] };
        let inwards = (twice_area > 0.0) == (ends[0] <= ends[1]);
        let sign = if inwards { 1.0 } else { -1.0 };
        let normal = [Wide::difference(a[1], b[1]) * sign, Wide::difference(b[0], a[0]) * sign];
        (a != b).then_some(Side { origin: a, normal })
    };
    Ok((0..corners.len()).filter_map(edge).collect())
}

/// [[s_low, s_high], [g_low, g_high]] when the corners are those of a rectangle along the axes.
fn rectangle(corners: &[[f64; 2]]) -> Option<[[f64; 2]; 2]> {
    let [a, b, c, d] = corners else { return None };
    let along_first = a[1] == b[1] && b[0] == c[0] && c[1] == d[1] && d[0] == a[0];
    let along_second = a[0] == b[0] && b[1] == c[1] && c[0] == d[0] && d[1] == a[1];
    (along_first || along_second)
        .then(|| [[a[0].min(c[0]), a[0].max(c[0])], [a[1].min(c[1]), a[1].max(c[1])]])
}
