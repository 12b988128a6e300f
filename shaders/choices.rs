//! What a scene asks of its shader: the choices that decide the text.

use voltet_core::optics::Overlap;
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::{Error, Result};

/// What runs the integral.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Compositor {
    /// None: `segment` alone, for a pass that brings its own entry point.
    #[default]
    None,
    /// `integrate_segments`: a list of segments, one invocation each.
    Segments,
}

/// How the widgets of a segment are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Combine {
    /// There is no widget.
    Nothing,
    /// One colour under the density-emitter: C = c A, whatever the order.
    OneColor,
    /// One widget.
    Alone,
    /// Kniss et al. 2003, Eq. 15.
    Mix,
    /// The ordered integral.
    Ordered,
}

/// A widget's profile, as far as it decides the text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 1 inside its region.
    Uniform,
    /// A Gaussian of the scalar alone.
    GaussianLine,
    /// A Gaussian over the (s, g) plane.
    GaussianPlane,
    /// A Gaussian over so many fields.
    GaussianFields(usize),
    /// A triangular Gaussian.
    Triangular,
    /// A triangle wave.
    TriangleWave,
    /// A sine wave.
    SineWave,
    /// Linear between so many control points.
    Piecewise(usize),
}

/// A widget, as far as it decides the text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct WidgetChoice {
    /// Its profile.
    pub kind: Kind,
    /// Edges of its region; `None` without one.
    pub edges: Option<usize>,
}

/// Everything that decides the text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Choices {
    /// The widgets in their order.
    pub widgets: Vec<WidgetChoice>,
    /// The constant-emitter, not the density-emitter.
    pub constant_emitter: bool,
    /// How widgets are combined.
    pub combine: Combine,
    /// Whether g is among the values.
    pub reads_gradient_magnitude: bool,
    /// Further fields among the values.
    pub field_count: usize,
    /// Silhouette enhancement.
    pub silhouette: bool,
    /// Diffuse lighting.
    pub light: bool,
    /// What runs the integral.
    pub compositor: Compositor,
}

impl Choices {
    /// What a scene asks for. Errors name what no piece serves: integrators other than the analytic one, tables.
    pub fn new(
        transfer_function: &TransferFunction,
        shading: &Shading,
        compositor: Compositor,
    ) -> Result<Choices> {
        if shading.integrator != Integrator::Analytic {
            return Err(Error::usage("the integrator has no shader")
                .found(shading.integrator.name())
                .accepted(Integrator::Analytic.name()));
        }
        let widgets = transfer_function.widgets.iter().enumerate();
        let widgets = widgets
            .map(|(i, widget)| choice(widget).map_err(|e| e.at_item(format!("widgets[{i}]"))))
            .collect::<Result<Vec<_>>>()?;
        let constant_emitter = matches!(transfer_function.model, OpticalModel::ConstantEmitter { .. });
        let combine = match widgets.len() {
            0 => Combine::Nothing,
            _ if !constant_emitter && has_one_color(transfer_function) => Combine::OneColor,
            1 => Combine::Alone,
            _ if shading.overlap == Overlap::Mix => Combine::Mix,
            _ => Combine::Ordered,
        };
        Ok(Choices {
            widgets,
            constant_emitter,
            combine,
            reads_gradient_magnitude: transfer_function.uses_gradient_magnitude(),
            field_count: transfer_function.fields().len(),
            silhouette: shading.silhouette.is_some_and(|p| p != 0.0),
            light: shading.light.is_some(),
            compositor,
        })
    }

    /// Values at each end of a segment: s, then g where it is read, then the further fields by name.
    pub fn value_count(&self) -> usize {
        1 + usize::from(self.reads_gradient_magnitude) + self.field_count
    }

    /// Whether a gradient vector is asked for.
    pub fn reads_gradient(&self) -> bool {
        self.silhouette || self.light
    }

    /// Numbers of a segment for [`Compositor::Segments`]: D, the values at the front, at the back; then the gradient at
    /// the middle, then for silhouettes the ray's direction.
    pub fn segment_stride(&self) -> usize {
        1 + 2 * self.value_count() + 3 * usize::from(self.reads_gradient()) + 3 * usize::from(self.silhouette)
    }

    /// Whether `numbers` is read, so that something must be bound to it.
    pub fn reads_numbers(&self) -> bool {
        self.widgets.iter().any(|widget| {
            widget.edges.is_some() || matches!(widget.kind, Kind::GaussianFields(_) | Kind::Piecewise(_))
        })
    }
}

fn choice(widget: &Widget) -> Result<WidgetChoice> {
    let kind = match &widget.profile {
        Profile::Uniform => Kind::Uniform,
        Profile::Gaussian { matrix, .. } if matrix[0][1] == 0.0 && matrix[1][1] == 0.0 => Kind::GaussianLine,
        Profile::Gaussian { .. } => Kind::GaussianPlane,
        Profile::GaussianNd { fields, .. } => Kind::GaussianFields(fields.len()),
        Profile::TriangularGaussian { .. } => Kind::Triangular,
        Profile::TriangleWave(_) => Kind::TriangleWave,
        Profile::SineWave(_) => Kind::SineWave,
        Profile::PiecewiseLinear { points } => Kind::Piecewise(points.len()),
        Profile::Table(_) => {
            return Err(Error::usage("a table widget has no shader")
                .found(widget.profile.name())
                .accepted("a widget with a closed form or control points"));
        }
    };
    let edges = widget.region.as_ref().map(|region| crate::parameters::edges(region).len());
    Ok(WidgetChoice { kind, edges })
}

/// Whether all light has one colour.
fn has_one_color(transfer_function: &TransferFunction) -> bool {
    let mut colors = transfer_function.widgets.iter().flat_map(|widget| match &widget.profile {
        Profile::PiecewiseLinear { points } => points.iter().map(|p| p.color).collect(),
        _ => vec![widget.color],
    });
    let first = colors.next();
    colors.all(|color| Some(color) == first)
}
