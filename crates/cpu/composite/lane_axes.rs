//! Curved axes of s and g, between what segments hold and what widgets read.

use crate::attribute::Attribute;
use crate::fragments::batch::Batch;
use voltet_core::transfer::TransferFunction;
use voltet_optics::curved_axes::CurvedAxes;

/// Curved axes of s and g, with the scales of what batches hold.
pub(crate) struct LaneAxes {
    pub curved: CurvedAxes,
    /// Value = scale × what is projected, since values of curved axes are counted from 0; of straight ones values and positions are stored
    /// alike.
    values: [f64; 2],
    /// Offset and scale of positions.
    positions: [[f64; 2]; 2],
    /// True if g is among the attributes.
    has_g: bool,
}

impl LaneAxes {
    /// Axes of a transfer function; none where they are straight. `projected`, `shaded`: attributes as segments and as widgets have them.
    pub fn new(
        transfer_function: &TransferFunction,
        projected: &[Attribute<'_>],
        shaded: &[Attribute<'_>],
    ) -> Option<LaneAxes> {
        let curved = CurvedAxes::new(transfer_function)?;
        let (mut values, mut positions) = ([1.0; 2], [[0.0, 1.0]; 2]);
        for (axis, (from, to)) in projected.iter().zip(shaded).take(2).enumerate() {
            if curved.scale(axis).is_curved() {
                (values[axis], positions[axis]) = (from.scale, [to.offset, to.scale]);
            }
        }
        Some(LaneAxes { curved, values, positions, has_g: projected.len() > 1 })
    }

    /// Values at a share of a segment of a batch.
    pub fn at(&self, batch: &Batch, k: usize, share: f64) -> [f64; 2] {
        let value = |axis: usize| {
            let [front, back] = [&batch.front, &batch.back].map(|columns| f64::from(columns[axis][k]));
            self.values[axis] * (front + share * (back - front))
        };
        [value(0), if self.has_g { value(1) } else { 0.0 }]
    }

    /// Positions as widgets read them.
    pub fn stored(&self, position: [f64; 2]) -> [f32; 2] {
        [0, 1].map(|axis| ((position[axis] - self.positions[axis][0]) / self.positions[axis][1]) as f32)
    }
}
