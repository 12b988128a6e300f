//! Manufactured fields: formulas whose gradient is known, the only truth that filters are held against.

use glam::DVec3;

/// A field over the unit cube and its gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field {
    /// Its name in tables.
    pub name: &'static str,
    /// s at a place.
    pub value: fn(DVec3) -> f64,
    /// ∇s there.
    pub gradient: fn(DVec3) -> DVec3,
}

/// Smooth fields, by which the order of convergence is found.
pub(super) const SMOOTH: [Field; 2] = [
    Field { name: "waves", value: waves, gradient: waves_gradient },
    Field { name: "peak", value: peak, gradient: peak_gradient },
];

/// A linear function: nearly every reconstruction claims to be exact here.
pub(super) const LINEAR: Field = Field { name: "linear", value: |p| 0.3 + SLOPE.dot(p), gradient: |_| SLOPE };

/// A quadratic function with all six products.
pub(super) const QUADRATIC: Field = Field {
    name: "quadratic",
    value: |p| {
        0.7 * p.x * p.x - 0.4 * p.y * p.y + 0.9 * p.z * p.z + p.x * p.y - 0.6 * p.y * p.z + 0.5 * p.x * p.z
    },
    gradient: |p| {
        DVec3::new(
            1.4 * p.x + p.y + 0.5 * p.z,
            -0.8 * p.y + p.x - 0.6 * p.z,
            1.8 * p.z - 0.6 * p.y + 0.5 * p.x,
        )
    },
};

/// Two materials that meet at x = ½: the scalar is continuous, its slope across is ten times as large beyond.
pub(super) const MATERIALS: Field = Field {
    name: "materials",
    value: |p| along(p) + if p.x <= MEETING { p.x - MEETING } else { STEEP * (p.x - MEETING) },
    gradient: |p| DVec3::new(if p.x <= MEETING { 1.0 } else { STEEP }, 2.0 * (2.0 * p.y).cos(), -(p.z).sin()),
};

/// Plane in which the two materials meet.
pub(super) const MEETING: f64 = 0.5;

/// By how much ∂s/∂x jumps there.
pub(super) const JUMP: f64 = STEEP - 1.0;

const STEEP: f64 = 10.0;

const SLOPE: DVec3 = DVec3::new(1.7, -0.9, 0.6);

fn along(p: DVec3) -> f64 {
    (2.0 * p.y).sin() + p.z.cos()
}

/// Waves of different lengths along each axis; no wave ends at the boundary.
fn waves(p: DVec3) -> f64 {
    (4.1 * p.x + 0.3).sin() * (3.3 * p.y - 0.2).cos() * (0.7 * p.z).exp()
}

fn waves_gradient(p: DVec3) -> DVec3 {
    let ((sine, cosine), growth) = ((4.1 * p.x + 0.3).sin_cos(), (0.7 * p.z).exp());
    let (up, across) = (3.3 * p.y - 0.2).sin_cos();
    DVec3::new(4.1 * cosine * across, -3.3 * sine * up, 0.7 * sine * across) * growth
}

const SUMMIT: DVec3 = DVec3::new(0.45, 0.55, 0.6);
const WIDTH: f64 = 0.28;

/// A Gaussian peak within the cube.
fn peak(p: DVec3) -> f64 {
    (-(p - SUMMIT).length_squared() / (2.0 * WIDTH * WIDTH)).exp()
}

fn peak_gradient(p: DVec3) -> DVec3 {
    (SUMMIT - p) * (peak(p) / (WIDTH * WIDTH))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By central differences at places away from the meeting of materials.
    #[test]
    fn gradients_are_those_of_the_values() {
        let step = 1e-5;
        for field in SMOOTH.into_iter().chain([LINEAR, QUADRATIC, MATERIALS]) {
            for p in [DVec3::new(0.1, 0.7, 0.4), DVec3::new(0.9, 0.2, 0.8)] {
                let slope = |axis: DVec3| {
                    ((field.value)(p + axis * step) - (field.value)(p - axis * step)) / (2.0 * step)
                };
                let found = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
                let off = (found - (field.gradient)(p)).length();
                assert!(off < 1e-8 * (1.0 + found.length()), "{}: off by {off:e} at {p}", field.name);
            }
        }
    }
}
