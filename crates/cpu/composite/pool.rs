//! Segments that take more than a quick form, of many batches: they wait among the layers of their rows until there are enough of a
//! kind to fill vectors, for they are few among their neighbours. What is hidden is let go.

use crate::composite::layers::Layers;
use crate::composite::lists::UNSEEN_FOR_SURE;
use crate::fragments::batch::{BATCH, Batch, Column};
use crate::project::record::TILE;
use crate::sample::Frame;
use crate::shade::roads::finish;
use crate::shade::shaded::{KINDS, Shaded};

/// A queue for each kind of [`Shaded::left_over`].
pub(crate) struct Pool {
    queues: [Queue; KINDS],
    /// What is known of a batch's.
    opacity: Box<Column>,
    opacities: Box<Column>,
    /// What is seen of a batch's segments, at most.
    seen: Box<Column>,
    /// What is seen through the pixels of rows that wait, at most.
    through: Box<[[f32; TILE]; TILE]>,
    /// What comes out.
    pub shaded: Shaded,
}

/// Segments of one kind.
struct Queue {
    batch: Batch,
    /// Where they wait.
    place: Box<Column<u32>>,
    opacity: Box<Column>,
    /// What light makes of colour and opacity.
    light: [Box<Column>; 2],
    count: usize,
}

/// The kind of those whose opacities are not known.
const UNKNOWN: usize = KINDS - 1;

/// Such segments that are served at once: what lies behind them may be hidden.
const UNKNOWN_MOST: usize = 32;

/// Share of the picture under which a segment that takes more than a quick form is let go.
const UNSEEN_COLOR: f32 = 1e-8;

impl Pool {
    pub fn new(scalar_count: usize) -> Pool {
        let queue = |_| Queue {
            batch: Batch::new(scalar_count, scalar_count),
            place: Column::new(),
            opacity: Column::new(),
            light: [Column::new(), Column::new()],
            count: 0,
        };
        Pool {
            queues: std::array::from_fn(queue),
            opacity: Column::new(),
            opacities: Column::new(),
            seen: Column::new(),
            through: Box::new([[1.0; TILE]; TILE]),
            shaded: Shaded::new(),
        }
    }

    /// Begins a row through whose pixels so much is seen.
    pub fn begin(&mut self, row: usize, through: &[f32; TILE]) {
        self.through[row] = *through;
    }

    /// Whether nothing that may come is seen of a row that waits.
    pub fn hides(&self, row: usize) -> bool {
        self.through[row].iter().all(|through| *through <= UNSEEN_FOR_SURE)
    }

    /// Makes those of a batch that will wait white and opaque, so that what light makes of them is kept.
    pub fn lend(&mut self, shaded: &mut Shaded) {
        let Shaded { in_order, deep, dense, rest, rgba, .. } = shaded;
        for &k in in_order.iter().chain([&*deep, &*dense, &*rest]).flatten() {
            self.opacity[k] = rgba[3][k];
            rgba.iter_mut().for_each(|column| column[k] = 1.0);
        }
    }

    /// Puts the first `count` segments of a batch, slices of a row, among the layers, and in queues those that wait and may be seen.
    pub fn take(
        &mut self,
        frame: &Frame<'_>,
        (row, batch): (usize, &Batch),
        shaded: &Shaded,
        count: usize,
        layers: &mut Layers,
    ) {
        self.see(row, batch, shaded, count);
        let first = layers.take(row, batch, shaded, count);
        let rgba = &shaded.rgba;
        for (number, which) in shaded.left_over().into_iter().enumerate() {
            for &k in which {
                let place = first + k;
                if self.seen[k] <= UNSEEN_COLOR {
                    // What is left of white would show.
                    layers.set(place, [0.0, 0.0, 0.0, self.opacities[k]]);
                    continue;
                }
                let queue = &mut self.queues[number];
                let to = queue.count;
                queue.batch.length[to] = batch.length[k];
                for a in 0..queue.batch.scalar_count {
                    queue.batch.front[a][to] = batch.front[a][k];
                    queue.batch.back[a][to] = batch.back[a][k];
                }
                queue.place[to] = place as u32;
                queue.opacity[to] = self.opacity[k];
                queue.light[0][to] = rgba[0][k];
                queue.light[1][to] = rgba[3][k];
                queue.count += 1;
                if queue.count == BATCH {
                    self.serve(number, frame, layers);
                }
            }
        }
        if self.queues[UNKNOWN].count > UNKNOWN_MOST {
            self.serve(UNKNOWN, frame, layers);
        }
    }

    /// Finds what is seen of each segment of a batch, and opacities after light; 0 where they are not known yet.
    fn see(&mut self, row: usize, batch: &Batch, shaded: &Shaded, count: usize) {
        let known = &mut self.opacities;
        known.copy_from_slice(&**shaded.rgba[3]);
        for (number, which) in shaded.left_over().into_iter().enumerate() {
            for &k in which {
                known[k] *= if number == UNKNOWN { 0.0 } else { self.opacity[k] };
            }
        }
        let of_row = &mut self.through[row];
        for at in (0..count).step_by(TILE) {
            self.seen[at..][..TILE].copy_from_slice(of_row);
            let slice = batch.length[at..][..TILE].iter().zip(&known[at..][..TILE]);
            for (through, (length, opacity)) in of_row.iter_mut().zip(slice) {
                *through *= if *length > 0.0 { 1.0 - opacity } else { 1.0 };
            }
        }
    }

    /// Serves all who wait.
    pub fn finish(&mut self, frame: &Frame<'_>, layers: &mut Layers) {
        for number in 0..self.queues.len() {
            self.serve(number, frame, layers);
        }
    }

    fn serve(&mut self, number: usize, frame: &Frame<'_>, layers: &mut Layers) {
        let Pool { queues, shaded, through, .. } = self;
        let queue = &mut queues[number];
        let count = std::mem::take(&mut queue.count);
        if count == 0 {
            return;
        }
        shaded.clear();
        shaded.left_over_mut()[number].extend(0..count);
        shaded.rgba[3].copy_from_slice(&**queue.opacity);
        finish(frame.shader, frame.lanes, &queue.batch, shaded);
        let [color, opacity] = &queue.light;
        for (column, light) in shaded.rgba.iter_mut().zip([color, color, color, opacity]) {
            column.iter_mut().zip(light.iter()).take(count).for_each(|(value, light)| *value *= light);
        }
        let [r, g, b, a] = &shaded.rgba;
        for (k, &place) in queue.place.iter().enumerate().take(count) {
            layers.set(place as usize, [r[k], g[k], b[k], a[k]]);
            if number == UNKNOWN {
                through[layers.row_of(place as usize)][place as usize % TILE] *= 1.0 - a[k];
            }
        }
    }
}
