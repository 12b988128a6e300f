//! Exact integrals over cells: moments within a region, the distribution over (s, g), and the count of
//! bands of a wave the cells cross.
//!
//! Inside a tetrahedron every field is linear (docs/src/explanation/optics.md, section 3), so all of these are integrals of
//! linear functions over convex pieces of tetrahedra, which have closed forms.

mod bands;
mod histogram;
mod percentile;
mod probe;
mod proposal;
mod sub_tetrahedron;
#[cfg(test)]
mod tests;

pub use bands::{BandCounts, bands, bands_of_cells};
pub use histogram::{Axis, Histogram, histogram};
pub use percentile::{Volumes, value_range};
pub use probe::{Mask, ProbeResult, kernel, probe};
pub use proposal::{ProposedWidget, proposal, quiet};
pub use sub_tetrahedron::ProbeRegion;

/// Cells between two looks at whether the user stopped: some milliseconds where each touches many bins.
const CELLS_PER_CHECK: usize = 1 << 10;
