//! Pareto front: settings that no other one beats in cost and error.

/// For each point (cost, error) whether it is on the Pareto front: no other one is at most as dear and at most as
/// wrong, and in one of the two less. Numbers that are not finite are never on it.
pub fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    let sound = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    points.iter().map(|p| sound(p) && !points.iter().any(|other| sound(other) && beats(other, p))).collect()
}

/// The cheapest point whose error is at most `bound`; of equally dear ones the best.
pub fn cheapest(points: &[[f64; 2]], bound: f64) -> Option<usize> {
    let fits = (0..points.len()).filter(|&i| points[i][1] <= bound && points[i][0].is_finite());
    fits.min_by(|&a, &b| {
        let by = |k: usize| points[a][k].total_cmp(&points[b][k]);
        by(0).then(by(1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 2]; 7] = [
        [1.0, 0.5],
        // As dear as the first, and worse.
        [1.0, 0.6],
        [2.0, 0.1],
        // Dearer and worse than the third.
        [3.0, 0.2],
        // Dearer and no better than the third.
        [4.0, 0.1],
        [8.0, 0.0],
        [0.5, f64::INFINITY],
    ];

    #[test]
    fn the_front_holds_what_nothing_beats() {
        assert_eq!(front(&POINTS), [true, false, true, false, false, true, false]);
        // Twins do not beat each other.
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0]]), [true, true]);
    }

    #[test]
    fn the_cheapest_under_a_bound_is_taken_with_the_bound_included() {
        assert_eq!(cheapest(&POINTS, 0.5), Some(0));
        assert_eq!(cheapest(&POINTS, 0.2), Some(2));
        assert_eq!(cheapest(&POINTS, 0.05), Some(5));
        assert_eq!(cheapest(&POINTS[..5], 0.05), None);
    }
}
