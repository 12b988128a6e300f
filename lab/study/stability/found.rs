//! What was found, and whether every bound was kept.

use super::integrators::Integrated;
use super::pictures::Drawn;
use super::printed::Printed;
use voltet_judge::Report;

/// What was found.
#[derive(Debug, Clone)]
pub struct Stability {
    /// One report a set of forms: 64-bit, 32-bit by lane set, further ones.
    pub forms: Vec<Report>,
    /// Every integrator in 64 bits.
    pub integrators: Vec<Integrated>,
    /// Pictures of hard scenes, one after the other.
    pub pictures: Vec<Drawn>,
    /// The formulas as printed.
    pub printed: Vec<Printed>,
    /// What was not judged, why, and how to have it.
    pub left_out: Vec<String>,
}

impl Stability {
    /// Whether every bound was kept.
    pub fn passed(&self) -> bool {
        self.forms.iter().all(Report::passed)
            && self.integrators.iter().all(Integrated::passed)
            && self.pictures.iter().all(Drawn::passed)
    }

    /// What drew the pictures, in their order.
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
