//! Colour maps: colours over levels from 0 to 1, by name or between points of a file.
//!
//! A map is linear in linear RGB between knots, so that a transfer function of it has closed forms. What is not linear there
//! (sRGB, Lab, Moreland's diverging maps) is sampled, and knots are kept so that no sample is farther off than [`TOLERANCE`].

mod spaces;
mod tables;

pub use spaces::ColorSpace;

use crate::color::linear_from_srgb;
use crate::{Error, Result};

/// Names of the colour maps, and their looks.
pub const NAMES: &[(&str, &str)] = &[
    ("viridis", "dark violet, blue, green, yellow; rises evenly in lightness"),
    ("magma", "black, purple, orange, pale yellow; rises evenly in lightness"),
    ("inferno", "black, purple, red, yellow; rises evenly in lightness"),
    ("plasma", "blue, purple, orange, yellow; rises evenly in lightness"),
    ("cividis", "blue, grey, yellow; alike for the colour-blind"),
    ("turbo", "a rainbow without false edges: blue, green, red"),
    ("batlow", "dark blue, green, orange, pink; rises evenly in lightness"),
    ("coolwarm", "blue, pale grey, red: diverges from its middle"),
];

/// A colour map by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Colormap {
    /// Dark violet to yellow, rising in lightness (N. Smith, S. van der Walt 2015).
    Viridis,
    /// Black over purple to pale yellow (the same).
    Magma,
    /// Black over red to yellow (the same).
    Inferno,
    /// Blue over purple to yellow (the same).
    Plasma,
    /// Blue over grey to yellow (J. Nuñez, C. Anderton, R. Renslow 2018).
    Cividis,
    /// A rainbow (A. Mikhailov 2019).
    Turbo,
    /// Dark blue over green to pink (F. Crameri 2018).
    Batlow,
    /// Blue over pale grey to red (K. Moreland 2009).
    Coolwarm,
}

impl Colormap {
    /// All maps, in the order of [`NAMES`].
    pub const ALL: [Colormap; 8] = [
        Colormap::Viridis,
        Colormap::Magma,
        Colormap::Inferno,
        Colormap::Plasma,
        Colormap::Cividis,
        Colormap::Turbo,
        Colormap::Batlow,
        Colormap::Coolwarm,
    ];

    /// The map of this name.
    pub fn named(name: &str) -> Option<Colormap> {
        Colormap::ALL.into_iter().find(|map| map.name() == name)
    }

    /// Its name, in small letters.
    pub fn name(self) -> &'static str {
        NAMES[self as usize].0
    }

    /// Its colours.
    pub fn curve(self) -> ColorCurve {
        let knot = |word: &str| {
            let [level, rgb @ ..] = u32::from_str_radix(word, 16).unwrap_or_default().to_be_bytes();
            (f64::from(level) / 255.0, rgb.map(|byte| linear_from_srgb(f64::from(byte) / 255.0)))
        };
        ColorCurve(tables::KNOTS[self as usize].split_whitespace().map(knot).collect())
    }

    /// Linear RGB of a level from 0 to 1.
    pub fn color(self, level: f64) -> [f64; 3] {
        self.curve().at(level)
    }
}

/// Colours over levels from 0 to 1: linear RGB, linear between knots. Two knots of one level are a jump.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorCurve(Vec<(f64, [f64; 3])>);

/// Largest distance of a curve from what it was sampled from, in sRGB: with rounding less than one step of 8 bits.
const TOLERANCE: f64 = 0.75 / 255.0;

/// Samples of a map that is not linear in linear RGB.
const SAMPLES: f64 = 256.0;

/// Most points of a file: the largest map in use has a few hundred.
const MAX_POINTS: usize = 65_536;

impl ColorCurve {
    /// Curve through points (x, sRGB) of rising x, straight between them in a colour space; the first is at level 0, the last at 1.
    ///
    /// # Errors
    /// - points that do not rise, are not finite or none; colours beyond 0 … 1.
    pub fn interpolated(points: &[(f64, [f64; 3])], space: ColorSpace) -> Result<ColorCurve> {
        let (Some((low, _)), Some((high, _))) = (points.first(), points.last()) else {
            return Err(Error::run("a colour map has no points").expected("at least two"));
        };
        if !(2..=MAX_POINTS).contains(&points.len()) {
            let error = Error::run("a colour map's points are too few or too many").got(points.len());
            return Err(error.expected(format!("from 2 to {MAX_POINTS}")));
        }
        let is_rising = points.windows(2).all(|pair| pair[0].0 <= pair[1].0) && low < high;
        if !is_rising || !(high - low).is_finite() {
            return Err(
                Error::run("a colour map's points do not rise").expected("finite x, none less than the last")
            );
        }
        if let Some((x, color)) = points.iter().find(|(_, rgb)| rgb.iter().any(|v| !(0.0..=1.0).contains(v)))
        {
            let error =
                Error::run("a colour of a colour map is out of range").got(format!("{color:?} at {x}"));
            return Err(error.expected("red, green and blue from 0 to 1"));
        }
        let level = |x: f64| (x - low) / (high - low);
        let mut samples = vec![(0.0, points[0].1)];
        for pair in points.windows(2) {
            let [(from, one), (to, other)] = [pair[0], pair[1]].map(|(x, color)| (level(x), color));
            let pieces = (SAMPLES * (to - from)).ceil().max(1.0);
            samples.extend((1..=pieces as usize).map(|i| {
                let t = i as f64 / pieces;
                (from + (to - from) * t, space.between(one, other, t))
            }));
        }
        Ok(ColorCurve(simplified(&samples)))
    }

    /// Linear RGB of a level; at a jump that behind it.
    pub fn at(&self, level: f64) -> [f64; 3] {
        limits(&self.0, level)[1]
    }

    /// The knots: level and linear RGB, from 0 to 1.
    pub fn knots(&self) -> &[(f64, [f64; 3])] {
        &self.0
    }

    /// The curve from its end to its beginning.
    pub fn reversed(mut self) -> ColorCurve {
        self.0.reverse();
        self.0.iter_mut().for_each(|(level, _)| *level = 1.0 - *level);
        self
    }

    /// Curve of so many bands of equal width, two or more, with the curve's colours from its first to its last.
    pub fn stepped(&self, count: usize) -> ColorCurve {
        let band = |k: usize| {
            let color = self.at(k as f64 / (count - 1).max(1) as f64);
            [k, k + 1].map(|end| (end as f64 / count as f64, color))
        };
        ColorCurve((0..count).flat_map(band).collect())
    }
}

/// Values of a piecewise-linear function in front of and behind a place: two where knots of one place are a jump, constant beyond
/// the ends.
pub(crate) fn limits<const N: usize>(knots: &[(f64, [f64; N])], x: f64) -> [[f64; N]; 2] {
    let between = |after: usize| match (after.checked_sub(1).map(|i| knots[i]), knots.get(after)) {
        (Some((x0, a)), Some(&(x1, b))) => {
            let t = (x - x0) / (x1 - x0);
            std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
        }
        (Some((_, only)), None) | (None, Some(&(_, only))) => only,
        (None, None) => [0.0; N],
    };
    [knots.partition_point(|knot| knot.0 < x), knots.partition_point(|knot| knot.0 <= x)].map(between)
}

/// The fewest of the samples (level, sRGB) between which linear RGB is linear, within the tolerance at those left out; a sample
/// that is kept is exact.
fn simplified(samples: &[(f64, [f64; 3])]) -> Vec<(f64, [f64; 3])> {
    let linear = |color: [f64; 3]| color.map(linear_from_srgb);
    let joins = |first: usize, last: usize| {
        let ends = [samples[first], samples[last]].map(|(level, color)| (level, linear(color)));
        ends[0].0 < ends[1].0
            && samples[first + 1..last].iter().all(|&(level, color)| {
                let [_, found] = limits(&ends, level);
                let is_near = |k: usize| {
                    let bound = |by: f64| linear_from_srgb((color[k] + by).max(0.0));
                    (bound(-TOLERANCE)..=bound(TOLERANCE)).contains(&found[k])
                };
                (0..3).all(is_near)
            })
    };
    let (mut knots, mut first) = (Vec::new(), 0);
    while let Some(&(level, color)) = samples.get(first) {
        knots.push((level, linear(color)));
        let mut last = first + 1;
        while last + 1 < samples.len() && joins(first, last + 1) {
            last += 1;
        }
        first = last;
    }
    knots
}

#[cfg(test)]
mod tests;
