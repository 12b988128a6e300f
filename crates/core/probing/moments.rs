//! Mean and covariance of several fields, weighted by volume.
//!
//! Over a tetrahedron with corner values v_i and mean m = Σ v_i / 4, the covariance of linear fields is
//! Σ (v_i − m)(v_i − m)ᵀ / 20 exactly (from ∫ λ_i λ_j = (1 + δ_ij) V / 20 of the barycentric coordinates λ). Parts are
//! merged as Chan, Golub and LeVeque (1979) do, about their own means, so that a small spread around a large value
//! keeps its digits.

/// Most fields that are looked at together: as many as a gaussian-nd widget has.
pub(super) const MAX_DIMENSIONS: usize = 8;

/// Weight, mean and weighted scatter about the mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments {
    pub weight: f64,
    pub mean: [f64; MAX_DIMENSIONS],
    /// Σ w (v − mean)(v − mean)ᵀ.
    pub scatter: [[f64; MAX_DIMENSIONS]; MAX_DIMENSIONS],
}

impl Moments {
    pub const NONE: Moments = Moments {
        weight: 0.0,
        mean: [0.0; MAX_DIMENSIONS],
        scatter: [[0.0; MAX_DIMENSIONS]; MAX_DIMENSIONS],
    };

    /// Moments of a tetrahedron of volume `weight`, `values[field][corner]`.
    pub fn of_tetrahedron(weight: f64, values: &[[f64; 4]]) -> Moments {
        let mut moments = Moments { weight, ..Moments::NONE };
        let mut centred = [[0.0; 4]; MAX_DIMENSIONS];
        for (k, v) in values.iter().enumerate() {
            let mean = 0.25 * ((v[0] + v[1]) + (v[2] + v[3]));
            moments.mean[k] = mean;
            centred[k] = v.map(|v| v - mean);
        }
        for (i, a) in centred.iter().enumerate().take(values.len()) {
            for (j, b) in centred.iter().enumerate().take(values.len()) {
                let sum = (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
                moments.scatter[i][j] = weight * sum / 20.0;
            }
        }
        moments
    }

    /// Moments of one point.
    pub fn of_point(values: &[f64]) -> Moments {
        let mut moments = Moments { weight: 1.0, ..Moments::NONE };
        moments.mean[..values.len()].copy_from_slice(values);
        moments
    }

    /// Adds other moments of `n` fields.
    pub fn merge(&mut self, other: &Moments, n: usize) {
        if other.weight <= 0.0 {
            return;
        }
        let weight = self.weight + other.weight;
        // The share of the newcomer; self.weight × share is the weight between the two means.
        let share = other.weight / weight;
        let mut apart = [0.0; MAX_DIMENSIONS];
        for (apart, (theirs, ours)) in apart[..n].iter_mut().zip(other.mean.iter().zip(&self.mean)) {
            *apart = theirs - ours;
        }
        for i in 0..n {
            for j in 0..n {
                self.scatter[i][j] += other.scatter[i][j] + self.weight * share * apart[i] * apart[j];
            }
        }
        self.mean.iter_mut().zip(apart).for_each(|(mean, apart)| *mean += share * apart);
        self.weight = weight;
    }
}
