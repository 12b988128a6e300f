//! Depth limits: rays that end within the grid, at opaque surfaces of another renderer.

use crate::fragments::batch::Batch;
use crate::tile::PIXELS;

/// Depth at which the ray of each of a tile's pixels ends (scene lengths from the distance origin); infinite where nothing ends it.
pub(crate) type DepthLimits = [f32; PIXELS];

/// Clips the first `count` segments of a batch at the depth limits of their rays. Along a ray depths and attributes are linear, so a
/// fraction of the one is a fraction of the other.
pub(crate) fn clip_to_depth(batch: &mut Batch, count: usize, attribute_count: usize, limits: &DepthLimits) {
    for k in 0..count {
        let limit = limits[batch.pixel[k] as usize % PIXELS];
        let (entry, exit) = (batch.entry[k], batch.exit[k]);
        if exit <= limit {
            continue;
        }
        let fraction = ((limit - entry) / (exit - entry)).max(0.0);
        batch.length[k] *= fraction;
        batch.exit[k] = limit;
        for a in 0..attribute_count {
            let front = batch.front[a][k];
            batch.back[a][k] = front + fraction * (batch.back[a][k] - front);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_ends_where_its_ray_does_and_keeps_what_it_is_before() {
        let mut batch = Batch::new(1, 1);
        let mut limits = [f32::INFINITY; PIXELS];
        limits[7] = 2.5;
        for (k, (pixel, entry, exit)) in
            [(7, 2.0, 3.0), (7, 3.0, 4.0), (7, 1.0, 2.0), (8, 2.0, 3.0)].into_iter().enumerate()
        {
            (batch.pixel[k], batch.entry[k], batch.exit[k]) = (pixel, entry, exit);
            (batch.length[k], batch.front[0][k], batch.back[0][k]) = (1.5, 10.0, 20.0);
        }
        clip_to_depth(&mut batch, 4, 1, &limits);
        assert_eq!([0, 1, 2, 3].map(|k| batch.length[k]), [0.75, 0.0, 1.5, 1.5]);
        assert_eq!([0, 2, 3].map(|k| batch.back[0][k]), [15.0, 20.0, 20.0]);
        assert_eq!([0, 2, 3].map(|k| batch.exit[k]), [2.5, 2.0, 3.0]);
    }
}
