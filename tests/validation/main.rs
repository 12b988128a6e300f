//! Pictures of the native engine on procedural scenes, held against the 64-bit referee and against formulas.
//!
//! Bounds: 2e-4 in premultiplied linear RGBA on ordinary scenes (what 32-bit segments leave, with room for the
//! condition of a scene); on stiff ones, where a surface moves by a pixel for a rounding error, 99.9 % of the
//! pixels within 1/255. No pixel missing, none not finite.

mod compare;
mod coverage;
mod difficult;
mod drawing;
mod golden;
mod grids;
mod integrators;
mod lit;
mod looks;
mod orders;
mod ordinary;
mod stiff;
mod waves;
mod widgets;
mod worked_example;
