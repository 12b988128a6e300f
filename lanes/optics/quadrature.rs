//! Gauss-Legendre panels of 8 points. Twin of `optics::quadrature`.

use crate::{Float, Lanes, array};

/// Points of a panel.
pub const POINTS: usize = 8;

/// Nodes on [0, 1] and their weights (Abramowitz & Stegun 1964, 25.4.30).
#[rustfmt::skip]
pub const PANEL: [(f32, f32); 8] = [
    (0.019_855_072, 0.050_614_268),
    (0.101_666_76, 0.111_190_52),
    (0.237_233_8, 0.156_853_32),
    (0.408_282_68, 0.181_341_89),
    (0.591_717_3, 0.181_341_89),
    (0.762_766_2, 0.156_853_32),
    (0.898_333_25, 0.111_190_52),
    (0.980_144_9, 0.050_614_268),
];

/// ∫ from 0 to node i of the polynomial that is 1 at node k and 0 at the others (computed in 40 digits): with it
/// the values at the nodes give the integral up to each node, as exactly as a polynomial of degree 7 follows them.
#[rustfmt::skip]
const TO_NODE: [[f32; POINTS]; POINTS] = [
    [0.025_307_134, -0.009_105_943, 0.006_280_831, -0.004_483_015_7, 0.003_078_491_4, -0.001_917_675_3, 0.000_972_757_64, -0.000_277_508_34],
    [0.054_759_324, 0.055_595_26, -0.013_639_796_5, 0.008_149_709, -0.005_215_352, 0.003_139_753, -0.001_564_935, 0.000_442_802_3],
    [0.048_587_535, 0.120_859_526, 0.078_426_66, -0.015_975_103, 0.008_371_733, -0.004_643_466, 0.002_225_714_7, -0.000_618_805_7],
    [0.051_865_52, 0.106_193_49, 0.170_671_14, 0.090_670_94, -0.016_021_041, 0.007_241_206_7, -0.003_197_814_3, 0.000_859_236_6],
    [0.049_755_033, 0.114_388_33, 0.149_612_11, 0.197_362_93, 0.090_670_94, -0.013_817_811, 0.004_997_027, -0.001_251_252_8],
    [0.051_233_076, 0.108_964_8, 0.161_496_79, 0.172_970_16, 0.197_316_99, 0.078_426_66, -0.009_669_008, 0.002_026_732],
    [0.050_171_465, 0.112_755_455, 0.153_713_57, 0.186_557_25, 0.173_192_19, 0.170_493_13, 0.055_595_26, -0.004_145_053_7],
    [0.050_891_776, 0.110_217_76, 0.158_771, 0.178_263_4, 0.185_824_9, 0.150_572_5, 0.120_296_46, 0.025_307_134],
];

/// ∫ f from the panel's start to each node, from f at the nodes, for a panel of length 1.
#[inline(always)]
pub fn to_nodes<L: Lanes>(values: &[L::F; POINTS]) -> [L::F; POINTS] {
    array(
        #[inline(always)]
        |i| {
            let mut sum = values[0] * L::F::splat(TO_NODE[i][0]);
            for k in 1..POINTS {
                sum = values[k].mul_add(L::F::splat(TO_NODE[i][k]), sum);
            }
            sum
        },
    )
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
