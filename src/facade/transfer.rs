//! Transfer functions: widgets over the scalar s and the gradient magnitude g, each by a builder of its own.

use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
pub use voltet_core::colormap::Colormap;
pub use voltet_core::transfer::AxisScale;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction as ScaledTransferFunction, Wave,
    Widget,
};
use voltet_graph::diagonal;
use voltet_nodes::table_image;

/// Length over which extinction is stated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum UnitDistance {
    /// A hundredth of the diagonal of the data.
    #[default]
    Auto,
    /// A length (world units).
    Length(f64),
}

/// Colour and extinction over (s, g), as a sum of widgets.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct TransferFunction {
    /// The widgets, whose extinctions add up.
    pub widgets: Vec<Widget>,
    /// Relation of absorption and emission.
    pub model: OpticalModel,
    /// Length over which extinction is stated.
    pub unit_distance: UnitDistance,
    /// Scales of s and g, at whose positions the widgets stand: on a logarithmic axis at log₁₀ of values, with widths in decades.
    pub axes: [AxisScale; 2],
}

impl TransferFunction {
    /// An empty transfer function in the density-emitter model.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a widget.
    pub fn with(mut self, widget: impl Into<Widget>) -> Self {
        self.widgets.push(widget.into());
        self
    }

    /// A colour map over a range of the scalar, whose extinction rises linearly from 0 to `extinction`.
    pub fn ramp(map: Colormap, [low, high]: [f64; 2], extinction: f64) -> Self {
        let high = if high > low { high } else { low + low.abs().max(1.0) };
        let points = map.curve().knots().iter().fold(Piecewise::new(), |points, &(level, color)| {
            points.point(low + level * (high - low), color, level * extinction)
        });
        Self::new().with(points)
    }

    /// Sets the optical model.
    pub fn model(self, model: OpticalModel) -> Self {
        TransferFunction { model, ..self }
    }

    /// Sets the scales of s and g.
    pub fn axes(self, s: AxisScale, g: AxisScale) -> Self {
        TransferFunction { axes: [s, g], ..self }
    }

    /// Sets the length over which extinction is stated (world units).
    pub fn unit_distance(self, length: f64) -> Self {
        TransferFunction { unit_distance: UnitDistance::Length(length), ..self }
    }

    /// The transfer function for a grid with these bounds. Errors: a number that is out of range or not finite.
    pub(super) fn scaled(&self, bounds: Option<[glam::DVec3; 2]>) -> Result<ScaledTransferFunction> {
        let unit_distance = match self.unit_distance {
            UnitDistance::Auto => diagonal(bounds) / 100.0,
            UnitDistance::Length(length) => length,
        };
        let widgets = self.widgets.clone();
        let scaled = ScaledTransferFunction { model: self.model, unit_distance, widgets, axes: self.axes };
        scaled.check()?;
        Ok(scaled)
    }
}

/// Methods that every widget of one colour has.
macro_rules! one_color {
    ($builder:ident) => {
        impl $builder {
            /// Linear RGB, 0 or more. Default: white.
            pub fn color(mut self, color: [f64; 3]) -> Self {
                self.0.color = color;
                self
            }

            /// Peak extinction per unit distance, 0 or more. Default: 1.
            pub fn extinction(mut self, extinction: f64) -> Self {
                self.0.extinction = extinction;
                self
            }

            /// Convex region of the (s, g) plane outside which the widget is 0.
            pub fn within(mut self, region: Region) -> Self {
                self.0.region = Some(region);
                self
            }
        }

        impl From<$builder> for Widget {
            fn from(builder: $builder) -> Widget {
                builder.0
            }
        }
    };
}

fn widget(profile: Profile) -> Widget {
    Widget { profile, color: [1.0; 3], extinction: 1.0, region: None }
}

/// A Gaussian over (s, g).
#[derive(Debug, Clone, PartialEq)]
pub struct Gaussian(Widget);
one_color!(Gaussian);

impl Gaussian {
    /// A Gaussian with its middle at (s, g) and standard deviations of 1.
    pub fn at(s: f64, g: f64) -> Self {
        Gaussian(widget(Profile::Gaussian { centre: [s, g], matrix: [[0.0; 2]; 2] })).sigma(1.0, 1.0)
    }

    /// Standard deviations along s and g; infinity ignores the axis.
    pub fn sigma(mut self, s: f64, g: f64) -> Self {
        let [along_s, along_g] = [s, g].map(|sigma| 1.0 / (std::f64::consts::SQRT_2 * sigma));
        if let Profile::Gaussian { matrix, .. } = &mut self.0.profile {
            *matrix = [[along_s, 0.0], [0.0, along_g]];
        }
        self
    }
}

/// Periodic bands across the (s, g) plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Band(Widget);
one_color!(Band);

impl Band {
    /// Bands with straight flanks, a period apart (units of s).
    pub fn triangle(period: f64) -> Self {
        Band(widget(Profile::TriangleWave(Self::wave(period))))
    }

    /// Bands of the form |sin|, a period apart (units of s).
    pub fn sine(period: f64) -> Self {
        Band(widget(Profile::SineWave(Self::wave(period))))
    }

    fn wave(period: f64) -> Wave {
        Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period, band_width: 1.0 }
    }

    fn with_wave(mut self, change: impl FnOnce(&mut Wave)) -> Self {
        if let Profile::TriangleWave(wave) | Profile::SineWave(wave) = &mut self.0.profile {
            change(wave);
        }
        self
    }

    /// A point of the plane where the wave is 0. Default: (0, 0).
    pub fn origin(self, s: f64, g: f64) -> Self {
        self.with_wave(|wave| wave.origin = [s, g])
    }

    /// Direction across the bands (degrees); 0 bands the scalar.
    pub fn angle(self, degrees: f64) -> Self {
        self.with_wave(|wave| wave.angle = degrees.to_radians())
    }

    /// Factors on the two axes. Default: 1.
    pub fn scale(self, s: f64, g: f64) -> Self {
        self.with_wave(|wave| wave.scale = [s, g])
    }

    /// Part of the profile that is kept around its peaks, above 0 up to 1. Default: 1.
    pub fn width(self, fraction: f64) -> Self {
        self.with_wave(|wave| wave.band_width = fraction)
    }
}

/// Constant extinction within a region of the (s, g) plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Uniform(Widget);
one_color!(Uniform);

impl Uniform {
    /// A widget of this region.
    pub fn over(region: Region) -> Self {
        Uniform(Widget { region: Some(region), ..widget(Profile::Uniform) })
    }

    /// A widget of a range of s, for every g.
    pub fn range(low: f64, high: f64) -> Self {
        Self::over(Region::rectangle([low, high], [f64::NEG_INFINITY, f64::INFINITY]))
    }
}

/// Colour and extinction linear between control points in s.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Piecewise {
    points: Vec<ControlPoint>,
    region: Option<Region>,
}

impl Piecewise {
    /// A widget without control points; it needs one or more, in rising s.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a control point: linear RGB, and extinction per unit distance.
    pub fn point(mut self, s: f64, color: [f64; 3], extinction: f64) -> Self {
        self.points.push(ControlPoint { s, color, extinction });
        self
    }

    /// Convex region of the (s, g) plane outside which the widget is 0.
    pub fn within(self, region: Region) -> Self {
        Piecewise { region: Some(region), ..self }
    }
}

impl From<Piecewise> for Widget {
    fn from(Piecewise { points, region }: Piecewise) -> Widget {
        Widget { region, ..widget(Profile::PiecewiseLinear { points }) }
    }
}

/// An image over a rectangle of the (s, g) plane: its colour, and its alpha as the share of the extinction.
#[derive(Debug, Clone, PartialEq)]
pub struct TableImage(Widget);

impl TableImage {
    /// Texels by row, straight linear RGB and alpha (0 or more), the first row at the largest g; over these ranges of s and g.
    pub fn new(width: usize, texels: Vec<[f32; 4]>, s: [f64; 2], g: [f64; 2]) -> Self {
        let height = texels.len() / width.max(1);
        TableImage(widget(Profile::Table(Arc::new(Table { width, height, texels, s, g }))))
    }

    /// An image file (PNG, JPEG, …), over these ranges of s and g.
    ///
    /// # Errors
    /// - the file cannot be read, or holds no image.
    pub fn read(path: impl AsRef<Path>, s: [f64; 2], g: [f64; 2]) -> Result<Self> {
        let (width, _, texels) = table_image(path.as_ref())?;
        Ok(Self::new(width, texels, s, g))
    }

    /// Extinction per unit distance where alpha is 1, 0 or more. Default: 1.
    pub fn extinction(mut self, extinction: f64) -> Self {
        self.0.extinction = extinction;
        self
    }
}

impl From<TableImage> for Widget {
    fn from(image: TableImage) -> Widget {
        image.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_ramp_spans_its_range_from_transparent_to_its_extinction() {
        let bounds = [DVec3::ZERO, DVec3::new(60.0, 0.0, 80.0)];
        let scaled = TransferFunction::ramp(Colormap::Viridis, [2.0, 6.0], 3.0).scaled(Some(bounds)).unwrap();
        assert_eq!(scaled.unit_distance, 1.0);
        let Profile::PiecewiseLinear { points } = &scaled.widgets[0].profile else { unreachable!() };
        let ends = [points[0], points[points.len() - 1]].map(|point| [point.s, point.extinction]);
        assert_eq!(ends, [[2.0, 0.0], [6.0, 3.0]]);
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let gaussian = Gaussian::at(0.0, 0.0);
        for wrong in [gaussian.clone().sigma(0.0, 1.0), gaussian.extinction(-1.0)] {
            TransferFunction::new().with(wrong).scaled(Some([DVec3::ZERO, DVec3::ONE])).unwrap_err();
        }
        TransferFunction::new().with(Piecewise::new()).scaled(Some([DVec3::ZERO, DVec3::ONE])).unwrap_err();
        TransferFunction::new()
            .with(Uniform::range(0.0, 1.0))
            .scaled(Some([DVec3::ZERO, DVec3::ONE]))
            .unwrap();
        for (count, is_right) in [(4, true), (3, false)] {
            let image = TableImage::new(2, vec![[1.0; 4]; count], [0.0, 1.0], [0.0, 2.0]).extinction(3.0);
            let scaled = TransferFunction::new().with(image).scaled(Some([DVec3::ZERO, DVec3::ONE]));
            assert_eq!(scaled.is_ok(), is_right);
        }
    }
}
