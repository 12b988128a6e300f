//! Exact integrals over cells: moments within a region, the distribution over (s, g), and the count of
//! bands of a wave the cells cross.
//!
//! Inside a tetrahedron every field is linear (docs/src/explanation/optics.md, section 3), so all of these are integrals of
//! linear functions over convex pieces of tetrahedra, which have closed forms.
//!
//! | file | what |
//! | --- | --- |
//! | `sub_tetrahedron` | a part of a tetrahedron, cut by half-spaces |
//! | `moments` | mean and covariance, merged without loss of digits |
//! | `region` | the part of a tetrahedron in a box or a ball |
//! | `probe` | the moments of fields in a region (Kniss et al. 2003, section 6) |
//! | `kernel` | from moments to the matrix K of a Gaussian widget |
//! | `histogram` | the distribution over (s, g), weighted by volume |
//! | `percentile` | percentiles of a field by volume |
//! | `proposal` | a first transfer function, from the histogram |
//! | `bands` | how many bands of a wave widget the cells cross (Song et al. 2009, section 6.3) |

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
