//! The pre-integrated table resampled to two-dimensional tiles about its diagonal s_f = s_b, D = 0.
//!
//! Roettger & Ertl 2002, section 4: the pixels of one cell lie on a plane through that diagonal, so two tiles,
//! the nearest in the angle α, hold a whole cell. Symbols: s_f, s_b, l the ends and the length, each over [0, 1];
//! α ∈ [0, 1] the plane, s and t the place on its tile, t = s_b. f of Eq. 9 fills the tiles, f⁻¹ of Eq. 10 reads
//! them; at s_f = s_b, l = 0 every α serves. A place of a tile whose s_f is outside [0, 1] takes the nearest inside,
//! so that the linear filter does not read nothing. In perspective α varies over a cell; it is taken anew for each
//! segment.

use super::pre_integrated::{Bilinear, PreIntegrated, blend, contribution};
use super::pre_integrated_cylindrical;
use super::slice::Ramp;
use rayon::prelude::*;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::integrators::{Extent, SegmentIntegrator, can_serve};
use voltet_optics::{Contribution, Segment};

/// The tiles.
#[derive(Debug, Clone)]
pub struct PreIntegratedCylindrical {
    ramp: Ramp,
    longest: f64,
    /// ρ̄ by (s_f, s_b).
    extinction: Vec<f32>,
    /// Number of tiles less 1, a multiple of 4, so that the mapping's creases lie on tiles.
    last: usize,
    /// C/(D E₁) by (α, s, t).
    tiles: Vec<[f32; 3]>,
}

/// Number of tiles less 1: `planes` times as many as the table has entries a side, rounded up so that the creases of f
/// lie on tiles.
pub const fn last_tile(table_size: usize, planes: usize) -> usize {
    4 * table_size.saturating_mul(planes).div_ceil(4)
}

/// f: (s_f, s_b, l) of (α, s, t); s_f may lie outside [0, 1].
pub fn from_cylinder(angle: f64, s: f64, t: f64) -> [f64; 3] {
    let [front, length] = if angle <= 0.25 {
        [t + s, 4.0 * angle * s]
    } else if angle <= 0.5 {
        [t + 4.0 * (0.5 - angle) * s, s]
    } else if angle <= 0.75 {
        [t - 4.0 * (angle - 0.5) * s, s]
    } else {
        [t - s, 4.0 * (1.0 - angle) * s]
    };
    [front, t, length]
}

/// f⁻¹: (α, s, t).
fn to_cylinder(front: f64, back: f64, length: f64) -> [f64; 3] {
    let fall = front - back;
    let (angle, s) = if length <= 0.0 && fall == 0.0 {
        (0.5, 0.0)
    } else if fall >= 0.0 {
        if length <= fall { (0.25 * length / fall, fall) } else { (0.5 - 0.25 * fall / length, length) }
    } else if length >= -fall {
        (0.5 - 0.25 * fall / length, length)
    } else {
        (1.0 + 0.25 * length / fall, -fall)
    };
    [angle, s, back]
}

impl PreIntegratedCylindrical {
    /// Fills the tiles on all cores: `planes` × `table_size` (rounded up to a multiple of 4) and one more of them; with
    /// `planes` = 1 they take as much memory as the table. The paper holds four times its side for enough to lose nothing.
    /// Serves what [`PreIntegrated`] serves.
    pub fn new(
        transfer_function: &TransferFunction,
        table_size: usize,
        oversampling: usize,
        planes: usize,
        extent: &Extent,
    ) -> Result<Self> {
        let settings = pre_integrated_cylindrical(table_size, oversampling, planes);
        can_serve(&settings, transfer_function)?;
        let table = PreIntegrated::new(transfer_function, table_size, oversampling, extent)?;
        let last = last_tile(table_size, planes);
        let mut tiles = vec![[0.0; 3]; table_size * table_size * (last + 1)];
        let step = (table_size - 1) as f64;
        tiles.par_chunks_mut(table_size * table_size).enumerate().for_each(|(plane, tile)| {
            for (k, texel) in tile.iter_mut().enumerate() {
                let (s, t) = ((k / table_size) as f64 / step, (k % table_size) as f64 / step);
                let [front, back, length] = from_cylinder(plane as f64 / last as f64, s, t);
                let glow = table.glow_at(front.clamp(0.0, 1.0) * step, back * step, length);
                *texel = glow.map(|x| x as f32);
            }
        });
        let (ramp, extinction) = table.into_parts();
        Ok(PreIntegratedCylindrical { ramp, longest: extent.longest, extinction, last, tiles })
    }

    /// C/(D E₁) by (α, s, t).
    pub fn tiles(&self) -> &[[f32; 3]] {
        &self.tiles
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.extinction.len() * size_of::<f32>() + self.tiles.len() * size_of::<[f32; 3]>()
    }
}

impl SegmentIntegrator for PreIntegratedCylindrical {
    fn table_bytes(&self) -> usize {
        self.bytes()
    }

    fn integrate(&self, segment: &Segment) -> Contribution {
        let n = self.ramp.size();
        let step = (n - 1) as f64;
        let (front, back) = (self.ramp.place(segment.front[0]), self.ramp.place(segment.back[0]));
        let extinction = Bilinear::new(front, back, n).number(&self.extinction);
        let length = segment.length / self.longest;
        contribution(length, extinction, || {
            let [angle, s, t] = to_cylinder(front / step, back / step, length.min(1.0));
            let place = angle * self.last as f64;
            let low = (place as usize).min(self.last - 1);
            let at = Bilinear::new(s * step, t * step, n);
            let tile = |k: usize| at.color(&self.tiles[k * n * n..(k + 1) * n * n]);
            blend(tile(low), tile(low + 1), place - low as f64)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_mapping_is_its_inverse(front in 0.0..1.0_f64, back in 0.0..1.0_f64, length in 1e-6..1.0_f64) {
            let [angle, s, t] = to_cylinder(front, back, length);
            prop_assert!((0.0..=1.0).contains(&angle) && (0.0..=1.0).contains(&s));
            let [f, b, l] = from_cylinder(angle, s, t);
            // A few roundings of numbers up to 1.
            prop_assert!((f - front).abs() < 1e-15 && b == back && (l - length).abs() < 1e-15);
        }
    }

    #[test]
    fn at_the_axis_every_plane_serves() {
        let [angle, s, t] = to_cylinder(0.3, 0.3, 0.0);
        assert_eq!((angle, s, t), (0.5, 0.0, 0.3));
    }
}
