//! The raster compositor: cells sorted by distance, drawn as silhouettes and blended by the hardware.

pub(crate) mod blending;
pub(crate) mod drawing;
pub(crate) mod sort;
