//! Segments that take more than a quick form, of many batches: they wait in their pixel's list until there are enough of a kind
//! to fill vectors, for they are few among their neighbours.

use crate::composite::lists::Lists;
use crate::fragments::batch::{BATCH, Batch, Column};
use crate::sample::Frame;
use crate::shade::later::Later;
use crate::shade::roads::finish;
use crate::shade::shaded::Shaded;
use crate::shade::stepped::STEPS;

/// One queue for each number of steps, then one for the others.
pub(crate) struct Pool {
    queues: [Queue; STEPS.len() + 1],
    /// What is known of a batch's.
    opacity: Box<Column>,
    opacities: Box<Column>,
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
            shaded: Shaded::new(),
        }
    }

    /// Nobody waits.
    pub fn clear(&mut self) {
        self.queues.iter_mut().for_each(|queue| queue.count = 0);
    }

    /// Makes those of a batch that will wait white and opaque, so that what light makes of them is kept.
    pub fn lend(&mut self, shaded: &mut Shaded) {
        let Shaded { in_order, dense, rest, rgba, .. } = shaded;
        for &k in in_order.iter().chain([&*dense, &*rest]).flatten() {
            self.opacity[k] = rgba[3][k];
            rgba.iter_mut().for_each(|column| column[k] = 1.0);
        }
    }

    /// Opacities of a batch after light; 0 where they are not known yet.
    pub fn opacities(&mut self, shaded: &Shaded) -> &Column {
        let Shaded { in_order, dense, rest, rgba, .. } = shaded;
        let known = &mut self.opacities;
        known.copy_from_slice(&**rgba[3]);
        for &k in in_order.iter().chain([dense]).flatten() {
            known[k] *= self.opacity[k];
        }
        rest.iter().for_each(|&k| known[k] = 0.0);
        known
    }

    /// Takes those of a batch that wait, once the lists have them.
    pub fn take(
        &mut self,
        frame: &Frame<'_>,
        batch: &Batch,
        shaded: &Shaded,
        lists: &mut Lists,
        later: &mut Later,
    ) {
        for &k in &shaded.dense {
            let [light, .., opacity] = [0, 1, 2, 3].map(|c: usize| shaded.rgba[c][k]);
            lists.set(lists.places[k], later.keep_one(batch, k, light, opacity * self.opacity[k]));
        }
        for (number, which) in shaded.in_order.iter().chain([&shaded.rest]).enumerate() {
            for &k in which {
                let queue = &mut self.queues[number];
                let to = queue.count;
                queue.batch.length[to] = batch.length[k];
                for a in 0..queue.batch.scalar_count {
                    queue.batch.front[a][to] = batch.front[a][k];
                    queue.batch.back[a][to] = batch.back[a][k];
                }
                queue.place[to] = lists.places[k];
                queue.opacity[to] = self.opacity[k];
                queue.light[0][to] = shaded.rgba[0][k];
                queue.light[1][to] = shaded.rgba[3][k];
                queue.count += 1;
                if queue.count == BATCH {
                    self.serve(number, frame, lists, later);
                }
            }
        }
    }

    /// Serves all who wait.
    pub fn finish(&mut self, frame: &Frame<'_>, lists: &mut Lists, later: &mut Later) {
        for number in 0..self.queues.len() {
            self.serve(number, frame, lists, later);
        }
    }

    fn serve(&mut self, number: usize, frame: &Frame<'_>, lists: &mut Lists, later: &mut Later) {
        let Pool { queues, shaded, .. } = self;
        let queue = &mut queues[number];
        let count = std::mem::take(&mut queue.count);
        if count == 0 {
            return;
        }
        shaded.in_order.iter_mut().chain([&mut shaded.rest]).for_each(Vec::clear);
        shaded.in_order.get_mut(number).unwrap_or(&mut shaded.rest).extend(0..count);
        shaded.rgba[3].copy_from_slice(&**queue.opacity);
        later.begin();
        finish(frame.shader, frame.lanes, &queue.batch, shaded, Some(later));
        let [color, opacity] = &queue.light;
        for (column, light) in shaded.rgba.iter_mut().zip([color, color, color, opacity]) {
            column.iter_mut().zip(light.iter()).take(count).for_each(|(value, light)| *value *= light);
        }
        later.mark(&mut shaded.rgba);
        let [r, g, b, a] = &shaded.rgba;
        for (k, &place) in queue.place.iter().enumerate().take(count) {
            lists.set(place, [r[k], g[k], b[k], a[k]]);
        }
    }
}
