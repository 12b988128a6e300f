//! State of a packet's rays: in memory, and in registers.

use super::edge_functions::Offset;
use super::ray_caster::MAX_RAYCAST_ATTRIBUTES;
use crate::fragments::batch::MAX_LANES;
use voltet_simd::{Float, Lanes, Unsigned, array, inlined};

/// State of rays in memory, ray by ray: of the entry face's three corners the positions relative to the ray, depths and attributes.
pub(super) struct StoredState {
    x: [[f32; MAX_LANES]; 3],
    y: [[f32; MAX_LANES]; 3],
    depth: [[u32; MAX_LANES]; 3],
    values: [[[f32; MAX_LANES]; 3]; MAX_RAYCAST_ATTRIBUTES],
    /// Edge functions of corners 0 and 1, 1 and 2, 2 and 0.
    functions: [[f32; MAX_LANES]; 3],
    pub half_face: [u32; MAX_LANES],
    /// Rotation of the corners against those of the half-face.
    rotation: [u32; MAX_LANES],
    /// Position of the ray: depth (steps), depth (scene lengths, perspective), attributes.
    at: [u32; MAX_LANES],
    distance: [f32; MAX_LANES],
    value: [[f32; MAX_LANES]; MAX_RAYCAST_ATTRIBUTES],
}

impl StoredState {
    /// StoredState that have not entered.
    pub fn outside(half_face: u32) -> StoredState {
        let zero = [0.0; MAX_LANES];
        StoredState {
            x: [zero; 3],
            y: [zero; 3],
            depth: [[0; MAX_LANES]; 3],
            values: [[zero; 3]; MAX_RAYCAST_ATTRIBUTES],
            functions: [zero; 3],
            half_face: [half_face; MAX_LANES],
            rotation: [0; MAX_LANES],
            at: [0; MAX_LANES],
            distance: [1.0; MAX_LANES],
            value: [zero; MAX_RAYCAST_ATTRIBUTES],
        }
    }
}

/// State of rays in registers.
pub(super) struct PacketState<L: Lanes, const N: usize> {
    pub(super) corners: [Offset<L>; 3],
    pub(super) depth: [L::U; 3],
    pub(super) values: [[L::F; 3]; N],
    pub(super) functions: [L::F; 3],
    pub(super) rotation: L::U,
    pub(super) at: L::U,
    pub(super) distance: L::F,
    pub(super) value: [L::F; N],
}

impl<L: Lanes, const N: usize> PacketState<L, N> {
    #[inline(always)]
    pub(super) fn load(rays: &StoredState, half: usize) -> Self {
        let float = inlined!(|of: &[f32; MAX_LANES]| L::F::load(&of[half..]));
        let unsigned = inlined!(|of: &[u32; MAX_LANES]| L::U::load(&of[half..]));
        PacketState {
            corners: array!(|k| [float(&rays.x[k]), float(&rays.y[k])]),
            depth: array!(|k| unsigned(&rays.depth[k])),
            values: array!(|a| { array!(|k| float(&rays.values[a][k])) }),
            functions: array!(|k| float(&rays.functions[k])),
            rotation: unsigned(&rays.rotation),
            at: unsigned(&rays.at),
            distance: float(&rays.distance),
            value: array!(|a| float(&rays.value[a])),
        }
    }

    #[inline(always)]
    pub(super) fn store(&self, rays: &mut StoredState, half: usize) {
        for k in 0..3 {
            self.corners[k][0].store(&mut rays.x[k][half..]);
            self.corners[k][1].store(&mut rays.y[k][half..]);
            self.depth[k].store(&mut rays.depth[k][half..]);
            self.functions[k].store(&mut rays.functions[k][half..]);
            for a in 0..N {
                self.values[a][k].store(&mut rays.values[a][k][half..]);
            }
        }
        self.rotation.store(&mut rays.rotation[half..]);
        self.at.store(&mut rays.at[half..]);
        self.distance.store(&mut rays.distance[half..]);
        for a in 0..N {
            self.value[a].store(&mut rays.value[a][half..]);
        }
    }
}
