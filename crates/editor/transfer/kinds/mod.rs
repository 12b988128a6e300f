//! The kinds of widgets as they lie in the plane. What a widget is says [`voltet_core::transfer`].
//!
//! To add a kind, add its arm in [`shape`] and, where no shape here is its own, one that implements [`Shape`]; nothing else of the
//! editor knows kinds.

mod fields;
mod gaussian;
mod shapes;

use super::plane::S_AND_G;
use fields::FieldShape;
pub(super) use fields::gaussian_over;
pub(super) use gaussian::gaussian;
use shapes::{Bands, Curve, Everywhere, Picture, Triangle};
pub(super) use shapes::{PlaneContext, Shape};
use std::sync::Arc;
use voltet_core::transfer::{Profile, Widget};
use voltet_graph::{ArrayRef, Field, find_setting};

/// The shape of a widget; `None` where it lies along other axes. `numbers`: its table, without numbers relative to data.
pub(super) fn shape(widget: &Widget, numbers: &[Field], on: &PlaneContext) -> Option<Arc<dyn Shape>> {
    let flat = |shape: Option<Arc<dyn Shape>>| shape.filter(|_| on.is_of_s_and_g());
    let over = |fields: &[ArrayRef], centre: &[f64], matrix: Vec<Vec<f64>>, magnitude: Option<&String>| {
        let shape = FieldShape::read((fields, centre, matrix), magnitude, numbers, on)?;
        Some(Arc::new(shape) as Arc<dyn Shape>)
    };
    let arrays = |names: &[String]| names.iter().cloned().map(ArrayRef::Array).collect::<Vec<_>>();
    match &widget.profile {
        // Its region is all that there is to see.
        Profile::Uniform => flat(Some(Arc::new(Everywhere))),
        Profile::Gaussian { centre, matrix } => {
            flat(over(&S_AND_G, centre, matrix.map(Vec::from).to_vec(), None))
        }
        Profile::GaussianNd { fields, centre, matrix } => over(&arrays(fields), centre, matrix.clone(), None),
        Profile::TriangularGaussian { centre, sigma } => {
            flat(Some(Arc::new(Triangle { centre: *centre, sigma: *sigma })))
        }
        Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
            over(&arrays(fields), centre, matrix.clone(), Some(magnitude))
        }
        Profile::TriangleWave(wave) => flat(Some(Arc::new(Bands { wave: *wave, sine: false }))),
        Profile::SineWave(wave) => flat(Some(Arc::new(Bands { wave: *wave, sine: true }))),
        Profile::PiecewiseLinear { points } => {
            let is_stated = find_setting(numbers, "points").is_some();
            let curve = Curve { points: points.clone(), is_stated };
            Some(Arc::new(curve) as Arc<dyn Shape>).filter(|_| on.axes[0] == S_AND_G[0])
        }
        // A Gaussian in the colours of a map.
        Profile::Table(_) if find_setting(numbers, "sigma").is_some() => {
            let numbers_of = |name: &str| find_setting(numbers, name)?.numbers();
            let (centre, sigma) = (numbers_of("centre")?, numbers_of("sigma")?);
            let row = |i: usize| {
                let width = sigma.get(i).map_or(f64::INFINITY, |sigma| std::f64::consts::SQRT_2 * sigma);
                (0..2).map(|j| if i == j { 1.0 / width } else { 0.0 }).collect::<Vec<f64>>()
            };
            flat(over(&S_AND_G, &centre, vec![row(0), row(1)], None))
        }
        Profile::Table(table) => flat(Some(Arc::new(Picture::new(table, numbers, on)))),
    }
}

/// The axes on which a widget can be seen: its first two fields, or what it has of these and g.
pub(super) fn natural_axes(widget: &Widget) -> [ArrayRef; 2] {
    let array = |name: &&str| ArrayRef::Array(name.to_string());
    match &widget.profile.properties().fields[..] {
        [] => S_AND_G,
        [one] => [array(one), ArrayRef::Named("g")],
        [first, second, ..] => [array(first), array(second)],
    }
}
