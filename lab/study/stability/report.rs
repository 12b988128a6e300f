//! Results, and the verdict on every bound.

use super::integrators::IntegratorReport;
use super::pictures::HardPicture;
use super::printed::PrintedFormula;
use voltet_judge::Report;

/// Results.
#[derive(Debug, Clone)]
pub struct StabilityReport {
    /// One report a set of forms: 64-bit, 32-bit by lane set, further ones.
    pub forms: Vec<Report>,
    /// Every integrator in 64 bits.
    pub integrators: Vec<IntegratorReport>,
    /// Pictures of hard scenes, one after the other.
    pub pictures: Vec<HardPicture>,
    /// The formulas as printed.
    pub printed: Vec<PrintedFormula>,
    /// Engines that were not judged, with the reason and the remedy.
    pub left_out: Vec<String>,
}

impl StabilityReport {
    /// True if every bound was kept.
    pub fn passed(&self) -> bool {
        self.forms.iter().all(Report::passed)
            && self.integrators.iter().all(IntegratorReport::passed)
            && self.pictures.iter().all(HardPicture::passed)
    }

    /// Engines of the pictures, in their order.
    pub(super) fn engines(&self) -> Vec<&str> {
        let mut engines: Vec<&str> = Vec::new();
        for drawn in &self.pictures {
            if !engines.contains(&drawn.engine.as_str()) {
                engines.push(&drawn.engine);
            }
        }
        engines
    }
}

/// A category as people call it.
pub fn category(name: &str) -> &str {
    match name {
        "bands" => "many bands",
        "scale" => "tiny and huge lengths",
        "edges" => "region edges",
        "overlap" => "widgets that overlap",
        "chain" => "long compositing chains",
        "ray" => "cells along a ray",
        "table" => "partial pre-integration",
        "wild" => "anything goes",
        other => other,
    }
}
