//! Results of a filter are checked, whoever wrote it.

use super::*;

/// Gives one vector for all points, or another number of them.
struct Constant {
    vector: DVec3,
    /// The vector at the first point.
    first: DVec3,
    too_many: usize,
}

impl GradientFilter for Constant {
    fn declaration(&self) -> VariantSchema {
        VariantSchema { name: "constant", summary: "The same everywhere.", parameters: &[] }
    }

    fn gradient_at(
        &self,
        _: &Grid,
        _: &[f64],
        points: &[u32],
        _: &Parameters,
        _: &dyn Progress,
    ) -> Option<Result<Gradient>> {
        let mut vectors = vec![self.vector; points.len() + self.too_many];
        vectors[0] = self.first;
        Some(Ok(Gradient { vectors, fallbacks: Vec::new() }))
    }

    fn gradient(&self, grid: &Grid, _: &[f64], _: &Parameters, _: &dyn Progress) -> Result<Gradient> {
        let mut vectors = vec![self.vector; grid.points.len() + self.too_many];
        vectors[0] = self.first;
        Ok(Gradient { vectors, fallbacks: Vec::new() })
    }
}

/// Gradients at some points are checked alike, and the point is named, not its index in the list.
#[test]
fn what_is_given_at_some_points_is_checked_too() {
    let grid = box_of_tetrahedra([5, 5, 5], UNIT, 0.0);
    let (points, values) = ([40, 30, 20], vec![7.0; grid.points.len()]);
    let run = |vector: DVec3, too_many: usize| {
        let filter = Constant { vector, first: DVec3::X, too_many };
        Method::with_defaults(Arc::new(filter))
            .unwrap()
            .gradient_at(&grid, &values, &points, &NoProgress)
            .unwrap()
    };
    assert_eq!(run(DVec3::Y, 0).unwrap().vectors, [DVec3::X, DVec3::Y, DVec3::Y]);
    let message = run(DVec3::Y, 1).unwrap_err().to_string();
    assert!(message.contains("found 4 vectors; expected 3"), "{message}");
    let message = run(DVec3::NAN, 0).unwrap_err().to_string();
    assert!(message.contains("not finite") && message.contains("at point 30, which lies at"), "{message}");
}

/// Runs it on a grid of 4000 points of which the first belongs to no cell.
fn run(filter: Constant, scalar: f64) -> Result<Gradient> {
    let box_of_cells = box_of_tetrahedra([20, 10, 17], UNIT, 0.0);
    let points = [DVec3::ONE].into_iter().chain(box_of_cells.points.iter().copied()).collect();
    let tetrahedra = box_of_cells.tetrahedra.iter().map(|cell| cell.map(|p| p + 1)).collect();
    let grid = grid_of(points, tetrahedra);
    let values = vec![scalar; grid.points.len()];
    Method::with_defaults(Arc::new(filter)).unwrap().gradient(&grid, &values, &NoProgress)
}

#[test]
fn another_number_of_vectors_than_points_is_refused() {
    let filter = Constant { vector: DVec3::X, first: DVec3::X, too_many: 1 };
    let message = run(filter, 0.0).unwrap_err().to_string();
    assert!(message.contains("'constant' did not give one vector a point"), "{message}");
    assert!(message.contains("found 4160 vectors; expected 4159"), "{message}");
}

#[test]
fn the_first_vector_that_is_not_finite_is_named_unless_no_cell_uses_its_point_or_the_value_is_not_finite() {
    let bad = [DVec3::new(f64::NAN, 0.0, 1.0), DVec3::new(0.0, f64::INFINITY, 0.0), DVec3::splat(1.5e308)];
    for vector in bad {
        let message = run(Constant { vector, first: DVec3::X, too_many: 0 }, 7.0).unwrap_err().to_string();
        let place = "at point 1, which lies at (0, 0, 0) and has the value 7";
        assert!(message.contains("'constant' gave a vector that is not finite"), "{message}");
        assert!(message.contains(place), "{message}");
        assert!(run(Constant { vector, first: DVec3::X, too_many: 0 }, f64::NAN).is_ok());
        assert!(run(Constant { vector: DVec3::X, first: vector, too_many: 0 }, 7.0).is_ok());
    }
}
