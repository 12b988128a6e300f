//! Filters that ship keep what is known of them; filters that are wrong in one way are found wrong in that way alone.

use super::*;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::field::{Gradient, GradientFilter, LeastSquares, QuadraticFit, VolumeWeighted};
use voltet_core::grid::Grid;
use voltet_core::parameters::{Parameters, VariantSchema};
use voltet_core::progress::NoProgress;

fn quick() -> TestOptions {
    TestOptions { levels: vec![6, 12], timed: 4, rounds: 1, ..TestOptions::default() }
}

fn test_of(filter: impl GradientFilter + 'static) -> GradientTest {
    let method = Method::with_defaults(Arc::new(filter)).expect("has no parameters");
    gradient_test(&[method], &quick(), &NoProgress).expect("is measured")
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
    let test = gradient_test(&methods, &quick(), &NoProgress).expect("is measured");
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
