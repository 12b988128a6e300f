//! Widgets over a list of fields, on the plane of two of them: what lies outside of the plane stays as it is.

use super::numbers::{Change, find, list, rounded, rows_of};
use super::shape::{Form, half_axes, metric};
use crate::worker::Known;
use voltet_core::graph::{Datum, Field, Quantity, Setting};

/// The numbers of such a widget.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OfFields {
    /// The fields along the plane's axes, by their places in the list.
    at: [Option<usize>; 2],
    centre: Vec<f64>,
    sigma: Option<Vec<f64>>,
    /// K of exp(−|K (v − centre)|²), or with the magnitude as 1.
    kernel: Vec<Vec<f64>>,
    magnitude: Option<Magnitude>,
}

/// The magnitude of all gradients, which the widths are shares of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Magnitude {
    /// The axis of the plane that it is.
    axis: Option<usize>,
    /// The one at which ellipses over two fields are drawn: in the middle of its range.
    level: f64,
}

impl OfFields {
    /// `None` of a widget of another kind, or one that has no field along either axis.
    pub fn read(fields: &[Field], axes: &[Quantity; 2], known: Option<&Known>) -> Option<OfFields> {
        let kind = find(fields, "kind").and_then(Setting::text)?;
        let per_width = match kind {
            "gaussian-nd" => std::f64::consts::SQRT_2,
            "triangular-gaussian-nd" => 1.0,
            _ => return None,
        };
        let names: Vec<&str> = find(fields, "fields")?.list()?.iter().filter_map(Setting::text).collect();
        let place = |axis: &Quantity| match axis {
            Quantity::Array(name) => names.iter().position(|known| known == name),
            Quantity::Named(_) | Quantity::Per(..) => None,
        };
        let at = [place(&axes[0]), place(&axes[1])];
        let centre = find(fields, "centre")?.numbers()?;
        let sigma = find(fields, "sigma").and_then(Setting::numbers);
        let kernel = match &sigma {
            Some(sigma) => {
                let entry = |i: usize, j: usize| if i == j { 1.0 / (per_width * sigma[i]) } else { 0.0 };
                (0..sigma.len()).map(|i| (0..sigma.len()).map(|j| entry(i, j)).collect()).collect()
            }
            None => {
                find(fields, "matrix")?.list()?.iter().map(Setting::numbers).collect::<Option<Vec<_>>>()?
            }
        };
        let n = names.len();
        if centre.len() != n || kernel.len() != n || kernel.iter().any(|row| row.len() != n) {
            return None;
        }
        let magnitude = (kind == "triangular-gaussian-nd").then(|| {
            let name = find(fields, "magnitude").and_then(Setting::text).unwrap_or("multi-gradient");
            let quantity = Quantity::Array(name.to_string());
            let range = known.and_then(|known| known.ranges.get(&quantity));
            Magnitude {
                axis: axes.iter().position(|axis| *axis == quantity),
                level: range.map_or(1.0, |[_, high]| 0.5 * high),
            }
        });
        if at == [None; 2] {
            return None;
        }
        Some(OfFields { at, centre, sigma, kernel, magnitude })
    }

    /// Whether the plane says all of it: no field lies outside, and the widths do not depend on what does.
    pub fn is_in_plane(&self) -> bool {
        let in_plane = (0..self.centre.len()).all(|field| self.at.contains(&Some(field)));
        in_plane && self.magnitude.is_none_or(|magnitude| magnitude.axis == Some(1))
    }

    /// The magnitude that its ellipse is drawn at, where it depends on one that is no axis.
    pub fn level(&self) -> Option<f64> {
        self.magnitude.filter(|magnitude| magnitude.axis.is_none()).map(|magnitude| magnitude.level)
    }

    pub fn form(&self, extent: [f64; 2]) -> Option<Form> {
        let of = |axis: usize| self.at[axis].map_or(0.0, |i| self.centre[i]);
        let centre = [of(0), of(1)];
        let [p, r, q] = metric(&self.kernel, self.at);
        match self.magnitude {
            Some(Magnitude { axis: Some(1), .. }) => {
                Some(Form::Triangular { centre: centre[0], sigma: 1.0 / p.sqrt() })
            }
            // The plane would lie on its side.
            Some(Magnitude { axis: Some(_), .. }) => None,
            Some(Magnitude { axis: None, level }) => {
                let times = level * level;
                Some(Form::Gaussian { centre, axes: half_axes([p / times, r / times, q / times], extent) })
            }
            None => Some(Form::Gaussian { centre, axes: half_axes([p, r, q], extent) }),
        }
    }

    /// The middle elsewhere in the plane.
    pub fn centred(&self, to: [f64; 2]) -> Vec<Change> {
        let mut centre = self.centre.clone();
        for (axis, place) in self.at.iter().enumerate() {
            if let Some(place) = place {
                centre[*place] = rounded(to[axis]);
            }
        }
        vec![("centre", Some(list(&centre)))]
    }

    /// Other half axes in the plane, in place of those `before`. K is brought along by the linear map from the ones to the others,
    /// so that it stays what it is across the plane.
    pub fn stretched(&self, before: [[f64; 2]; 2], after: [[f64; 2]; 2]) -> Vec<Change> {
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
            (row[i], row[j]) = (x * back[0][0] + y * back[1][0], x * back[0][1] + y * back[1][1]);
        }
        vec![("matrix", Some(rows_of(&kernel))), ("sigma", None)]
    }

    /// Wider by factors along the plane's axes.
    pub fn scaled(&self, by: [f64; 2]) -> Vec<Change> {
        let factor = |field: usize| {
            let own = (0..2).filter(|axis| self.at[*axis] == Some(field));
            own.map(|axis| by[axis]).product::<f64>()
        };
        match &self.sigma {
            Some(sigma) => {
                let sigma: Vec<f64> =
                    sigma.iter().enumerate().map(|(i, sigma)| rounded(sigma * factor(i))).collect();
                vec![("sigma", Some(list(&sigma)))]
            }
            None => {
                let mut kernel = self.kernel.clone();
                for row in &mut kernel {
                    row.iter_mut().enumerate().for_each(|(i, x)| *x /= factor(i));
                }
                vec![("matrix", Some(rows_of(&kernel)))]
            }
        }
    }
}

/// The axes on which a widget can be seen: its first two fields, or its field and the magnitude.
pub(super) fn natural_axes(fields: &[Field]) -> Option<[Quantity; 2]> {
    let kind = find(fields, "kind").and_then(Setting::text)?;
    let array = |name: &str| Quantity::Array(name.to_string());
    let names: Vec<&str> =
        find(fields, "fields").and_then(Setting::list)?.iter().filter_map(Setting::text).collect();
    let first = array(names.first()?);
    match (kind, names.get(1)) {
        ("gaussian-nd" | "triangular-gaussian-nd", Some(second)) => Some([first, array(second)]),
        ("gaussian-nd", None) => Some([first, Quantity::Named("g")]),
        ("triangular-gaussian-nd", None) => {
            let magnitude = find(fields, "magnitude").and_then(Setting::text).unwrap_or("multi-gradient");
            Some([first, array(magnitude)])
        }
        _ => None,
    }
}

/// The arrays that a widget names.
pub(super) fn arrays(fields: &[Field]) -> Vec<String> {
    let listed = find(fields, "fields").and_then(Setting::list).unwrap_or_default();
    let mut names: Vec<String> = listed.iter().filter_map(Setting::text).map(str::to_string).collect();
    if find(fields, "kind").and_then(Setting::text) == Some("triangular-gaussian-nd") {
        let magnitude = find(fields, "magnitude").and_then(Setting::text).unwrap_or("multi-gradient");
        names.push(magnitude.to_string());
    }
    names
}

/// The keys of a Gaussian over two arrays; `None` where an axis is none.
pub(super) fn gaussian_over(
    axes: &[Quantity; 2],
    centre: [f64; 2],
    sigma: [f64; 2],
) -> Option<Vec<(&'static str, Datum)>> {
    let [Quantity::Array(x), Quantity::Array(y)] = axes else { return None };
    let names = [x, y].map(|name| Setting::from(Datum::Text(name.clone())));
    Some(vec![("fields", Datum::List(names.to_vec())), ("centre", list(&centre)), ("sigma", list(&sigma))])
}

#[cfg(test)]
mod tests {
    use super::super::numbers::array;
    use super::*;

    fn field(name: &str, datum: Datum) -> Field {
        Field { name: name.into(), origin: Default::default(), setting: datum.into() }
    }

    fn texts(names: &[&str]) -> Datum {
        Datum::List(names.iter().map(|name| Datum::Text((*name).into()).into()).collect())
    }

    fn axes(names: [&str; 2]) -> [Quantity; 2] {
        names.map(|name| Quantity::Array(name.into()))
    }

    fn widget(spread: (&str, Datum)) -> Vec<Field> {
        vec![
            field("kind", Datum::Text("gaussian-nd".into())),
            field("fields", texts(&["a", "b", "c"])),
            field("centre", list(&[1.0, 2.0, 3.0])),
            field(spread.0, spread.1),
        ]
    }

    /// exp(−|K (v − centre)|²) at v.
    fn strength(fields: &[Field], v: [f64; 3]) -> f64 {
        let of = OfFields::read(fields, &axes(["a", "b"]), None).unwrap();
        let d: Vec<f64> = v.iter().zip(&of.centre).map(|(v, c)| v - c).collect();
        let q = |row: &Vec<f64>| row.iter().zip(&d).map(|(k, d)| k * d).sum::<f64>();
        (-of.kernel.iter().map(|row| q(row).powi(2)).sum::<f64>()).exp()
    }

    fn changed(mut fields: Vec<Field>, changes: Vec<Change>) -> Vec<Field> {
        for (key, value) in changes {
            fields.retain(|field| field.name != key);
            fields.extend(value.map(|value| field(key, value)));
        }
        fields
    }

    #[test]
    fn a_drag_in_the_plane_of_two_fields_leaves_the_others() {
        let fields = widget(("sigma", list(&[0.5, 0.25, 4.0])));
        let of = OfFields::read(&fields, &axes(["c", "a"]), None).unwrap();
        assert_eq!(
            of.form([10.0, 1.0]),
            Some(Form::Gaussian { centre: [3.0, 1.0], axes: [[4.0, 0.0], [0.0, 0.5]] })
        );
        assert_eq!(of.centred([5.0, 1.5]), [("centre", Some(list(&[1.5, 2.0, 5.0])))]);
        let wider = of.stretched([[4.0, 0.0], [0.0, 0.5]], [[8.0, 0.0], [0.0, 0.25]]);
        assert_eq!(wider, [("sigma", Some(list(&[0.25, 0.25, 8.0])))]);
        assert!(OfFields::read(&fields, &axes(["x", "y"]), None).is_none());
    }

    /// Of a widget with correlations: its ellipse in the plane becomes the wanted one, and across the plane, at the centre of the
    /// two fields, nothing changes.
    #[test]
    fn turned_in_the_plane_it_is_as_before_across_it() {
        let k = vec![vec![1.3, -0.4, 0.2], vec![0.1, 0.9, -0.3], vec![0.0, 0.5, 0.7]];
        let fields = widget(("matrix", rows_of(&k)));
        let of = OfFields::read(&fields, &axes(["a", "b"]), None).unwrap();
        let Some(Form::Gaussian { axes: before, .. }) = of.form([1.0, 1.0]) else { panic!("no ellipse") };
        let (sin, cos) = 0.7f64.sin_cos();
        let after = [[2.0 * cos, 2.0 * sin], [-0.3 * sin, 0.3 * cos]];
        let turned = changed(fields.clone(), of.stretched(before, after));
        for half_axis in after {
            let at = strength(&turned, [1.0 + half_axis[0], 2.0 + half_axis[1], 3.0]);
            assert!((at - (-0.5f64).exp()).abs() < 1e-5, "{at}");
        }
        let across = [1.0, 2.0, 3.8];
        assert!((strength(&turned, across) - strength(&fields, across)).abs() < 1e-5);
    }

    #[test]
    fn on_the_plane_of_a_field_and_the_magnitude_it_is_a_triangle() {
        let mut fields = widget(("sigma", list(&[0.5, 0.25, 4.0])));
        fields[0] = field("kind", Datum::Text("triangular-gaussian-nd".into()));
        let of = OfFields::read(&fields, &axes(["b", "multi-gradient"]), None).unwrap();
        assert_eq!(of.form([1.0, 1.0]), Some(Form::Triangular { centre: 2.0, sigma: 0.25 }));
        assert_eq!(of.scaled([2.0, 1.0]), [("sigma", Some(list(&[0.5, 0.5, 4.0])))]);
        assert_eq!(array::<3>(&fields, "centre"), Some([1.0, 2.0, 3.0]));
    }
}
