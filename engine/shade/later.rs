//! Segments whose colour waits until it is known whether anybody sees them.
//!
//! The order of widgets takes many steps where they are dense, and dense segments hide what lies behind them. Their opacity is
//! known in closed form; so they are put in order first, and only those that are seen get a colour: in lanes
//! ([`voltet_lanes::optics::dense`]), or in 64 bits where these do not serve.

use crate::fragments::batch::{BATCH, Batch};
use crate::shade::roads::dense;
use crate::shade::shaded::{Colors, Left, Shaded};
use crate::shade::shader::Shader;
use voltet_lanes::LaneSet;

/// What is known of them: lengths and values at both ends.
pub(crate) struct Later {
    numbers: Vec<f32>,
    /// Numbers of one.
    stride: usize,
    /// Places in the batch in hand, in the order in which they were kept.
    kept: Vec<usize>,
    /// Those that are seen, gathered anew, and what comes out.
    batch: Batch,
    shaded: Shaded,
}

/// Stands for blue where a colour waits: none is negative.
const WAITS: f32 = -1.0;

/// A segment in a list that is seen and waits for its colour.
pub(crate) struct Mark {
    /// Where it stands.
    pub place: u32,
    /// Its number, and what light makes of white; then its colour.
    pub color: [f32; 3],
}

impl Mark {
    /// `None` where a colour is no mark.
    pub fn new(rgba: [f32; 4], place: u32) -> Option<Mark> {
        let [light, number, waits, _] = rgba;
        (waits == WAITS).then_some(Mark { place, color: [light, number, 0.0] })
    }
}

impl Later {
    pub fn new(scalar_count: usize) -> Later {
        Later {
            numbers: Vec::new(),
            stride: 1 + 2 * scalar_count,
            kept: Vec::new(),
            batch: Batch::new(scalar_count, scalar_count),
            shaded: Shaded::new(),
        }
    }

    /// Nothing waits.
    pub fn clear(&mut self) {
        self.numbers.clear();
        self.kept.clear();
    }

    /// Nothing of the next batch waits yet.
    pub fn begin(&mut self) {
        self.kept.clear();
    }

    /// Segments that 64 bits served.
    pub fn exact_count(&self) -> u64 {
        self.shaded.exact_count
    }

    /// How often the transfer function was asked for them: see [`voltet_core::engine::Counts::evaluations`].
    pub fn evaluation_count(&self) -> u64 {
        self.shaded.evaluation_count
    }

    /// Whether no colour waits.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Keeps those of the segments that lanes left over whose opacity `shaded` holds. Until they are marked they are white.
    pub fn keep(&mut self, batch: &Batch, shaded: &mut Shaded) {
        let Shaded { rest, why, rgba, .. } = shaded;
        let mut reasons = why.iter();
        rest.retain(|&k| {
            let waits = reasons.next().is_some_and(|why| *why == Left::Dense || *why == Left::Delicate);
            if waits {
                self.kept.push(k);
                write_down(&mut self.numbers, batch, k);
                rgba[..3].iter_mut().for_each(|column| column[k] = 1.0);
            }
            !waits
        });
        why.clear();
    }

    /// Keeps one more segment; what stands for it in its list. `light`: what light makes of white, `opacity`: its own, lit.
    pub fn keep_one(&mut self, batch: &Batch, k: usize, light: f32, opacity: f32) -> [f32; 4] {
        let number = self.numbers.len() / self.stride;
        write_down(&mut self.numbers, batch, k);
        [light, f32::from_bits(number as u32), WAITS, opacity]
    }

    /// Puts their numbers where colours will stand: red is then what light makes of white.
    pub fn mark(&self, rgba: &mut Colors) {
        let count = self.numbers.len() / self.stride;
        for (number, &k) in (count - self.kept.len()..).zip(&self.kept) {
            rgba[1][k] = f32::from_bits(number as u32);
            rgba[2][k] = WAITS;
        }
    }

    /// Gives marks their colours.
    pub fn color(&mut self, shader: &Shader, lanes: LaneSet, marks: &mut [Mark]) {
        let Later { numbers, stride, batch, shaded, .. } = self;
        for marks in marks.chunks_mut(BATCH) {
            for (k, mark) in marks.iter().enumerate() {
                let of_one = &numbers[mark.color[1].to_bits() as usize * *stride..][..*stride];
                let (front, back) = of_one[1..].split_at(*stride / 2);
                batch.length[k] = of_one[0];
                for (columns, values) in [(&mut batch.front, front), (&mut batch.back, back)] {
                    columns.iter_mut().zip(values).for_each(|(column, value)| column[k] = *value);
                }
            }
            shaded.rest.clear();
            shaded.rest.extend(0..marks.len());
            dense(shader, lanes, batch, shaded);
            for (k, mark) in marks.iter_mut().enumerate() {
                let light = mark.color[0];
                for (value, column) in mark.color.iter_mut().zip(&shaded.rgba) {
                    *value = column[k] * light;
                }
            }
        }
    }
}

fn write_down(numbers: &mut Vec<f32>, batch: &Batch, k: usize) {
    numbers.push(batch.length[k]);
    for columns in [&batch.front, &batch.back] {
        numbers.extend(columns[..batch.scalar_count].iter().map(|column| column[k]));
    }
}
