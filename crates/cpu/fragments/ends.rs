//! Rays that end within the grid: at opaque surfaces that others draw.

use crate::fragments::batch::Batch;
use crate::project::record::TILE;

/// Where the rays of a tile's pixels end: depth from the distance origin, scene lengths; infinite where nothing ends them.
pub(crate) type Ends = [f32; TILE * TILE];

/// Cuts the first `count` segments of a batch at the ends of their rays. Along a ray depths and attributes are linear, so a share of
/// the one is a share of the other.
pub(crate) fn cut(batch: &mut Batch, count: usize, attribute_count: usize, ends: &Ends) {
    for k in 0..count {
        let end = ends[batch.pixel[k] as usize % (TILE * TILE)];
        let (entry, exit) = (batch.entry[k], batch.exit[k]);
        if exit <= end {
            continue;
        }
        let share = ((end - entry) / (exit - entry)).max(0.0);
        batch.length[k] *= share;
        batch.exit[k] = end;
        for a in 0..attribute_count {
            let front = batch.front[a][k];
            batch.back[a][k] = front + share * (batch.back[a][k] - front);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_ends_where_its_ray_does_and_keeps_what_it_is_before() {
        let mut batch = Batch::new(1, 1);
        let mut ends = [f32::INFINITY; TILE * TILE];
        ends[7] = 2.5;
        for (k, (pixel, entry, exit)) in
            [(7, 2.0, 3.0), (7, 3.0, 4.0), (7, 1.0, 2.0), (8, 2.0, 3.0)].into_iter().enumerate()
        {
            (batch.pixel[k], batch.entry[k], batch.exit[k]) = (pixel, entry, exit);
            (batch.length[k], batch.front[0][k], batch.back[0][k]) = (1.5, 10.0, 20.0);
        }
        cut(&mut batch, 4, 1, &ends);
        assert_eq!([0, 1, 2, 3].map(|k| batch.length[k]), [0.75, 0.0, 1.5, 1.5]);
        assert_eq!([0, 2, 3].map(|k| batch.back[0][k]), [15.0, 20.0, 20.0]);
        assert_eq!([0, 2, 3].map(|k| batch.exit[k]), [2.5, 2.0, 3.0]);
    }
}
