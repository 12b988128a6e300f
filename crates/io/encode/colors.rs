//! Colours for numbers.

use super::linear_from_srgb;

/// Five colours of the map viridis (Smith and van der Walt 2015), 8-bit sRGB, from its low end to its high end.
const VIRIDIS: [[u8; 3]; 5] = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

/// The colour of a level from 0 (dark violet) to 1 (yellow), straight between the colours of the map; linear, opaque.
pub fn viridis(level: f32) -> [f32; 4] {
    let place = level * (VIRIDIS.len() - 1) as f32;
    let first = (place as usize).min(VIRIDIS.len() - 2);
    let t = place - first as f32;
    let channel = |k: usize| {
        let (a, b) = (f32::from(VIRIDIS[first][k]), f32::from(VIRIDIS[first + 1][k]));
        linear_from_srgb((a + (b - a) * t) / 255.0)
    };
    [channel(0), channel(1), channel(2), 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_and_the_middle_are_the_maps() {
        for (level, srgb) in [(0.0, VIRIDIS[0]), (0.5, VIRIDIS[2]), (1.0, VIRIDIS[4])] {
            let color = viridis(level);
            assert_eq!(color[3], 1.0);
            for k in 0..3 {
                assert_eq!((super::super::srgb_from_linear(color[k]) * 255.0).round() as u8, srgb[k]);
            }
        }
    }
}
