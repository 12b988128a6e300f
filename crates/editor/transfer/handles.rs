//! Handles of widgets: what a hand takes hold of.

use super::scale::Scale;

/// Handles of a widget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Handle {
    Centre,
    /// The end of a half axis.
    Width(usize),
    Angle,
    /// Width of the bands around a wave's peaks.
    Band,
    /// A corner of a picture's ranges.
    Rim(usize),
    /// A side of a picture's ranges: along which axis, and whether the upper end.
    Edge(usize, bool),
    /// A corner of the region.
    Corner(usize),
    /// A side of the region, as of an edge.
    Side(usize, bool),
    /// A point of a curve, by its place.
    Point(usize),
}

/// The corners of a box, against the clock from the lower left.
pub(super) fn corners([s, g]: [[f64; 2]; 2]) -> [[f64; 2]; 4] {
    [[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]]
}

/// The sides of a box that limit, each in the middle of what is shown of it: along which axis, whether the upper end, and where.
pub(super) fn edges(limits: [[f64; 2]; 2], scale: &Scale) -> impl Iterator<Item = (usize, bool, [f64; 2])> {
    let shown = scale.shown;
    (0..2).flat_map(move |axis| {
        let other = 1 - axis;
        let [low, high] = shown[other];
        let middle = 0.5 * (limits[other][0].clamp(low, high) + limits[other][1].clamp(low, high));
        let ends = limits[axis].into_iter().enumerate().filter(|(_, limit)| limit.is_finite());
        ends.map(move |(end, limit)| {
            let mut at = [middle; 2];
            at[axis] = limit;
            (axis, end == 1, at)
        })
    })
}
