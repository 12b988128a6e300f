//! A picture with what belongs to it: layers of numbers beside its colours, and its annotation as shapes.

use crate::picture::Picture;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A picture with what belongs to it, as far as it was requested.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureParts {
    /// The whole picture, its annotation included.
    pub picture: Arc<Picture>,
    /// Numbers of each pixel beside its colour.
    pub layers: Option<Arc<PictureLayers>>,
    /// The annotation apart from the picture under it.
    pub annotation: Option<Arc<Annotation>>,
}

impl From<Arc<Picture>> for PictureParts {
    fn from(picture: Arc<Picture>) -> Self {
        PictureParts { picture, layers: None, annotation: None }
    }
}

/// Kind of a layer: a number of each pixel, of the ray through the pixel's centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PictureLayer {
    /// Depth at which the transmittance of the ray falls to ½; infinite where it stays above. Depths are from the eye along the view
    /// direction, world units.
    Depth,
    /// Depth of the first contribution to the ray; infinite where there is none.
    FirstHit,
    /// Number of the cell of the file in which the transmittance falls to ½; [`NO_CELL`] where it stays above, or falls at a surface.
    Cell,
    /// −ln of the transmittance of the whole ray; infinite behind an opaque surface.
    OpticalDepth,
}

/// The number where there is no cell: −1 in 32 bits with a sign.
pub const NO_CELL: u32 = u32::MAX;

impl PictureLayer {
    /// All of them.
    pub const ALL: [PictureLayer; 4] =
        [PictureLayer::Depth, PictureLayer::FirstHit, PictureLayer::Cell, PictureLayer::OpticalDepth];

    /// The name in pipeline files and picture files.
    pub fn name(self) -> &'static str {
        match self {
            PictureLayer::Depth => "depth",
            PictureLayer::FirstHit => "first_hit",
            PictureLayer::Cell => "cell",
            PictureLayer::OpticalDepth => "optical_depth",
        }
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<PictureLayer> {
        PictureLayer::ALL.into_iter().find(|layer| layer.name() == name)
    }
}

/// Values of a layer, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub enum LayerValues {
    /// Numbers.
    Numbers(Vec<f32>),
    /// Numbers of cells.
    Cells(Vec<u32>),
}

/// Layers of a picture.
pub type PictureLayers = BTreeMap<PictureLayer, LayerValues>;

/// Place in a picture, pixels from its upper left corner.
pub type Place = [f32; 2];

/// The annotation of a picture apart from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Annotation {
    /// The picture under the shapes.
    pub ground: Picture,
    /// The shapes, each over those before it.
    pub shapes: Vec<Shape>,
}

/// A shape of one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// The form.
    pub form: ShapeForm,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Opacity.
    pub opacity: f32,
}

/// Form of a shape.
#[derive(Debug, Clone, PartialEq)]
pub enum ShapeForm {
    /// A straight line with flat ends.
    Line {
        /// Its ends.
        ends: [Place; 2],
        /// Its width, pixels.
        width: f32,
    },
    /// A rectangle: its upper left and its lower right corner.
    Rectangle([Place; 2]),
    /// The inside of a closed path, by its winding number.
    Area(Arc<[PathStep]>),
    /// A path drawn with a pen.
    Outline {
        /// The path.
        path: Arc<[PathStep]>,
        /// Width of the pen, pixels.
        width: f32,
    },
}

/// A step of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathStep {
    /// Begins a part there.
    Move(Place),
    /// A straight line.
    Line(Place),
    /// A quadratic Bézier curve: control point and end.
    Quadratic(Place, Place),
    /// A cubic Bézier curve: two control points and end.
    Cubic(Place, Place, Place),
    /// A line to the begin of the part.
    Close,
}
