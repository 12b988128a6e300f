//! Unbounded lists, for pixels with more segments than the fixed lists hold: sorted one pixel at a time.

use crate::composite::fragment_lists::is_behind;
use crate::tile::TILE;

/// A shaded segment.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Fragment {
    /// Premultiplied colour and opacity.
    pub rgba: [f32; 4],
    /// Depth of the entry.
    pub entry: f32,
    /// Depth of the exit.
    pub exit: f32,
}

impl Fragment {
    pub fn new(entry: f32, exit: f32, rgba: [f32; 4]) -> Fragment {
        Fragment { rgba, entry, exit }
    }

    /// True if this segment comes behind the other: [`is_behind`].
    fn is_behind(&self, other: &Fragment) -> bool {
        is_behind([self.entry, self.exit], [other.entry, other.exit])
    }
}

/// Fragment lists of one row of pixels.
#[derive(Default)]
pub(crate) struct UnboundedFragmentLists {
    pixels: [Vec<Fragment>; TILE],
    /// Transmittance of each pixel.
    pub transmittance: [f64; TILE],
}

impl UnboundedFragmentLists {
    pub fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
    }

    pub fn push(&mut self, column: usize, fragment: Fragment) {
        self.pixels[column].push(fragment);
    }

    /// Composites the row; returns the pixels whose segments were not in order.
    pub fn composite(&mut self, sorted: bool, out: &mut [[f32; 4]]) -> u64 {
        let mut disordered = 0;
        for ((fragments, transmittance), out) in self.pixels.iter_mut().zip(&mut self.transmittance).zip(out)
        {
            if sorted {
                fragments.sort_by(|a, b| a.entry.total_cmp(&b.entry).then_with(|| a.exit.total_cmp(&b.exit)));
                for k in 1..fragments.len() {
                    let mut to = k;
                    while to > 0 && fragments[to - 1].is_behind(&fragments[to]) {
                        fragments.swap(to - 1, to);
                        to -= 1;
                    }
                }
            } else {
                disordered += u64::from(!fragments.is_sorted_by(|a, b| a.entry <= b.entry));
            }
            // Thousands of fragments: 64-bit sums.
            let (mut color, mut through) = ([0f64; 3], 1f64);
            for fragment in fragments.iter() {
                for (sum, c) in color.iter_mut().zip(fragment.rgba) {
                    *sum += through * f64::from(c);
                }
                through *= 1.0 - f64::from(fragment.rgba[3]);
            }
            *transmittance = through;
            *out = [color[0] as f32, color[1] as f32, color[2] as f32, (1.0 - through) as f32];
        }
        disordered
    }
}
