//! Quantities that are made of the gradients of an array at a point.
//!
//! Symbols: J the matrix whose rows are the gradients of the components of a vector **v**, J_ij = ∂v_i/∂x_j.

use super::length;
use glam::DVec3;

/// A quantity made of gradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivative {
    /// |∇s|.
    GradientMagnitude,
    /// |∇ × **v**|.
    Vorticity,
    /// ∇ · **v** = tr J.
    Divergence,
    /// Q = ½ (‖Ω‖² − ‖S‖²) = −½ tr J², Ω and S the antisymmetric and the symmetric part of J: above 0 where rotation prevails over strain
    /// (J. C. R. Hunt, A. A. Wray, P. Moin, "Eddies, streams, and convergence zones in turbulent flows", CTR-S88, 1988).
    QCriterion,
}

impl Derivative {
    /// All, by name.
    pub const ALL: [(&str, Derivative); 4] = [
        ("gradient_magnitude", Derivative::GradientMagnitude),
        ("vorticity", Derivative::Vorticity),
        ("divergence", Derivative::Divergence),
        ("q_criterion", Derivative::QCriterion),
    ];

    /// Components of the array that it is made of.
    pub fn component_count(self) -> usize {
        if self == Derivative::GradientMagnitude { 1 } else { 3 }
    }

    /// Its value; the gradient of each component of the array.
    pub fn value(self, gradients: [DVec3; 3]) -> f64 {
        let [u, v, w] = gradients;
        match self {
            Derivative::GradientMagnitude => length(u),
            Derivative::Vorticity => length(DVec3::new(w.y - v.z, u.z - w.x, v.x - u.y)),
            Derivative::Divergence => u.x + v.y + w.z,
            Derivative::QCriterion => {
                -0.5 * (u.x * u.x + v.y * v.y + w.z * w.z) - (u.y * v.x + u.z * w.x + v.z * w.y)
            }
        }
    }
}
