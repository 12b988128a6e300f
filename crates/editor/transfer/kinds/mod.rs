//! The kinds of widgets as they lie in the plane, one file a kind: what is drawn, what a hand takes hold of, and what a drag makes
//! of the numbers. What a widget is says [`voltet_core::transfer`].
//!
//! To add a kind, add its arm in [`shape`] and, where no shape here is its own, a file; nothing else of the editor knows kinds.

mod curve;
mod fields;
mod gaussian;
mod table;
mod triangle;
mod wave;

pub(super) use fields::gaussian_over;
pub(super) use gaussian::gaussian;

use super::geometry::S_AND_G;
use super::shape::{PlaneContext, Shape};
use std::sync::Arc;
use voltet_core::transfer::{Profile, Widget};
use voltet_graph::{ArrayRef, Field};

/// The shape of a widget; `None` where it lies along other axes. `numbers`: its table, without numbers relative to data.
pub(super) fn shape(widget: &Widget, numbers: &[Field], on: &PlaneContext) -> Option<Arc<dyn Shape>> {
    let flat = on.is_of_s_and_g();
    match &widget.profile {
        // Its region is all that there is to see.
        Profile::Uniform => flat.then(|| Arc::new(Everywhere) as Arc<dyn Shape>),
        Profile::Gaussian { centre, matrix } => {
            flat.then(|| Arc::new(gaussian::Gaussian::new(*centre, matrix, numbers, on)) as Arc<dyn Shape>)
        }
        Profile::GaussianNd { fields, centre, matrix } => {
            fields::FieldShape::shape((fields, centre, matrix), None, numbers, on)
        }
        Profile::TriangularGaussian { centre, sigma } => {
            let (centre, sigma) = (*centre, *sigma);
            flat.then(|| Arc::new(triangle::Triangle { centre, sigma }) as Arc<dyn Shape>)
        }
        Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
            fields::FieldShape::shape((fields, centre, matrix), Some(magnitude), numbers, on)
        }
        Profile::TriangleWave(wave) => {
            flat.then(|| Arc::new(wave::Bands { wave: *wave, sine: false }) as Arc<dyn Shape>)
        }
        Profile::SineWave(wave) => {
            flat.then(|| Arc::new(wave::Bands { wave: *wave, sine: true }) as Arc<dyn Shape>)
        }
        Profile::PiecewiseLinear { points } => (on.axes[0] == S_AND_G[0])
            .then(|| Arc::new(curve::Curve { points: points.clone() }) as Arc<dyn Shape>),
        Profile::Table(table) => {
            flat.then(|| Arc::new(table::Picture::new(table, numbers, on)) as Arc<dyn Shape>)
        }
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

/// A widget without a shape.
#[derive(Debug)]
struct Everywhere;

impl Shape for Everywhere {}
