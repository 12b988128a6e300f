//! Key of a shader: everything in a scene that decides the text of its shader; and shader text of integrators from outside.

use crate::kinds::Kind;
use crate::passes::{Layout, Parts};
use crate::text::WgslPiece;
use std::fmt;
use std::hash::{Hash, Hasher};
use voltet_core::transfer::{AxisScale, OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::{Integrator, IntegratorKind, can_serve};
use voltet_optics::shading::Shading;

/// Numbers of an edge of a region: a normal and a corner.
const EDGE_NUMBERS: usize = 4;

/// Compositor that runs the integral.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CompositorProgram {
    /// None: `segment` alone, for a pass that brings its own entry point.
    #[default]
    None,
    /// `integrate_segments`: a list of segments, one invocation each.
    Segments,
    /// `composite_tiles`: tiles of pixels, one workgroup each.
    Tiles(TileOrder),
    /// `outline_cell` and `blend_cell`: the cells' silhouettes, drawn and blended by the hardware.
    Raster(Blend),
    /// `place_corner` and `blend_triangle`: the cells' triangles, split by [`crate::FramePass::Split`], likewise.
    Triangles(Blend),
}

/// Contents of a pixel of the blending compositors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Blend {
    /// Colour and opacity, one cell's over those behind it.
    Over,
    /// One number, since there is one colour.
    Sum,
}

/// Order in which a tile's pixels take their segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TileOrder {
    /// By entry, pixel by pixel.
    Exact,
    /// Likewise, with surfaces and clips among them.
    Cut,
    /// As the tile's list has them.
    Listed,
    /// In whatever order, since there is one colour.
    Sum,
}

/// Integrator of a segment, as far as it decides the text: counts, tolerances and the sides of tables are numbers
/// that the text reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Closed forms.
    Analytic,
    /// Closed forms, subdivided to a tolerance.
    Adaptive,
    /// Text from outside.
    Registered(&'static dyn WgslIntegrator),
}

impl Method {
    /// The call of text from outside.
    pub(crate) fn call(self, constant_emitter: bool) -> Option<WgslCall> {
        match self {
            Method::Registered(text) => Some(text.call(constant_emitter)),
            Method::Analytic | Method::Adaptive => None,
        }
    }

    /// True if all that is drawn stands in a table, so that the text has no widgets.
    pub fn is_table_of_lengths(self) -> bool {
        matches!(self.call(false), Some(WgslCall::Table { .. }))
    }

    /// True if the widgets are sampled.
    pub(crate) fn samples(self) -> bool {
        matches!(self.call(false), Some(WgslCall::Samples { .. }))
    }

    /// The pieces that the text adds to those that ship.
    pub(crate) fn pieces(self) -> &'static [WgslPiece] {
        match self {
            Method::Registered(text) => text.pieces(),
            Method::Analytic | Method::Adaptive => &[],
        }
    }
}

/// Combination of a segment's widgets.
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

/// A widget, as far as it decides the text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct WidgetChoice {
    /// Its profile.
    pub kind: Kind,
    /// Edges of its region, and of a table's range; `None` without any.
    pub edges: Option<usize>,
}

/// Scale of an axis, as far as it decides the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AxisShape {
    /// Values are positions.
    Linear,
    /// Logarithmic.
    Log,
    /// Symmetrically logarithmic.
    SymLog,
}

/// Everything that decides the text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ShaderKey {
    /// Integrator.
    pub method: Method,
    /// The widgets in their order; none where a table stands for them.
    pub widgets: Vec<WidgetChoice>,
    /// The constant-emitter, not the density-emitter.
    pub constant_emitter: bool,
    /// Combination of widgets.
    pub combine: Combine,
    /// True if g is among the values.
    pub reads_gradient_magnitude: bool,
    /// Further fields among the values.
    pub field_count: usize,
    /// The scales of s and g; `None` where both are linear.
    pub curved_axes: Option<[AxisShape; 2]>,
    /// Silhouette enhancement.
    pub silhouette: bool,
    /// Diffuse lighting.
    pub light: bool,
    /// Compositor.
    pub compositor: CompositorProgram,
    /// Split of large arrays over bindings: whole, until a device requires otherwise.
    pub layout: Layout,
}

impl ShaderKey {
    /// Key of a scene. Errors: those of `can_serve`, and the integrator `reference`, which has no shader.
    pub fn new(
        transfer_function: &TransferFunction,
        shading: &Shading,
        compositor: CompositorProgram,
    ) -> Result<ShaderKey> {
        can_serve(&shading.integrator, transfer_function)?;
        let method = method_of(&shading.integrator).ok_or_else(|| {
            Error::usage("the integrator has no shader: the CPU draws it")
                .got(shading.integrator.name())
                .expected("engine = \"cpu\"")
        })?;
        let scene = ShaderKey {
            method,
            widgets: Vec::new(),
            constant_emitter: false,
            combine: Combine::Nothing,
            reads_gradient_magnitude: false,
            field_count: 0,
            curved_axes: None,
            silhouette: shading.silhouette.is_some_and(|p| p != 0.0),
            light: shading.light.is_some(),
            compositor,
            layout: Layout::WHOLE,
        };
        let curved_axes = curved_axes(transfer_function);
        if curved_axes.is_some() && matches!(method, Method::Registered(_)) {
            return Err(Error::usage(
                "the integrator has no shader for logarithmic axes: the CPU draws them",
            )
            .got(shading.integrator.name())
            .expected(
                "engine = \"cpu\" or \"auto\", linear axes, or the integrators analytic and adaptive",
            ));
        }
        if method.is_table_of_lengths() {
            return Ok(scene);
        }
        let widgets: Vec<WidgetChoice> = transfer_function.widgets.iter().map(choice).collect();
        let constant_emitter = matches!(transfer_function.model, OpticalModel::ConstantEmitter { .. });
        // The others than `analytic` take widgets together in their order.
        let mixed = shading.overlap == WidgetBlend::Mix && method == Method::Analytic;
        let combine = match widgets.len() {
            0 => Combine::Nothing,
            _ if method.samples() => Combine::Ordered,
            _ if transfer_function.uniform_color().is_some() => Combine::OneColor,
            1 => Combine::Alone,
            _ if mixed => Combine::Mix,
            _ => Combine::Ordered,
        };
        let reads_gradient_magnitude = transfer_function.uses_gradient_magnitude();
        let field_count = transfer_function.fields().len();
        Ok(ShaderKey {
            widgets,
            constant_emitter,
            combine,
            reads_gradient_magnitude,
            field_count,
            curved_axes,
            ..scene
        })
    }

    /// Values at each end of a segment: s, then g where it is read, then the further fields by name.
    pub fn value_count(&self) -> usize {
        1 + usize::from(self.reads_gradient_magnitude) + self.field_count
    }

    /// True if a gradient vector is asked for.
    pub fn reads_gradient(&self) -> bool {
        self.silhouette || self.light
    }

    /// True if sums of one colour are sums of optical depths: a silhouette gives every segment a factor of its own.
    pub fn depths_add_up(&self) -> bool {
        !self.reads_gradient()
    }

    /// Numbers of a segment for [`CompositorProgram::Segments`]: D, the values at the front, at the back; then the gradient at
    /// the middle, then for silhouettes the ray's direction.
    pub fn segment_stride(&self) -> usize {
        1 + 2 * self.value_count() + 3 * usize::from(self.reads_gradient()) + 3 * usize::from(self.silhouette)
    }

    /// Numbers of a point behind its scalar for the compositors of pixels: further values, then the gradient.
    pub fn attribute_stride(&self) -> usize {
        self.value_count() - 1 + 3 * usize::from(self.reads_gradient())
    }

    /// Numbers of all widgets: edges, control points, matrices.
    pub fn number_count(&self) -> u64 {
        let of =
            |widget: &WidgetChoice| EDGE_NUMBERS * widget.edges.unwrap_or(0) + widget.kind.number_count();
        self.widgets.iter().map(|widget| of(widget) as u64).sum()
    }

    /// True if numbers are read one by one, so that something must be bound to `numbers`.
    pub(crate) fn reads_numbers(&self) -> bool {
        let of_widgets =
            self.widgets.iter().any(|widget| widget.edges.is_some() || widget.kind.number_count() > 0);
        let of_method = self.method.call(self.constant_emitter);
        let of_method = matches!(of_method, Some(WgslCall::Samples { reads_numbers: true, .. }));
        of_widgets || (of_method && !self.widgets.is_empty()) || self.curved_axes.is_some()
    }

    /// The read-only storage buffers of group 0, by name and binding: what [`crate::Resources`] fills, `numbers` in its parts.
    /// All that a scene reads beside its uniform stands there; see [`crate::Places`].
    pub fn storage_buffers(&self) -> Vec<(String, u32)> {
        let count = match self.reads_vectors() {
            Some(_) => self.layout.table.count,
            None => u32::from(self.reads_numbers()),
        };
        (0..count).map(|part| (Parts::name("numbers", part), ShaderKey::binding_of_numbers(part))).collect()
    }

    /// The function that reads vectors, where the scene has any: of images, or the colours by (D, s_f, s_b) or (α, s, t), which
    /// stand for all widgets.
    pub(crate) fn reads_vectors(&self) -> Option<&'static str> {
        if self.method.is_table_of_lengths() {
            return Some("glow");
        }
        let has_images = self.widgets.iter().any(|widget| widget.kind == Kind::Table);
        has_images.then_some("texel")
    }

    /// Binding of a part of `numbers` in group 0.
    pub(crate) fn binding_of_numbers(part: u32) -> u32 {
        1 + part
    }
}

/// Method that draws an integrator on a device; `None`: there is none.
fn method_of(integrator: &Integrator) -> Option<Method> {
    if *integrator == Integrator::ANALYTIC {
        return Some(Method::Analytic);
    }
    if integrator.tolerance().is_some() {
        return Some(Method::Adaptive);
    }
    registered(integrator).map(Method::Registered)
}

/// True if there is a shader for the integrator.
pub fn has_method(integrator: &Integrator) -> bool {
    method_of(integrator).is_some()
}

/// Scales of s and g; `None` where both are linear.
fn curved_axes(transfer_function: &TransferFunction) -> Option<[AxisShape; 2]> {
    let shape = |scale: AxisScale| match scale {
        AxisScale::Linear => AxisShape::Linear,
        AxisScale::Log => AxisShape::Log,
        AxisScale::SymLog { .. } => AxisShape::SymLog,
    };
    transfer_function.has_curved_axes().then(|| transfer_function.axes_read().map(shape))
}

fn choice(widget: &Widget) -> WidgetChoice {
    let clipped = widget.region.is_some() || widget.profile.properties().range.is_some();
    let edges = clipped.then(|| widget.half_planes().len());
    WidgetChoice { kind: Kind::from_profile(&widget.profile), edges }
}

/// Extension by which a kind of integrators has shader text ([`voltet_optics::integrators::IntegratorKind::extensions`]).
pub struct WgslExtension(pub &'static dyn WgslIntegrator);

/// Shader text of a kind of integrators. Without one, devices do not draw with it. Equal names of kinds mean equal text.
pub trait WgslIntegrator: IntegratorKind {
    /// The pieces that the crate of the integrator adds to those that ship ([`crate::PIECES`]).
    fn pieces(&self) -> &'static [WgslPiece];

    /// The call that integrates a segment.
    fn call(&self, constant_emitter: bool) -> WgslCall;

    /// Samples or pieces of a segment: `scene.piece_count`.
    fn piece_count(&self, _integrator: &Integrator) -> Option<usize> {
        None
    }

    /// Size of the table that the text reads.
    fn table_size(&self, _integrator: &Integrator, _transfer_function: &TransferFunction) -> TableSize {
        TableSize::default()
    }

    /// The numbers of a table that stand in front of those of the widgets ([`TableSize::entries`] of them).
    fn entries(&self, _integrator: &Integrator, _transfer_function: &TransferFunction) -> Vec<f32> {
        Vec::new()
    }
}

/// Size of the table that an integrator's text reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TableSize {
    /// Vectors that stand for all widgets ([`WgslCall::Table`]); 0 without such a table.
    pub vectors: u64,
    /// Vectors of the table that those are made from, if it is another: it has buffers of its own.
    pub source_vectors: u64,
    /// Numbers beside the vectors.
    pub entries: u64,
}

/// The call of a function that integrates a segment; the function returns the colour, and the optical depth in the fourth component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WgslCall {
    /// A function of the widgets as members (`Members`) and the number of pieces.
    Samples {
        /// Its name.
        function: &'static str,
        /// The pieces that it stands in.
        pieces: &'static [&'static str],
        /// True if the pieces read `numbers`.
        reads_numbers: bool,
    },
    /// A function of length, scalar at the front and scalar at the back, which reads a table that stands for all widgets.
    Table {
        /// Its name.
        function: &'static str,
        /// The pieces that it stands in.
        pieces: &'static [&'static str],
    },
}

impl fmt::Debug for dyn WgslIntegrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.schema().name)
    }
}

impl PartialEq for dyn WgslIntegrator {
    fn eq(&self, other: &dyn WgslIntegrator) -> bool {
        self.schema().name == other.schema().name
    }
}

impl Eq for dyn WgslIntegrator {}

impl Hash for dyn WgslIntegrator {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.schema().name.hash(state);
    }
}

/// The shader text of an integrator's kind.
pub(crate) fn registered(integrator: &Integrator) -> Option<&'static dyn WgslIntegrator> {
    integrator.extension().map(|WgslExtension(text)| *text)
}
