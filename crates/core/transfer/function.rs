//! A transfer function and its checks.

use super::check::not_negative;
use super::kinds::AxisOrigin;
use super::widget::Widget;
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
}

/// The optical model (docs/src/explanation/optics.md, section 6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OpticalModel {
    /// C = ∫ Σ c_i ρ_i e^(−T) dl (Williams & Max 1992; Max 1995).
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

impl TransferFunction {
    /// True if any widget looks at the gradient magnitude.
    pub fn uses_gradient_magnitude(&self) -> bool {
        self.widgets.iter().any(Widget::uses_gradient_magnitude)
    }

    /// The value that an axis (0: s, 1: g, then the further fields by name) is best counted from, if there is one: offsets
    /// are then taken from it in 64 bits, so that a widget far narrower than the range loses nothing. Of several places
    /// (centres, and corners of regions) it is the middle: what is near them keeps more digits than the range's ends.
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
        Some(low + 0.5 * (high - low))
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
}

impl TransferFunction {
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
        for (i, widget) in self.widgets.iter().enumerate() {
            check(widget).map_err(|e| e.at_item(format!("widgets[{i}]")))?;
        }
        Ok(())
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
    Ok(())
}
