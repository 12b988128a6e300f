//! The quadrature rule: 15 Kronrod points with the 7 Gauss points among them.
//!
//! Besides its value a rule gives the running integral at its own nodes (the integral of the polynomial through
//! the 15 values), which is how the optical depth in front of a node is found. Nodes and weights: Laurie,
//! "Calculation of Gauss-Kronrod quadrature rules", 1997, as tabulated in QUADPACK (Piessens et al. 1983); the
//! error estimate is QUADPACK's.

use std::sync::LazyLock;

pub(crate) const NODES: usize = 15;

/// Kronrod abscissae from the middle outward; each but the first stands for ± itself.
const ABSCISSAE: [f64; 8] = [
    0.0,
    0.207_784_955_007_898_47,
    0.405_845_151_377_397_2,
    0.586_087_235_467_691_1,
    0.741_531_185_599_394_4,
    0.864_864_423_359_769_1,
    0.949_107_912_342_758_5,
    0.991_455_371_120_812_6,
];

/// Kronrod weights, in the order of [`ABSCISSAE`].
const KRONROD: [f64; 8] = [
    0.209_482_141_084_727_82,
    0.204_432_940_075_298_9,
    0.190_350_578_064_785_4,
    0.169_004_726_639_267_9,
    0.140_653_259_715_525_92,
    0.104_790_010_322_250_19,
    0.063_092_092_629_978_56,
    0.022_935_322_010_529_224,
];

/// Gauss weights of every second abscissa, from the middle outward.
const GAUSS: [f64; 4] =
    [0.417_959_183_673_469_4, 0.381_830_050_505_118_9, 0.279_705_391_489_276_64, 0.129_484_966_168_869_7];

/// The rule on [0, 1].
pub(crate) struct Rule {
    pub(crate) nodes: [f64; NODES],
    pub(crate) kronrod: [f64; NODES],
    /// Weights of the 7 Gauss nodes, 0 at the others.
    pub(crate) gauss: [f64; NODES],
    /// `running[j][k]`: integral from 0 to node j of the polynomial that is 1 at node k and 0 at the others.
    pub(crate) running: [[f64; NODES]; NODES],
}

/// The rule, made once.
pub(crate) static RULE: LazyLock<Rule> = LazyLock::new(Rule::new);

impl Rule {
    fn new() -> Self {
        let mut nodes = [0.0; NODES];
        let mut kronrod = [0.0; NODES];
        let mut gauss = [0.0; NODES];
        for (k, &x) in ABSCISSAE.iter().enumerate() {
            for (place, signed) in [(7 - k, -x), (7 + k, x)] {
                nodes[place] = 0.5 + 0.5 * signed;
                kronrod[place] = 0.5 * KRONROD[k];
                gauss[place] = if k % 2 == 0 { 0.5 * GAUSS[k / 2] } else { 0.0 };
            }
        }
        // The rule itself is exact for the polynomials of degree 14 that are to be integrated.
        let mut running = [[0.0; NODES]; NODES];
        for (j, row) in running.iter_mut().enumerate() {
            for (k, entry) in row.iter_mut().enumerate() {
                let value = |x: f64| -> f64 {
                    (0..NODES).filter(|&m| m != k).map(|m| (x - nodes[m]) / (nodes[k] - nodes[m])).product()
                };
                *entry = (0..NODES).map(|i| kronrod[i] * nodes[j] * value(nodes[i] * nodes[j])).sum();
            }
        }
        Rule { nodes, kronrod, gauss, running }
    }
}

/// QUADPACK's estimate of the error of the Kronrod value, from both values and the integral of |f|.
pub(crate) fn estimated_error(kronrod: f64, gauss: f64, magnitude: f64) -> f64 {
    if magnitude <= 0.0 {
        return 0.0;
    }
    let share = 200.0 * (kronrod - gauss).abs() / magnitude;
    magnitude * (share * share.sqrt()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 15 Kronrod points are exact to degree 22 (and by symmetry 23), 7 Gauss points to 13. Rounding of 15
    /// terms of size below 1: 1e-15.
    #[test]
    fn rule_integrates_powers() {
        let integral = |weights: &[f64], n: i32| -> f64 {
            weights.iter().zip(&RULE.nodes).map(|(w, x)| w * x.powi(n)).sum()
        };
        for n in 0..=22 {
            assert!((integral(&RULE.kronrod, n) - 1.0 / f64::from(n + 1)).abs() < 1e-15, "degree {n}");
        }
        for n in 0..=13 {
            assert!((integral(&RULE.gauss, n) - 1.0 / f64::from(n + 1)).abs() < 1e-15, "degree {n}");
        }
        assert!((integral(&RULE.gauss, 14) - 1.0 / 15.0).abs() > 1e-12);
    }

    /// The running integral of xⁿ is xⁿ⁺¹/(n + 1), exactly up to degree 14; the matrix's entries stay below 1.
    #[test]
    fn running_integral_of_powers() {
        for n in 0..=14 {
            for (j, &x) in RULE.nodes.iter().enumerate() {
                let sum: f64 = RULE.running[j].iter().zip(&RULE.nodes).map(|(m, y)| m * y.powi(n)).sum();
                assert!((sum - x.powi(n + 1) / f64::from(n + 1)).abs() < 1e-14, "degree {n} at {x}");
            }
        }
    }
}
