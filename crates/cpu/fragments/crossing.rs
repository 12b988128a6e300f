//! Crossings: entry and exit of each fragment's ray in its cell, and the attributes there.

use crate::fragments::batch::{Batch, MAX_LANES, meant};
use crate::project::cells::{AttributePlane, CELL_WORDS, ProjectedCell};
use crate::tile::TILE;
use voltet_simd::{Float, Lanes, Unsigned, array, inlined};

/// SoA packet of up to `WIDTH` projected cells: word by word, cells side by side.
pub(crate) struct CellPacket {
    words: Words<CELL_WORDS>,
    pixel_x: [f32; MAX_LANES],
    pixel_y: [f32; MAX_LANES],
    /// Words of each attribute, then padding.
    attributes: Vec<Words<8>>,
    /// Planes cell by cell.
    records: [ProjectedCell; MAX_LANES],
    attribute_records: Vec<[[[f32; 4]; 2]; MAX_LANES]>,
}

/// Words of cells: word by word, cells side by side.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Words<const N: usize>([[f32; MAX_LANES]; N]);

impl<const N: usize> Words<N> {
    /// From quads of words, `quads` of them a cell.
    #[inline(always)]
    fn transpose<L: Lanes>(&mut self, cells: &[[f32; 4]], quads: u32) {
        for (quad, rows) in self.0.chunks_exact_mut(4).enumerate() {
            let mut index = [0; MAX_LANES];
            for (cell, index) in index.iter_mut().enumerate() {
                *index = cell as u32 * quads + quad as u32;
            }
            let parts = L::F::gather_parts(cells, L::U::load(&index));
            for (row, part) in rows.iter_mut().zip(parts) {
                part.store(row);
            }
        }
    }
}

impl CellPacket {
    pub fn new(attribute_count: usize) -> Self {
        CellPacket {
            words: Words([[0.0; MAX_LANES]; CELL_WORDS]),
            pixel_x: [0.0; MAX_LANES],
            pixel_y: [0.0; MAX_LANES],
            attributes: vec![Words([[0.0; MAX_LANES]; 8]); attribute_count],
            records: [ProjectedCell::default(); MAX_LANES],
            attribute_records: vec![[[[0.0; 4]; 2]; MAX_LANES]; attribute_count],
        }
    }

    /// Takes a cell into a lane.
    #[inline(always)]
    pub fn take(&mut self, lane: usize, record: &ProjectedCell, attributes: &[AttributePlane]) {
        self.records[lane] = *record;
        for (cells, attribute) in self.attribute_records.iter_mut().zip(attributes) {
            let &AttributePlane { p, q, r, base, low, high } = attribute;
            cells[lane] = [[p, q, r, base], [low, high, 0.0, 0.0]];
        }
    }

    /// Transposes the cells; pixels become relative to the tile at (`left`, `top`).
    #[inline(always)]
    pub fn transpose<L: Lanes>(&mut self, left: usize, top: usize) {
        self.words.transpose::<L>(bytemuck::cast_slice(&self.records), CELL_WORDS as u32 / 4);
        for (words, cells) in self.attributes.iter_mut().zip(&self.attribute_records) {
            words.transpose::<L>(cells.as_flattened(), 2);
        }
        let pixel = L::F::load(&self.words.0[15]).to_bits();
        let relative = inlined!(|x: L::U, origin: usize| x.to_float() - L::F::splat(origin as f32));
        relative(pixel.and(L::U::splat(0xffff)), left).store(&mut self.pixel_x);
        relative(pixel.shr::<16>(), top).store(&mut self.pixel_y);
    }

    /// Evaluates `codes` (at most [`super::batch::BATCH`], readable up to the next multiple of `WIDTH`) into a batch. `length_per_depth` is the
    /// length of each pixel's ray direction. Entry and exit depths are found only if the segments are `ordered`.
    #[inline(always)]
    pub fn evaluate<L: Lanes, const PERSPECTIVE: bool>(
        &self,
        codes: &[u16],
        count: usize,
        length_per_depth: &[f32; TILE * TILE],
        near: Near,
        ordered: bool,
        batch: &mut Batch,
    ) {
        let crossed = Planes::<L>::load(self, near);
        batch.hits = 0;
        let mut at = 0;
        while at < count {
            let ray = crossed.cross::<PERSPECTIVE>(L::U::load_u16(&codes[at..]));
            batch.hits += meant::<L>(ray.hit, count - at).count_ones();
            let length = ray.length * L::F::gather(length_per_depth, ray.pixel);
            L::F::select(ray.hit, length, L::F::splat(0.0)).store(&mut batch.length[at..]);
            if ordered {
                ray.entry().store(&mut batch.entry[at..]);
                ray.exit().store(&mut batch.exit[at..]);
            }
            ray.pixel.store(&mut batch.pixel[at..]);
            for (k, rows) in self.attributes.iter().enumerate() {
                let [front, back] = ray.ends(rows);
                front.store(&mut batch.front[k][at..]);
                back.store(&mut batch.back[k][at..]);
            }
            at += L::WIDTH;
        }
    }

    /// Evaluates `codes` (readable up to the next multiple of `WIDTH`) into lists, each at its slot there; lengths are depths from
    /// entry to exit. What misses its cell has no length. Returns the fragments that cross theirs.
    #[inline(always)]
    pub fn append<L: Lanes, const PERSPECTIVE: bool>(
        &self,
        codes: &[u16],
        slots: &[u32],
        near: Near,
        quads: &mut [Vec<[f32; 4]>],
    ) -> u64 {
        let crossed = Planes::<L>::load(self, near);
        let mut hits = 0;
        let mut put = inlined!(|quad: usize, values: [L::F; 4], slot: L::U| {
            let quads: &mut [[[f32; 4]; 1]] = bytemuck::cast_slice_mut(quads[quad].as_mut_slice());
            L::F::scatter_parts([values], quads, slot);
        });
        let count = slots.len() - MAX_LANES;
        let mut at = 0;
        while at < count {
            let ray = crossed.cross::<PERSPECTIVE>(L::U::load_u16(&codes[at..]));
            hits += u64::from(meant::<L>(ray.hit, count - at).count_ones());
            let slot = L::U::load(&slots[at..]);
            let entry = L::F::select(ray.hit, ray.entry(), ray.distance);
            let length = L::F::select(ray.hit, ray.length, L::F::splat(0.0));
            match self.attributes.as_slice() {
                [] => put(0, [entry, length, entry, entry], slot),
                [first, further @ ..] => {
                    let [front, back] = ray.ends(first);
                    put(0, [entry, length, front, back], slot);
                    for (quad, two) in further.chunks(2).enumerate() {
                        let [front, back] = ray.ends(&two[0]);
                        let [next_front, next_back] = match two.get(1) {
                            Some(next) => ray.ends(next),
                            None => [front, back],
                        };
                        put(1 + quad, [front, back, next_front, next_back], slot);
                    }
                }
            }
            at += L::WIDTH;
        }
        hits
    }
}

/// Near plane, where it cuts cells: its v as scale × distance + offset, and its depth from the distance origin.
pub(crate) type Near = Option<[f32; 3]>;

/// Planes of a packet's cells, in registers.
struct Planes<L: Lanes> {
    planes: [[L::F; 3]; 4],
    depth: L::F,
    distance: L::F,
    front: L::U,
    pixel: [L::F; 2],
    near: Near,
}

/// The rays of one vector of fragments, and where they cross their cells.
struct Crossing<L: Lanes> {
    pixel: L::U,
    lane: L::U,
    /// From the record's pixel.
    from_pixel: [L::F; 2],
    hit: L::M,
    /// Depth from entry to exit.
    length: L::F,
    /// v and 1 / (1 + v) at entry and exit.
    v: [L::F; 2],
    q: [L::F; 2],
    depth: L::F,
    distance: L::F,
    /// Lanes that the near plane cuts, and its depth.
    cut: Option<(L::M, f32)>,
}

impl<L: Lanes> Planes<L> {
    #[inline(always)]
    fn load(group: &CellPacket, near: Near) -> Planes<L> {
        let word = inlined!(|k: usize| L::F::load(&group.words.0[k]));
        Planes {
            planes: array!(|k| [word(k), word(4 + k), word(8 + k)]),
            depth: word(12),
            distance: word(13),
            front: word(14).to_bits(),
            pixel: [L::F::load(&group.pixel_x), L::F::load(&group.pixel_y)],
            near,
        }
    }

    #[inline(always)]
    fn cross<const PERSPECTIVE: bool>(&self, code: L::U) -> Crossing<L> {
        let one = L::F::splat(1.0);
        let pixel = code.and(L::U::splat(255));
        let lane = code.shr::<8>().and(L::U::splat(L::WIDTH as u32 - 1));
        let dx = pixel.and(L::U::splat(15)).to_float() - self.pixel[0].permute(lane);
        let dy = pixel.shr::<4>().to_float() - self.pixel[1].permute(lane);

        // Enter at the least v of the front faces, leave at the greatest of the back faces.
        let facing = self.front.permute(lane);
        let mut v_front = L::F::splat(f32::MAX);
        let mut v_back = L::F::splat(-f32::MAX);
        for (k, plane) in self.planes.iter().enumerate() {
            let v = plane[0]
                .permute(lane)
                .mul_add(dx, plane[1].permute(lane).mul_add(dy, plane[2].permute(lane)));
            let is_front = facing.test(L::U::splat(1 << k));
            v_front = L::F::select(is_front, v.min(v_front), v_front);
            v_back = L::F::select(is_front, v_back, v.max(v_back));
        }
        let depth = self.depth.permute(lane);
        let distance = self.distance.permute(lane);
        let cut = self.near.map(inlined!(|[scale, offset, cut_at]: [f32; 3]| {
            let v_near = distance.mul_add(L::F::splat(scale), L::F::splat(offset));
            let cut = v_near.lt(v_front);
            v_front = v_front.min(v_near);
            (cut, cut_at)
        }));
        let thickness = v_front - v_back;
        let hit = L::F::splat(0.0).lt(thickness);
        let (q, length) = if PERSPECTIVE {
            let (w_front, w_back) = (one + v_front, one + v_back);
            let both = one / (w_front * w_back);
            ([both * w_back, both * w_front], thickness * depth * both)
        } else {
            ([one, one], thickness * depth)
        };
        let v = [v_front, v_back];
        Crossing { pixel, lane, from_pixel: [dx, dy], hit, length, v, q, depth, distance, cut }
    }
}

impl<L: Lanes> Crossing<L> {
    #[inline(always)]
    fn depth_at(&self, end: usize) -> L::F {
        self.distance - self.v[end] * self.depth * self.q[end]
    }

    /// Depth of the entry from the distance origin.
    #[inline(always)]
    fn entry(&self) -> L::F {
        let entry = self.depth_at(0);
        match self.cut {
            // Segments that the plane cuts begin at it, bit for bit in all cells: their exits decide their order.
            Some((cut, cut_at)) => L::F::select(cut, L::F::splat(cut_at), entry),
            None => entry,
        }
    }

    #[inline(always)]
    fn exit(&self) -> L::F {
        self.depth_at(1)
    }

    /// An attribute at entry and exit.
    #[inline(always)]
    fn ends(&self, rows: &Words<8>) -> [L::F; 2] {
        let row = inlined!(|k: usize| L::F::load(&rows.0[k]).permute(self.lane));
        let [dx, dy] = self.from_pixel;
        let across = row(0).mul_add(dx, row(1) * dy);
        let (r, base, low, high) = (row(2), row(3), row(4), row(5));
        array!(|end| r.mul_add(self.v[end], across).mul_add(self.q[end], base).max(low).min(high))
    }
}
