//! Values of continuous functions of any order at the nodes of a mesh of the first or of the second.
//!
//! A function of the order p has a value at each vertex, then p − 1 in each edge, (p − 1)(p − 2)/2 in each triangle, (p − 1)² in each
//! quadrilateral, and those within the elements: Lagrange's polynomials through the points of Gauss and Lobatto. At the middle of an edge
//! value i has the weight wᵢ, of quadrilaterals and cubes value (i, j, k) the product wᵢ wⱼ wₖ; since wᵢ = wₚ₋ᵢ, it makes no difference
//! in which direction an edge runs, or how a face is turned.

use super::elements::MfemElements;
use super::numbering::MfemNodes;
use super::shapes::PYRAMID;

/// Greatest order that is read.
pub(super) const MAX_ORDER: u32 = 32;

/// The places of a function's values.
pub(super) struct ContinuousLayout<'a> {
    nodes: &'a MfemNodes,
    weights: Vec<f64>,
    /// First value within each element with a node in the middle.
    middles: Vec<usize>,
    pub count: usize,
}

impl<'a> ContinuousLayout<'a> {
    /// The places by an order; `is_bergot`: with the functions on pyramids of M. Bergot et al. (2010, `_Pyr0` in the name of a space), of which
    /// fewer are within, for those of F. Fuentes et al. (2015), which MFEM takes if none are named.
    pub fn new(nodes: &'a MfemNodes, elements: &MfemElements, order: u32, is_bergot: bool) -> Self {
        let p = order as usize;
        let (line, triangle) = (p - 1, (p - 1) * p.saturating_sub(2) / 2);
        let within = |number: usize| match number {
            1 => line,
            2 => triangle,
            3 => line * line,
            4 => triangle * p.saturating_sub(3) / 3,
            5 => line * line * line,
            6 => triangle * line,
            PYRAMID if is_bergot => line * p.saturating_sub(2) * (2 * p).saturating_sub(3) / 6,
            PYRAMID => line * line * line,
            _ => 0,
        };
        let faces = nodes.triangle_count * triangle + nodes.quadrilaterals.len() * line * line;
        let mut count = nodes.vertex_count + nodes.edges.len() * line + faces;
        let mut middles = Vec::with_capacity(nodes.middles.len());
        for element in elements.iter() {
            if element.shape.has_middle && !nodes.middles.is_empty() {
                middles.push(count);
            }
            count += within(element.number);
        }
        ContinuousLayout { nodes, weights: weights(p), middles, count }
    }

    /// Layout of values that stand at even distances.
    pub fn with_even_points(self) -> Self {
        let p = self.weights.len() - 1;
        let points: Vec<f64> = (0..=p).map(|i| 2.0 * i as f64 / p as f64 - 1.0).collect();
        ContinuousLayout { weights: middle_weights(&points), ..self }
    }

    /// True if the values are those at the nodes, in their order.
    pub fn is_of_nodes(&self) -> bool {
        let order = self.weights.len() - 1;
        self.count == self.nodes.len() && (order == 2 || self.nodes.len() == self.nodes.vertex_count)
    }

    /// The value at a node; `value` gives those of the function.
    pub fn at(&self, node: usize, value: impl Fn(usize) -> f64 + Copy) -> f64 {
        let (nodes, end) = (self.nodes, self.weights[0]);
        let sum =
            |all: &[u32], of: &dyn Fn(usize) -> f64| all.iter().map(|&own| of(own as usize)).sum::<f64>();
        let Some(edge) = node.checked_sub(nodes.vertex_count) else { return value(node) };
        let in_edge = |edge: usize| self.within(nodes.vertex_count + edge * self.side(), 1, value);
        if let Some(ends) = nodes.edges.get(edge) {
            return end * sum(ends, &value) + in_edge(edge);
        }
        let face = edge - nodes.edges.len();
        if let Some(own) = nodes.quadrilaterals.get(face) {
            return end * end * sum(&own.vertices, &value)
                + end * sum(&own.edges, &in_edge)
                + self.in_face(face, value);
        }
        let middle = face - nodes.quadrilaterals.len();
        let (Some(&first), Some(&element)) = (self.middles.get(middle), nodes.middles.get(middle)) else {
            return f64::NAN;
        };
        let first_face = nodes.vertex_count + nodes.edges.len();
        let in_edge = |node: usize| in_edge(node - nodes.vertex_count);
        let in_face = |node: usize| self.in_face(node - first_face, value);
        match *nodes.of_element(element as usize) {
            [a, b, _] => end * sum(&[a, b], &value) + self.within(first, 1, value),
            ref own if own.len() == 9 => {
                end * end * sum(&own[..4], &value)
                    + end * sum(&own[4..8], &in_edge)
                    + self.within(first, 2, value)
            }
            ref own => {
                let outside = end * sum(&own[..8], &value) + sum(&own[8..20], &in_edge);
                end * end * outside + end * sum(&own[20..26], &in_face) + self.within(first, 3, value)
            }
        }
    }

    /// Values between the ends of an edge.
    fn side(&self) -> usize {
        self.weights.len() - 2
    }

    fn in_face(&self, face: usize, value: impl Fn(usize) -> f64) -> f64 {
        let nodes = self.nodes;
        let (line, triangles) = (self.side(), nodes.quadrilaterals[face].triangles_before);
        let before = triangles * (line * line.saturating_sub(1) / 2) + face * line * line;
        self.within(nodes.vertex_count + nodes.edges.len() * line + before, 2, value)
    }

    /// Sum of the values within an edge, a quadrilateral or a cube, from the first on, with their weights.
    fn within(&self, first: usize, dimension: u32, value: impl Fn(usize) -> f64) -> f64 {
        let line = self.side();
        let weight = |mut place: usize| {
            let mut product = 1.0;
            for _ in 0..dimension {
                product *= self.weights[1 + place % line];
                place /= line;
            }
            product
        };
        (0..line.pow(dimension)).map(|place| weight(place) * value(first + place)).sum()
    }
}

/// Legendre's polynomials of the orders p − 1 and p ≥ 1.
fn legendre(p: usize, x: f64) -> [f64; 2] {
    let (mut before, mut own) = (1.0, x);
    for k in 2..=p {
        (before, own) = (own, ((2 * k - 1) as f64 * x * own - (k - 1) as f64 * before) / k as f64);
    }
    [before, own]
}

/// Steps of Newton's method, from points that are near.
const STEPS: usize = 50;

/// The p + 1 points of Gauss and Lobatto: −1, 1, and where the derivative of Legendre's polynomial of the order p is zero (M. Abramowitz,
/// I. Stegun, "Handbook of Mathematical Functions", 25.4.32).
fn lobatto_points(p: usize) -> Vec<f64> {
    let order = p as f64;
    let point = |i: usize| {
        let mut x = -(std::f64::consts::PI * i as f64 / order).cos();
        for _ in 0..STEPS {
            let [before, own] = legendre(p, x);
            x -= (x * own - before) / ((order + 1.0) * own);
        }
        x
    };
    (0..=p).map(|i| if 2 * i == p { 0.0 } else { point(i) }).collect()
}

/// Weights of the p + 1 points of Gauss and Lobatto in the mean over a line (25.4.32).
pub(super) fn lobatto_mean(p: usize) -> Vec<f64> {
    let order = p as f64;
    let weight = |x: f64| 1.0 / (order * (order + 1.0) * legendre(p, x)[1].powi(2));
    lobatto_points(p).into_iter().map(weight).collect()
}

/// Weights of the n points of Gauss and Legendre in the mean over a line (25.4.29).
pub(super) fn legendre_mean(n: usize) -> Vec<f64> {
    let slope = |x: f64| {
        let [before, own] = legendre(n, x);
        (own, n as f64 * (x * own - before) / (x * x - 1.0))
    };
    let weight = |i: usize| {
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..STEPS {
            let (own, slope) = slope(x);
            x -= own / slope;
        }
        1.0 / ((1.0 - x * x) * slope(x).1.powi(2))
    };
    (0..n).map(weight).collect()
}

/// Weights in the middle of Lagrange's polynomials through the p + 1 points of Gauss and Lobatto.
fn weights(p: usize) -> Vec<f64> {
    middle_weights(&lobatto_points(p))
}

/// Weights in the middle of Lagrange's polynomials through points from −1 to 1.
fn middle_weights(points: &[f64]) -> Vec<f64> {
    let weight = |i: usize| {
        let others = points.iter().enumerate().filter(|other| other.0 != i);
        others.map(|(_, x)| -x / (points[i] - x)).product()
    };
    (0..points.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::{legendre_mean, lobatto_mean, weights};

    #[test]
    fn weights_of_the_mean_are_those_of_known_points() {
        let same = |found: Vec<f64>, expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        };
        same(legendre_mean(1), &[1.0]);
        same(legendre_mean(2), &[0.5, 0.5]);
        same(legendre_mean(3), &[5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0]);
        same(lobatto_mean(1), &[0.5, 0.5]);
        same(lobatto_mean(2), &[1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0]);
        for n in 2..=20 {
            let sums = [legendre_mean(n), lobatto_mean(n)].map(|weights| weights.iter().sum::<f64>());
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-12), "{n}: {sums:?}");
        }
    }

    #[test]
    fn weights_of_the_middle_are_those_of_known_points() {
        let same = |p: usize, expected: &[f64]| {
            let found = weights(p);
            assert_eq!(found.len(), expected.len());
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{p}: {found:?}");
        };
        same(1, &[0.5, 0.5]);
        same(2, &[0.0, 1.0, 0.0]);
        // Points ±1/√5.
        same(3, &[-0.125, 0.625, 0.625, -0.125]);
        let even = super::middle_weights(&[-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0]);
        assert!(even.iter().zip([-0.0625, 0.5625, 0.5625, -0.0625]).all(|(a, b)| (a - b).abs() < 1e-15));
        // A polynomial of the order comes back: x^p and a constant have 0 and 1 in the middle.
        for p in 1..=12 {
            let sum: f64 = weights(p).iter().sum();
            assert!((sum - 1.0).abs() < 1e-13, "{p}: {sum}");
        }
    }
}
