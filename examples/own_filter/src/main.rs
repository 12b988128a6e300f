//! The program voltet with a gradient filter, a grid filter, an image filter and a format of its own.

mod grey;
mod logarithm;
mod numbers;
mod weighted_fit;

use std::sync::Arc;
use voltet::core::Result;
use voltet::graph::Registry;

fn main() -> std::process::ExitCode {
    voltet::run(registry())
}

/// Registry of the shipped nodes and filters, and of those added here.
fn registry() -> Result<Registry> {
    let mut registry = voltet::registry()?;
    registry.add(&logarithm::NODE)?;
    registry.add(&grey::NODE)?;
    registry.add(voltet::nodes::external_formats::reader(&numbers::Numbers))?;
    registry.add_filter(Arc::new(weighted_fit::WeightedFit))?;
    Ok(registry)
}
