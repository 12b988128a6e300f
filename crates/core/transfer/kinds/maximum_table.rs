//! Upper bounds of an image's alpha over boxes of the (s, g) plane.

use super::properties::Table;

/// Largest alpha over blocks of texels, halved in size from level to level, so that any box of the plane is
/// covered by at most nine blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct MaximumTable {
    s: [f64; 2],
    g: [f64; 2],
    levels: Vec<(usize, usize, Vec<f32>)>,
}

impl MaximumTable {
    /// Builds all levels.
    pub fn new(table: &Table) -> Self {
        let mut level = (table.width, table.height, table.texels.iter().map(|t| t[3]).collect::<Vec<_>>());
        let mut levels = vec![level.clone()];
        while level.0 > 1 || level.1 > 1 {
            let (width, height) = (level.0.div_ceil(2), level.1.div_ceil(2));
            let mut half = vec![0.0_f32; width * height];
            for j in 0..level.1 {
                for i in 0..level.0 {
                    let block = &mut half[j / 2 * width + i / 2];
                    *block = block.max(level.2[j * level.0 + i]);
                }
            }
            level = (width, height, half);
            levels.push(level.clone());
        }
        MaximumTable { s: table.s, g: table.g, levels }
    }

    /// The largest alpha that can occur for s and g in these ranges.
    pub fn bound(&self, s: (f64, f64), g: (f64, f64)) -> f64 {
        if s.1 < self.s[0] || s.0 > self.s[1] || g.1 < self.g[0] || g.0 > self.g[1] {
            return 0.0;
        }
        let (width, height, _) = self.levels[0];
        // Texels whose bilinear reach meets the box; the cast saturates.
        let span = |low: f64, high: f64, from: f64, to: f64, count: usize| {
            let texel = |x: f64| (x - from) / (to - from) * count as f64 - 0.5;
            let first = (texel(low) - 1e-9).floor().max(0.0) as usize;
            let last = (texel(high) + 1e-9).ceil().max(0.0) as usize;
            (first.min(count - 1), last.min(count - 1))
        };
        let (i0, i1) = span(s.0, s.1, self.s[0], self.s[1], width);
        // Row 0 is at the largest g.
        let (j0, j1) = span(g.1, g.0, self.g[1], self.g[0], height);
        let shift = (i1 - i0).max(j1 - j0).checked_ilog2().unwrap_or(0) as usize;
        let shift = shift.min(self.levels.len() - 1);
        let (width, _, blocks) = &self.levels[shift];
        let mut most = 0.0_f32;
        for j in j0 >> shift..=j1 >> shift {
            for i in i0 >> shift..=i1 >> shift {
                most = most.max(blocks[j * width + i]);
            }
        }
        f64::from(most)
    }
}
