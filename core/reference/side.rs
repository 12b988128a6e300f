//! A region as an intersection of half planes of the (s, g) plane.

use super::along::Along;
use crate::transfer::Region;
use crate::{Error, Result};

/// The half plane normal · (v − origin) ≥ 0; its boundary belongs to it.
pub(super) struct Side {
    origin: [f64; 2],
    normal: [f64; 2],
}

impl Side {
    /// normal · (v − origin) along a path from `front` to `back`.
    pub(super) fn along(&self, front: &[f64], back: &[f64]) -> Along {
        let value = |v: &[f64]| {
            // A normal along an axis must not multiply the other axis into the value (0 × ∞).
            let part =
                |k: usize| if self.normal[k] == 0.0 { 0.0 } else { self.normal[k] * (v[k] - self.origin[k]) };
            part(0) + part(1)
        };
        Along { front: value(front), back: value(back) }
    }
}

/// The half planes of a region. Rectangles may have infinite limits, which give none.
pub(super) fn sides_of(region: &Region) -> Result<Vec<Side>> {
    let corners = &region.corners;
    let refuse = |what: &str| Err(Error::usage(what.to_owned()).found(format!("{corners:?}")));
    if corners.len() < 3 || corners.iter().flatten().any(|c| c.is_nan()) {
        return refuse("a region has fewer than three corners, or one that is not a number");
    }
    if let Some(limits) = rectangle(corners) {
        let mut sides = Vec::new();
        for (axis, [low, high]) in limits.into_iter().enumerate() {
            for (limit, sign) in [(low, 1.0), (high, -1.0)] {
                if limit.is_finite() {
                    let (mut origin, mut normal) = ([0.0; 2], [0.0; 2]);
                    (origin[axis], normal[axis]) = (limit, sign);
                    sides.push(Side { origin, normal });
                }
            }
        }
        return Ok(sides);
    }
    if !corners.iter().flatten().all(|c| c.is_finite()) {
        return refuse("a region that is not a rectangle has an infinite corner");
    }
    let edge = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        [b[0] - a[0], b[1] - a[1]]
    };
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
    let turn = twice_area.signum();
    Ok((0..corners.len())
        .map(|k| (corners[k], edge(k)))
        .filter(|(_, e)| *e != [0.0, 0.0])
        .map(|(origin, e)| Side { origin, normal: [-turn * e[1], turn * e[0]] })
        .collect())
}

/// [[s_low, s_high], [g_low, g_high]] when the corners are those of a rectangle along the axes.
fn rectangle(corners: &[[f64; 2]]) -> Option<[[f64; 2]; 2]> {
    let [a, b, c, d] = corners else { return None };
    let along_first = a[1] == b[1] && b[0] == c[0] && c[1] == d[1] && d[0] == a[0];
    let along_second = a[0] == b[0] && b[1] == c[1] && c[0] == d[0] && d[1] == a[1];
    (along_first || along_second)
        .then(|| [[a[0].min(c[0]), a[0].max(c[0])], [a[1].min(c[1]), a[1].max(c[1])]])
}
