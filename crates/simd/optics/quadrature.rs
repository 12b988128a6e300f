//! Gauss-Legendre panels of 8 points. Twin of `optics::quadrature`.

use crate::{Float, Lanes};
use voltet_optics::quadrature::{GAUSS_8, Node, UP_TO_8};

/// Points of a panel.
pub const POINTS: usize = 8;

/// Nodes on [0, 1] and their weights.
pub const PANEL: [(f32, f32); POINTS] = nodes(GAUSS_8);

/// ∫ from 0 to node i of the polynomial that is 1 at node k and 0 at the others: with it
/// the values at the nodes give the integral up to each node, as exactly as a polynomial of degree 7 follows them.
const TO_NODE: [[f32; POINTS]; POINTS] = up_to(UP_TO_8);

/// Nodes and weights in 32 bits.
pub const fn nodes<const N: usize>(wide: [Node; N]) -> [(f32, f32); N] {
    let mut narrow = [(0.0, 0.0); N];
    let mut i = 0;
    while i < N {
        narrow[i] = (wide[i].0 as f32, wide[i].1 as f32);
        i += 1;
    }
    narrow
}

/// Integrals up to each node in 32 bits.
pub const fn up_to<const N: usize>(wide: [[f64; N]; N]) -> [[f32; N]; N] {
    let mut narrow = [[0.0; N]; N];
    let mut i = 0;
    while i < N * N {
        narrow[i / N][i % N] = wide[i / N][i % N] as f32;
        i += 1;
    }
    narrow
}

/// ∫ f from the panel's start to each node, from f at the nodes, for a panel of length 1.
#[inline(always)]
pub fn to_nodes<L: Lanes>(values: &[L::F; POINTS]) -> [L::F; POINTS] {
    array!(|i| {
        let mut sum = values[0] * L::F::splat(TO_NODE[i][0]);
        for k in 1..POINTS {
            sum = values[k].mul_add(L::F::splat(TO_NODE[i][k]), sum);
        }
        sum
    })
}

/// ∫ f over a panel of length 1.
#[inline(always)]
pub fn over_panel<L: Lanes>(values: &[L::F; POINTS]) -> L::F {
    let mut sum = values[0] * L::F::splat(PANEL[0].1);
    for k in 1..POINTS {
        sum = values[k].mul_add(L::F::splat(PANEL[k].1), sum);
    }
    sum
}
