//! Segments whose colour waits until it is known whether anybody sees them.
//!
//! What lanes leave over because it is dense costs a hundred times as much in 64 bits, and dense segments hide what lies behind
//! them. Their opacity is known in closed form; so they are put in order first, and only those that are seen get a colour.

use crate::fragments::batch::Batch;
use crate::shade::shaded::{Colors, Left, Shaded};
use crate::shade::shader::Shader;

/// What is known of them: lengths and values at both ends.
#[derive(Default)]
pub(crate) struct Later {
    numbers: Vec<f32>,
    /// Numbers of one.
    stride: usize,
    /// Places in the batch in hand, in the order in which they were kept.
    batch: Vec<usize>,
}

/// Stands for blue where a colour waits: none is negative.
const WAITS: f32 = -1.0;

impl Later {
    /// Nothing waits.
    pub fn clear(&mut self) {
        self.numbers.clear();
        self.batch.clear();
    }

    /// Nothing of the next batch waits yet.
    pub fn begin(&mut self) {
        self.batch.clear();
    }

    /// Whether no colour waits.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Keeps those of the segments that lanes left over whose opacity `shaded` holds. Until they are marked they are white.
    pub fn keep(&mut self, batch: &Batch, shaded: &mut Shaded) {
        let Shaded { rest, why, rgba, .. } = shaded;
        self.stride = 1 + 2 * batch.scalar_count;
        let mut reasons = why.iter();
        rest.retain(|&k| {
            let waits = reasons.next().is_some_and(|why| *why == Left::Dense || *why == Left::Delicate);
            if waits {
                self.batch.push(k);
                self.numbers.push(batch.length[k]);
                for columns in [&batch.front, &batch.back] {
                    self.numbers.extend(columns[..batch.scalar_count].iter().map(|column| column[k]));
                }
                rgba[..3].iter_mut().for_each(|column| column[k] = 1.0);
            }
            !waits
        });
        why.clear();
    }

    /// Puts their numbers where colours will stand: red is then what light makes of white.
    pub fn mark(&self, rgba: &mut Colors) {
        let count = self.numbers.len() / self.stride.max(1);
        for (number, &k) in (count - self.batch.len()..).zip(&self.batch) {
            rgba[1][k] = f32::from_bits(number as u32);
            rgba[2][k] = WAITS;
        }
    }

    /// The colour that a mark stands for; `None` where a colour is no mark.
    pub fn color(&self, shader: &Shader, [light, number, waits, _]: [f32; 4]) -> Option<[f32; 3]> {
        if waits != WAITS {
            return None;
        }
        let numbers = &self.numbers[number.to_bits() as usize * self.stride..][..self.stride];
        let (front, back) = numbers[1..].split_at(self.stride / 2);
        let rgba = shader.integrate_stored(numbers[0], front, back, false).rgba;
        Some([rgba[0] * light, rgba[1] * light, rgba[2] * light])
    }
}
