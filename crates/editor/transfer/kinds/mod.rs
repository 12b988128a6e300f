//! The kinds of widgets as they lie in the plane, one file a kind: what is drawn, what a hand takes hold of, and what a drag makes
//! of the numbers. What a widget is says [`voltet_core::transfer`].
//!
//! To add a kind, add its arm in [`shape`] and, where no shape here is its own, a file; nothing else of the editor knows kinds.

mod curve;
mod ellipse;
mod fields;
mod gaussian;
mod table;
mod triangle;
mod wave;

pub(super) use fields::gaussian_over;
pub(super) use gaussian::gaussian;

use super::handles::Handle;
use super::images::Images;
use super::numbers::Change;
use super::pen::Pen;
use super::scale::{S_AND_G, Scale};
use crate::worker::Known;
use std::fmt::Debug;
use std::sync::Arc;
use voltet_core::transfer::{Profile, Widget};
use voltet_graph::{ArrayRef, Field};

/// A widget in the plane, but for its region. Places are values along the plane's axes.
pub(super) trait Shape: Debug {
    /// What a hand takes hold of, and where it lies.
    fn handles(&self, _scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        Vec::new()
    }

    /// What becomes of the numbers when a handle is brought to a place.
    fn moved(&self, _handle: Handle, _to: [f64; 2], _scale: &Scale) -> Vec<Change> {
        Vec::new()
    }

    /// What becomes of the numbers when all of it is moved along.
    fn shifted(&self, _by: [f64; 2]) -> Vec<Change> {
        Vec::new()
    }

    fn draw(&self, _pen: &Pen) {}

    /// Whether it has points, to which others can be added.
    fn has_points(&self) -> bool {
        false
    }

    /// With a point more at a place, and which one that is.
    fn with_point(&self, _at: [f64; 2], _scale: &Scale) -> Option<(Vec<Change>, Handle)> {
        None
    }

    /// Without the point of a handle; `None` where it is none, or is needed.
    fn without_point(&self, _handle: Handle) -> Option<Vec<Change>> {
        None
    }

    /// The values of its further fields at a place, in the order of its properties.
    fn fields(&self, _at: [f64; 2]) -> Vec<f64> {
        Vec::new()
    }

    /// Whether the plane says all of it: no field lies outside, and the widths do not depend on what does.
    fn is_in_plane(&self) -> bool {
        true
    }

    /// The magnitude that it is drawn at, where it depends on one that is no axis.
    fn level(&self) -> Option<f64> {
        None
    }
}

/// The plane that a widget is to be drawn in.
pub(super) struct On<'a> {
    pub axes: &'a [ArrayRef; 2],
    /// Lengths along both axes that are equal on the screen, for angles.
    pub extent: [f64; 2],
    pub known: Option<&'a Known>,
    pub images: &'a Images,
}

impl On<'_> {
    /// Whether the plane is that of s and g.
    pub fn is_of_s_and_g(&self) -> bool {
        *self.axes == S_AND_G
    }
}

/// The shape of a widget; `None` where it lies along other axes. `numbers`: its table, without numbers relative to data.
pub(super) fn shape(widget: &Widget, numbers: &[Field], on: &On) -> Option<Arc<dyn Shape>> {
    let flat = on.is_of_s_and_g();
    match &widget.profile {
        // Its region is all that there is to see.
        Profile::Uniform => flat.then(|| Arc::new(Everywhere) as Arc<dyn Shape>),
        Profile::Gaussian { centre, matrix } => {
            flat.then(|| Arc::new(gaussian::Gaussian::new(*centre, matrix, numbers, on)) as Arc<dyn Shape>)
        }
        Profile::GaussianNd { fields, centre, matrix } => {
            fields::OfFields::shape((fields, centre, matrix), None, numbers, on)
        }
        Profile::TriangularGaussian { centre, sigma } => {
            let (centre, sigma) = (*centre, *sigma);
            flat.then(|| Arc::new(triangle::Triangle { centre, sigma }) as Arc<dyn Shape>)
        }
        Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
            fields::OfFields::shape((fields, centre, matrix), Some(magnitude), numbers, on)
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

/// What has no shape of its own.
#[derive(Debug)]
struct Everywhere;

impl Shape for Everywhere {}
