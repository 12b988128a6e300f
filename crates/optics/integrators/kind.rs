//! Kinds of integrators: the trait that each implements, and their registration.

use super::{Extent, Integrator, SegmentIntegrator};
use crate::WidgetBlend;
use std::any::Any;
use std::sync::Arc;
use voltet_core::parameters::{Parameters, Variant, VariantSchema};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// The parameter of a pipeline file that names an integrator.
pub const INTEGRATOR: &str = "integrator";

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
    /// The property: "widgets[0] (gaussian), which reads the gradient magnitude".
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

impl Integrator {
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
}

/// A kind as a variant of the parameter [`INTEGRATOR`], which a registry adds.
///
/// Errors: a kind with too many parameters.
pub fn variant(kind: &'static dyn IntegratorKind) -> Result<Variant> {
    let schema = kind.schema();
    if schema.parameters.len() > super::MAX_SETTINGS {
        let error = Error::usage("an integrator has too many parameters").got(schema.parameters.len());
        return Err(error.expected(format!("at most {}", super::MAX_SETTINGS)).at_item(schema.name));
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
    Integrator::from_parameters(kind, parameters)
}

fn kind_of(variant: &Variant) -> Option<&'static dyn IntegratorKind> {
    variant.object.downcast_ref::<&'static dyn IntegratorKind>().copied()
}

/// Checks, without any data, that the integrator's settings are in range and that it can integrate the transfer function.
pub fn can_serve(integrator: &Integrator, transfer_function: &TransferFunction) -> Result<()> {
    can_serve_among(&[], integrator, transfer_function)
}

/// Like [`can_serve`], with an error that names those of `kinds` that can.
pub fn can_serve_among(
    kinds: &[&'static dyn IntegratorKind],
    integrator: &Integrator,
    transfer_function: &TransferFunction,
) -> Result<()> {
    integrator.check()?;
    let Some(Obstacle { found, accepted }) = integrator.kind().obstacle(transfer_function) else {
        return Ok(());
    };
    let others = kinds.iter().filter(|kind| kind.obstacle(transfer_function).is_none());
    let others: Vec<&str> = others.map(|kind| kind.schema().name).collect();
    let what = format!("the integrator '{}' cannot serve this transfer function", integrator.name());
    Err(Error::usage(what).got(found).expected(match others.is_empty() {
        true => accepted.to_string(),
        false => format!("{accepted}, or one of the integrators {}", others.join(", ")),
    }))
}
