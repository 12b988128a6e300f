//! Cast: rays from cell to cell through the faces that these share, so that a ray's segments come in order.
//!
//! What a ray comes to next follows from the face that it leaves by (Garrity 1990; Bunyk, Kaufman and Silva 1997): nothing is
//! projected cell by cell, covered, put in lists or in order, and what is hidden is not looked at. The rays of 4 × 4 pixels go side
//! by side, a lane each. In a cell the three corners of the face that a ray came in by are at hand; the fourth is looked up, and on which
//! sides of the lines from it to the three the ray passes says by which face it goes out. These sides are the same in all
//! cells that share the edge, and a ray that meets an edge is moved right and, by less, down: so a ray that comes in goes out by exactly
//! one face.
//!
//! A place where a ray passes a face is the mean of its corners with weights that are not negative. So rounding moves a ray aside by some
//! 1e-7 of a cell; it never extrapolates. Where one cell ends the next begins, by the same number.
//!
//! Rays come in by the boundary of what is drawn, by faces that are found as triangles are drawn. Where that leads into cells which
//! overlap others, or by another face out of the grid than one that the ray meets, the tile is drawn from its cells, projected one by
//! one; so is a whole picture where this does not serve or pay: see [`Cast::of`].
//!
//! | file | what |
//! | --- | --- |
//! | `mesh` | which faces cells share: of a volume |
//! | `half_faces` | the same for the cells that are drawn, as rays follow it |
//! | `known` | both, kept between pictures |
//! | `points` | the points on the screen, in steps |
//! | `sides` | on which side of an edge a ray passes |
//! | `boundary` | faces by which rays come in or go out, by tiles |
//! | `entered` | where the rays of a tile come in |
//! | `bundle` | rays side by side |
//! | `here` | where they are |
//! | `way` | from cell to cell |
//! | `mean` | where rays pass faces |

mod boundary;
pub(crate) mod bundle;
pub(crate) mod entered;
mod half_faces;
mod here;
mod known;
mod mean;
mod mesh;
mod points;
mod sides;
#[cfg(test)]
mod tests;
mod way;

pub(crate) use known::KnownFaces;

use crate::attribute::Attribute;
use crate::cells::{Casting, Cells};
use crate::view::{Seen, View};
use boundary::Boundary;
use half_faces::HalfFaces;
use points::{Points, Reach};
use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_optics::shading::VisibilityOrder;

/// Attributes that rays carry along: s, g and the components of ∇s.
pub(crate) const CARRIED_MOST: usize = 5;

/// From which cells on rays go from one to the other. What that gains over projecting them is counted in what it takes to find
/// the faces that they share, both by cells; measured over grids of 0.2 to 16 million cells, 2 to 140 segments each
/// (`cargo bench --bench frame`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// What is gained by each segment of a cell: less than nothing where nothing has to be put in order.
    gain_of_segment: f64,
    /// Faces at the boundary by cells, at most.
    boundary_most: f64,
}

/// What is gained by a cell that is not projected; in proportion less where cells cover less than a pixel each: those that cover none
/// are soon left.
const GAIN_OF_CELL: f64 = 0.8;

/// What a picture must gain. It could be drawn once, for which finding faces takes longer than is gained by less than 1; or often.
/// Which of both nobody knows, and a picture shall have the same bits whatever was drawn before: less than a frame is lost at most.
const GAIN_LEAST: f64 = 0.3;

/// Optical depth over the scene length, at the densest place, from which on rays soon end.
const OPAQUE: f64 = 100.0;

impl Limits {
    /// Of a scene of this optical depth over the scene length, at the densest place.
    pub fn of(transfer_function: &TransferFunction, densest: f64) -> Limits {
        match transfer_function.uniform_color() {
            None => Limits { gain_of_segment: 0.01, boundary_most: 1.0 },
            Some(_) if OPAQUE < densest => Limits { gain_of_segment: 0.0, boundary_most: 0.2 },
            Some(_) => Limits { gain_of_segment: -0.01, boundary_most: 0.2 },
        }
    }
}

/// Cells at most: what numbers of half-faces allow.
pub(crate) const CELLS_MOST: usize = 1 << 27;

/// Bytes of a cell: its half-faces, the faces that it shares, on which side its corners lie, its place among those that are drawn.
pub(crate) const OF_CELL: u64 = 4 * (16 + 4) + 1 + 4;

/// Cells that tell how many pixels a cell covers.
const SAMPLED: usize = 4096;

/// Optical depth over the longest thin cell, at the densest place, at most: rounding moves a face by some 1e-7 of the cell's reach.
const DENSEST: f64 = 4e3;

/// A picture's rays.
#[derive(Debug)]
pub(crate) struct Cast {
    half_faces: Arc<HalfFaces>,
    points: Points,
    boundary: Boundary,
}

impl Cast {
    /// Rays through the cells of a picture. `None` where cells are drawn otherwise: another order is asked for, or that they be
    /// projected; points lie behind the eye or far deeper than others; attributes are many; cells are beyond the `limits`, or thin ones are
    /// dense.
    pub fn of(
        cells: &Cells,
        view: &View,
        seen: &[Seen],
        attributes: &[Attribute<'_>],
        densest: f64,
        limits: Limits,
    ) -> Option<Cast> {
        let faces = cells.faces.as_ref()?;
        let drawn = faces.drawn();
        let serves = cells.casting != Casting::Never
            && matches!(cells.order, VisibilityOrder::Exact | VisibilityOrder::Auto)
            && attributes.len() <= CARRIED_MOST
            && !drawn.is_empty()
            && drawn.len() <= CELLS_MOST;
        let tetrahedra = &cells.volume.grid.tetrahedra;
        if !serves {
            return None;
        }
        let segments = covered(seen, tetrahedra, &cells.kept) / drawn.len() as f64;
        let gain = GAIN_OF_CELL * segments.min(1.0) + limits.gain_of_segment * segments;
        if cells.casting != Casting::Always && gain < GAIN_LEAST {
            return None;
        }
        // Faces are looked for last: of a volume that takes longer than a frame.
        let reach = Reach::of(view, seen)?;
        let grid = &cells.volume.grid;
        let mesh = faces.mesh(grid);
        let [longest, longest_thin] = mesh.longest.map(|longest| longest / cells.length);
        if DENSEST < densest * longest_thin {
            return None;
        }
        let half_faces = faces.half_faces(&mesh, grid);
        if limits.boundary_most * (drawn.len() as f64) < half_faces.boundary.len() as f64 {
            return None;
        }
        let points = Points::new(view, seen, &reach, longest, attributes)?;
        let boundary = Boundary::new(seen, &half_faces, view.size);
        Some(Cast { half_faces, points, boundary })
    }

    /// Tiles that rays come in at, numbered row by row.
    pub fn queue(&self) -> Vec<u32> {
        self.boundary.queue()
    }
}

/// Pixels that cells cover, about: from some of them. A tetrahedron covers half of what its four faces do.
fn covered(seen: &[Seen], tetrahedra: &[[u32; 4]], cells: &[u32]) -> f64 {
    let step = (cells.len() / SAMPLED).max(1);
    let area = |cell: &u32| {
        let [a, b, c, d] = tetrahedra[*cell as usize].map(|p| &seen[p as usize]);
        let face = |a: &Seen, b: &Seen, c: &Seen| {
            (0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x))).abs()
        };
        0.5 * (face(a, b, c) + face(a, b, d) + face(a, c, d) + face(b, c, d))
    };
    cells.iter().step_by(step).map(area).sum::<f64>() * step as f64
}
