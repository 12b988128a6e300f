//! The kinds of integrators, their parameters and what they accept.

use super::{
    PreIntegrated, PreIntegratedCylindrical, Riemann, Segments, Tabulated, VertexSampled, last_tile,
    vertex_sampled::Classification,
};
use crate::lanes::{PreIntegratedLanes, RiemannLanes, SegmentsLanes, TabulatedLanes, VertexSampledLanes};
use crate::settings::{
    MAX_OVERSAMPLING, MAX_PARTIAL_SIDE, MAX_PLANES, MAX_TABLE_SIDE, MAX_TILE_ENTRIES, OVERSAMPLING,
    OVERSAMPLING_PARAMETER, PARTIAL_SIDE_PARAMETER, PIECES, PIECES_PARAMETER, PLANES, PLANES_PARAMETER, SIDE,
    SIDE_PARAMETER, check_count, check_pieces, count,
};
use crate::shader::{CylindricalText, PreIntegratedText, RiemannText, SegmentsText};
use std::any::Any;
use voltet_core::Result;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::{Profile, TransferFunction};
use voltet_cpu::integrator::LaneExtension;
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::{
    Extent, Integrator, IntegratorKind, Obstacle, ScenePreparation, SegmentIntegrator, TableDomain,
};
use voltet_shaders::{WgslExtension, WgslTableExtension};

/// All kinds, in the order in which studies list them.
pub static KINDS: [&dyn IntegratorKind; 6] = [
    &SegmentsKind,
    &RiemannKind,
    &PreIntegratedKind,
    &PreIntegratedCylindricalKind,
    &VertexSampledKind,
    &TabulatedKind,
];

/// Point samples: `count` ≥ 1 of a segment.
pub const fn riemann(count: usize) -> Integrator {
    Integrator::with_settings(&RiemannKind, [count as f64])
}

/// Equal pieces, `count` ≥ 1 of a segment, combined by a table of `side` ≥ 2 entries a side.
pub const fn segments(count: usize, side: usize) -> Integrator {
    Integrator::with_settings(&SegmentsKind, [count as f64, side as f64])
}

/// A three-dimensional table: 2 … [`MAX_TABLE_SIDE`] entries a side, 1 … [`MAX_OVERSAMPLING`] pieces of a path from one to the next.
pub const fn pre_integrated(side: usize, oversampling: usize) -> Integrator {
    Integrator::with_settings(&PreIntegratedKind, [side as f64, oversampling as f64])
}

/// The table of [`pre_integrated`], resampled to `planes` tiles for each entry of a side, 1 … [`MAX_PLANES`]; all of them take no more
/// memory than those of the largest side with one.
pub const fn pre_integrated_cylindrical(side: usize, oversampling: usize, planes: usize) -> Integrator {
    let settings = [side as f64, oversampling as f64, planes as f64];
    Integrator::with_settings(&PreIntegratedCylindricalKind, settings)
}

/// Integrals of uniform and Gaussian widgets from tables of 2 … [`MAX_PARTIAL_SIDE`] entries a side.
pub const fn tabulated(side: usize) -> Integrator {
    Integrator::with_settings(&TabulatedKind, [side as f64])
}

/// The transfer function applied at the grid's points, absorption and emission linear between them.
pub const VERTEX_SAMPLED: Integrator = Integrator::with_settings(&VertexSampledKind, []);

/// Widget with the reason that it cannot be integrated.
fn named(transfer_function: &TransferFunction, place: usize, why: &str) -> String {
    format!("widgets[{place}] ({}), {why}", transfer_function.widgets[place].profile.name())
}

/// The first widget that reads more than the scalar.
fn of_scalar_alone(transfer_function: &TransferFunction) -> Option<Obstacle> {
    let found = transfer_function.widgets.iter().enumerate().find_map(|(place, widget)| {
        if widget.uses_gradient_magnitude() {
            Some(named(transfer_function, place, "which reads the gradient magnitude"))
        } else if !widget.profile.properties().fields.is_empty() {
            Some(named(transfer_function, place, "which reads further fields"))
        } else {
            None
        }
    })?;
    Some(Obstacle { found, accepted: "widgets of the scalar alone" })
}

/// The kind `segments`.
struct SegmentsKind;

impl IntegratorKind for SegmentsKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "segments",
            summary: "equal pieces, linear in each, combined by the partial pre-integration table",
            parameters: &[PIECES_PARAMETER, PARTIAL_SIDE_PARAMETER],
        }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        check_pieces(integrator)?;
        check_count(integrator, SIDE, 2, MAX_PARTIAL_SIDE)
    }

    fn table(&self) -> TableDomain {
        TableDomain::Fixed
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Segments::new(transfer_function, count(integrator, PIECES), count(integrator, SIDE))?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&SegmentsLanes), &WgslExtension(&SegmentsText)]
    }
}

/// The kind `riemann`.
struct RiemannKind;

impl IntegratorKind for RiemannKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema { name: "riemann", summary: "point samples", parameters: &[PIECES_PARAMETER] }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        check_pieces(integrator)
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Riemann::new(transfer_function, count(integrator, PIECES))?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&RiemannLanes), &WgslExtension(&RiemannText)]
    }
}

/// The kind `pre-integrated`.
struct PreIntegratedKind;

impl IntegratorKind for PreIntegratedKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "pre-integrated",
            summary: "a three-dimensional table, for transfer functions of the scalar alone",
            parameters: &[SIDE_PARAMETER, OVERSAMPLING_PARAMETER],
        }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        check_count(integrator, SIDE, 2, MAX_TABLE_SIDE)?;
        check_count(integrator, OVERSAMPLING, 1, MAX_OVERSAMPLING)
    }

    fn obstacle(&self, transfer_function: &TransferFunction) -> Option<Obstacle> {
        of_scalar_alone(transfer_function)
    }

    fn table(&self) -> TableDomain {
        TableDomain::Data
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        extent: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(PreIntegrated::new(
            transfer_function,
            count(integrator, SIDE),
            count(integrator, OVERSAMPLING),
            extent,
        )?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[
            &LaneExtension(&PreIntegratedLanes),
            &WgslExtension(&PreIntegratedText),
            &WgslTableExtension(&PreIntegratedText),
        ]
    }
}

/// The kind `pre-integrated-cylindrical`.
struct PreIntegratedCylindricalKind;

impl IntegratorKind for PreIntegratedCylindricalKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "pre-integrated-cylindrical",
            summary: "the same table as tiles",
            parameters: &[SIDE_PARAMETER, OVERSAMPLING_PARAMETER, PLANES_PARAMETER],
        }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        check_count(integrator, SIDE, 2, MAX_TABLE_SIDE)?;
        check_count(integrator, OVERSAMPLING, 1, MAX_OVERSAMPLING)?;
        check_count(integrator, PLANES, 1, MAX_PLANES)?;
        let side = count(integrator, SIDE);
        let fit = |planes: &usize| side * side * (last_tile(side, *planes) + 1) <= MAX_TILE_ENTRIES;
        let max = (1..=MAX_PLANES).rev().find(fit).unwrap_or(1);
        match count(integrator, PLANES) {
            planes if planes <= max => Ok(()),
            planes => {
                let what = format!("{PLANES}, with table_size = {side},");
                Err(integrator.out_of_range(&what, planes, format!("1 to {max}")))
            }
        }
    }

    fn obstacle(&self, transfer_function: &TransferFunction) -> Option<Obstacle> {
        of_scalar_alone(transfer_function)
    }

    fn table(&self) -> TableDomain {
        TableDomain::Data
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        extent: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(PreIntegratedCylindrical::new(
            transfer_function,
            count(integrator, SIDE),
            count(integrator, OVERSAMPLING),
            count(integrator, PLANES),
            extent,
        )?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[
            &LaneExtension(&PreIntegratedLanes),
            &WgslExtension(&CylindricalText),
            &WgslTableExtension(&CylindricalText),
        ]
    }
}

/// The kind `vertex-sampled`.
struct VertexSampledKind;

impl IntegratorKind for VertexSampledKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "vertex-sampled",
            summary: "the transfer function applied at the grid's points only, linear between them",
            parameters: &[],
        }
    }

    fn scene_preparation(&self) -> Option<&dyn ScenePreparation> {
        Some(&Classification)
    }

    fn compile(
        &self,
        _: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(VertexSampled::new(transfer_function)?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&VertexSampledLanes)]
    }
}

/// The kind `tabulated`.
struct TabulatedKind;

impl IntegratorKind for TabulatedKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "tabulated",
            summary: "integrals of Gaussians from tables, widgets mixed without their order",
            parameters: &[PARTIAL_SIDE_PARAMETER],
        }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        check_count(integrator, SIDE, 2, MAX_PARTIAL_SIDE)
    }

    fn obstacle(&self, transfer_function: &TransferFunction) -> Option<Obstacle> {
        let has_table = |profile: &Profile| {
            matches!(
                profile,
                Profile::Uniform
                    | Profile::Gaussian { .. }
                    | Profile::GaussianNd { .. }
                    | Profile::TriangularGaussian { .. }
                    | Profile::TriangularGaussianNd { .. }
            )
        };
        let without = transfer_function.widgets.iter().position(|widget| !has_table(&widget.profile))?;
        let found = named(transfer_function, without, "whose integral it has no table of");
        Some(Obstacle { found, accepted: "uniform widgets and Gaussians" })
    }

    fn table(&self) -> TableDomain {
        TableDomain::Fixed
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Tabulated::new(transfer_function, count(integrator, SIDE))?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&TabulatedLanes)]
    }
}
