//! 64-bit adaptive quadrature, which knows no closed form: the referee's own segments (module
//! [`crate::reference`]).

use super::{Extent, Integrator, IntegratorKind, SegmentIntegrator};
use crate::reference::{Integrand, Tolerance, Workspace};
use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use std::cell::RefCell;
use std::sync::OnceLock;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};

/// Adaptive quadrature to a relative 1e-11.
pub struct Reference {
    integrand: Integrand,
    /// For values that are not finite, which contribute nothing.
    prepared: CompiledTransferFunction,
    overlap: WidgetBlend,
    /// What it could not integrate first.
    failure: OnceLock<Error>,
}

impl Reference {
    /// Serves every transfer function.
    pub fn new(transfer_function: &TransferFunction, overlap: WidgetBlend) -> Result<Self> {
        Ok(Reference {
            prepared: CompiledTransferFunction::new(transfer_function)?,
            integrand: Integrand::new(transfer_function, overlap, Tolerance::PICTURE)?,
            overlap,
            failure: OnceLock::new(),
        })
    }
}

/// The kind `reference`.
pub(super) struct ReferenceKind;

impl IntegratorKind for ReferenceKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema { name: "reference", summary: "64-bit adaptive quadrature, slow", parameters: &[] }
    }

    fn compile(
        &self,
        _: &Integrator,
        blend: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Reference::new(transfer_function, blend)?))
    }
}

thread_local! {
    static WORK: RefCell<(Workspace, Vec<f64>, Vec<f64>)> = RefCell::default();
}

impl SegmentIntegrator for Reference {
    fn integrate(&self, segment: &Segment) -> Contribution {
        let ends = [segment.front, segment.back];
        let fields = segment.fields_front.iter().chain(segment.fields_back);
        if !ends.iter().flatten().chain(fields).all(|x| x.is_finite()) {
            return self.prepared.integrate(segment, self.overlap);
        }
        WORK.with_borrow_mut(|(work, front, back)| {
            let fill = |values: &mut Vec<f64>, pair: [f64; 2], fields: &[f64]| {
                values.clear();
                values.extend(pair);
                values.extend(fields);
            };
            fill(front, segment.front, segment.fields_front);
            fill(back, segment.back, segment.fields_back);
            self.integrand.integrate(segment.length, front, back, work).unwrap_or_else(|error| {
                // Of several failures one is enough.
                let _ = self.failure.set(error);
                Contribution::default()
            })
        })
    }

    fn failure(&self) -> Option<&Error> {
        self.failure.get()
    }
}
