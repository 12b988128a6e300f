//! Split of curved cells (quadratic, triquadratic, Lagrange, Bezier) into linear pieces.
//!
//! A cell of order p is cut on the lattice of order p × subdivision. Lattice points that are nodes of the cell are
//! taken as they are; every other one is an added point, a weighted sum of the cell's nodes by its shape functions,
//! with which positions and all values are interpolated. Added points on an edge or face are shared with the
//! neighbours: they are known by the numbers of the corners of that edge or face and their place between these.
//! An axis along which the cell is linear is not cut, as little as a linear cell is.
//!
//! The triquadratic pyramid has nodes inside its triangles that no regular lattice has; it is joined straight from
//! node to node whatever the subdivision.

mod basis;
mod lattice;

use crate::grid::cell_types::{CellType, code};
use crate::grid::parts::{Cell, number};
use crate::{Error, Result};
use basis::Weights;
use lattice::LatticeCell;
use std::collections::HashMap;

/// Pieces along an edge of a curved cell at most: its degree × the subdivision.
const MAX_PIECES: usize = 64;

/// One point of a cell's lattice.
#[derive(Debug, Clone)]
enum LatticePoint {
    Node(usize),
    /// An added point: its number among the cell's added points.
    Added(usize),
}

/// A point that cells of one kind add.
#[derive(Debug, Clone)]
struct AddedPoint {
    weights: Weights,
    /// Corners with whole weights where the point lies on the surface; empty inside.
    surface: Vec<(usize, u64)>,
}

/// Subdivision of the curved cells of one kind.
#[derive(Debug, Clone)]
struct Template {
    points: Vec<LatticePoint>,
    added: Vec<AddedPoint>,
    pieces: Vec<LatticeCell>,
}

/// Key of a template: cell type, number of points, degrees.
type Kind = (u8, usize, Option<[u8; 3]>);

/// The templates of all kinds of curved cells in a file, and the points they add.
#[derive(Debug, Default)]
pub(super) struct Curved {
    templates: HashMap<Kind, Template>,
    /// Numbers of the added points, cell after cell.
    numbers: Vec<u32>,
    /// First added point of each cell; empty where no cell adds points.
    starts: Vec<usize>,
    /// Source of each added point: cell, and index among the cell's added points.
    pub origins: Vec<(u32, u32)>,
}

/// True if cells of this type are curved.
pub fn is_curved(code: u8) -> bool {
    lattice::is_curved(code) || code == code::TRIQUADRATIC_PYRAMID
}

impl Curved {
    /// Makes the template of a kind of cell unless it is there.
    pub fn prepare(&mut self, cell: &Cell, kind: Kind, subdivision: usize) -> Result<()> {
        let degrees = kind.2;
        if self.templates.contains_key(&kind) {
            return Ok(());
        }
        let name = CellType::from_code(cell.code).map_or("curved cell", |t| t.name);
        let wrong_count = || {
            let degrees =
                degrees.map_or(String::new(), |d| format!(" with degrees {} {} {}", d[0], d[1], d[2]));
            Error::run(format!("cell {}, a {name}{degrees}, has the wrong number of points", cell.number))
                .got(cell.corners.len())
                .expected("the number that its degree calls for")
        };
        let template = if cell.code == code::TRIQUADRATIC_PYRAMID {
            triquadratic_pyramid()
        } else {
            let nodes = lattice::nodes(cell.code, cell.corners.len(), degrees).ok_or_else(wrong_count)?;
            let order = nodes.orders.into_iter().max().unwrap_or(1);
            if order > 1 && order * subdivision > MAX_PIECES {
                return Err(Error::usage(format!("the subdivision is too fine for cells of degree {order}"))
                    .got(subdivision)
                    .expected(format!("at most {}", MAX_PIECES / order))
                    .at_item("subdivision"));
            }
            template(&nodes, subdivision).ok_or_else(wrong_count)?
        };
        self.templates.insert(kind, template);
        Ok(())
    }

    /// Numbers for the added points of `count` cells, counting up from `first_free`; `None` where no cell adds
    /// any.
    pub fn numbering(&mut self, count: usize, first_free: usize) -> Option<Numbering<'_>> {
        if self.templates.values().all(|t| t.added.is_empty()) {
            return None;
        }
        self.starts = Vec::with_capacity(count + 1);
        self.starts.push(0);
        Some(Numbering { curved: self, first_free, known: HashMap::new() })
    }

    /// Hands out the tetrahedra of a curved cell.
    pub fn tetrahedra(&self, cell: &Cell, kind: Kind, emit: &mut impl FnMut([u32; 4])) {
        let template = &self.templates[&kind];
        let start = self.starts.get(cell.number).copied().unwrap_or(0);
        let number = |at: usize| match template.points[at] {
            LatticePoint::Node(node) => cell.corners[node],
            LatticePoint::Added(added) => self.numbers[start + added],
        };
        for piece in &template.pieces {
            piece.tetrahedra(number, emit);
        }
    }

    /// Nodes of the cell and weights that make an added point.
    pub fn weights(&self, kind: Kind, added: u32) -> &[(usize, f64)] {
        &self.templates[&kind].added[added as usize].weights
    }
}

/// Numbers the points that cells add, cell after cell.
pub(super) struct Numbering<'a> {
    curved: &'a mut Curved,
    first_free: usize,
    known: HashMap<[(u32, u64); 4], u32>,
}

impl Numbering<'_> {
    /// Takes the next cell; `None`: one that adds nothing, since it is not curved or not drawn.
    pub fn take(&mut self, cell: Option<(&Cell, Kind)>) -> Result<()> {
        let Numbering { curved, first_free, known } = self;
        if let Some((cell, kind)) = cell {
            for (added, point) in curved.templates[&kind].added.iter().enumerate() {
                let what = "curved cells need too many points";
                let next = number(*first_free + curved.origins.len(), what, " (or a lower subdivision)")?;
                let number_of_point = match place(&point.surface, cell.corners) {
                    // Inside its cell, or at a corner of a collapsed edge or face.
                    _ if point.surface.is_empty() => next,
                    [(corner, _), (_, 0), ..] => corner,
                    place => *known.entry(place).or_insert(next),
                };
                if number_of_point == next {
                    curved.origins.push((cell.number as u32, added as u32));
                }
                curved.numbers.push(number_of_point);
            }
        }
        curved.starts.push(curved.numbers.len());
        Ok(())
    }
}

/// Cuts cells with these nodes.
fn template(nodes: &lattice::Nodes, subdivision: usize) -> Option<Template> {
    let orders = nodes.orders;
    let fine = orders.map(|p| if p == 1 { 1 } else { p * subdivision });
    let full = basis::full_lattice(nodes)?;
    let mut added = Vec::new();
    let points = lattice::points(nodes.shape, fine)
        .into_iter()
        .map(|at| {
            let functions = basis::functions_at(nodes.shape, orders, fine, at);
            let weights = basis::combine(&functions, &full);
            if let [(node, _)] = weights[..] {
                return LatticePoint::Node(node);
            }
            let corner_weights = lattice::corner_weights(nodes.shape, fine, at);
            let surface =
                if lattice::on_surface(nodes.shape, &corner_weights) { corner_weights } else { Vec::new() };
            added.push(AddedPoint { weights, surface });
            LatticePoint::Added(added.len() - 1)
        })
        .collect();
    Some(Template { points, added, pieces: lattice::pieces(nodes.shape, fine) })
}

/// The triquadratic pyramid (VTK's vtkTriQuadraticPyramid): corners 0 … 4, middles of the base edges 5 … 8 and of
/// the others 9 … 12, centre of the base 13, of the triangles 14 … 17, of the body 18, from which all pieces are
/// joined.
fn triquadratic_pyramid() -> Template {
    let mut pieces = Vec::new();
    for c in 0..4 {
        let (next, before) = ((c + 1) % 4, (c + 3) % 4);
        pieces.push(LatticeCell::Pyramid([c, 5 + c, 13, 5 + before, 18]));
        let around = [c, 5 + c, next, 9 + next, 4, 9 + c];
        for i in 0..6 {
            pieces.push(LatticeCell::Tetrahedron([around[i], around[(i + 1) % 6], 14 + c, 18]));
        }
    }
    Template { points: (0..19).map(LatticePoint::Node).collect(), added: Vec::new(), pieces }
}

/// Place of an added point between up to four corners, by ascending number, with whole weights without a common factor, equal in all
/// cells that share it; unused places have weight 0.
fn place(surface: &[(usize, u64)], corners: &[u32]) -> [(u32, u64); 4] {
    let mut between = [(u32::MAX, 0_u64); 4];
    for (slot, &(corner, weight)) in between.iter_mut().zip(surface) {
        *slot = (corners[corner], weight);
    }
    between.sort_unstable();
    // A collapsed cell names a corner twice.
    for i in (1..4).rev() {
        if between[i].1 > 0 && between[i].0 == between[i - 1].0 {
            between[i - 1].1 += between[i].1;
            between[i] = (u32::MAX, 0);
        }
    }
    between.sort_unstable();
    let divisor = between.iter().fold(0, |a, &(_, weight)| common_divisor(a, weight)).max(1);
    between.map(|(corner, weight)| (corner, weight / divisor))
}

fn common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}
