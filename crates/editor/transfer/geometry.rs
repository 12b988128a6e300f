//! Measures of the plane: the scale of its axes, handles of widgets, and numbers of a widget's table as they are read and written.

use voltet_graph::{ArrayRef, Field, LocatedValue, ParameterValue, find_setting};

/// Scale of the plane, for drawing and moving handles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// Lengths along both axes that are equal on the screen.
    pub extent: [f64; 2],
    /// The shown part, low and high of each axis.
    pub shown: [[f64; 2]; 2],
    pub peak: f64,
}

impl Scale {
    /// The largest value shown along the second axis, where a curve reaches its peak.
    pub fn top(&self) -> f64 {
        self.shown[1][1]
    }
}

/// The plane of the scalar and its gradient magnitude.
pub(super) const S_AND_G: [ArrayRef; 2] = [ArrayRef::Named("s"), ArrayRef::Named("g")];

/// The height in the plot of an extinction, 0 to 1: its cube root, so that small ones are told apart.
pub(super) fn height_of(extinction: f64, peak: f64) -> f64 {
    (extinction / peak).max(0.0).cbrt()
}

/// The extinction at a height of the plot.
pub(super) fn extinction_at(height: f64, peak: f64) -> f64 {
    let height = height.clamp(0.0, 1.5);
    // At the foot it is none at all.
    if height < 0.01 { 0.0 } else { rounded(height.powi(3) * peak) }
}

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

pub(super) fn array<const N: usize>(fields: &[Field], name: &str) -> Option<[f64; N]> {
    find_setting(fields, name)?.array()
}

pub(super) fn number(fields: &[Field], name: &str) -> Option<f64> {
    find_setting(fields, name).and_then(LocatedValue::number)
}

/// A change of a widget's table: a key, and its value or none to take it out.
pub(super) type Change = (&'static str, Option<ParameterValue>);

pub(super) fn list(numbers: &[f64]) -> ParameterValue {
    numbers.iter().map(|x| rounded(*x)).collect()
}

pub(super) fn rows<Row: AsRef<[f64]>>(rows: &[Row]) -> ParameterValue {
    rows.iter().map(|row| list(row.as_ref())).collect()
}

/// Six digits: finer than a pixel of any screen.
pub(super) fn rounded(x: f64) -> f64 {
    if x.is_finite() { format!("{x:.5e}").parse().unwrap_or(x) } else { x }
}
