//! Pictures of the native engine on procedural scenes, held against the 64-bit referee and against formulas.
//!
//! Bounds: 2e-4 in premultiplied linear RGBA on ordinary scenes (what 32-bit segments leave, with room for the
//! condition of a scene); on stiff ones, where a surface moves by a pixel for a rounding error, 99.9 % of the
//! pixels within 1/255. No pixel missing, none not finite.

mod drawing;
mod golden;
mod orders;
mod parts;
mod stiff;
mod surfaces;
mod vertex_sampled;
mod waves;

voltet_testing::picture_tests!(crate::drawing::Tested);

/// Tests with projected cells, in place of rays that go from cell to cell.
mod by_cells {
    voltet_testing::picture_tests!(crate::drawing::ByCells);
}
