//! Nodes of MFEM's meshes in the order in which its finite element spaces number them: vertices, then edges, faces and elements, each in the
//! order in which the elements first name them.

use super::elements::MfemElements;
use std::collections::HashMap;
use voltet_core::{Error, Result};

/// Nodes of a mesh of the first or of the second order, and the elements by them.
#[derive(Default)]
pub(super) struct MfemNodes {
    pub vertex_count: usize,
    /// Vertices of each edge, ascending; none in the first order.
    pub edges: Vec<[u32; 2]>,
    pub quadrilaterals: Vec<Quadrilateral>,
    /// Number of triangles between elements; 0 where the order needs none.
    pub triangle_count: usize,
    /// Elements with a node in the middle.
    pub middles: Vec<u32>,
    /// Nodes of all elements in VTK's order, and the end of each one's.
    pub connectivity: Vec<u32>,
    pub ends: Vec<usize>,
}

/// A face of four vertices.
pub(super) struct Quadrilateral {
    pub vertices: [u32; 4],
    pub edges: [u32; 4],
    /// Number of the triangles that appear before it.
    pub triangles_before: usize,
}

/// Numbers things by their vertices in the order in which they appear.
#[derive(Default)]
struct Appearances<const N: usize> {
    numbers: HashMap<[u32; N], u32>,
    all: Vec<[u32; N]>,
}

impl<const N: usize> Appearances<N> {
    fn number(&mut self, mut vertices: [u32; N]) -> u32 {
        vertices.sort_unstable();
        *self.numbers.entry(vertices).or_insert_with(|| {
            self.all.push(vertices);
            self.all.len() as u32 - 1
        })
    }
}

impl MfemNodes {
    /// Numbers the nodes: of the first order the vertices, of others those of edges, faces and middles, too.
    pub fn new(elements: &MfemElements, vertex_count: usize, order: u32) -> Result<MfemNodes> {
        let mut nodes = MfemNodes { vertex_count, ..MfemNodes::default() };
        if order < 2 {
            nodes.connectivity.clone_from(&elements.vertices);
            nodes.ends = elements.iter().map(|element| element.end).collect();
            return Ok(nodes);
        }
        // Edges first, for faces follow all of them, and middles these.
        let mut edges = Appearances::<2>::default();
        let (mut triangles, mut squares) = (Appearances::<3>::default(), Appearances::<4>::default());
        let (mut own_edges, mut own_faces) = (Vec::new(), Vec::new());
        for element in elements.iter() {
            let vertex = |place: u8| element.vertices[usize::from(place)];
            own_edges.extend(element.shape.edges.iter().map(|edge| edges.number(edge.map(vertex))));
            for &face in element.shape.faces {
                match *face {
                    [a, b, c, d] => {
                        let vertices = [a, b, c, d].map(vertex);
                        let number = squares.number(vertices);
                        if number as usize == nodes.quadrilaterals.len() {
                            let side = |k: usize| edges.number([vertices[k], vertices[(k + 1) % 4]]);
                            nodes.quadrilaterals.push(Quadrilateral {
                                vertices,
                                edges: [0, 1, 2, 3].map(side),
                                triangles_before: triangles.all.len(),
                            });
                        }
                        own_faces.push(number);
                    }
                    // Triangles have nodes from the third order on.
                    [a, b, c] if order > 2 => {
                        triangles.number([a, b, c].map(vertex));
                    }
                    _ => {}
                }
            }
        }
        nodes.triangle_count = triangles.all.len();
        nodes.edges = edges.all;
        let middles = elements.iter().filter(|element| element.shape.has_middle).count();
        let first_edge = vertex_count;
        let first_face = first_edge + nodes.edges.len();
        let first_middle = first_face + nodes.quadrilaterals.len();
        if u32::try_from(first_middle + middles).is_err() {
            return Err(Error::run("the mesh has too many nodes of the second order").expected(u32::MAX));
        }
        let (mut own_edges, mut own_faces) = (own_edges.into_iter(), own_faces.into_iter());
        let mut local = Vec::new();
        for (number, element) in elements.iter().enumerate() {
            let face_count = element.shape.faces.iter().filter(|face| face.len() == 4).count();
            local.clear();
            local.extend_from_slice(element.vertices);
            let of_edges = own_edges.by_ref().take(element.shape.edges.len());
            local.extend(of_edges.map(|own| first_edge as u32 + own));
            local.extend(own_faces.by_ref().take(face_count).map(|own| first_face as u32 + own));
            if element.shape.has_middle {
                local.push((first_middle + nodes.middles.len()) as u32);
                nodes.middles.push(number as u32);
            }
            nodes.connectivity.extend(element.shape.order.iter().map(|&place| local[usize::from(place)]));
            nodes.ends.push(nodes.connectivity.len());
        }
        Ok(nodes)
    }

    pub fn len(&self) -> usize {
        self.vertex_count + self.edges.len() + self.quadrilaterals.len() + self.middles.len()
    }

    /// Nodes of an element, in VTK's order.
    pub fn of_element(&self, element: usize) -> &[u32] {
        let begin = if element == 0 { 0 } else { self.ends[element - 1] };
        &self.connectivity[begin..self.ends[element]]
    }
}
