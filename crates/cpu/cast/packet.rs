//! Ray packets of 4 × 4 pixels: neighbours, so that they pass the same cells at about the same time.

use super::edge_functions::Offset;
use super::points::Points;
use super::ray_caster::{BoundaryHits, MAX_RAYCAST_ATTRIBUTES, RayCaster};
use crate::fragments::batch::{BATCH, MAX_LANES};
use crate::tile::{PIXELS, TILE, TileRect};
use crate::tolerances::ENTRY_OVERLAP;
use voltet_simd::{Float, Lanes, Unsigned, array, inlined};

/// Cells that a ray may pass: more are an endless loop.
pub(super) const MAX_TRAVERSAL_STEPS: usize = 1 << 17;

/// Packets that are advanced in turns: the next cell of a ray depends on a gather, whose latency the other packets hide.
pub(crate) const PACKETS_IN_FLIGHT: usize = 4;

/// Side of a packet (pixels).
const PACKET_SIDE: usize = 4;

/// Segments of a ray for each batch.
pub(super) const SLICES: usize = BATCH / TILE;

/// Pixel of a tile (row << 4 | column) of a packet's ray. There are as many packets as rows.
pub(crate) fn pixel_of(packet: usize, ray: usize) -> usize {
    let across = TILE / PACKET_SIDE;
    let (row, column) = (
        packet / across * PACKET_SIDE + ray / PACKET_SIDE,
        packet % across * PACKET_SIDE + ray % PACKET_SIDE,
    );
    row * TILE + column
}

pub(crate) struct RayPacket<'a> {
    pub(super) caster: &'a RayCaster,
    hits: &'a BoundaryHits,
    pub(super) pixels: [u32; TILE],
    /// Positions of the rays, across and down, at the depth of step 0 (steps), and how far they spread: see [`super::points::Points`].
    pub(super) position: [[u32; TILE]; 2],
    pub(super) spread: [[u32; TILE]; 2],
    /// Ray length per unit of depth.
    pub(super) length_per_depth: [f32; TILE],
    pub(super) distance_origin: f64,
    pub(super) state: StoredState,
    pub(super) pending: PendingEntry,
    /// Entries that each ray has consumed.
    consumed: [u32; TILE],
    /// Depth at which each ray has entered, and the end of all cells that it has left (steps, behind the near plane).
    begun: [u32; TILE],
    furthest: [u32; TILE],
    /// Rest of [`BoundaryHits::exit_checksum`].
    pub(super) exit_checksum: [u32; TILE],
    /// Active rays, a bit each, and those of them that are about to enter.
    pub(super) active: u32,
    pub(super) entering: u32,
    pub(super) slices: usize,
    pub segments: u64,
    /// True if a ray left by an unexpected face.
    pub is_mistracked: bool,
}

/// Next entry of each ray: corners, half-face, depth (steps).
pub(super) struct PendingEntry {
    pub corners: [[u32; MAX_LANES]; 3],
    pub half_face: [u32; MAX_LANES],
    pub at: [u32; MAX_LANES],
}

impl<'a> RayPacket<'a> {
    pub fn new(caster: &'a RayCaster, hits: &'a BoundaryHits, distance_origin: f64) -> RayPacket<'a> {
        RayPacket {
            caster,
            hits,
            pixels: [0; TILE],
            position: [[0; TILE]; 2],
            spread: [[0; TILE]; 2],
            length_per_depth: [1.0; TILE],
            distance_origin,
            state: StoredState::outside(caster.half_faces.sentinel()),
            pending: PendingEntry {
                corners: [[0; MAX_LANES]; 3],
                half_face: [0; MAX_LANES],
                at: [0; MAX_LANES],
            },
            consumed: [0; TILE],
            begun: [0; TILE],
            furthest: [0; TILE],
            exit_checksum: [0; TILE],
            active: 0,
            entering: 0,
            slices: 0,
            segments: 0,
            is_mistracked: false,
        }
    }

    /// Replaces the rays by those of a packet of the tile, before they enter.
    pub fn begin(&mut self, number: usize, rect: TileRect, length_per_depth: &[f32; PIXELS]) {
        (self.entering, self.slices) = (u32::MAX >> (32 - TILE), 0);
        (self.consumed, self.pending.at) = ([0; TILE], [0; MAX_LANES]);
        (self.begun, self.furthest) = ([0; TILE], [0; TILE]);
        let Points { ray_spacing, ray_spread, .. } = self.caster.points;
        for ray in 0..TILE {
            let pixel = pixel_of(number, ray);
            self.pixels[ray] = pixel as u32;
            for (axis, n) in [rect.left + pixel % TILE, rect.top + pixel / TILE].into_iter().enumerate() {
                self.position[axis][ray] = (n as u32).wrapping_mul(ray_spacing);
                self.spread[axis][ray] = n as u32 * ray_spread;
            }
            self.length_per_depth[ray] = length_per_depth[pixel];
            self.exit_checksum[ray] = self.hits.exit_checksum[pixel];
        }
        for ray in 0..TILE {
            self.enter_grid(ray);
        }
    }

    pub fn is_active(&self) -> bool {
        self.active != 0
    }

    /// Ends all rays: mistracked where one is in cells that may lie before those that it has left.
    pub fn stop(&mut self) {
        self.is_mistracked |=
            (0..TILE).any(|ray| self.active >> ray & 1 != 0 && self.overlaps(ray, self.furthest[ray]));
        self.active = 0;
    }

    /// True if cells that a ray has been in since it entered, up to a depth, overlap those that it had left before, by more than rounding.
    fn overlaps(&self, ray: usize, to: u32) -> bool {
        self.begun[ray].saturating_add(ENTRY_OVERLAP) < to.min(self.furthest[ray])
    }

    /// Enters the grid by a ray's next entry; if there is none the ray ends. It is mistracked where it has not exited by all faces that it
    /// should have, or where the cells that it leaves overlap those before; on the eye's side of the near plane, where it has no segments,
    /// the order does not matter.
    pub(super) fn enter_grid(&mut self, ray: usize) {
        let bit = 1 << ray;
        let near = self.caster.points.near.unwrap_or(0);
        let at = self.pending.at[ray].max(near);
        self.is_mistracked |= self.overlaps(ray, at);
        self.furthest[ray] = self.furthest[ray].max(at);
        let Some(entry) = self.hits.entries_of(self.pixels[ray] as usize).get(self.consumed[ray] as usize)
        else {
            self.is_mistracked |= self.exit_checksum[ray] != 0;
            self.active &= !bit;
            self.pending.half_face[ray] = self.caster.half_faces.sentinel();
            return;
        };
        self.begun[ray] = entry.depth.max(near);
        self.consumed[ray] += 1;
        self.active |= bit;
        let face = self.caster.half_faces.boundary[entry.face as usize];
        for (corners, corner) in self.pending.corners.iter_mut().zip(face.corners) {
            corners[ray] = corner;
        }
        self.pending.half_face[ray] = face.half_face;
        self.pending.at[ray] = entry.depth;
    }
}

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
