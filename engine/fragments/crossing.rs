//! Crossings: where each fragment's ray enters and leaves its cell, and the attributes there.

use crate::fragments::batch::{Batch, LANES_MOST};
use crate::project::record::{AttributeRecord, RECORD_WORDS, Record, TILE};
use voltet_lanes::{Float, Lanes, Mask, Unsigned, array, inlined};

/// Records of up to `WIDTH` cells, word by word, cells side by side.
pub(crate) struct Group {
    words: Words<RECORD_WORDS>,
    pixel_x: [f32; LANES_MOST],
    pixel_y: [f32; LANES_MOST],
    /// Of each attribute, and words that nobody looks at.
    attributes: Vec<Words<8>>,
    /// As they came, cell by cell.
    records: [Record; LANES_MOST],
    attribute_records: Vec<[[[f32; 4]; 2]; LANES_MOST]>,
}

/// Words of cells: word by word, cells side by side.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Words<const N: usize>([[f32; LANES_MOST]; N]);

impl<const N: usize> Words<N> {
    /// From fours of words, `fours` of them a cell.
    #[inline(always)]
    fn turn<L: Lanes>(&mut self, cells: &[[f32; 4]], fours: u32) {
        for (four, rows) in self.0.chunks_exact_mut(4).enumerate() {
            let mut place = [0; LANES_MOST];
            for (cell, place) in place.iter_mut().enumerate() {
                *place = cell as u32 * fours + four as u32;
            }
            let parts = L::F::gather_parts(cells, L::U::load(&place));
            for (row, part) in rows.iter_mut().zip(parts) {
                part.store(row);
            }
        }
    }
}

impl Group {
    pub fn new(attribute_count: usize) -> Self {
        Group {
            words: Words([[0.0; LANES_MOST]; RECORD_WORDS]),
            pixel_x: [0.0; LANES_MOST],
            pixel_y: [0.0; LANES_MOST],
            attributes: vec![Words([[0.0; LANES_MOST]; 8]); attribute_count],
            records: [Record::default(); LANES_MOST],
            attribute_records: vec![[[[0.0; 4]; 2]; LANES_MOST]; attribute_count],
        }
    }

    /// Takes a cell into a lane.
    #[inline(always)]
    pub fn take(&mut self, lane: usize, record: &Record, attributes: &[AttributeRecord]) {
        self.records[lane] = *record;
        for (cells, attribute) in self.attribute_records.iter_mut().zip(attributes) {
            let &AttributeRecord { p, q, r, base, low, high } = attribute;
            cells[lane] = [[p, q, r, base], [low, high, 0.0, 0.0]];
        }
    }

    /// Makes ready what was taken; pixels become relative to the tile at (`left`, `top`).
    #[inline(always)]
    pub fn turn<L: Lanes>(&mut self, left: usize, top: usize) {
        self.words.turn::<L>(bytemuck::cast_slice(&self.records), RECORD_WORDS as u32 / 4);
        for (words, cells) in self.attributes.iter_mut().zip(&self.attribute_records) {
            words.turn::<L>(cells.as_flattened(), 2);
        }
        let pixel = L::F::load(&self.words.0[15]).to_bits();
        let relative = inlined(
            #[inline(always)]
            |x: L::U, origin: usize| x.to_float() - L::F::splat(origin as f32),
        );
        relative(pixel.and(L::U::splat(0xffff)), left).store(&mut self.pixel_x);
        relative(pixel.shr::<16>(), top).store(&mut self.pixel_y);
    }

    /// Evaluates `codes` (at most [`super::batch::BATCH`], readable up to the next multiple of `WIDTH`). `stretch` is the
    /// length of each pixel's ray direction; `near`, where the near plane cuts cells, gives its
    /// v as scale × distance + offset, and its depth from the distance origin. Entry and exit depths are found only if the
    /// segments are `ordered`.
    #[inline(always)]
    pub fn evaluate<L: Lanes, const PERSPECTIVE: bool>(
        &self,
        codes: &[u16],
        count: usize,
        stretch: &[f32; TILE * TILE],
        near: Option<[f32; 3]>,
        ordered: bool,
        batch: &mut Batch,
    ) {
        let word = inlined(
            #[inline(always)]
            |k: usize| L::F::load(&self.words.0[k]),
        );
        let planes: [[L::F; 3]; 4] = array(
            #[inline(always)]
            |k| [word(k), word(4 + k), word(8 + k)],
        );
        let (depth, distance) = (word(12), word(13));
        let front = word(14).to_bits();
        let (pixel_x, pixel_y) = (L::F::load(&self.pixel_x), L::F::load(&self.pixel_y));
        let one = L::F::splat(1.0);

        batch.hits = 0;
        let mut at = 0;
        while at < count {
            let code = L::U::load_u16(&codes[at..]);
            let pixel = code.and(L::U::splat(255));
            let lane = code.shr::<8>().and(L::U::splat(L::WIDTH as u32 - 1));
            let dx = pixel.and(L::U::splat(15)).to_float() - pixel_x.permute(lane);
            let dy = pixel.shr::<4>().to_float() - pixel_y.permute(lane);

            // Enter at the least v of the front faces, leave at the greatest of the back faces.
            let facing = front.permute(lane);
            let mut v_front = L::F::splat(f32::MAX);
            let mut v_back = L::F::splat(-f32::MAX);
            for (k, plane) in planes.iter().enumerate() {
                let v = plane[0]
                    .permute(lane)
                    .mul_add(dx, plane[1].permute(lane).mul_add(dy, plane[2].permute(lane)));
                let is_front = facing.test(L::U::splat(1 << k));
                v_front = L::F::select(is_front, v.min(v_front), v_front);
                v_back = L::F::select(is_front, v_back, v.max(v_back));
            }
            let depth = depth.permute(lane);
            let distance = distance.permute(lane);
            let v_whole = v_front;
            let v_near = match near {
                Some([scale, offset, _]) => distance.mul_add(L::F::splat(scale), L::F::splat(offset)),
                None => v_whole,
            };
            v_front = v_whole.min(v_near);
            let thickness = v_front - v_back;
            let hit = L::F::splat(0.0).lt(thickness);
            let meant = u32::MAX >> (32 - (count - at).min(L::WIDTH));
            batch.hits += (hit.bits() & meant).count_ones();
            let stretch = L::F::gather(stretch, pixel);
            let (q_front, q_back, length) = if PERSPECTIVE {
                let (w_front, w_back) = (one + v_front, one + v_back);
                let both = one / (w_front * w_back);
                (both * w_back, both * w_front, thickness * depth * both * stretch)
            } else {
                (one, one, thickness * depth * stretch)
            };
            let depth_at = inlined(
                #[inline(always)]
                |v: L::F, q: L::F| distance - v * depth * q,
            );
            L::F::select(hit, length, L::F::splat(0.0)).store(&mut batch.length[at..]);
            if ordered {
                let mut entry = depth_at(v_front, q_front);
                if let Some([_, _, cut_at]) = near {
                    // What the plane cuts begins where it is, bit for bit in all cells: their exits tell their order.
                    entry = L::F::select(v_near.lt(v_whole), L::F::splat(cut_at), entry);
                }
                entry.store(&mut batch.entry[at..]);
                depth_at(v_back, q_back).store(&mut batch.exit[at..]);
            }
            pixel.store(&mut batch.pixel[at..]);
            for (k, rows) in self.attributes.iter().enumerate() {
                let row = inlined(
                    #[inline(always)]
                    |k: usize| L::F::load(&rows.0[k]).permute(lane),
                );
                let across = row(0).mul_add(dx, row(1) * dy);
                let (r, base, low, high) = (row(2), row(3), row(4), row(5));
                let value = inlined(
                    #[inline(always)]
                    |v: L::F, q: L::F| r.mul_add(v, across).mul_add(q, base).max(low).min(high),
                );
                value(v_front, q_front).store(&mut batch.front[k][at..]);
                value(v_back, q_back).store(&mut batch.back[k][at..]);
            }
            at += L::WIDTH;
        }
    }
}
