//! Gaussians over s and g.

use super::super::handles::Handle;
use super::super::numbers::{Change, array, list, rows};
use super::super::scale::Scale;
use super::super::shape::{PlaneContext, Shape};
use super::super::widget_painter::WidgetPainter;
use super::ellipse::Ellipse;
use voltet_graph::Field;

#[derive(Debug)]
pub(super) struct Gaussian(Ellipse);

impl Gaussian {
    pub fn new(centre: [f64; 2], matrix: &[[f64; 2]; 2], numbers: &[Field], on: &PlaneContext) -> Gaussian {
        // Deviations that are stated need no inverse.
        if let Some([s, g]) = array(numbers, "sigma") {
            return Gaussian(Ellipse { centre, axes: [[s, 0.0], [0.0, g]] });
        }
        let matrix = matrix.map(Vec::from);
        Gaussian(Ellipse::new(centre, &matrix, [Some(0), Some(1)], on.extent))
    }
}

impl Shape for Gaussian {
    fn handles(&self, _: &Scale) -> Vec<(Handle, [f64; 2])> {
        self.0.handles()
    }

    fn moved(&self, handle: Handle, to: [f64; 2], scale: &Scale) -> Vec<Change> {
        match self.0.stretched(handle, to, scale) {
            Some(after) => spread(after),
            None => vec![("centre", Some(list(&to)))],
        }
    }

    fn shifted(&self, by: [f64; 2]) -> Vec<Change> {
        let to = [0, 1].map(|k: usize| self.0.centre[k] + by[k]);
        vec![("centre", Some(list(&to)))]
    }

    fn draw(&self, pen: &WidgetPainter) {
        self.0.draw(pen);
    }
}

/// A Gaussian by |K (v − centre)|²: its kind and its keys. `extent`: of the plane, where its half axes are at right angles.
pub(in crate::transfer) fn gaussian(
    centre: [f64; 2],
    k: &[Vec<f64>],
    extent: [f64; 2],
) -> (&'static str, Vec<Change>) {
    let ellipse = Ellipse::new(centre, k, [Some(0), Some(1)], extent);
    ("gaussian", std::iter::once(("centre", Some(list(&centre)))).chain(spread(ellipse.axes)).collect())
}

/// Half axes as a file states them: upright ones as sigma, turned ones as a matrix.
fn spread(axes: [[f64; 2]; 2]) -> Vec<Change> {
    let [[a, b], [c, d]] = axes;
    let small = |x: f64, of: f64| x.abs() <= 1e-9 * of.abs();
    if small(b, d) && small(c, a) {
        return vec![("sigma", Some(list(&[a.abs(), d.abs()]))), ("matrix", None)];
    }
    if small(a, c) && small(d, b) {
        return vec![("sigma", Some(list(&[c.abs(), b.abs()]))), ("matrix", None)];
    }
    // K = A⁻¹ / √2, where the half axes are the columns of A: |K v|² = ½ at one standard deviation.
    let det = (a * d - c * b) * std::f64::consts::SQRT_2;
    let matrix = [[d / det, -c / det], [-b / det, a / det]];
    vec![("matrix", Some(rows(&matrix))), ("sigma", None)]
}
