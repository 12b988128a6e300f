//! Silhouettes and light: factors on a segment's colour and opacity from the gradient at its midpoint.
//!
//! Opacity and colour × (1 − |ĝ·view|)^p (Song et al. 2009, section 6.2), colour × (k_a + k_d |ĝ·light|). The
//! gradient's three components are attributes of their own, the last ones; the interpolant is linear, so the middle
//! has the mean of both ends. Only directions matter: the components share one scale.

use crate::fragments::batch::Batch;
use crate::tile::TILE;
use crate::view::View;
use voltet_core::arithmetic::unit_vector;
use voltet_optics::shading::{Light, Shading};
use voltet_simd::optics::elementary::power;
use voltet_simd::{Float, Lanes, Mask, Unsigned, array};

/// Directions of a tile's rays, component by component, unit length, world axes.
pub(crate) type Rays = [[f32; TILE * TILE]; 3];

/// Silhouette and diffuse factors of a scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    /// p.
    pub silhouette: Option<f64>,
    /// Light, its direction of unit length.
    light: Option<Light>,
    /// Attributes before the gradient.
    first: usize,
}

impl Surface {
    /// `None` where the shading has neither, or a silhouette that changes nothing. `first`: attributes before the
    /// gradient.
    pub fn new(shading: &Shading, first: usize) -> Option<Surface> {
        let silhouette = shading.silhouette.filter(|&p| p != 0.0);
        let light = shading.light.map(|light| Light { direction: unit_vector(light.direction), ..light });
        (silhouette.is_some() || light.is_some()).then_some(Surface { silhouette, light, first })
    }

    /// Factors of opacity and of colour for the segments at `at`.
    #[inline(always)]
    pub fn factors<L: Lanes>(&self, batch: &Batch, at: usize, rays: &Rays) -> (L::F, L::F) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        // Twice the gradient at the middle.
        let g: [L::F; 3] = array!(|i| {
            let k = self.first + i;
            L::F::load(&batch.front[k][at..]) + L::F::load(&batch.back[k][at..])
        });
        // Scaled by its largest component, so that no square leaves 32 bits.
        let largest = g[0].abs().max(g[1].abs()).max(g[2].abs());
        let is_flat = zero.lt(largest).not();
        let inverse = one / L::F::select(is_flat, one, largest);
        let g: [L::F; 3] = array!(|i| g[i] * inverse);
        let square = g[0].mul_add(g[0], g[1].mul_add(g[1], g[2] * g[2]));
        let mut opacity = one;
        if let Some(p) = self.silhouette {
            let pixel = L::U::load(&batch.pixel[at..]);
            let view: [L::F; 3] = array!(|i| L::F::gather(&rays[i], pixel));
            let segments = g[0].mul_add(view[0], g[1].mul_add(view[1], g[2] * view[2])).abs();
            let across: [L::F; 3] = array!(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                g[j] * view[k] - g[k] * view[j]
            });
            let across = across[0].mul_add(across[0], across[1].mul_add(across[1], across[2] * across[2]));
            // 1 − cos = sin² / (1 + cos): the difference would lose the digits of a gradient along the ray.
            let size = square.sqrt();
            let value = across / (size * (size + segments)).max(splat(f32::MIN_POSITIVE));
            let value = value.min(one);
            let value = if p == 1.0 { value } else { power::<L>(value, splat(p as f32)) };
            opacity = L::F::select(is_flat, one, value);
        }
        let color = match self.light {
            None => opacity,
            Some(light) => {
                let [x, y, z] = light.direction.to_array().map(|c| splat(c as f32));
                let facing = g[0].mul_add(x, g[1].mul_add(y, g[2] * z)).abs();
                let facing = facing / square.max(splat(f32::MIN_POSITIVE)).sqrt();
                opacity * facing.min(one).mul_add(splat(light.diffuse as f32), splat(light.ambient as f32))
            }
        };
        (opacity, color)
    }
}

/// Directions of the rays of the tile at (`left`, `top`).
pub(crate) fn rays(view: &View, left: usize, top: usize, out: &mut Rays) {
    for pixel in 0..TILE * TILE {
        let direction = view.direction((left + pixel % TILE) as f64, (top + pixel / TILE) as f64);
        for (row, c) in out.iter_mut().zip(direction.to_array()) {
            row[pixel] = c as f32;
        }
    }
}
