//! Pictures of the device on procedural scenes, held against the 64-bit referee. The scenes are those of all engines, and some
//! of its own.
//!
//! Bounds: 2e-4 in premultiplied linear RGBA on ordinary scenes; on stiff ones 99.9 % of the pixels within 1/255.

mod drawing;
mod flight;
mod hard;
mod limits;
mod moved;
mod parts;
mod raster;
mod surfaces;
mod triangles;
mod webgpu;

voltet_testing::picture_tests!(crate::drawing::Tested);
