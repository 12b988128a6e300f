//! Filters that ship keep what is known of them; filters that are wrong in one way are found wrong in that way alone.

use super::manufactured::Meshed;
use super::*;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::field::{Gradient, GradientFilter, LeastSquares, QuadraticFit, VolumeWeighted};
use voltet_core::grid::{Grid, cells_of_faces, cells_of_points, points_of_points};
use voltet_core::parameters::{Parameters, VariantSchema};
use voltet_core::progress::NoProgress;

fn quick() -> TestOptions {
    TestOptions { levels: vec![6, 12], timed: 4, rounds: 1, ..TestOptions::default() }
}

fn test_of(filter: impl GradientFilter + 'static) -> GradientTest {
    let method = Method::with_defaults(Arc::new(filter)).expect("has no parameters");
    gradient_test(&[method], &quick(), None, &NoProgress).expect("is measured")
}

/// Requirements that hold: finite, linear, order, invariance.
fn held(test: &GradientTest) -> Vec<bool> {
    test.requirements.iter().map(|requirement| requirement.holds).collect()
}

/// Change of the vectors of a grid and its scalar.
type Change = fn(&Grid, &[f64], Vec<DVec3>) -> Result<Vec<DVec3>>;

/// Least squares, its vectors changed.
struct Changed(Change);

impl GradientFilter for Changed {
    fn declaration(&self) -> VariantSchema {
        VariantSchema { name: "changed", summary: "Least squares with a mistake.", parameters: &[] }
    }

    fn gradient(&self, grid: &Grid, s: &[f64], p: &Parameters, progress: &dyn Progress) -> Result<Gradient> {
        let gradient = LeastSquares.gradient(grid, s, p, progress)?;
        Ok(Gradient { vectors: (self.0)(grid, s, gradient.vectors)?, ..gradient })
    }
}

#[test]
fn filters_that_ship_keep_their_orders() {
    let quadratic = test_of(QuadraticFit);
    assert!(quadratic.passed(), "{}", text(&quadratic));
    let least = quadratic.filters[0].convergence.iter().filter_map(|one| one.inside.order);
    assert!(least.fold(f64::INFINITY, f64::min) > 1.5, "{}", text(&quadratic));
    assert!(quadratic.filters[0].exactness.iter().all(|one| one.quadratic_boundary < 1e-12));
    let mean = test_of(VolumeWeighted);
    assert!(mean.passed(), "{}", text(&mean));
    let boundary: Vec<f64> =
        mean.filters[0].convergence.iter().filter_map(|one| one.boundary.order).collect();
    assert!(boundary.len() == 8 && boundary.iter().all(|order| (0.6..1.4).contains(order)), "{boundary:?}");
    assert!(mean.filters[0].exactness.iter().all(|one| one.quadratic_boundary > 1e-3));
}

#[test]
fn a_vector_that_is_too_long_is_neither_exact_nor_convergent() {
    let test = test_of(Changed(|_, _, vectors| Ok(vectors.into_iter().map(|v| v * 1.5).collect())));
    assert_eq!(held(&test), [true, false, false, true], "{}", text(&test));
    let off = test.filters[0].exactness[0].linear;
    assert!((off - 0.5).abs() < 1e-6, "{off}");
}

#[test]
fn errors_on_the_boundary_alone_are_a_warning_or_a_requirement() {
    let halved: Change = |grid, _, mut vectors| {
        let outer = |(face, other): (usize, u32)| (other == u32::MAX).then_some(face);
        let mut at_boundary = vec![false; vectors.len()];
        for face in cells_of_faces(grid).into_iter().enumerate().filter_map(outer) {
            let corners = grid.tetrahedra[face / 4].into_iter().enumerate().filter(|(i, _)| *i != face % 4);
            corners.for_each(|(_, p)| at_boundary[p as usize] = true);
        }
        vectors.iter_mut().zip(at_boundary).filter(|(_, at)| *at).for_each(|(v, _)| *v *= 0.3);
        Ok(vectors)
    };
    let test = test_of(Changed(halved));
    let [warning] = &test.warnings[..] else { panic!("{}", text(&test)) };
    assert!(warning.what.contains("converges on the boundary") && !warning.holds);
    assert!(text(&test).contains("WARNING it does not hold: converges on the boundary"), "{}", text(&test));
    // Held to, it is no warning any more.
    let method = Method::with_defaults(Arc::new(Changed(halved))).expect("has no parameters");
    let strict = TestOptions { hold_to: vec![RequirementKind::Boundary], ..quick() };
    let held = gradient_test(&[method], &strict, None, &NoProgress).expect("is measured");
    assert!(held.warnings.is_empty() && !held.passed(), "{}", text(&held));
    assert!(test_of(QuadraticFit).warnings.is_empty() && test_of(LeastSquares).warnings.is_empty());
}

#[test]
fn what_is_wrong_on_large_grids_or_between_coincident_points_is_not_exact() {
    let large: Change = |grid, _, vectors| {
        let factor = if grid.points.len() == 14 * 14 * 14 { 1.5 } else { 1.0 };
        Ok(vectors.into_iter().map(|v| v * factor).collect())
    };
    let method = Method::with_defaults(Arc::new(Changed(large))).expect("has no parameters");
    let wish = TestOptions { timed: 13, ..quick() };
    let test = gradient_test(&[method], &wish, None, &NoProgress).expect("is measured");
    assert_eq!(held(&test), [true, false, true, true], "{}", text(&test));
    assert!(test.requirements[1].found.contains("5.0e-1 on the timed grid"), "{}", text(&test));
    // Weights by the distance.
    let twins: Change = |grid, s, mut vectors| {
        let cells = cells_of_points(grid);
        let neighbours = points_of_points(grid, &cells);
        for p in 0..vectors.len() {
            for &q in neighbours.row(p) {
                let d = grid.points[q as usize] - grid.points[p];
                let off = s[q as usize] - s[p] - vectors[p].dot(d);
                vectors[p] += d * off * 1e-30 / d.length_squared();
            }
        }
        Ok(vectors)
    };
    let test = test_of(Changed(twins));
    assert_eq!(held(&test), [false, true, true, true], "{}", text(&test));
    assert!(test.requirements[0].found.contains("coincident grid"), "{}", text(&test));
}

#[test]
fn a_grid_of_the_users_own_is_measured_too() {
    let Meshed { mut grid, .. } = Mesh::Coincident.grid(5);
    // Far from the unit cube, and with a point that no cell uses.
    let mut points: Vec<DVec3> = grid.points.iter().map(|p| *p * 3000.0 + 50.0).collect();
    points.push(DVec3::NAN);
    grid.points = points.into();
    let methods =
        |filter: Arc<dyn GradientFilter>| [Method::with_defaults(filter).expect("has no parameters")];
    let test = gradient_test(&methods(Arc::new(LeastSquares)), &quick(), Some(&grid), &NoProgress);
    let test = test.expect("is measured");
    assert!(test.passed(), "{}", text(&test));
    let data = test.filters[0].data.as_ref().expect("is measured");
    assert!(data.coincident_pairs == 36 && data.linear < 1e-12, "{data:?}");
    assert!(
        text(&test).contains("253 points, and 36 pairs of neighbours at the same position"),
        "{}",
        text(&test)
    );
    let count: Change = |grid, _, vectors| {
        let factor = if grid.points.len() == 7 * 6 * 6 + 1 { 1.1 } else { 1.0 };
        Ok(vectors.into_iter().map(|v| v * factor).collect())
    };
    let test = gradient_test(&methods(Arc::new(Changed(count))), &quick(), Some(&grid), &NoProgress);
    let test = test.expect("is measured");
    assert!(test.requirements[1].found.contains("1.0e-1 on the given grid"), "{}", text(&test));
}

#[test]
fn what_looks_at_numbers_or_places_is_found() {
    // By the number of the point, by the place, and by the scalar's own size.
    let mistakes: [(&str, Change); 3] = [
        ("numbering", |_, _, mut vectors| {
            let first = vectors[0];
            vectors[1] = vectors[1].lerp(first, 1e-3);
            Ok(vectors)
        }),
        ("translation", |grid, _, vectors| {
            let off = |p: &DVec3| if p.length() > 100.0 { 1.001 } else { 1.0 };
            Ok(vectors.into_iter().zip(grid.points.iter()).map(|(v, p)| v * off(p)).collect())
        }),
        ("a constant added", |_, s, vectors| {
            Ok(vectors.into_iter().zip(s).map(|(v, s)| if *s > 100.0 { v * 0.999 } else { v }).collect())
        }),
    ];
    for (under, mistake) in mistakes {
        let test = test_of(Changed(mistake));
        let broken = test.filters[0].invariance.iter().filter(|one| one.difference > one.rounding);
        let names: Vec<&str> = broken.map(|one| one.under).collect();
        assert!(names.contains(&under), "{under}: {names:?}");
        assert!(!held(&test)[3] && !test.passed(), "{}", text(&test));
    }
}

#[test]
fn a_filter_that_fails_is_what_is_found() {
    let refuses = test_of(Changed(|grid, _, vectors| match grid.points.len() {
        0..300 => Ok(vectors),
        count => Err(Error::run("too many points for me").got(count)),
    }));
    assert_eq!(held(&refuses), [false, false, false, false], "{}", text(&refuses));
    let said = text(&refuses);
    assert!(said.contains("too many points for me") && said.contains("BROKEN"), "{said}");
    let empty = test_of(Changed(|_, _, mut vectors| {
        vectors[0].x = f64::NAN;
        Ok(vectors)
    }));
    assert!(!held(&empty)[0] && text(&empty).contains("not finite"), "{}", text(&empty));
    // Nor is anything of it shown as if it were measured.
    assert!(empty.filters[0].cost.is_none() && empty.filters[0].picture.is_none());
}

#[test]
fn tables_plot_and_page_name_every_filter() {
    let methods: Vec<Method> = [Arc::new(LeastSquares) as Arc<dyn GradientFilter>, Arc::new(VolumeWeighted)]
        .map(|filter| Method::with_defaults(filter).expect("has no parameters"))
        .to_vec();
    let test = gradient_test(&methods, &quick(), None, &NoProgress).expect("is measured");
    let (svg, table) = (plot(&test).svg(), text(&test));
    let page = page(&test, &svg);
    for name in ["least-squares", "volume-weighted"] {
        assert!(table.contains(name) && svg.contains(name) && page.contains(name), "{name}");
    }
    // The picture with the exact gradient and one of each.
    assert_eq!(page.matches("<img ").count(), 3);
    let wrong = test.filters[0].picture.as_ref().map(|picture| picture.maximum);
    assert!(wrong.is_some_and(|wrong| (1e-3..0.5).contains(&wrong)), "{wrong:?}");
}
