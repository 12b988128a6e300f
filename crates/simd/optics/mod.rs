//! 32-bit twins of the segment integrals, over vector lanes.
//!
//! Each bears the name and argument order of the 64-bit truth in [`voltet_optics`]; `docs` of each state the
//! range and the error measured. They take differences from a widget's centre, formed in 64 bits before rounding.
//!
//! | what | twin | takes |
//! | --- | --- | --- |
//! | region | [`clip::LaneStretch::whole`]`().cut(front, back)` per edge, then `.at_start`, `.at_end` | distances of both ends from the edge |
//! | opacity 1 − e^(−T) | [`elementary::one_minus_exp`]`(T)` | |
//! | gaussian, gaussian-nd: T/(ρ₀ D) | [`gaussian::mean_profile`]`::<L, N>(q_f, q_b)` | q = K (v − v₀) at the ends of the clipped stretch |
//! | triangular-gaussian: T/(ρ₀ D) | [`triangular_gaussian::mean_profile`]`([δ_f, δ_b], [γ_f, γ_b])` | δ = s − s₀, γ = σ g |
//! | waves: T/(ρ₀ D) | [`wave::LaneBell::mean`]`(φ_f, φ_b)` | [`wave::LanePhase`]: nearest foot and offset |
//! | the same within one band, with its shape | [`wave::LaneBell::shape`]`(φ_f, φ_b, ρ₀ D)` | the same |
//! | linear piece | [`linear::piece_weights`] | (ρ_f D, ρ_b D), at most 1 |
//! | the same, deeper | [`linear::middling_piece_weights`] | (ρ_f D, ρ_b D), one of them at least 1, at most 4 |
//! | the same, deep | [`linear::deep_piece_weights`] | (ρ_f D, ρ_b D), one of them at least 1 |
//! | linear extinction and linear emission: (F, B) | [`linear::front_back`] | (ρ_f D, ρ_b D) |
//! | widgets that hardly bend, in order | [`smooth::Sums::ordered`] | a [`smooth::DensityShape`] each |
//! | any widgets in order, either model: C | [`overlap::ordered`]`(&members, None or D/U)` | [`overlap::LaneMember`] each, over the whole segment |
//! | uniform widgets and Gaussians in order, where they are dense: C | [`dense::dense`]`(&members)` | the same |
//!
//! D and ρ₀ D are those of the clipped stretch for all but the last three, which take the whole segment and the ranges of t.

pub mod clip;
pub mod dense;
pub mod elementary;
pub mod gaussian;
pub mod linear;
pub mod overlap;
pub mod piecewise_linear;
pub mod quadrature;
pub mod smooth;
pub mod table;
mod track;
pub mod triangular_gaussian;
pub mod wave;

#[cfg(test)]
mod tests;
