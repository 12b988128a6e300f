//! One widget, and where along a straight path through the (s, g) plane it changes.
//!
//! Every profile is a function of a few coordinates that are linear along the path; a region is an intersection of half planes. Symbols
//! as in docs/src/explanation/optics.md, section 5.
//!
//! A table: which texels a path crosses, and what it is between two lines of their centres.

use crate::linear_on_segment::{Cuts, LinearOnSegment, Place, Wide, quadratic_crossings};
use std::f64::consts::PI;
use std::sync::Arc;
use voltet_core::transfer::{ControlPoint, Profile, Region, Table, Wave, Widget};

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
}

/// The half planes of a rectangle; infinite limits give none.
fn sides_of_rectangle(region: &Region) -> Vec<Side> {
    let side = |axis: usize, limit: f64, sign: f64| {
        let mut side = Side { origin: [0.0; 2], normal: [Wide::ZERO; 2] };
        (side.origin[axis], side.normal[axis]) = (limit, Wide::from(sign));
        limit.is_finite().then_some(side)
    };
    let both = |axis: usize| {
        let [low, high] = region.limits(axis);
        [side(axis, low, 1.0), side(axis, high, -1.0)]
    };
    (0..2).flat_map(both).flatten().collect()
}

/// The half planes of a region. Rectangles may have infinite limits, which give none.
fn sides_of(region: &Region) -> Vec<Side> {
    let corners = &region.corners;
    if region.is_rectangle() {
        return sides_of_rectangle(region);
    }
    let twice_area: f64 = (1..corners.len() - 1)
        .map(|k| {
            let from_first = |c: [f64; 2]| [c[0] - corners[0][0], c[1] - corners[0][1]];
            let (a, b) = (from_first(corners[k]), from_first(corners[k + 1]));
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    let edge = |k: usize| {
        // Counted from the same corner in every region that has this edge, so that all pass it at one place.
        let ends = [corners[k], corners[(k + 1) % corners.len()]];
        let [a, b] = if ends[0] <= ends[1] { ends } else { [ends[1], ends[0]] };
        let inwards = (twice_area > 0.0) == (ends[0] <= ends[1]);
        let sign = if inwards { 1.0 } else { -1.0 };
        let normal = [Wide::difference(a[1], b[1]) * sign, Wide::difference(b[0], a[0]) * sign];
        (a != b).then_some(Side { origin: a, normal })
    };
    (0..corners.len()).filter_map(edge).collect()
}

/// A path that stays within so many widths of a Gaussian's centre is known to 1e-14 of a width in doubles.
const ROUNDED_WIDTHS: f64 = 100.0;

pub(crate) struct Term {
    pub(crate) shape: ReadyProfile,
    /// Extinction / unit distance, 1/L.
    pub(crate) peak: f64,
    /// The extinction where it is densest, 1/L.
    pub(crate) densest: f64,
    pub(crate) color: [f64; 3],
    /// The largest component of any of its colours.
    pub(crate) brightest: f64,
    /// Half planes whose intersection is the region, and a table's range.
    sides: Vec<Side>,
}

/// A profile, and in which coordinates it is simplest.
pub(crate) enum ReadyProfile {
    Uniform,
    /// Coordinates: K (v − v0).
    Gaussian(Widths),
    /// Coordinates: K (v − v0), and the width that they are shares of: its column and what that is multiplied by.
    Triangular(Widths, (usize, f64)),
    /// Coordinate: φ.
    Bands(Bands),
    /// Coordinate: s.
    Linear {
        points: Vec<ControlPoint>,
        peak: f64,
    },
    /// Coordinates: s, g.
    Table(Texels),
}

/// K and v0, over these columns of a value.
pub(crate) struct Widths {
    columns: Vec<usize>,
    centre: Vec<f64>,
    matrix: Vec<Vec<f64>>,
}

impl Widths {
    /// The column, factor and origin of each part of K (v − v0), coordinate by coordinate.
    fn coordinates(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, f64, f64)> + Clone> {
        let Widths { columns, centre, matrix } = self;
        let part = |((factor, column), origin): ((&f64, &usize), &f64)| (*column, *factor, *origin);
        matrix.iter().map(move |row| row.iter().zip(columns).zip(centre).map(part))
    }
}

/// A triangle or sine wave; peaks at φ = n + ½.
pub(crate) struct Bands {
    pub(crate) sine: bool,
    pub(crate) band_width: f64,
    pub(crate) half: f64,
    /// ∂φ/∂s and ∂φ/∂g.
    slope: [Wide; 2],
    origin: [f64; 2],
}

impl Bands {
    fn new(wave: &Wave, sine: bool) -> Self {
        let (sin, cos) = wave.angle.sin_cos();
        let slope = [(cos, wave.scale[0]), (sin, wave.scale[1])];
        let slope = slope.map(|(part, scale)| Wide::from(part) * scale / Wide::from(wave.period));
        let mut bands = Bands { sine, band_width: wave.band_width, half: 0.5, slope, origin: wave.origin };
        if wave.band_width < 1.0 {
            bands.half = bands.half_width(0.0);
        }
        bands
    }

    /// Half-width in φ of what is higher than a share of the peak.
    pub(crate) fn half_width(&self, height: f64) -> f64 {
        let below = self.band_width * (1.0 - height);
        if self.sine { (0.5 * below).sqrt().asin() * 2.0 / PI } else { 0.5 * below }
    }
}

impl Term {
    /// A widget that was checked. `fields`: names of the point quantities that follow s and g in a value.
    pub(crate) fn new(widget: &Widget, unit_distance: f64, fields: &[&str]) -> Self {
        let column = |name: &String| {
            2 + fields.iter().position(|field| field == name).expect("the fields are those of all widgets")
        };
        let widths = |own: &[String], centre: &[f64], matrix: &[Vec<f64>]| {
            let columns = own.iter().map(column).collect();
            Widths { columns, centre: centre.to_vec(), matrix: matrix.to_vec() }
        };
        let properties = widget.profile.properties();
        let regions = widget.region.iter().chain(&properties.range);
        let sides = regions.flat_map(sides_of).collect();
        let mut extinction = widget.extinction;
        let shape = match &widget.profile {
            Profile::Uniform => ReadyProfile::Uniform,
            Profile::Gaussian { centre, matrix } => ReadyProfile::Gaussian(Widths {
                columns: vec![0, 1],
                centre: centre.to_vec(),
                matrix: matrix.map(Vec::from).to_vec(),
            }),
            Profile::GaussianNd { fields, centre, matrix } => {
                ReadyProfile::Gaussian(widths(fields, centre, matrix))
            }
            Profile::TriangularGaussian { centre, sigma } => {
                let own = Widths { columns: vec![0], centre: vec![*centre], matrix: vec![vec![1.0]] };
                ReadyProfile::Triangular(own, (1, *sigma))
            }
            Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                ReadyProfile::Triangular(widths(fields, centre, matrix), (column(magnitude), 1.0))
            }
            Profile::TriangleWave(wave) => ReadyProfile::Bands(Bands::new(wave, false)),
            Profile::SineWave(wave) => ReadyProfile::Bands(Bands::new(wave, true)),
            Profile::PiecewiseLinear { points } => {
                extinction = 1.0;
                let peak = points.iter().map(|p| p.extinction).fold(0.0, f64::max);
                ReadyProfile::Linear { points: points.clone(), peak }
            }
            Profile::Table(table) => ReadyProfile::Table(Texels::new(table.clone())),
        };
        Term {
            shape,
            peak: extinction / unit_distance,
            densest: widget.peak() / unit_distance,
            color: widget.color,
            brightest: widget.max_emission(),
            sides,
        }
    }

    /// Between which places the path is inside the region; `None` where it is nowhere, and for a widget that is
    /// nowhere dense: it does not glow either.
    pub(crate) fn window(&self, front: &[f64], back: &[f64]) -> Option<[Place; 2]> {
        if self.densest == 0.0 {
            return None;
        }
        let [mut from, mut to] = [Place::FRONT, Place::BACK];
        for side in &self.sides {
            let along = side.on_segment(front, back);
            let (f, b) = (along.front.value(), along.back.value());
            // A path along an edge is inside.
            if f.min(b) < 0.0 && f.max(b) <= 0.0 {
                return None;
            }
            let Some(place) = along.passes(Wide::ZERO) else { continue };
            if f < 0.0 && from.is_before(place) {
                from = place;
            } else if f > 0.0 && place.is_before(to) {
                to = place;
            }
        }
        from.is_before(to).then_some([from, to])
    }

    /// Appends the coordinates along the path from `front` to `back` (each [s, g, fields …]).
    pub(crate) fn coordinates(&self, front: &[f64], back: &[f64], out: &mut Vec<LinearOnSegment>) {
        match &self.shape {
            ReadyProfile::Uniform => {}
            ReadyProfile::Gaussian(widths) => out.extend(widths.coordinates().map(|parts| {
                let along = LinearOnSegment::rounded(front, back, parts.clone());
                let farthest = along.front.abs().value().max(along.back.abs().value());
                if farthest < ROUNDED_WIDTHS { along } else { LinearOnSegment::exact(front, back, parts) }
            })),
            ReadyProfile::Triangular(widths, (column, factor)) => {
                let exact = |parts| LinearOnSegment::exact(front, back, parts);
                out.extend(widths.coordinates().map(exact));
                out.push(LinearOnSegment::exact(front, back, [(*column, *factor, 0.0)].into_iter()));
            }
            ReadyProfile::Bands(bands) => {
                let parts = (0..2).map(|axis| (axis, bands.slope[axis], bands.origin[axis]));
                out.push(LinearOnSegment::new(front, back, parts));
            }
            ReadyProfile::Linear { .. } => out.push(LinearOnSegment::column(front, back, 0)),
            ReadyProfile::Table(_) => {
                out.extend([0, 1].map(|column| LinearOnSegment::column(front, back, column)))
            }
        }
    }
}

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
