//! Where the rays of a bundle are: in memory, and in registers.

use super::CARRIED_MOST;
use super::sides::At;
use crate::fragments::batch::LANES_MOST;
use voltet_simd::{Float, Lanes, Unsigned, array, inlined};

/// Where rays are: ray by ray. Of three corners of a face the places relative to the ray, depths and attributes.
pub(super) struct Rays {
    x: [[f32; LANES_MOST]; 3],
    y: [[f32; LANES_MOST]; 3],
    depth: [[u32; LANES_MOST]; 3],
    values: [[[f32; LANES_MOST]; 3]; CARRIED_MOST],
    /// Of corners 0 and 1, 1 and 2, 2 and 0.
    turns: [[f32; LANES_MOST]; 3],
    pub half_face: [u32; LANES_MOST],
    /// How the corners are turned against those of the half-face.
    turned: [u32; LANES_MOST],
    /// Where the ray is: depth in steps, depth in scene lengths (perspective), attributes.
    at: [u32; LANES_MOST],
    distance: [f32; LANES_MOST],
    value: [[f32; LANES_MOST]; CARRIED_MOST],
}

impl Rays {
    /// Nowhere.
    pub fn none(half_face: u32) -> Rays {
        let zero = [0.0; LANES_MOST];
        Rays {
            x: [zero; 3],
            y: [zero; 3],
            depth: [[0; LANES_MOST]; 3],
            values: [[zero; 3]; CARRIED_MOST],
            turns: [zero; 3],
            half_face: [half_face; LANES_MOST],
            turned: [0; LANES_MOST],
            at: [0; LANES_MOST],
            distance: [1.0; LANES_MOST],
            value: [zero; CARRIED_MOST],
        }
    }
}

/// [`Rays`] in registers.
pub(super) struct Here<L: Lanes, const N: usize> {
    pub(super) corners: [At<L>; 3],
    pub(super) depth: [L::U; 3],
    pub(super) values: [[L::F; 3]; N],
    pub(super) turns: [L::F; 3],
    pub(super) turned: L::U,
    pub(super) at: L::U,
    pub(super) distance: L::F,
    pub(super) value: [L::F; N],
}

impl<L: Lanes, const N: usize> Here<L, N> {
    #[inline(always)]
    pub(super) fn load(rays: &Rays, half: usize) -> Self {
        let float = inlined(
            #[inline(always)]
            |of: &[f32; LANES_MOST]| L::F::load(&of[half..]),
        );
        let unsigned = inlined(
            #[inline(always)]
            |of: &[u32; LANES_MOST]| L::U::load(&of[half..]),
        );
        Here {
            corners: array(
                #[inline(always)]
                |k| [float(&rays.x[k]), float(&rays.y[k])],
            ),
            depth: array(
                #[inline(always)]
                |k| unsigned(&rays.depth[k]),
            ),
            values: array(
                #[inline(always)]
                |a| {
                    array(
                        #[inline(always)]
                        |k| float(&rays.values[a][k]),
                    )
                },
            ),
            turns: array(
                #[inline(always)]
                |k| float(&rays.turns[k]),
            ),
            turned: unsigned(&rays.turned),
            at: unsigned(&rays.at),
            distance: float(&rays.distance),
            value: array(
                #[inline(always)]
                |a| float(&rays.value[a]),
            ),
        }
    }

    #[inline(always)]
    pub(super) fn store(&self, rays: &mut Rays, half: usize) {
        for k in 0..3 {
            self.corners[k][0].store(&mut rays.x[k][half..]);
            self.corners[k][1].store(&mut rays.y[k][half..]);
            self.depth[k].store(&mut rays.depth[k][half..]);
            self.turns[k].store(&mut rays.turns[k][half..]);
            for a in 0..N {
                self.values[a][k].store(&mut rays.values[a][k][half..]);
            }
        }
        self.turned.store(&mut rays.turned[half..]);
        self.at.store(&mut rays.at[half..]);
        self.distance.store(&mut rays.distance[half..]);
        for a in 0..N {
            self.value[a].store(&mut rays.value[a][half..]);
        }
    }
}
