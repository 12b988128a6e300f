//! Model of each lane operation in plain Rust, and beside it a plausible fault.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "what a comparison is for NaN is what is tested")]

use super::inputs::Row;
use crate::portable::Portable;
use crate::{Float, LaneSet, Lanes};

/// Bits of what one lane gave.
pub(super) type Found = u64;

/// The meaning of an operation: the whole vector and the number of a lane.
pub(super) type Model = fn(&[Row], usize) -> Found;

/// Length of the table that gathers read.
pub(super) const TABLE: usize = 1000;

pub(super) fn table() -> Vec<f32> {
    (0..TABLE).map(|k| k as f32 * 1.5 - 7.0).collect()
}

/// Table of vectors that gathers read.
pub(super) fn table_of_parts() -> Vec<[f32; 4]> {
    table().into_iter().map(|x| [x, x + 0.25, -x, x + 0.5]).collect()
}

fn of_part(place: usize) -> [u32; 4] {
    table_of_parts()[place].map(f32::to_bits)
}

fn parts_of(row: &Row) -> [u32; 4] {
    [row.a, row.b, row.c, -row.a].map(f32::to_bits)
}

/// Pairs of values, and those from the third on once more.
fn twos_of(row: &Row) -> impl Iterator<Item = u32> {
    let parts = parts_of(row);
    parts.into_iter().chain([2, 3, 0, 1].map(|k| parts[k]))
}

/// Parts as one answer: each part, and each place among them, changes it.
pub(super) fn joined(parts: impl IntoIterator<Item = u32>) -> Found {
    parts.into_iter().fold(0, |all, part| (all ^ Found::from(part)).wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// All NaNs are one: which of them an operation makes is left open.
const NAN: Found = 0x7ff8_0000_0000_0000;

/// Bits of a number that was computed.
pub(super) fn number(x: f32) -> Found {
    if x.is_nan() { NAN } else { x.to_bits().into() }
}

pub(super) fn number64(x: f64) -> Found {
    if x.is_nan() { NAN } else { x.to_bits() }
}

pub(super) fn bits(x: f32) -> Found {
    u64::from(x.to_bits())
}

/// In 0 … 2³¹ − 1, for conversions. (An interpreter may let a power differ in its last digit, each time in another way.)
pub(super) fn convertible(x: f32) -> f32 {
    const ABOVE: f32 = (1_u32 << 31) as f32;
    if x.abs() < ABOVE { x.abs() } else { 0.0 }
}

pub(super) fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

pub(super) fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// Name, meaning, and a fault that the inputs must show.
#[rustfmt::skip]
pub(super) const OPERATIONS: [(&str, Model, Model); 52] = [
    ("splat", |_, _| bits(2.5), |_, l| bits(if l == 0 { 2.5 } else { 0.0 })),
    ("load and store", |v, l| bits(v[l].a), |v, l| bits(v[l ^ 1].a)),
    ("+", |v, l| number(v[l].a + v[l].b), |v, l| number(v[l].a - -v[l].b + 0.0)),
    ("-", |v, l| number(v[l].a - v[l].b), |v, l| number(v[l].b - v[l].a)),
    ("×", |v, l| number(v[l].a * v[l].b), |v, l| number((v[l].a * v[l].b).abs())),
    ("/", |v, l| number(v[l].a / v[l].b), |v, l| number(v[l].a * (1.0 / v[l].b))),
    ("neg", |v, l| bits(-v[l].a), |v, l| bits(0.0 - v[l].a)),
    ("min", |v, l| bits(smaller(v[l].a, v[l].b)), |v, l| bits(v[l].a.min(v[l].b))),
    ("max", |v, l| bits(larger(v[l].a, v[l].b)), |v, l| bits(v[l].a.max(v[l].b))),
    ("abs", |v, l| bits(v[l].a.abs()), |v, l| bits(larger(v[l].a, -v[l].a))),
    ("sqrt", |v, l| number(v[l].a.sqrt()), |v, l| number(v[l].a * (1.0 / v[l].a.sqrt()))),
    ("round", |v, l| number(v[l].a.round_ties_even()), |v, l| number(v[l].a.round())),
    ("floor", |v, l| number(v[l].a.floor()), |v, l| number(v[l].a.trunc())),
    ("lt", |v, l| (v[l].a < v[l].b).into(), |v, l| (v[l].a <= v[l].b).into()),
    ("le", |v, l| (v[l].a <= v[l].b).into(), |v, l| (!(v[l].a > v[l].b)).into()),
    ("select", |v, l| bits(if v[l].a < v[l].b { v[l].b } else { v[l].c }), |v, l| bits(if v[l].a < v[l].b { v[l].c } else { v[l].b })),
    ("to_bits", |v, l| bits(v[l].a), |v, l| bits(-v[l].a)),
    ("from_bits", |v, l| v[l].i.into(), |v, l| bits(v[l].i as f32)),
    ("to_unsigned", |v, l| u64::from(convertible(v[l].a) as u32), |v, l| u64::from(convertible(v[l].a).round() as u32)),
    ("permute", |v, l| bits(v[v[l].j as usize % v.len()].a), |v, l| bits(v[(v[l].j as usize + 1) % v.len()].a)),
    ("gather", |v, l| bits(table()[v[l].j as usize % TABLE]), |v, l| bits(table()[v[l].j as usize % TABLE / 2])),
    ("gather_parts", |v, l| joined(of_part(v[l].j as usize % TABLE)), |v, l| joined(of_part(v[l ^ 1].j as usize % TABLE))),
    ("gather_awaited", |v, l| joined(of_part((v[l].j as usize % (TABLE + 3)).min(TABLE - 1))), |v, l| joined(of_part(v[l].j as usize % (TABLE + 3) % TABLE))),
    ("scatter_parts", |v, l| joined(parts_of(&v[v.len() - 1 - l])), |v, l| joined(parts_of(&v[l]))),
    ("scatter_parts of two fours", |v, l| joined(twos_of(&v[v.len() - 1 - l])), |v, l| joined(parts_of(&v[v.len() - 1 - l]).repeat(2))),
    ("unsigned splat", |_, _| 0x9000_0001, |_, _| 0x1000_0001),
    ("iota", |_, l| l as u64, |_, l| l as u64 + 1),
    ("unsigned load and store", |v, l| v[l].i.into(), |v, l| v[l ^ 1].i.into()),
    ("load_u16", |v, l| v[l].h.into(), |v, l| u64::from(v[l].h as i16 as u32)),
    ("unsigned +", |v, l| v[l].i.wrapping_add(v[l].j).into(), |v, l| v[l].i.saturating_add(v[l].j).into()),
    ("unsigned -", |v, l| v[l].i.wrapping_sub(v[l].j).into(), |v, l| v[l].i.saturating_sub(v[l].j).into()),
    ("unsigned ×", |v, l| v[l].i.wrapping_mul(v[l].j).into(), |v, l| v[l].i.saturating_mul(v[l].j).into()),
    ("and", |v, l| (v[l].i & v[l].j).into(), |v, l| (!v[l].i & v[l].j).into()),
    ("or", |v, l| (v[l].i | v[l].j).into(), |v, l| (v[l].i ^ v[l].j).into()),
    ("shl 1", |v, l| (v[l].i << 1).into(), |v, l| (v[l].i << 2).into()),
    ("shl 31", |v, l| (v[l].i << 31).into(), |v, l| (v[l].i << 30).into()),
    ("shr 1", |v, l| (v[l].i >> 1).into(), |v, l| u64::from((v[l].i as i32 >> 1) as u32)),
    ("shr 31", |v, l| (v[l].i >> 31).into(), |v, l| u64::from((v[l].i as i32 >> 31) as u32)),
    ("unsigned min", |v, l| v[l].i.min(v[l].j).into(), |v, l| u64::from((v[l].i as i32).min(v[l].j as i32) as u32)),
    ("unsigned max", |v, l| v[l].i.max(v[l].j).into(), |v, l| u64::from((v[l].i as i32).max(v[l].j as i32) as u32)),
    ("test", |v, l| (v[l].i & v[l].j != 0).into(), |v, l| (v[l].i & v[l].j == v[l].j).into()),
    ("equal", |v, l| (v[l].i == v[l].j).into(), |v, l| (v[l].i as f32 == v[l].j as f32).into()),
    ("unsigned select", |v, l| if v[l].a < v[l].b { v[l].i } else { v[l].j }.into(), |v, l| if v[l].a < v[l].b { v[l].j } else { v[l].i }.into()),
    ("to_float", |v, l| bits(v[l].i as i32 as f32), |v, l| bits(v[l].i as f32)),
    ("unsigned permute", |v, l| v[v[l].j as usize % v.len()].i.into(), |v, l| v[(v[l].j as usize + 1) % v.len()].i.into()),
    ("mask and", |v, l| (v[l].a < v[l].b && v[l].b <= v[l].c).into(), |v, l| (v[l].a < v[l].b).into()),
    ("mask or", |v, l| (v[l].a < v[l].b || v[l].b <= v[l].c).into(), |v, l| (v[l].a < v[l].b).into()),
    ("mask not", |v, l| (!(v[l].a < v[l].b)).into(), |v, l| (v[l].a >= v[l].b).into()),
    ("any", |v, _| v.iter().any(|row| row.i == row.j).into(), |v, _| (v[0].i == v[0].j).into()),
    ("bits past the last lane", |_, _| 0, |_, _| 1),
    ("load from longer, store in longer", |v, l| bits(v[l].b), |v, l| bits(v[l].a)),
    ("what lies behind a store", |_, _| bits(7.0), |_, _| bits(0.0)),
];

/// Operations of 64-bit lanes.
#[rustfmt::skip]
pub(super) const DOUBLES: [(&str, Model, Model); 19] = [
    ("double splat", |_, _| number64(2.5), |_, l| number64(if l == 0 { 2.5 } else { 0.0 })),
    ("double load and store", |v, l| v[l].p.to_bits(), |v, l| v[l ^ 1].p.to_bits()),
    ("double +", |v, l| number64(v[l].p + v[l].q), |v, l| number64(v[l].p + v[l].q + 0.0)),
    ("double -", |v, l| number64(v[l].p - v[l].q), |v, l| number64(v[l].q - v[l].p)),
    ("double ×", |v, l| number64(v[l].p * v[l].q), |v, l| number64((v[l].p * v[l].q).abs())),
    ("double /", |v, l| number64(v[l].p / v[l].q), |v, l| number64(v[l].p * (1.0 / v[l].q))),
    ("double neg", |v, l| (-v[l].p).to_bits(), |v, l| (0.0 - v[l].p).to_bits()),
    ("double min", |v, l| smaller(v[l].p, v[l].q).to_bits(), |v, l| v[l].p.min(v[l].q).to_bits()),
    ("double max", |v, l| larger(v[l].p, v[l].q).to_bits(), |v, l| v[l].p.max(v[l].q).to_bits()),
    ("double abs", |v, l| v[l].p.abs().to_bits(), |v, l| larger(v[l].p, -v[l].p).to_bits()),
    ("ceil", |v, l| number64(v[l].p.ceil()), |v, l| number64(-(-v[l].p).floor() + 0.0)),
    ("double lt", |v, l| (v[l].p < v[l].q).into(), |v, l| (v[l].p <= v[l].q).into()),
    ("double le", |v, l| (v[l].p <= v[l].q).into(), |v, l| (!(v[l].p > v[l].q)).into()),
    ("double select", |v, l| if v[l].p < v[l].q { v[l].q } else { v[l].r }.to_bits(), |v, l| if v[l].p < v[l].q { v[l].r } else { v[l].q }.to_bits()),
    ("store_f32", |v, l| number(v[l].p as f32), |v, l| number(v[l].p as i64 as f32)),
    ("double mask and", |v, l| (v[l].p < v[l].q && v[l].q <= v[l].r).into(), |v, l| (v[l].p < v[l].q).into()),
    ("double mask or", |v, l| (v[l].p < v[l].q || v[l].q <= v[l].r).into(), |v, l| (v[l].p < v[l].q).into()),
    ("double mask not", |v, l| (!(v[l].p < v[l].q)).into(), |v, l| (v[l].p >= v[l].q).into()),
    ("double bits past the last lane", |_, _| 0, |_, _| 1),
];

/// ×+ in one rounding or in two, in both lengths, whichever the lane set has.
#[rustfmt::skip]
pub(super) const MULTIPLY_ADD: [[(&str, Model, Model); 2]; 2] = {
    const TWO: Model = |v, l| number(v[l].a * v[l].b + v[l].c);
    const ONE: Model = |v, l| number(v[l].a.mul_add(v[l].b, v[l].c));
    const DOUBLE_TWO: Model = |v, l| number64(v[l].p * v[l].q + v[l].r);
    const DOUBLE_ONE: Model = |v, l| number64(v[l].p.mul_add(v[l].q, v[l].r));
    [
        [("×+ in two roundings", TWO, ONE), ("double ×+ in two roundings", DOUBLE_TWO, DOUBLE_ONE)],
        [("×+ in one rounding", ONE, TWO), ("double ×+ in one rounding", DOUBLE_ONE, DOUBLE_TWO)],
    ]
};

/// Operations that a lane set is tested with, in the order in which [`All`] answers.
pub(super) fn operations(lanes: LaneSet) -> impl Iterator<Item = (&'static str, Model, Model)> {
    // The portable set says whether it fuses.
    let fused = lanes != LaneSet::Portable || <<Portable as Lanes>::F as Float>::FUSED;
    let multiply_add = MULTIPLY_ADD[usize::from(fused)];
    OPERATIONS.into_iter().chain(DOUBLES).chain(multiply_add)
}
