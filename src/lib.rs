//! voltet: volume pictures of results on unstructured grids, straight from the cells, with transfer functions over
//! a scalar and its gradient magnitude.
//!
//! From arrays to a picture file:
//!
//! ```
//! use voltet::prelude::*;
//!
//! # fn arrays() -> (Vec<[f64; 3]>, Vec<u8>, Vec<u64>, Vec<u32>, Vec<f64>) {
//! #     let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! #     (points, vec![10], vec![0, 4], vec![0, 1, 2, 3], vec![60.2, 60.6, 61.0, 61.4])
//! # }
//! fn main() -> voltet::Result<()> {
//! #   let (points, types, offsets, connectivity, temperature) = arrays();
//! #   let folder = std::env::temp_dir().join(format!("voltet-doctest-{}", std::process::id()));
//! #   std::fs::create_dir_all(&folder).and_then(|()| std::env::set_current_dir(&folder)).unwrap();
//!     let grid = Grid::from_vtk_arrays(points, &types, &offsets, &connectivity)?.point_data("T", temperature)?;
//!     let volume = Volume::new(grid, "T")?; // the gradient is computed on demand, by least squares
//!     let transfer_function = TransferFunction::new()
//!         .with(Gaussian::at(60.8, 0.0).sigma(0.35, 0.025).color([1.0, 0.48, 0.06]).extinction(60.0));
//!     let camera = Camera::framing(volume.bounds()).from([-0.45, -0.85, 0.4]).size(80, 60);
//!     let image = Renderer::new()?.render(&Scene::new(volume, transfer_function, camera))?;
//!     image.save("heat_pipes.png")
//! }
//! ```
//!
//! From a data file, with a colour map over the range of a scalar:
//!
//! ```
//! use voltet::prelude::*;
//!
//! # fn main() -> voltet::Result<()> {
//! # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/lab/testing/files/every_type.vtu");
//! let volume = Volume::new(Grid::read(path)?, "s")?;
//! let transfer_function = TransferFunction::ramp(Colormap::Viridis, volume.range(), 0.5);
//! let camera = Camera::framing(volume.bounds()).size(80, 60);
//! let renderer = Renderer::on(Engine::Cpu)?;
//! let image = renderer.render(&Scene::new(volume, transfer_function, camera))?;
//! assert_eq!(image.pixels().len(), 80 * 60);
//! # Ok(())
//! # }
//! ```
//!
//! A pipeline file states a whole picture; [`Pipeline`] opens, changes and renders it, with grids of the program in place of files
//! where wanted: `Pipeline::open("scene.toml")?.with_grid("grid", grid)?.render("picture")?`.
//!
//! The crates beneath are public for code that extends the program: node types and gradient filters ([`graph`], [`core`]), formats
//! ([`io`]), engines ([`optics`], [`engine`]). With the feature `cli`, which is on by default, `voltet::run` is the program itself,
//! so that one with nodes and filters of its own is a `main` of a few lines. A program that uses the library alone depends on it with
//! `default-features = false`, and `features = ["gpu"]` for the graphics device.

#[cfg(feature = "cli")]
mod cli;
mod document;
mod facade;
#[cfg(all(feature = "cli", feature = "mpi"))]
mod launched_ranks;
pub mod launcher;
#[cfg(feature = "mpi")]
pub mod mpi_ranks;
pub mod series;

#[cfg(feature = "cli")]
pub use cli::{ExitOnOutOfMemory, registry, run, run_command_line};
pub use document::{Change, Document, Source};
pub use facade::*;
pub use voltet_core as core;
pub use voltet_core::clip::{Clip, ClipShape};
pub use voltet_core::grid::{Array, CellSet, Cells};
pub use voltet_core::progress::Progress;
pub use voltet_core::surface::{EyeLight, Paint, Surface};
pub use voltet_core::transfer::{ControlPoint, OpticalModel, Region, Widget};
pub use voltet_core::{Error, Result};
pub use voltet_cpu as engine;
#[cfg(feature = "gpu")]
pub use voltet_gpu as gpu;
pub use voltet_graph as graph;
pub use voltet_io as io;
pub use voltet_io::formats::TimeStep;
pub use voltet_nodes as nodes;
pub use voltet_optics as optics;
pub use voltet_optics::WidgetBlend;
pub use voltet_optics::engine::Compositor;
pub use voltet_optics::shading::VisibilityOrder;
pub use voltet_simd as lanes;

/// Types that a program needs for a picture.
pub mod prelude {
    pub use crate::{
        Band, Camera, Colormap, Engine, Gaussian, Grid, Image, Light, Piecewise, Pipeline, RenderOptions,
        Renderer, Result, Scene, Shading, TableImage, TransferFunction, Uniform, Volume,
    };
    pub use voltet_core::transfer::Region;
}
