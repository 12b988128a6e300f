//! What a plug-in is asked to do, with all that it is given, and what comes of it: the same in this process and in one of its own.

use crate::describe::{Declared, Family};
use crate::grid_filter::GivenGrid;
use crate::grids::{Buffers, Head};
use crate::host::State;
use crate::image_filter::GivenImage;
use crate::library::{Piece, Work};
use crate::outcome::Said;
use crate::reader::{OfFile, Wanted};
use crate::values::Owned;
use crate::work::{Given, check};
use voltet_core::Result;
use voltet_core::glam::DVec3;
use voltet_core::grid::Grid;
use voltet_core::parameters::Parameters;

/// What is asked; owned, or shared, so that a call that never ends harms nobody.
pub(crate) enum Task {
    /// Whether these values can be together.
    Check(Owned),
    /// The gradient at every point.
    Gradient(Box<Given>),
    /// What a file holds.
    Inspect(Box<OfFile>),
    /// What it holds of what is wanted.
    Read(Box<OfFile>, Box<Wanted>),
    /// A grid of a grid.
    Grid(Box<GivenGrid>),
    /// A picture of a picture.
    Image(Box<GivenImage>),
}

/// What was made.
#[derive(Default)]
pub(crate) enum Outcome {
    /// Nothing but what was said.
    #[default]
    Nothing,
    /// The gradient's vectors.
    Vectors(Vec<DVec3>),
    /// What a file holds.
    Head(Head),
    /// A grid, or parts of it. Of a grid filter counts are those of the whole grid, whatever it shares with the input.
    Grid(Head, Buffers),
    /// A picture's pixels.
    Pixels(Vec<[f32; 4]>),
}

impl Task {
    /// Errors: an array that is not there.
    pub fn gradient(
        declared: &Declared,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
    ) -> Result<Task> {
        Given::new(declared, grid, scalar, parameters).map(|given| Task::Gradient(Box::new(given)))
    }

    /// The stage that progress is reported of.
    pub fn stage(&self) -> &'static str {
        match self {
            Task::Check(_) => "check",
            Task::Gradient(_) => "gradient",
            Task::Inspect(_) | Task::Read(..) => "reading",
            Task::Grid(_) | Task::Image(_) => "filter",
        }
    }

    /// Calls the function of a loaded library. A piece of another family says nothing and makes nothing.
    pub fn carry_out(self, piece: &Piece, state: &State) -> (Said, Outcome) {
        match (self, piece.work, piece.declared.family) {
            (Task::Check(values), ..) => {
                (piece.check.map_or_else(Said::default, |f| check(f, &values, state)), Outcome::Nothing)
            }
            (Task::Gradient(given), Work::Gradient(function), Family::GradientFilter { needs }) => {
                let (said, vectors) = given.compute(function, needs, state);
                (said, Outcome::Vectors(vectors))
            }
            (Task::Inspect(file), Work::Reader { inspect, .. }, _) => {
                let (said, head) = file.inspect(inspect, state);
                (said, head.map(Outcome::Head).unwrap_or_default())
            }
            (Task::Read(file, wanted), Work::Reader { read, .. }, _) => {
                let (said, buffers) = file.read(read, &wanted, state);
                (said, Outcome::Grid(wanted.head, buffers))
            }
            (Task::Grid(given), Work::GridFilter(function), _) => given.filter(function, state),
            (Task::Image(given), Work::ImageFilter(function), _) => {
                let (said, pixels) = given.filter(function, state);
                (said, Outcome::Pixels(pixels))
            }
            _ => (Said::default(), Outcome::Nothing),
        }
    }
}

/// What was made, if it is of the kind that was asked for.
impl Outcome {
    pub fn vectors(self) -> Option<Vec<DVec3>> {
        if let Outcome::Vectors(vectors) = self { Some(vectors) } else { None }
    }

    pub fn head(self) -> Option<Head> {
        if let Outcome::Head(head) = self { Some(head) } else { None }
    }

    pub fn grid(self) -> Option<(Head, Buffers)> {
        if let Outcome::Grid(head, buffers) = self { Some((head, buffers)) } else { None }
    }

    pub fn pixels(self) -> Option<Vec<[f32; 4]>> {
        if let Outcome::Pixels(pixels) = self { Some(pixels) } else { None }
    }
}
