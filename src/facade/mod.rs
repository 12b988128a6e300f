//! The library's front: types that validate, and functions that need no knowledge of the crates beneath.

mod background;
mod camera;
mod grid;
mod pipeline;
mod pipeline_text;
mod renderer;
mod scene;
mod transfer;

pub use background::{RunStatus, panic_message, run_in_background};
pub use camera::Camera;
pub use grid::{CellArrays, Grid, PointNumbers, add_array, borrowed_piece, build_grid, unnamed_scalar};
pub use pipeline::{Pipeline, RenderPlan, RunRecord};
pub use pipeline_text::PipelineText;
pub use renderer::{Engine, Image, RenderOptions, RenderOutput, Renderer, RendererOptions, render_to_depth};
pub use scene::{Integrator, Light, Scene, Shading, Volume};
pub use transfer::{
    Band, Colormap, Gaussian, Piecewise, TableImage, TransferFunction, Uniform, UnitDistance,
};
