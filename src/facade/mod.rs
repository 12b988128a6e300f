//! The library's front: types that validate, and functions that need no knowledge of the crates beneath.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `grid`, `grid_arrays` | grids from arrays or files |
//! | `volume` | a grid's scalar and gradient |
//! | `transfer` | transfer functions and their widgets |
//! | `camera` | cameras |
//! | `scene` | volume, transfer function, camera, shading |
//! | `renderer` | scenes to pictures |
//! | `image` | pictures and their files |
//! | `pipeline` | pipeline files |
//! | `session`, `background` | runs of a host program |

mod background;
mod camera;
mod grid;
mod image;
mod pipeline;
mod renderer;
mod scene;
mod session;
mod transfer;

pub use background::{RunStatus, panic_message, run_in_background};
pub use camera::Camera;
pub use grid::{
    BorrowedGrid, CellArrays, Grid, GridIndex, NamedArray, PointNumbers, build_grid, unnamed_scalar,
};
pub use image::Image;
pub use pipeline::Pipeline;
pub use renderer::{Engine, RenderOptions, RenderOutput, Renderer, RendererOptions, render_to_depth};
pub use scene::{Integrator, Light, Scene, Shading, Volume};
pub use session::{PipelineSource, RenderPlan, RunRecord, Session};
pub use transfer::{Band, Colormap, Gaussian, Piecewise, TransferFunction, Uniform, UnitDistance};
