//! Regions of the (s, g) plane, and their half-planes.

/// A convex polygon in the (s, g) plane, corners in either orientation, at least three.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Corners [s, g].
    pub corners: Vec<[f64; 2]>,
}

/// The points v of the (s, g) plane with normal · (v − corner) ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Points inwards; of any length.
    pub normal: [f64; 2],
    /// A point of its edge; 0 along an axis that the normal has no part in.
    pub corner: [f64; 2],
}

impl Region {
    /// A rectangle; infinite limits (an axis that was not limited) are allowed.
    pub fn rectangle(s: [f64; 2], g: [f64; 2]) -> Self {
        Region { corners: vec![[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]] }
    }

    /// False for a strip that is limited in s only.
    pub fn depends_on_g(&self) -> bool {
        self.corners.iter().any(|c| c[1].is_finite())
    }

    /// True if a place lies within; the boundary belongs to it.
    pub fn holds(&self, v: [f64; 2]) -> bool {
        self.half_planes().iter().all(|plane| {
            let part = |k: usize| plane.normal[k] * (v[k] - plane.corner[k]);
            part(0) + part(1) >= 0.0
        })
    }

    /// [low, high] along an axis (0: s, 1: g).
    pub fn limits(&self, axis: usize) -> [f64; 2] {
        let wider = |[low, high]: [f64; 2], c: &[f64; 2]| [low.min(c[axis]), high.max(c[axis])];
        self.corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], wider)
    }

    /// The half-planes that it is the intersection of; a rectangle with open sides has fewer than four.
    pub fn half_planes(&self) -> Vec<HalfPlane> {
        if self.corners.iter().flatten().any(|x| x.is_infinite()) {
            return self.open_half_planes();
        }
        let corners = &self.corners;
        // Differences from the first corner, so that an offset of all of them costs no digits.
        let from_first = |c: [f64; 2]| [c[0] - corners[0][0], c[1] - corners[0][1]];
        let pairs = || corners.iter().zip(corners.iter().cycle().skip(1));
        let turn: f64 = pairs()
            .map(|(a, b)| {
                let (a, b) = (from_first(*a), from_first(*b));
                a[0] * b[1] - a[1] * b[0]
            })
            .sum();
        let sign = if turn >= 0.0 { 1.0 } else { -1.0 };
        let edge = |(a, b): (&[f64; 2], &[f64; 2])| HalfPlane {
            normal: [sign * (a[1] - b[1]), sign * (b[0] - a[0])],
            corner: *a,
        };
        pairs().map(edge).filter(|edge| edge.normal != [0.0; 2]).collect()
    }

    /// Half-planes of a rectangle with sides at infinity.
    fn open_half_planes(&self) -> Vec<HalfPlane> {
        let mut found = Vec::new();
        for axis in 0..2 {
            let [low, high] = self.limits(axis);
            for (sign, limit) in [(1.0, low), (-1.0, high)] {
                if limit.is_finite() {
                    let along = |value: f64| if axis == 0 { [value, 0.0] } else { [0.0, value] };
                    found.push(HalfPlane { normal: along(sign), corner: along(limit) });
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_planes_hold_the_region_whichever_way_its_corners_turn() {
        let corners = vec![[1e8, 2.0], [1e8 + 2.0, 2.0], [1e8 + 1.0, 5.0]];
        let reversed = corners.iter().rev().copied().collect();
        for region in [Region { corners }, Region { corners: reversed }] {
            assert!(region.holds([1e8 + 1.0, 3.0]) && region.holds([1e8, 2.0]));
            assert!(!region.holds([1e8 + 1.0, 1.9]) && !region.holds([1e8 + 0.1, 4.0]));
        }
    }

    #[test]
    fn an_open_side_has_no_half_plane() {
        let strip = Region::rectangle([1.0, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(strip.half_planes(), [HalfPlane { normal: [1.0, 0.0], corner: [1.0, 0.0] }]);
        assert!(!strip.depends_on_g());
    }
}
