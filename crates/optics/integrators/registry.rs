//! Registration of integrators as variants of a pipeline's parameter, and their choice.

use super::{Integrator, IntegratorKind, MAX_SETTINGS, Obstacle};
use std::sync::Arc;
use voltet_core::parameters::{Parameters, Variant};
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};

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
    Integrator::from_parameters(kind, parameters)
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
