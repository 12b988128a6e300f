//! Widgets over s and g or over a list of fields, on the plane of two of them: what lies outside of the plane stays as it is.

use super::gaussian::{Ellipse, finely, spread};
use super::shapes::{PlaneContext, Shape, Triangle};
use crate::transfer::plane::{Change, Handle, Plane, S_AND_G, WidgetPainter, list, rounded, rows};
use voltet_core::transfer::WIDGET_KINDS;
use voltet_graph::{ArrayRef, Field, LocatedValue, ParameterValue, find_setting};

#[derive(Debug, Clone, PartialEq)]
pub(super) struct FieldShape {
    /// The fields along the plane's axes, by their places in the list.
    at: [Option<usize>; 2],
    centre: Vec<f64>,
    sigma: Option<Vec<f64>>,
    /// K of exp(−|K (v − centre)|²), or with the magnitude as 1.
    kernel: Vec<Vec<f64>>,
    magnitude: Option<Magnitude>,
    figure: Figure,
    /// True over s and g, where the half axes say all.
    is_flat: bool,
    /// True if its kind can be turned: it has a matrix.
    turns: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Figure {
    Ellipse(Ellipse),
    Triangle(Triangle),
}

/// The magnitude of all gradients, which the widths are shares of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Magnitude {
    axis: Option<usize>,
    /// The one at which ellipses over two fields are drawn: in the middle of its range.
    level: f64,
}

impl FieldShape {
    /// `None` of one that has no field along either axis, or would lie on its side. `magnitude`: the name of the array, where its
    /// widths are shares of one.
    pub fn read(
        (fields, centre, kernel): (&[ArrayRef], &[f64], Vec<Vec<f64>>),
        magnitude: Option<&String>,
        numbers: &[Field],
        on: &PlaneContext,
    ) -> Option<FieldShape> {
        let at = on.axes.each_ref().map(|axis| fields.iter().position(|known| known == axis));
        if at == [None; 2] {
            return None;
        }
        let magnitude = magnitude.map(|name| {
            let quantity = ArrayRef::Array(name.clone());
            let range = on.known.and_then(|known| known.ranges.get(&quantity));
            Magnitude {
                axis: on.axes.iter().position(|axis| *axis == quantity),
                level: range.map_or(1.0, |[_, high]| 0.5 * high),
            }
        });
        let sigma = find_setting(numbers, "sigma").and_then(LocatedValue::numbers);
        let middle = at.map(|place| place.map_or(0.0, |i| centre[i]));
        let ellipse = Ellipse::new(middle, &kernel, at, on.extent);
        let figure = match magnitude {
            Some(Magnitude { axis: Some(1), .. }) => {
                let width = kernel.iter().map(|row| at[0].map_or(0.0, |i| row[i] * row[i])).sum::<f64>();
                Figure::Triangle(Triangle { centre: middle[0], sigma: 1.0 / width.sqrt() })
            }
            Some(Magnitude { axis: Some(_), .. }) => return None,
            Some(Magnitude { axis: None, level }) => {
                let axes = ellipse.axes.map(|axis| axis.map(|x| if x == 0.0 { 0.0 } else { x * level }));
                Figure::Ellipse(Ellipse { axes, ..ellipse })
            }
            None => {
                let mut ellipse = ellipse;
                // Deviations that are stated need no inverse.
                for (axis, place) in at.iter().enumerate() {
                    if let Some(sigma) = place.and_then(|i| sigma.as_ref()?.get(i)) {
                        ellipse.axes[axis] = [0.0; 2];
                        ellipse.axes[axis][axis] = *sigma;
                    }
                }
                Figure::Ellipse(ellipse)
            }
        };
        let (centre, is_flat) = (centre.to_vec(), *fields == S_AND_G);
        let kind = find_setting(numbers, "kind").and_then(LocatedValue::text);
        let kind = WIDGET_KINDS.iter().find(|known| Some(known.name) == kind);
        let turns = kind.is_some_and(|kind| kind.parameters.iter().any(|known| known.name == "matrix"));
        Some(FieldShape { at, centre, sigma, kernel, magnitude, figure, is_flat, turns })
    }

    fn centred(&self, to: [f64; 2]) -> Vec<Change> {
        let mut centre = self.centre.clone();
        for (axis, place) in self.at.iter().enumerate() {
            if let Some(place) = place {
                centre[*place] = to[axis];
            }
        }
        vec![("centre", Some(list(&centre)))]
    }

    /// Other half axes in the plane, in place of those `before`. K is brought along by the linear map from the ones to the others,
    /// so that it stays what it is across the plane.
    fn stretched(&self, before: [[f64; 2]; 2], after: [[f64; 2]; 2]) -> Vec<Change> {
        if self.is_flat {
            return spread(after);
        }
        let is_upright = |axes: [[f64; 2]; 2]| {
            axes[0][1].abs() <= 1e-9 * axes[0][0].abs() && axes[1][0].abs() <= 1e-9 * axes[1][1].abs()
        };
        let ratio = |k: usize| {
            let ratio = after[k][k] / before[k][k];
            if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
        };
        if is_upright(before) && is_upright(after) {
            return self.scaled([ratio(0), ratio(1)]);
        }
        let [Some(i), Some(j)] = self.at else { return Vec::new() };
        // T⁻¹ = H_before H_after⁻¹, where the half axes are the columns of H.
        let [[a, b], [c, d]] = after;
        let det = a * d - c * b;
        let inverse = [[d / det, -c / det], [-b / det, a / det]];
        let column = |k: usize| [before[0][k], before[1][k]];
        let entry = |k: usize, l: usize| column(k)[0] * inverse[0][l] + column(k)[1] * inverse[1][l];
        let back = [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]];
        let mut kernel = self.kernel.clone();
        for row in &mut kernel {
            let (x, y) = (row[i], row[j]);
            let along = |k: usize| rounded(x * back[0][k] + y * back[1][k]);
            (row[i], row[j]) = (along(0), along(1));
        }
        vec![("matrix", Some(rows(&kernel))), ("sigma", None)]
    }

    fn scaled(&self, by: [f64; 2]) -> Vec<Change> {
        let factor = |field: usize| {
            let own = (0..2).filter(|axis| self.at[*axis] == Some(field));
            own.map(|axis| by[axis]).product::<f64>()
        };
        let scaled = |x: f64, by: f64| if by == 1.0 { x } else { rounded(x * by) };
        match &self.sigma {
            Some(sigma) => {
                let sigma: Vec<f64> =
                    sigma.iter().enumerate().map(|(i, sigma)| scaled(*sigma, factor(i))).collect();
                vec![("sigma", Some(list(&sigma)))]
            }
            None => {
                let mut kernel = self.kernel.clone();
                for row in &mut kernel {
                    row.iter_mut().enumerate().for_each(|(i, x)| *x = scaled(*x, 1.0 / factor(i)));
                }
                vec![("matrix", Some(rows(&kernel)))]
            }
        }
    }
}

impl Shape for FieldShape {
    fn handles(&self, plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        let mut handles = match &self.figure {
            Figure::Ellipse(ellipse) => ellipse.handles(),
            Figure::Triangle(triangle) => triangle.handles(plane),
        };
        handles.retain(|(handle, _)| self.turns || *handle != Handle::Angle);
        handles
    }

    fn moved(&self, handle: Handle, to: [f64; 2], plane: &Plane) -> Vec<Change> {
        match (&self.figure, handle) {
            (Figure::Ellipse(ellipse), Handle::Width(_) | Handle::Angle) => ellipse
                .stretched(handle, to, plane)
                .map_or(Vec::new(), |after| self.stretched(ellipse.axes, after)),
            (Figure::Triangle(triangle), Handle::Width(_)) => {
                self.scaled([triangle.widened(to, plane) / triangle.sigma, 1.0])
            }
            _ => self.centred(to),
        }
    }

    fn draw(&self, pen: &WidgetPainter) {
        match &self.figure {
            Figure::Ellipse(ellipse) => ellipse.draw(pen),
            Figure::Triangle(triangle) => triangle.draw(pen),
        }
    }

    /// Values of the plane's fields; those of the others are at their centres.
    fn fields(&self, at: [f64; 2]) -> Vec<f64> {
        let along = |i: usize| (0..2).find(|axis| self.at[*axis] == Some(i)).map(|axis| at[axis]);
        let own = (0..self.centre.len()).map(|i| along(i).unwrap_or(self.centre[i]));
        let magnitude = self.magnitude.map(|of| of.axis.map_or(of.level, |axis| at[axis]));
        own.chain(magnitude).collect()
    }

    fn is_in_plane(&self) -> bool {
        let in_plane = (0..self.centre.len()).all(|field| self.at.contains(&Some(field)));
        in_plane && self.magnitude.is_none_or(|magnitude| magnitude.axis == Some(1))
    }

    fn level(&self) -> Option<f64> {
        self.magnitude.filter(|magnitude| magnitude.axis.is_none()).map(|magnitude| magnitude.level)
    }
}

/// A Gaussian over two arrays: its kind and its keys; `None` where an axis is none.
pub(in crate::transfer) fn gaussian_over(
    axes: &[ArrayRef; 2],
    centre: [f64; 2],
    sigma: [f64; 2],
) -> Option<(&'static str, Vec<Change>)> {
    let [ArrayRef::Array(x), ArrayRef::Array(y)] = axes else { return None };
    let names: ParameterValue = [x, y].into_iter().map(String::as_str).collect();
    let centre = finely(centre, sigma);
    let (centre, sigma) = (("centre", Some(list(&centre))), ("sigma", Some(list(&sigma.map(rounded)))));
    Some(("gaussian-nd", vec![("fields", Some(names)), centre, sigma]))
}

#[cfg(test)]
mod tests {
    use super::super::super::images::Images;
    use super::*;
    use voltet_core::transfer::{Profile, Widget};

    fn axes(names: [&str; 2]) -> [ArrayRef; 2] {
        names.map(|name| ArrayRef::Array(name.into()))
    }

    /// Over a, b and c about (1, 2, 3).
    fn field_shape(
        kernel: &[Vec<f64>],
        sigma: Option<&[f64]>,
        magnitude: bool,
        on: [&str; 2],
    ) -> Option<FieldShape> {
        let names = ["a", "b", "c"].map(|name| ArrayRef::Array(name.into()));
        let numbers = sigma.map(|sigma| Field {
            name: "sigma".into(),
            origin: Default::default(),
            setting: list(sigma).into(),
        });
        let (images, name) = (Images::default(), "multi-gradient".to_string());
        let (axes, scales) = (axes(on), Default::default());
        let on = PlaneContext { axes: &axes, scales, extent: [1.0, 1.0], known: None, images: &images };
        let numbers: Vec<Field> = numbers.into_iter().collect();
        FieldShape::read(
            (&names, &[1.0, 2.0, 3.0], kernel.to_vec()),
            magnitude.then_some(&name),
            &numbers,
            &on,
        )
    }

    fn diagonal(numbers: [f64; 3]) -> Vec<Vec<f64>> {
        let entry = |i: usize, j: usize| if i == j { numbers[i] } else { 0.0 };
        (0..3).map(|i| (0..3).map(|j| entry(i, j)).collect()).collect()
    }

    /// exp(−|K (v − centre)|²) at v.
    fn strength(kernel: &[Vec<f64>], v: [f64; 3]) -> f64 {
        let fields = ["a", "b", "c"].map(String::from).to_vec();
        let profile = Profile::GaussianNd { fields, centre: vec![1.0, 2.0, 3.0], matrix: kernel.to_vec() };
        Widget { profile, color: [1.0; 3], extinction: 1.0, region: None }.weight_at([0.0; 2], &v)
    }

    #[test]
    fn a_drag_in_the_plane_of_two_fields_leaves_the_others() {
        let sigma = [0.5, 0.25, 4.0];
        let kernel = diagonal(sigma.map(|x| 1.0 / (std::f64::consts::SQRT_2 * x)));
        let widget = field_shape(&kernel, Some(&sigma), false, ["c", "a"]).unwrap();
        let upright = Ellipse { centre: [3.0, 1.0], axes: [[4.0, 0.0], [0.0, 0.5]] };
        assert_eq!(widget.figure, Figure::Ellipse(upright));
        assert_eq!(widget.centred([5.0, 1.5]), [("centre", Some(list(&[1.5, 2.0, 5.0])))]);
        let wider = widget.stretched([[4.0, 0.0], [0.0, 0.5]], [[8.0, 0.0], [0.0, 0.25]]);
        assert_eq!(wider, [("sigma", Some(list(&[0.25, 0.25, 8.0])))]);
        assert_eq!(widget.fields([7.0, 8.0]), [8.0, 2.0, 7.0], "what is no axis is in the middle");
        assert!(field_shape(&kernel, Some(&sigma), false, ["x", "y"]).is_none());
    }

    /// A widget with correlations: its ellipse in the plane becomes the requested one, and across the plane, at the
    /// centre of the two fields, nothing changes.
    #[test]
    fn turned_in_the_plane_it_is_as_before_across_it() {
        let k = vec![vec![1.3, -0.4, 0.2], vec![0.1, 0.9, -0.3], vec![0.0, 0.5, 0.7]];
        let widget = field_shape(&k, None, false, ["a", "b"]).unwrap();
        let Figure::Ellipse(Ellipse { axes: before, .. }) = widget.figure else { panic!("no ellipse") };
        let (sin, cos) = 0.7f64.sin_cos();
        let after = [[2.0 * cos, 2.0 * sin], [-0.3 * sin, 0.3 * cos]];
        let changes = widget.stretched(before, after);
        let Some(ParameterValue::List(matrix)) = &changes[0].1 else { panic!("{changes:?}") };
        let turned: Vec<Vec<f64>> = matrix.iter().map(|row| row.numbers().unwrap()).collect();
        for half_axis in after {
            let at = strength(&turned, [1.0 + half_axis[0], 2.0 + half_axis[1], 3.0]);
            assert!((at - (-0.5f64).exp()).abs() < 1e-5, "{at}");
        }
        let across = [1.0, 2.0, 3.8];
        assert!((strength(&turned, across) - strength(&k, across)).abs() < 1e-5);
    }

    #[test]
    fn on_the_plane_of_a_field_and_the_magnitude_it_is_a_triangle() {
        let (sigma, kernel) = ([0.5, 0.25, 4.0], diagonal([2.0, 4.0, 0.25]));
        let widget = field_shape(&kernel, Some(&sigma), true, ["b", "multi-gradient"]).unwrap();
        assert_eq!(widget.figure, Figure::Triangle(Triangle { centre: 2.0, sigma: 0.25 }));
        assert_eq!(widget.scaled([2.0, 1.0]), [("sigma", Some(list(&[0.5, 0.5, 4.0])))]);
        assert_eq!(widget.fields([7.0, 8.0]), [1.0, 7.0, 3.0, 8.0], "the magnitude is the last");
    }
}
