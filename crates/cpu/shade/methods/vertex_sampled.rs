//! What the transfer function is at the grid's points, linear between them. Twin of `optics::integrators::VertexSampled`, of a
//! scene that is classified.

use crate::fragments::batch::{Column, meant};
use crate::shade::kinds::Making;
use crate::shade::roads::{Form, Part};
use crate::shade::shaded::{Left, Shaded};
use crate::shade::shader::push;
use voltet_optics::research::CLASSIFIED;
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::optics::linear::{DEEPEST, front_back};
use voltet_simd::{Float, Lanes, Mask, array, inlined};

/// Where κ by channel and ρ stand among a batch's values.
pub(crate) struct VertexSampled {
    places: [usize; 4],
    /// Per scene length: offset + scale × stored.
    offsets: [f32; 4],
    scales: [f32; 4],
}

impl VertexSampled {
    /// `length`: world units in a scene length. Errors: a scene that is not classified, or in numbers beyond 32 bits.
    pub fn new(making: &Making, length: f64) -> Result<VertexSampled, Left> {
        let mut made = VertexSampled { places: [0; 4], offsets: [0.0; 4], scales: [0.0; 4] };
        for (k, name) in CLASSIFIED.into_iter().enumerate() {
            let (place, axis) = making.field(name).ok_or(Left::Integrator)?;
            made.places[k] = 2 + place;
            made.offsets[k] = (axis.offset * length) as f32;
            made.scales[k] = (axis.scale * length) as f32;
        }
        let held = made.offsets.iter().chain(&made.scales).all(|x| x.is_finite());
        if held { Ok(made) } else { Err(Left::Lengths) }
    }
}

impl Form for VertexSampled {
    #[inline(always)]
    fn shade<L: Lanes>(&self, part: Part<'_>, out: &mut Shaded) {
        let Part { one_color, batch, count, .. } = part;
        let splat = L::F::splat;
        let (zero, half) = (splat(0.0), splat(0.5));
        for at in (0..count).step_by(L::WIDTH) {
            let length = L::F::load(&batch.length[at..]);
            let crossing = zero.lt(length);
            let length = L::F::select(crossing, length, zero);
            // Interpolation may leave less than nothing; what is no number stays none.
            let ends = inlined(
                #[inline(always)]
                |columns: &[Column]| -> [L::F; 4] {
                    array(
                        #[inline(always)]
                        |k| {
                            let stored = L::F::load(&columns[self.places[k]][at..]);
                            let value = stored.mul_add(splat(self.scales[k]), splat(self.offsets[k]));
                            zero.max(value) * length
                        },
                    )
                },
            );
            let (front, back) = (ends(&batch.front), ends(&batch.back));
            let depth = half.mul_add(front[3], half * back[3]);
            depth.store(&mut out.depth[at..]);
            let mut unsure = depth.le(splat(0.5 * DEEPEST)).not().bits();
            // At a cutoff of 0 glows what does not absorb.
            let mut whole = depth;
            for k in 0..3 {
                whole = whole + (front[k] + back[k]);
            }
            let there = zero.lt(whole).bits();
            if !one_color {
                let color = if there == 0 {
                    [zero; 3]
                } else {
                    let (near, far) = front_back::<L>(front[3], back[3]);
                    array(
                        #[inline(always)]
                        |c| near.mul_add(front[c], far * back[c]),
                    )
                };
                let whole = depth + (color[0] + (color[1] + color[2]));
                unsure |= whole.le(splat(f32::MAX)).not().bits();
                let [r, g, b] = color;
                for (column, value) in out.rgba.iter_mut().zip([r, g, b, one_minus_exp::<L>(depth)]) {
                    value.store(&mut column[at..]);
                }
            }
            let meant = meant::<L>(crossing, count - at);
            push(&mut out.rest, unsure & meant, at);
            out.evaluation_count += u64::from((there & meant & !unsure).count_ones());
        }
    }
}
