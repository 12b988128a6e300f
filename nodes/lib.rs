//! voltet-nodes: one file a node, at the top of this folder; each a declaration and a function.
//!
//! | folder | what |
//! | --- | --- |
//! | [`between_steps`] | values between two steps of a series |
//! | [`color_scale`] | the scale of a transfer function's colours, for pictures |
//! | [`external_formats`] | nodes of formats that come from outside |
//! | [`drawing`] | what the nodes that draw share |
//! | [`files`] | writing whole files |
//! | [`in_memory_grid`] | grids that a program holds in memory |
//! | [`surfacing`] | what the nodes that make surfaces share |
//! | [`relative`] | numbers relative to data: ranges and percentiles |

mod annotation;
mod bands;
mod between_steps;
mod boundary;
mod calculator;
mod camera;
mod color_scale;
mod composite;
mod contour;
mod cull;
pub mod drawing;
mod edges;
pub mod external_formats;
pub mod files;
mod gpu_renderer;
mod gradient_magnitude;
mod grid_writer;
mod histogram;
mod image_writer;
pub mod in_memory_grid;
mod multi_gradient;
mod probe;
mod project;
mod reader;
pub mod relative;
mod renderer;
mod report_writer;
mod slice;
mod slice_image;
mod sort;
mod surface_reader;
pub mod surfacing;
mod threshold;
mod transfer_function;
mod wavelet;

pub use camera::VIEW_PARAMETERS;
pub use color_scale::{ScalarColors, scalar_colors};
pub use transfer_function::load_image as table_image;

use std::path::Path;
use voltet_core::Result;
use voltet_core::field::filters;
use voltet_graph::{Node, Registry, Session, Stamp, VariantAlias};
use voltet_optics::integrators::{self, Integrator};

/// The nodes that ship, in the order in which data runs through them.
pub static NODES: &[&Node] = &[
    &reader::NODE,
    &wavelet::NODE,
    &calculator::NODE,
    &gradient_magnitude::NODE,
    &multi_gradient::NODE,
    &threshold::NODE,
    &probe::NODE,
    &histogram::NODE,
    &transfer_function::NODE,
    &bands::NODE,
    &contour::NODE,
    &slice::NODE,
    &boundary::NODE,
    &edges::NODE,
    &surface_reader::NODE,
    &camera::NODE,
    &cull::NODE,
    &sort::NODE,
    &project::NODE,
    &composite::NODE,
    &renderer::NODE,
    &gpu_renderer::NODE,
    &slice_image::NODE,
    &annotation::NODE,
    &grid_writer::NODE,
    &image_writer::NODE,
    &report_writer::NODE,
];

/// A registry with the nodes, gradient filters and integrators that ship; others are added by the same [`Registry::add`],
/// [`Registry::add_filter`] and [`Registry::add_variant`].
pub fn registry() -> Result<Registry> {
    let mut registry = Registry::new();
    NODES.iter().try_for_each(|node| registry.add(node))?;
    filters().into_iter().try_for_each(|filter| registry.add_filter(filter))?;
    for kind in integrators::KINDS {
        registry.add_variant(integrators::INTEGRATOR, integrators::variant(kind)?)?;
    }
    // A piecewise-linear function is cut at its control points by the closed forms.
    registry.add_alias(VariantAlias {
        parameter: integrators::INTEGRATOR,
        alias: "clipped",
        name: Integrator::ANALYTIC.name(),
    });
    Ok(registry)
}

/// A session that knows when files change.
pub fn session() -> Session {
    Session::new(stamp)
}

fn stamp(path: &Path) -> Stamp {
    let metadata = std::fs::metadata(path).ok()?;
    // A pipe changes as it is read, and can be read once.
    if !(metadata.is_file() || metadata.is_dir()) {
        return None;
    }
    Some((metadata.len(), metadata.modified().ok()?))
}
