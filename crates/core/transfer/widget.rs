//! Widget: a profile over the (s, g) plane with colour, extinction and region.

use super::kinds::{ColorSource, Profile};
use super::region::{HalfPlane, Region};

/// One widget.
#[derive(Debug, Clone, PartialEq)]
pub struct Widget {
    /// The profile and its parameters.
    pub profile: Profile,
    /// Linear RGB, ≥ 0, may exceed 1. Unused by piecewise-linear and table widgets, which hold their own.
    pub color: [f64; 3],
    /// Peak extinction per unit distance, ≥ 0. Unused by piecewise-linear widgets, which hold their own.
    pub extinction: f64,
    /// Convex polygon in the (s, g) plane outside which ρ = 0; its boundary belongs to it.
    pub region: Option<Region>,
}

impl Widget {
    /// The largest extinction that it may have, per unit distance.
    pub fn peak(&self) -> f64 {
        self.profile.properties().own_peak.unwrap_or(self.extinction)
    }

    /// True if it absorbs or glows anywhere: a widget of extinction 0 does neither, under either model.
    pub fn is_drawn(&self) -> bool {
        self.peak() > 0.0
    }

    /// The largest channel of any of its colours.
    pub fn max_emission(&self) -> f64 {
        match self.profile.properties().color {
            ColorSource::Widget => self.color.into_iter().fold(0.0, f64::max),
            ColorSource::Points(points) => points.iter().flat_map(|p| p.color).fold(0.0, f64::max),
            ColorSource::Texels(texels) => {
                texels.iter().flat_map(|t| [t[0], t[1], t[2]]).fold(0.0, f32::max).into()
            }
        }
    }

    /// True if its colour is a function of s and g.
    pub fn has_colors_of_its_own(&self) -> bool {
        match self.profile.properties().color {
            ColorSource::Widget => false,
            ColorSource::Points(_) | ColorSource::Texels(_) => true,
        }
    }

    /// Its colour, if it is the same wherever the widget is; an image is taken to have several.
    pub fn uniform_color(&self) -> Option<[f64; 3]> {
        match self.profile.properties().color {
            ColorSource::Widget => Some(self.color),
            ColorSource::Points(points) => {
                let first = points.first().map(|point| point.color);
                first.filter(|first| points.iter().all(|point| point.color == *first))
            }
            ColorSource::Texels(_) => None,
        }
    }

    /// Its profile at a place of the plane, 0 to 1; 0 outside of its region. `fields`: as of [`Profile::eval`].
    pub fn weight_at(&self, v: [f64; 2], fields: &[f64]) -> f64 {
        match &self.region {
            Some(region) if !region.holds(v) => 0.0,
            _ => self.profile.eval(v, fields),
        }
    }

    /// Widget with its extinction, or those of its control points, multiplied.
    pub fn with_extinction_times(&self, factor: f64) -> Widget {
        let profile = self.profile.with_extinction_times(factor);
        Widget { profile, extinction: self.extinction * factor, ..self.clone() }
    }

    /// Widget in one colour.
    pub fn in_color(&self, color: [f64; 3]) -> Widget {
        Widget { profile: self.profile.in_color(color), color, ..self.clone() }
    }

    /// True if the widget's profile or region depends on the gradient magnitude.
    pub fn uses_gradient_magnitude(&self) -> bool {
        self.profile.properties().depends_on_g || self.region.as_ref().is_some_and(Region::depends_on_g)
    }

    /// The half-planes that limit it: those of its region, and those of the range that its profile has.
    pub fn half_planes(&self) -> Vec<HalfPlane> {
        let range = self.profile.properties().range;
        self.region.iter().chain(&range).flat_map(Region::half_planes).collect()
    }
}
