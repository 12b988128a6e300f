//! Quadrature of segments behind the traits of integrators and of the ray tracer.

use crate::renderer::{ENGINE, NAME};
use crate::segment::{Integrand, Tolerance, Workspace};
use std::any::Any;
use std::cell::RefCell;
use std::sync::OnceLock;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_optics::integrators::{Extent, Integrator, IntegratorKind, SegmentIntegrator};
use voltet_optics::trace::SegmentIntegral;
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};

/// Kind of the integrator `reference`, which has an engine of its own.
pub(crate) struct ReferenceKind;

impl IntegratorKind for ReferenceKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema { name: NAME, summary: "64-bit adaptive quadrature, slow", parameters: &[] }
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

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&ENGINE]
    }
}

/// Adaptive quadrature to a relative 1e-11.
pub struct Reference {
    integrand: Integrand,
    /// Closed forms, for values that are not finite, which contribute nothing.
    prepared: CompiledTransferFunction,
    overlap: WidgetBlend,
    failure: OnceLock<Error>,
}

impl Reference {
    /// Quadrature of a transfer function. Errors: a number out of range.
    pub fn new(transfer_function: &TransferFunction, overlap: WidgetBlend) -> Result<Self> {
        Ok(Reference {
            prepared: CompiledTransferFunction::new(transfer_function)?,
            integrand: Integrand::new(transfer_function, overlap, Tolerance::PICTURE)?,
            overlap,
            failure: OnceLock::new(),
        })
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

impl SegmentIntegral for Integrand {
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution> {
        WORK.with_borrow_mut(|(work, ..)| self.integrate(length, front, back, work))
    }

    fn max_color(&self, length: f64) -> f64 {
        self.brightest(length)
    }
}
