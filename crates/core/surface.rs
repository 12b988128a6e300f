//! Surfaces that are drawn in a volume: triangles of one colour, of colours at their points, or coloured by values through a colour map.

use crate::arithmetic::unit_vector;
use crate::colormap::ColorCurve;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;

/// Triangles, drawn from both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Positions, world units.
    pub points: Vec<DVec3>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
    /// Its colour.
    pub paint: Paint,
    /// Opacity of one crossing, 0 to 1; times that of the points, where they have one.
    pub opacity: f64,
    /// Light from the eye; none: the colour as it is.
    pub light: Option<EyeLight>,
    /// Normals of the points, of any length above 0, for a smooth look; none: each triangle's own.
    pub normals: Vec<DVec3>,
}

/// Colour of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Paint {
    /// Linear RGB.
    Uniform([f64; 3]),
    /// Linear RGB and opacity of each point; linear in a triangle.
    Points(Vec<[f64; 4]>),
    /// A map's colours over a range of values; beyond it those of its ends.
    Mapped {
        /// Value of each point; linear in a triangle.
        values: Vec<f64>,
        /// Values of the map's first and last colour.
        range: [f64; 2],
        /// The map.
        curve: ColorCurve,
        /// Linear RGB of a triangle with a value that is not finite; none: there is no such value.
        bad: Option<[f64; 3]>,
    },
}

/// Light from the eye: colour times (ambient + diffuse |n · v|), with the unit normal n and the unit direction v of the ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeLight {
    /// Share of the colour that needs no light.
    pub ambient: f64,
    /// Share of the colour that faces the eye.
    pub diffuse: f64,
}

impl Surface {
    /// Checks that points exist and are finite, that each has what belongs to it, and that numbers are in range.
    ///
    /// # Errors
    /// - what is wrong, with its number.
    pub fn check(&self) -> Result<()> {
        let count = self.points.len();
        let (values, bad) = match &self.paint {
            Paint::Mapped { values, bad, .. } => (values.as_slice(), *bad),
            Paint::Uniform(_) | Paint::Points(_) => (&[][..], None),
        };
        let colors = if let Paint::Points(colors) = &self.paint { colors.as_slice() } else { &[] };
        let of_paint = match &self.paint {
            Paint::Uniform(_) => None,
            Paint::Points(colors) => Some(("colour", colors.len())),
            Paint::Mapped { values, .. } => Some(("value", values.len())),
        };
        let of_light = (!self.normals.is_empty()).then_some(("normal", self.normals.len()));
        for (name, given) in of_paint.into_iter().chain(of_light) {
            if given != count {
                return Err(Error::run(format!("a surface has not one {name} a point"))
                    .got(given)
                    .expected(count));
            }
        }
        if !(0.0..=1.0).contains(&self.opacity) {
            return Err(Error::run("a surface's opacity is out of range")
                .got(self.opacity)
                .expected("from 0 to 1"));
        }
        let is_color =
            |color: &[f64; 4]| color.iter().all(|c| (0.0..f64::INFINITY).contains(c)) && color[3] <= 1.0;
        if let Some(point) = colors.iter().position(|color| !is_color(color)) {
            return Err(Error::run(format!("the colour of point {point} of a surface is out of range"))
                .got(format!("{:?}", colors[point]))
                .expected("red, green and blue of at least 0, and an opacity from 0 to 1"));
        }
        let check = |(number, corners): (usize, &[u32; 3])| {
            let is_placed = |&p: &u32| self.points.get(p as usize).is_some_and(|at| at.is_finite());
            if let Some(&point) = corners.iter().find(|point| !is_placed(point)) {
                return Err(Error::run("a surface has a point that does not exist or is not finite")
                    .got(format!("point {point} of triangle {number}")));
            }
            let is_bad = |p: &&u32| values.get(**p as usize).is_some_and(|value| !value.is_finite());
            if let Some(point) = corners.iter().find(is_bad).filter(|_| bad.is_none()) {
                let error = Error::run("a surface has a value that is not finite, and no colour for it");
                let error = error.got(format!("{} at point {point}", values[*point as usize]));
                return Err(error.expected("a colour 'bad' for places without a value"));
            }
            Ok(())
        };
        let all = self.triangles.par_iter().enumerate().with_min_len(1 << 14);
        all.find_map_first(|triangle| check(triangle).err()).map_or(Ok(()), Err)
    }

    /// Premultiplied linear colour and opacity where a ray crosses a triangle at these weights of its corners. `facing`: |n · v|, where
    /// there is light.
    pub fn color(&self, triangle: usize, weights: [f64; 3], facing: f64) -> [f64; 4] {
        let [a, b, c] = self.triangles[triangle].map(|p| p as usize);
        let [u, v, w] = weights;
        let mut opacity = self.opacity;
        let [red, green, blue] = match &self.paint {
            Paint::Uniform(color) => *color,
            Paint::Points(colors) => {
                let component = |k: usize| u * colors[a][k] + v * colors[b][k] + w * colors[c][k];
                opacity *= component(3);
                [component(0), component(1), component(2)]
            }
            Paint::Mapped { values, bad: Some(bad), .. }
                if [a, b, c].iter().any(|&p| !values[p].is_finite()) =>
            {
                *bad
            }
            Paint::Mapped { values, range: [low, high], curve, .. } => {
                // From one corner, so that equal values stay what they are.
                let base = values[a];
                let above = v * (values[b] - base) + w * (values[c] - base);
                let level = if high > low { (base + above - low) / (high - low) } else { 0.5 };
                curve.at(level.clamp(0.0, 1.0))
            }
        };
        let lit = self.light.map_or(1.0, |EyeLight { ambient, diffuse }| ambient + diffuse * facing);
        let share = lit * opacity;
        [red * share, green * share, blue * share, opacity]
    }

    /// Unit normal at these weights of a triangle's corners: that of its points, where they have one.
    pub fn normal(&self, triangle: usize, [u, v, w]: [f64; 3]) -> DVec3 {
        if self.normals.is_empty() {
            return self.flat_normal(triangle);
        }
        let [a, b, c] = self.triangles[triangle].map(|p| unit_vector(self.normals[p as usize]));
        unit_vector(u * a + v * b + w * c)
    }

    /// Unit normal of a triangle by its corners.
    pub fn flat_normal(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.triangles[triangle].map(|p| self.points[p as usize]);
        unit_vector((b - a).cross(c - a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colormap::Colormap;

    fn surface(colors: Vec<[f64; 4]>) -> Surface {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let paint = Paint::Points(colors);
        Surface { points, triangles: vec![[0, 1, 2]], paint, opacity: 0.5, light: None, normals: Vec::new() }
    }

    #[test]
    fn colours_of_points_are_linear_between_them() {
        let one = surface(vec![[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.5], [0.0, 0.0, 2.0, 0.0]]);
        one.check().unwrap();
        assert_eq!(one.color(0, [0.0, 1.0, 0.0], 1.0), [0.0, 0.25, 0.0, 0.25]);
        assert_eq!(one.color(0, [0.25, 0.25, 0.5], 1.0), [0.25 * 0.1875, 0.25 * 0.1875, 0.1875, 0.1875]);
    }

    #[test]
    fn wrong_colours_are_refused() {
        for wrong in [f64::NAN, -0.1, f64::INFINITY] {
            let error = surface(vec![[1.0, wrong, 0.0, 1.0]; 3]).check().unwrap_err().to_string();
            assert!(error.contains("colour of point 0"), "{error}");
        }
        assert!(surface(vec![[0.0, 0.0, 0.0, 1.5]; 3]).check().is_err());
        for count in [0, 2, 4] {
            let error = surface(vec![[0.0; 4]; count]).check().unwrap_err().to_string();
            assert!(error.contains("one colour a point"), "{error}");
        }
    }

    #[test]
    fn a_triangle_without_a_value_has_the_colour_for_it() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        let paint = |bad| {
            let (values, curve) = (vec![0.0, 1.0, 1.0, f64::NAN], Colormap::Viridis.curve());
            Paint::Mapped { values, range: [0.0, 1.0], curve, bad }
        };
        let surface = |bad| Surface {
            points: points.clone(),
            triangles: vec![[0, 1, 2], [1, 2, 3]],
            paint: paint(bad),
            opacity: 0.5,
            light: None,
            normals: Vec::new(),
        };
        let error = surface(None).check().unwrap_err().to_string();
        assert!(error.contains("NaN at point 3") && error.contains("'bad'"), "{error}");
        let surface = surface(Some([1.0, 0.0, 1.0]));
        surface.check().unwrap();
        // Also where the corner without a value counts for nothing.
        assert_eq!(surface.color(1, [0.5, 0.5, 0.0], 1.0), [0.5, 0.0, 0.5, 0.5]);
        let [r, g, b] = Colormap::Viridis.curve().at(0.5).map(|c| 0.5 * c);
        assert_eq!(surface.color(0, [0.5, 0.25, 0.25], 1.0), [r, g, b, 0.5]);
    }
}
