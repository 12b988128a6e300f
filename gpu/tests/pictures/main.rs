//! Pictures of the device on procedural scenes, held against the 64-bit referee. The scenes are those of the native
//! engine's own tests.
//!
//! Bounds: 2e-4 in premultiplied linear RGBA on ordinary scenes; on stiff ones 99.9 % of the pixels within 1/255.

mod compare;
#[path = "../../../tests/validation/grids.rs"]
#[allow(dead_code)]
mod grids;
mod hard;
mod integrators;
mod kinds;
mod limits;
#[path = "../../../tests/validation/looks.rs"]
#[allow(dead_code)]
mod looks;
mod views;
#[path = "../../../tests/validation/widgets.rs"]
mod widgets;
