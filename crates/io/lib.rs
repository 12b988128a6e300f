//! voltet-io: data files to grids, grids and pictures to files, and the provenance that pictures carry.
//!
//! | module | responsibility |
//! | --- | --- |
//! | [`colormaps`] | colour map files |
//! | [`encode`] | formats of pictures, and the pipelines that pictures carry |
//! | [`formats`] | data files to grids |
//! | [`grids`] | grids to files |
//! | [`memory`] | bytes that a grid takes, and bytes that are left |
//! | [`provenance`] | records of inputs, written into pictures and reports |

pub mod colormaps;
pub mod encode;
pub mod formats;
pub mod grids;
pub mod memory;
pub mod provenance;
