//! Transfer functions and widgets: their checks, and a widget from the keys of a pipeline file (docs/src/explanation/optics.md, section 5).

use super::axis::AxisScale;
use super::kinds::properties::not_negative;
use super::kinds::{AxisOrigin, ColorSource, DECLARED, LoadFiles, Profile, WIDGET_KINDS};
use super::region::{Convex, HalfPlane, Region};
use crate::parameters::{Parameters, suggest};
use crate::{Error, Result};

/// A transfer function: an optical model and a list of widgets, ρ = Σ ρ_i.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// Relation of absorption and emission.
    pub model: OpticalModel,
    /// U: the length over which `extinction` is stated, world units, > 0.
    pub unit_distance: f64,
    /// The widgets; none at all draws nothing.
    pub widgets: Vec<Widget>,
    /// Scales of s and g, at whose positions the widgets stand.
    pub axes: [AxisScale; 2],
}

/// The optical model (docs/src/explanation/optics.md, section 6).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum OpticalModel {
    /// C = ∫ Σ c_i ρ_i e^(−T) dl (Williams & Max 1992; Max 1995).
    #[default]
    DensityEmitter,
    /// C = ∫ Σ κ_i e^(−T) dl, κ_i = c_i/U where ρ_i > cutoff × its peak (Song et al. 2009, Eq. 4).
    ConstantEmitter {
        /// Share of the peak under which a widget does not glow, in [0, 1).
        cutoff: f64,
    },
}

impl OpticalModel {
    /// The constant-emitter's cutoff.
    pub fn cutoff(self) -> Option<f64> {
        match self {
            OpticalModel::DensityEmitter => None,
            OpticalModel::ConstantEmitter { cutoff } => Some(cutoff),
        }
    }
}

/// Share of the larger of two places under which the smaller is as good as 0 beside it.
const NEAR_ZERO: f64 = 1e-3;

impl TransferFunction {
    /// True if any widget looks at the gradient magnitude.
    pub fn uses_gradient_magnitude(&self) -> bool {
        self.widgets.iter().any(Widget::uses_gradient_magnitude)
    }

    /// The value that an axis (0: s, 1: g, then the further fields by name) is best counted from, if there is one: offsets
    /// are then taken from it in 64 bits, so that a widget far narrower than the range loses nothing. Of several places
    /// (centres, and corners of regions) it is the middle: what is near them keeps more digits than the range's ends; and 0 where one is
    /// far nearer to it.
    pub fn axis_origin(&self, axis: usize) -> Option<f64> {
        let names = self.fields();
        let of = |widget: &Widget| -> AxisOrigin {
            let properties = widget.profile.properties();
            let place = match axis {
                0 | 1 => Some(axis),
                _ => {
                    properties.fields.iter().position(|name| names.get(axis - 2) == Some(name)).map(|k| k + 2)
                }
            };
            place.and_then(|place| properties.axes.get(place).copied()).unwrap_or(AxisOrigin::Any)
        };
        let mut places = Vec::new();
        for widget in &self.widgets {
            match (of(widget), self.widgets.len()) {
                (AxisOrigin::Zero, _) => return Some(0.0),
                // Alone, its region's edges may lie farther off than its widths are.
                (AxisOrigin::Centre(centre), 1) => return Some(centre),
                (AxisOrigin::Centre(centre), _) => places.push(centre),
                (AxisOrigin::Any, _) => {}
            }
            let corners = widget.region.iter().flat_map(|region| &region.corners);
            places.extend(corners.filter_map(|corner| corner.get(axis)).filter(|x| x.is_finite()));
        }
        let low = places.iter().copied().reduce(f64::min)?;
        let high = places.iter().copied().reduce(f64::max)?;
        let [smaller, larger] = [low.abs().min(high.abs()), low.abs().max(high.abs())];
        // From the middle of 1e-3 and 1e4, what is below 1e-3 could not be told from it; from 0 each has its own digits.
        Some(if smaller < NEAR_ZERO * larger { 0.0 } else { low + 0.5 * (high - low) })
    }

    /// Names of further point arrays that the widgets look at.
    pub fn fields(&self) -> Vec<&str> {
        let mut names: Vec<&str> =
            self.widgets.iter().flat_map(|widget| widget.profile.properties().fields).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// The one colour of all that is drawn, under the density-emitter: then C = c A whatever the order, along a segment and
    /// from segment to segment. Widgets of extinction 0 have no say.
    pub fn uniform_color(&self) -> Option<[f64; 3]> {
        match self.model {
            OpticalModel::ConstantEmitter { .. } => None,
            OpticalModel::DensityEmitter => {
                let mut colors =
                    self.widgets.iter().filter(|widget| widget.is_drawn()).map(Widget::uniform_color);
                let first = colors.next().unwrap_or(Some([0.0; 3]));
                first.filter(|_| colors.all(|color| color == first))
            }
        }
    }

    /// Checks every number.
    pub fn check(&self) -> Result<()> {
        let u = self.unit_distance;
        if !(u > 0.0 && u.is_finite()) {
            return Err(Error::usage("the unit distance is not a length").got(u).expected("a number > 0"));
        }
        if let OpticalModel::ConstantEmitter { cutoff } = self.model
            && !(0.0..1.0).contains(&cutoff)
        {
            return Err(Error::usage("the cutoff is out of range").got(cutoff).expected("0 ≤ cutoff < 1"));
        }
        for (axis, name) in self.axes.iter().zip(["s", "g"]) {
            axis.check(name)?;
        }
        for (i, widget) in self.widgets.iter().enumerate() {
            check(widget).map_err(|e| e.at_item(format!("widgets[{i}]")))?;
        }
        self.check_axes()
    }

    /// Scales of s and g; linear for a g that no widget reads.
    pub fn axes_read(&self) -> [AxisScale; 2] {
        [self.axes[0], if self.uses_gradient_magnitude() { self.axes[1] } else { AxisScale::Linear }]
    }

    /// True if an axis is logarithmic.
    pub fn has_curved_axes(&self) -> bool {
        self.axes_read().iter().any(|axis| axis.is_curved())
    }

    /// Refuses widgets that mean nothing on curved axes.
    ///
    /// # Errors
    /// - a triangular Gaussian beside a curved axis.
    pub fn check_axes(&self) -> Result<()> {
        let is_triangular = |widget: &Widget| matches!(widget.profile, Profile::TriangularGaussian { .. });
        match self.widgets.iter().position(is_triangular) {
            Some(number) if self.has_curved_axes() => {
                let what = "the width of a triangular Gaussian is in proportion to g, which no logarithmic axis shows";
                let error = Error::usage(what).expected("linear axes of s and g, or a gaussian");
                Err(error.at_item(format!("widgets[{number}]")))
            }
            _ => Ok(()),
        }
    }
}

fn check(widget: &Widget) -> Result<()> {
    not_negative("the extinction", widget.extinction)?;
    for c in widget.color {
        not_negative("a colour component", c)?;
    }
    widget.profile.check()?;
    let properties = widget.profile.properties();
    if properties.needs_region && widget.region.is_none() {
        let what = format!("a {} widget has no region", properties.name);
        return Err(Error::usage(what).expected("a region"));
    }
    widget.region.as_ref().map_or(Ok(()), |region| Convex::new(region).map(drop))
}

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
        self.profile.properties().color != ColorSource::Widget
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

    /// Values of s between which it changes, or beyond which it is below a millionth of its peak; infinite where there are no such ends.
    pub fn scalar_range(&self) -> [f64; 2] {
        let parts = self.region.iter().map(|region| region.limits(0)).chain([self.profile.scalar_range()]);
        parts.fold([f64::NEG_INFINITY, f64::INFINITY], |[low, high], part| {
            [low.max(part[0]), high.min(part[1])]
        })
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

/// One widget of the given kind from its keys.
pub fn read(kind: &str, p: &Parameters, files: &dyn LoadFiles) -> Result<Widget> {
    let Some((_, read)) = DECLARED.iter().find(|(declared, _)| declared.name == kind) else {
        let known = suggest(kind, WIDGET_KINDS.iter().map(|kind| kind.name));
        return Err(Error::usage("unknown kind of widget").got(kind).expected(known));
    };
    let profile = read(p, files)?;
    let extinction = match profile.properties().own_peak {
        Some(peak) => peak,
        None => p.number("extinction")?,
    };
    let color = p.optional_color("color")?.unwrap_or([1.0; 3]);
    let region = p.table("region")?.map(|region| polygon(&region)).transpose()?;
    Ok(Widget { profile, color, extinction, region })
}

/// The region: a rectangle, whose missing limits are infinite, or a convex polygon.
fn polygon(p: &Parameters) -> Result<Region> {
    let limits = |name: &str| -> Result<[f64; 2]> {
        if p.optional(name).is_none() {
            return Ok([f64::NEG_INFINITY, f64::INFINITY]);
        }
        let [low, high] = p.vector(name)?;
        if low >= high {
            let error = p.error(name, format!("the range '{name}' of the region is empty"));
            return Err(error.got(format!("[{low}, {high}]")).expected("two numbers, the smaller first"));
        }
        Ok([low, high])
    };
    if p.optional("polygon").is_none() {
        if p.optional("s").is_none() && p.optional("g").is_none() {
            return Err(p
                .error("s", "the region has no limits")
                .expected("s = [low, high], g = [low, high] or polygon"));
        }
        return Ok(Region::rectangle(limits("s")?, limits("g")?));
    }
    if p.optional("s").is_some() || p.optional("g").is_some() {
        return Err(p
            .error("polygon", "'polygon' and the ranges 's' and 'g' exclude each other")
            .expected("one of them"));
    }
    let corners: Vec<[f64; 2]> = p.rows("polygon")?.iter().map(|row| [row[0], row[1]]).collect();
    let region = Region { corners };
    if Convex::new(&region).is_err() {
        let error = p.error("polygon", "the region is not a convex polygon with an area");
        return Err(error.expected("at least three corners in order around a convex polygon"));
    }
    Ok(region)
}
