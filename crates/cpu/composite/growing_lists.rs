//! Pixels with more segments than the fixed lists hold: lists that grow, sorted one pixel at a time.

use crate::composite::lists::follows;
use crate::project::record::TILE;

/// What one segment contributes to its pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Layer {
    /// Premultiplied colour and opacity.
    pub rgba: [f32; 4],
    /// Depth of the entry.
    pub entry: f32,
    /// Depth of the exit.
    pub exit: f32,
}

impl Layer {
    pub fn new(entry: f32, exit: f32, rgba: [f32; 4]) -> Layer {
        Layer { rgba, entry, exit }
    }

    /// Whether this segment comes behind the other: [`follows`].
    fn follows(&self, other: &Layer) -> bool {
        follows([self.entry, self.exit], [other.entry, other.exit])
    }
}

/// Lists of one row of pixels.
#[derive(Default)]
pub(crate) struct GrowingLists {
    pixels: [Vec<Layer>; TILE],
    /// What is seen through each pixel.
    pub through: [f64; TILE],
}

impl GrowingLists {
    pub fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
    }

    pub fn push(&mut self, column: usize, layer: Layer) {
        self.pixels[column].push(layer);
    }

    /// Composites the row; returns the pixels whose segments were not in order.
    pub fn composite(&mut self, sorted: bool, out: &mut [[f32; 4]]) -> u64 {
        let mut disordered = 0;
        for ((layers, seen), out) in self.pixels.iter_mut().zip(&mut self.through).zip(out) {
            if sorted {
                layers.sort_by(|a, b| a.entry.total_cmp(&b.entry).then_with(|| a.exit.total_cmp(&b.exit)));
                for k in 1..layers.len() {
                    let mut to = k;
                    while to > 0 && layers[to - 1].follows(&layers[to]) {
                        layers.swap(to - 1, to);
                        to -= 1;
                    }
                }
            } else {
                disordered += u64::from(!layers.is_sorted_by(|a, b| a.entry <= b.entry));
            }
            // Thousands of layers: 64-bit sums.
            let (mut color, mut through) = ([0f64; 3], 1f64);
            for layer in layers.iter() {
                for (sum, c) in color.iter_mut().zip(layer.rgba) {
                    *sum += through * f64::from(c);
                }
                through *= 1.0 - f64::from(layer.rgba[3]);
            }
            *seen = through;
            *out = [color[0] as f32, color[1] as f32, color[2] as f32, (1.0 - through) as f32];
        }
        disordered
    }
}
