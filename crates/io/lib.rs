//! voltet-io: data files to grids, grids and pictures to files, and the provenance that pictures carry.
//!
//! | module | responsibility |
//! | --- | --- |
//! | [`colormaps`] | colour map files |
//! | [`encode`] | formats of pictures, and the pipelines that pictures carry |
//! | [`formats`] | data files to grids |
//! | [`memory`] | bytes that a grid takes, and bytes that are left |
//! | [`provenance`] | records of inputs, written into pictures and reports |
//! | [`vtu`] | grids to VTK files |

pub mod colormaps;
pub mod encode;
pub mod formats;
pub mod memory;
pub mod provenance;
pub mod vtu;
