//! Integrators: the trait that each kind implements, an integrator as its kind with a number for each parameter of the kind, and
//! its registration as a variant of a pipeline's parameter.

use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use std::any::Any;
use std::sync::Arc;
use voltet_core::parameters::{LocatedValue, Parameter, ParameterType, Parameters, Variant, VariantSchema};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// Computes (C, A) of one segment.
pub trait SegmentIntegrator: Send + Sync {
    /// The segment's contribution.
    fn integrate(&self, segment: &Segment) -> Contribution;

    /// Bytes of its tables.
    fn table_bytes(&self) -> usize {
        0
    }

    /// The table that the integrator looks up, for kernels that share it.
    fn table(&self) -> Option<&dyn Any> {
        None
    }

    /// Reason why a segment could not be integrated so far: a picture drawn with it is invalid.
    fn failure(&self) -> Option<&Error> {
        None
    }
}

/// Ranges of the segments of a data set: the domain of a table over them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Smallest and largest scalar.
    pub scalar: [f64; 2],
    /// Length of the longest segment, world units.
    pub longest: f64,
}

/// A kind of integrators. Each is a static; a registry that adds its [`variant`] makes it known to pipelines.
pub trait IntegratorKind: Send + Sync {
    /// Name in pipeline files, summary and parameters: whole numbers and numbers, at most [`super::MAX_SETTINGS`] of them.
    fn schema(&self) -> VariantSchema;

    /// Checks the settings of an integrator of this kind.
    ///
    /// Errors: a setting out of range.
    fn check(&self, integrator: &Integrator) -> Result<()> {
        integrator.check_ranges()
    }

    /// The property of a transfer function that keeps the kind from integrating it; `None`: none does.
    fn obstacle(&self, _transfer_function: &TransferFunction) -> Option<Obstacle> {
        None
    }

    /// The 64-bit integral of a segment. `integrator` was checked; `blend` counts for kinds that can mix widgets.
    ///
    /// Errors: a transfer function with a number out of range.
    fn compile(
        &self,
        integrator: &Integrator,
        blend: WidgetBlend,
        transfer_function: &TransferFunction,
        extent: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>>;

    /// The domain of the table that the kind looks up.
    fn table(&self) -> TableDomain {
        TableDomain::None
    }

    /// The preparation of whole scenes, for a kind that needs one.
    fn scene_preparation(&self) -> Option<&dyn ScenePreparation> {
        None
    }

    /// Objects for single engines, each looked up by its type ([`Integrator::extension`]): kernels for vector lanes, shader text.
    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[]
    }
}

/// The property of a transfer function that an integrator cannot integrate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Obstacle {
    /// The property: `widgets[0] (gaussian), which reads the gradient magnitude`.
    pub found: String,
    /// A transfer function that the kind integrates: "widgets of the scalar alone".
    pub accepted: &'static str,
}

/// The domain of an integrator's table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TableDomain {
    /// There is no table.
    #[default]
    None,
    /// A domain that no data decide.
    Fixed,
    /// Scalars and lengths of the data ([`Extent`]).
    Data,
}

/// The preparation of a whole scene before its segments are integrated.
pub trait ScenePreparation: Send + Sync {
    /// The volume and the transfer function to draw in place of the scene's.
    ///
    /// Errors: a field that the volume does not have; numbers out of range.
    fn prepare(&self, volume: &Volume, transfer_function: &TransferFunction) -> Result<PreparedScene>;

    /// True if the transfer function is one that [`ScenePreparation::prepare`] returned.
    fn is_prepared(&self, transfer_function: &TransferFunction) -> bool;
}

/// A scene after [`ScenePreparation::prepare`].
#[derive(Debug, Clone)]
pub struct PreparedScene {
    /// The volume to draw.
    pub volume: Volume,
    /// The transfer function to draw with.
    pub transfer_function: TransferFunction,
}

/// Parameters of a kind at most.
pub const MAX_SETTINGS: usize = 4;

/// An integrator: its kind and the settings of it.
#[derive(Clone, Copy)]
pub struct Integrator {
    kind: &'static dyn IntegratorKind,
    /// In the order of the kind's parameters.
    settings: [f64; MAX_SETTINGS],
}

impl PartialEq for Integrator {
    fn eq(&self, other: &Integrator) -> bool {
        self.is_kind_of(other) && self.settings == other.settings
    }
}

impl std::fmt::Debug for Integrator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct(self.name());
        for (parameter, value) in self.parameters().iter().zip(self.settings) {
            text.field(parameter.name, &value);
        }
        text.finish()
    }
}

impl Integrator {
    /// An integrator with these settings, in the order of the kind's parameters.
    pub const fn with_settings<const N: usize>(
        kind: &'static dyn IntegratorKind,
        settings: [f64; N],
    ) -> Integrator {
        let mut all = [0.0; MAX_SETTINGS];
        let mut k = 0;
        while k < N {
            all[k] = settings[k];
            k += 1;
        }
        Integrator { kind, settings: all }
    }

    /// An integrator with the default settings of its kind.
    pub fn new(kind: &'static dyn IntegratorKind) -> Integrator {
        let mut integrator = Integrator::with_settings(kind, []);
        for (parameter, setting) in kind.schema().parameters.iter().zip(&mut integrator.settings) {
            let default = parameter.default.datum().map(LocatedValue::from);
            *setting = default.and_then(|value| value.number()).unwrap_or(0.0);
        }
        integrator
    }

    /// The kind.
    pub fn kind(&self) -> &'static dyn IntegratorKind {
        self.kind
    }

    /// The name in pipeline files.
    pub fn name(&self) -> &'static str {
        self.kind.schema().name
    }

    /// The parameters of the kind.
    pub fn parameters(&self) -> &'static [Parameter] {
        self.kind.schema().parameters
    }

    /// The setting of that name; `None` where the kind has no such parameter.
    pub fn setting(&self, name: &str) -> Option<f64> {
        let place = self.parameters().iter().position(|parameter| parameter.name == name)?;
        Some(self.settings[place])
    }

    /// The setting of that name as a whole number.
    pub fn count(&self, name: &str) -> Option<usize> {
        self.setting(name).map(|value| value as usize)
    }

    /// This integrator with another setting; as it is where the kind has no such parameter.
    pub fn with(mut self, name: &str, value: f64) -> Integrator {
        if let Some(place) = self.parameters().iter().position(|parameter| parameter.name == name) {
            self.settings[place] = value;
        }
        self
    }

    /// True if both are of one kind, whatever their settings.
    pub fn is_kind_of(&self, other: &Integrator) -> bool {
        self.name() == other.name()
    }

    /// Checks that the settings are in range.
    pub fn check(&self) -> Result<()> {
        self.kind.check(self)
    }

    /// Checks that each setting lies in the range that its parameter declares.
    pub fn check_ranges(&self) -> Result<()> {
        for (parameter, value) in self.parameters().iter().zip(self.settings) {
            let (range, whole) = match parameter.parameter_type {
                ParameterType::Integer(range) => (range, true),
                ParameterType::Number(range) => (range, false),
                _ => continue,
            };
            if !range.holds(value) || (whole && value.fract() != 0.0) {
                return Err(self.out_of_range(parameter.name, value, range));
            }
        }
        Ok(())
    }

    /// True if the integrator looks up a table.
    pub fn has_table(&self) -> bool {
        self.kind().table() != TableDomain::None
    }

    /// True if the integrator looks up a table over lengths, so that [`super::new`] reads the data's extent.
    pub fn has_table_of_lengths(&self) -> bool {
        self.kind().table() == TableDomain::Data
    }

    /// The object of type `T` that the kind has for an engine.
    pub fn extension<T: Any>(&self) -> Option<&'static T> {
        self.kind().extensions().iter().find_map(|object| object.downcast_ref())
    }

    /// The error for a setting that is out of range.
    pub fn out_of_range(
        &self,
        what: &str,
        value: impl std::fmt::Display,
        accepted: impl std::fmt::Display,
    ) -> Error {
        Error::usage(format!("{what} of the integrator '{}' is out of range", self.name()))
            .got(value)
            .expected(accepted)
    }
}

/// The parameter of a pipeline file that names an integrator.
pub const INTEGRATOR: &str = "integrator";

/// A kind as a variant of the parameter [`INTEGRATOR`], which a registry adds.
///
/// Errors: a kind with too many parameters.
pub fn variant(kind: &'static dyn IntegratorKind) -> Result<Variant> {
    let schema = kind.schema();
    if schema.parameters.len() > MAX_SETTINGS {
        let error = Error::usage("an integrator has too many parameters").got(schema.parameters.len());
        return Err(error.expected(format!("at most {}", MAX_SETTINGS)).at_item(schema.name));
    }
    Ok(Variant { schema, object: Arc::new(kind) })
}

/// The kinds among variants of a registry, or of a node's parameters.
pub fn kinds<'a>(variants: impl IntoIterator<Item = &'a Variant>) -> Vec<&'static dyn IntegratorKind> {
    variants.into_iter().filter_map(kind_of).collect()
}

/// The integrator that a node's parameters state.
///
/// Errors: a name that is not registered.
pub fn stated(parameters: &Parameters) -> Result<Integrator> {
    let variant = parameters.variant(INTEGRATOR)?;
    let kind = kind_of(variant).ok_or_else(|| {
        parameters.error(INTEGRATOR, format!("'{}' is not registered as an integrator", variant.schema.name))
    })?;
    let mut integrator = Integrator::with_settings(kind, []);
    for (parameter, setting) in kind.schema().parameters.iter().zip(&mut integrator.settings) {
        *setting = parameters.number(parameter.name)?;
    }
    Ok(integrator)
}

fn kind_of(variant: &Variant) -> Option<&'static dyn IntegratorKind> {
    variant.object.downcast_ref::<&'static dyn IntegratorKind>().copied()
}

/// Checks, without any data, that the integrator's settings are in range and that it can integrate the transfer function.
pub fn can_serve(integrator: &Integrator, transfer_function: &TransferFunction) -> Result<()> {
    integrator.check()?;
    let Some(Obstacle { found, accepted }) = integrator.kind().obstacle(transfer_function) else {
        return Ok(());
    };
    let what = format!("the integrator '{}' cannot serve this transfer function", integrator.name());
    Err(Error::usage(what).got(found).expected(accepted))
}

/// The closed forms.
#[derive(Debug, Clone)]
pub struct Analytic {
    prepared: CompiledTransferFunction,
    overlap: WidgetBlend,
}

impl Analytic {
    /// Closed forms of a transfer function.
    ///
    /// Errors: a number out of range.
    pub fn new(transfer_function: &TransferFunction, overlap: WidgetBlend) -> Result<Self> {
        Ok(Analytic { prepared: CompiledTransferFunction::new(transfer_function)?, overlap })
    }
}

impl Integrator {
    /// Closed forms; quadrature with closed-form optical depth where widgets overlap.
    pub const ANALYTIC: Integrator = Integrator::with_settings(&AnalyticKind, []);
}

impl Default for Integrator {
    fn default() -> Self {
        Integrator::ANALYTIC
    }
}

pub(super) struct AnalyticKind;

impl IntegratorKind for AnalyticKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "analytic",
            summary: "closed forms; quadrature with closed-form optical depth where widgets overlap",
            parameters: &[],
        }
    }

    fn compile(
        &self,
        _: &Integrator,
        blend: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Analytic::new(transfer_function, blend)?))
    }
}

impl SegmentIntegrator for Analytic {
    fn integrate(&self, segment: &Segment) -> Contribution {
        self.prepared.integrate(segment, self.overlap)
    }
}
