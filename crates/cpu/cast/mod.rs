//! Ray casting from cell to cell through shared faces (Garrity 1990; Bunyk, Kaufman and Silva 1997): a ray's segments come in visibility
//! order.
//!
//! The next cell of a ray follows from the face that it leaves by: nothing is projected cell by cell, covered, put in lists or sorted, and
//! no occluded cell is read. The rays of 4 × 4 pixels form a packet, a lane each. In a cell the three corners of the entry face are in
//! registers; the opposite vertex is gathered, and the sides on which the ray passes the lines from it to the three select the exit face.
//! These sides are the same in all cells that share the edge, and a ray that meets an edge is moved right and, by less, down: so a ray that
//! enters leaves by exactly one face.
//!
//! A ray's position on a face is the mean of its corners with weights that are not negative. So rounding moves a ray aside by some 1e-7 of a
//! cell; it never extrapolates. Where one cell ends the next begins, by the same number.
//!
//! Rays enter by the boundary of the drawn cells, whose faces are rasterised as triangles. Where that leads into cells which overlap others,
//! or out of the grid by another face than one that the ray meets, the ray is mistracked and its tile is drawn from projected cells; so is a
//! whole picture where ray casting is impossible or slower: see [`RayCaster::new`].
//!
//! Where the near plane or the eye lies among the cells, those in view are a grid of their own: rays enter it by faces on the eye's side
//! of the plane, or behind the eye, and segments begin at the plane. Each ray then sees the points moved along it into the plane of depth 0, a
//! linear map that holds at the eye and behind it; the sides of edges and the weights of corners are found there as for parallel rays.

mod edge_functions;
mod half_faces;
pub(crate) mod packet;
mod points;
pub(crate) mod ray_caster;
#[cfg(test)]
mod tests;
pub(crate) mod traversal;

pub(crate) use half_faces::{BYTES_PER_CELL, FaceCache, MAX_CELLS};
pub(crate) use points::ScreenExtent;
pub(crate) use ray_caster::{RayCastPolicy, RayCaster};
