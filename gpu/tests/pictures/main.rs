//! Pictures of the device on procedural scenes, held against the 64-bit referee. The scenes are those of the native
//! engine's own tests.
//!
//! Bounds: 2e-4 in premultiplied linear RGBA on ordinary scenes; on stiff ones 99.9 % of the pixels within 1/255.

#[path = "../../../tests/validation/compare.rs"]
mod compare;
#[path = "../../../tests/validation/coverage.rs"]
mod coverage;
#[path = "../../../tests/validation/difficult.rs"]
mod difficult;
mod drawing;
#[path = "../../../tests/validation/grids.rs"]
mod grids;
mod hard;
#[path = "../../../tests/validation/integrators.rs"]
mod integrators;
mod limits;
#[path = "../../../tests/validation/lit.rs"]
mod lit;
#[path = "../../../tests/validation/looks.rs"]
mod looks;
#[path = "../../../tests/validation/ordinary.rs"]
mod ordinary;
mod parts;
mod raster;
#[path = "../../../tests/validation/widgets.rs"]
mod widgets;
#[path = "../../../tests/validation/worked_example.rs"]
mod worked_example;
