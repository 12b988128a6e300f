//! Every operation of every lane set is what its trait says, lane by lane, at all pairs of awkward values.
//!
//! That the inputs tell each operation from a faulty one is asserted as well, so an operation that is named in `models` is an
//! operation that is tested.

mod inputs;
mod models;

use super::*;
use inputs::{Row, vectors};
use models::{
    DOUBLES, Found, MULTIPLY_ADD, TABLE, bits, convertible, joined, number, number64, operations, table,
    table_of_parts,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs every operation on one vector of rows; what each lane gave, operation by operation.
struct All<'a>(&'a [Row]);

impl Kernel<Vec<Vec<Found>>> for All<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<Vec<Found>> {
        let rows = self.0;
        let float = |of: fn(&Row) -> f32| L::F::load(&rows.iter().map(of).collect::<Vec<_>>());
        let unsigned = |of: fn(&Row) -> u32| L::U::load(&rows.iter().map(of).collect::<Vec<_>>());
        let (a, b, c) = (float(|row| row.a), float(|row| row.b), float(|row| row.c));
        let (i, j) = (unsigned(|row| row.i), unsigned(|row| row.j));
        let short = L::U::load_u16(&rows.iter().map(|row| row.h).collect::<Vec<_>>());
        let place = unsigned(|row| row.j % TABLE as u32);
        let lane = j.and(L::U::splat(L::WIDTH as u32 - 1));
        let gathered = L::F::gather(&table(), place);
        let parts = L::F::gather_parts(&table_of_parts(), place);
        // Some past the end.
        let (awaited_table, beyond) = (table_of_parts(), unsigned(|row| row.j % (TABLE as u32 + 3)));
        let mut awaited = PrefetchedGather::first(&awaited_table);
        awaited.ask::<L>(beyond);
        let awaited = L::F::gather_awaited(&awaited);
        let mut scattered = vec![[[0.0; 4]; 1]; L::WIDTH];
        let mut scattered_twos = vec![[[0.0; 4]; 2]; L::WIDTH];
        let backwards = L::U::splat(L::WIDTH as u32 - 1) - L::U::iota();
        L::F::scatter_parts([[a, b, c, -a]], &mut scattered, backwards);
        L::F::scatter_parts([[a, b, c, -a], [c, -a, a, b]], &mut scattered_twos, backwards);
        let (less, not_above) = (a.lt(b), b.le(c));
        // Longer slices than a vector.
        let mut longer = vec![7.0; L::WIDTH + 5];
        L::F::load(&rows.iter().map(|row| row.b).chain([9.0; 5]).collect::<Vec<_>>()).store(&mut longer);
        let behind = longer[L::WIDTH..].iter().fold(7.0, |all, &x| if x == 7.0 { all } else { x });
        let past = |bits: u32, count: usize| vec![Found::from(bits) >> count; L::WIDTH];

        let mut found = vec![
            floats::<L>(L::F::splat(2.5)),
            floats::<L>(a),
            numbers::<L>(a + b),
            numbers::<L>(a - b),
            numbers::<L>(a * b),
            numbers::<L>(a / b),
            floats::<L>(-a),
            floats::<L>(a.min(b)),
            floats::<L>(a.max(b)),
            floats::<L>(a.abs()),
            numbers::<L>(a.sqrt()),
            numbers::<L>(a.round()),
            numbers::<L>(a.floor()),
            masks::<L>(less),
            masks::<L>(a.le(b)),
            floats::<L>(L::F::select(less, b, c)),
            unsigneds::<L>(a.to_bits()),
            floats::<L>(L::F::from_bits(i)),
            unsigneds::<L>(float(|row| convertible(row.a)).to_unsigned()),
            floats::<L>(a.permute(lane)),
            floats::<L>(gathered),
            fours::<L>(parts),
            fours::<L>(awaited),
            scattered.iter().map(|[parts]| joined(parts.map(f32::to_bits))).collect(),
            scattered_twos
                .iter()
                .map(|twos| joined(twos.iter().flatten().map(|part| part.to_bits())))
                .collect(),
            unsigneds::<L>(L::U::splat(0x9000_0001)),
            unsigneds::<L>(L::U::iota()),
            unsigneds::<L>(i),
            unsigneds::<L>(short),
            unsigneds::<L>(i + j),
            unsigneds::<L>(i - j),
            unsigneds::<L>(i * j),
            unsigneds::<L>(i.and(j)),
            unsigneds::<L>(i.or(j)),
            unsigneds::<L>(i.shl::<1>()),
            unsigneds::<L>(i.shl::<31>()),
            unsigneds::<L>(i.shr::<1>()),
            unsigneds::<L>(i.shr::<31>()),
            unsigneds::<L>(i.min(j)),
            unsigneds::<L>(i.max(j)),
            masks::<L>(i.test(j)),
            masks::<L>(i.equal(j)),
            unsigneds::<L>(L::U::select(less, i, j)),
            floats::<L>(i.to_float()),
            unsigneds::<L>(i.permute(lane)),
            masks::<L>(less.and(not_above)),
            masks::<L>(less.or(not_above)),
            masks::<L>(less.not()),
            vec![i.equal(j).any().into(); L::WIDTH],
            past(less.not().bits(), L::WIDTH),
            longer[..L::WIDTH].iter().map(|&x| bits(x)).collect(),
            vec![bits(behind); L::WIDTH],
        ];
        let mut doubles = doubles::<L::D>(rows);
        let last = doubles.pop();
        found.extend(doubles);
        found.push(numbers::<L>(a.mul_add(b, c)));
        found.extend(last);
        found
    }
}

/// Every operation of 64-bit lanes on rows, as many at a time as there are lanes; ×+ comes last.
#[inline(always)]
fn doubles<D: Double>(rows: &[Row]) -> Vec<Vec<Found>> {
    let mut doubles = vec![Vec::new(); DOUBLES.len() + 1];
    for half in rows.chunks(D::COUNT) {
        let double = |of: fn(&Row) -> f64| D::load(&half.iter().map(of).collect::<Vec<_>>());
        let (p, q, r) = (double(|row| row.p), double(|row| row.q), double(|row| row.r));
        let (less, not_above) = (p.lt(q), q.le(r));
        let mut rounded = [0f32; 8];
        p.store_f32(&mut rounded);
        let answers = [
            exact64(D::splat(2.5)),
            exact64(p),
            numbers64(p + q),
            numbers64(p - q),
            numbers64(p * q),
            numbers64(p / q),
            exact64(-p),
            exact64(p.min(q)),
            exact64(p.max(q)),
            exact64(p.abs()),
            numbers64(p.ceil()),
            masks64::<D>(less),
            masks64::<D>(p.le(q)),
            exact64(D::select(less, q, r)),
            rounded[..D::COUNT].iter().map(|&x| number(x)).collect(),
            masks64::<D>(less.and(not_above)),
            masks64::<D>(less.or(not_above)),
            masks64::<D>(less.not()),
            vec![Found::from(less.not().bits()) >> D::COUNT; D::COUNT],
            numbers64(p.mul_add(q, r)),
        ];
        for (all, answer) in doubles.iter_mut().zip(answers) {
            all.extend(answer);
        }
    }
    doubles
}

fn stored<L: Lanes>(x: L::F) -> Vec<f32> {
    let mut lanes = vec![0.0; L::WIDTH];
    x.store(&mut lanes);
    lanes
}

/// Fours of floats, lane by lane.
fn fours<L: Lanes>(parts: [L::F; 4]) -> Vec<Found> {
    let parts = parts.map(floats::<L>);
    (0..L::WIDTH).map(|i| joined([0, 1, 2, 3].map(|c| parts[c][i] as u32))).collect()
}

fn floats<L: Lanes>(x: L::F) -> Vec<Found> {
    stored::<L>(x).into_iter().map(bits).collect()
}

fn numbers<L: Lanes>(x: L::F) -> Vec<Found> {
    stored::<L>(x).into_iter().map(number).collect()
}

fn unsigneds<L: Lanes>(x: L::U) -> Vec<Found> {
    let mut lanes = vec![0; L::WIDTH];
    x.store(&mut lanes);
    lanes.into_iter().map(Found::from).collect()
}

fn masks<L: Lanes>(mask: L::M) -> Vec<Found> {
    (0..L::WIDTH).map(|lane| Found::from(mask.bits() >> lane & 1)).collect()
}

fn stored64<D: Double>(x: D) -> Vec<f64> {
    let mut lanes = vec![0.0; D::COUNT];
    x.store(&mut lanes);
    lanes
}

fn exact64<D: Double>(x: D) -> Vec<Found> {
    stored64(x).into_iter().map(f64::to_bits).collect()
}

fn numbers64<D: Double>(x: D) -> Vec<Found> {
    stored64(x).into_iter().map(number64).collect()
}

fn masks64<D: Double>(mask: D::Mask) -> Vec<Found> {
    (0..D::COUNT).map(|lane| Found::from(mask.bits() >> lane & 1)).collect()
}

#[test]
fn every_operation_is_what_its_trait_says_on_every_lane_set() {
    for lanes in LaneSet::ALL {
        if !lanes.is_supported() {
            eprintln!("skipped: this processor has no {}", lanes.name());
            continue;
        }
        for vector in vectors(lanes.width()) {
            let found = dispatch(lanes, All(&vector));
            assert_eq!(found.len(), operations(lanes).count());
            for ((operation, model, _), found) in operations(lanes).zip(found) {
                let expected: Vec<Found> = (0..vector.len()).map(|lane| model(&vector, lane)).collect();
                assert_eq!(found, expected, "{operation} on {}", lanes.name());
            }
        }
    }
}

/// It rounds ×+ once wherever it runs.
#[test]
fn a_single_lane_is_what_its_trait_says() {
    for row in vectors(1) {
        let fused = MULTIPLY_ADD[1][1];
        for ((name, model, _), found) in DOUBLES.into_iter().chain([fused]).zip(doubles::<f64>(&row)) {
            assert_eq!(found, [model(&row, 0)], "{name}");
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "it needs all inputs, and runs nothing on lanes")]
fn the_inputs_tell_each_operation_from_a_faulty_one() {
    for lanes in [LaneSet::Portable, LaneSet::Avx2] {
        let vectors = vectors(4);
        for (name, model, fault) in operations(lanes) {
            let differs = |vector: &Vec<Row>| (0..4).any(|lane| model(vector, lane) != fault(vector, lane));
            assert!(vectors.iter().any(differs), "{name}");
        }
    }
}

/// Loads from, or stores in, slices that are one value too short.
struct TooShort(usize);

impl Kernel for TooShort {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let (short, half) = (L::WIDTH - 1, L::D::COUNT - 1);
        match self.0 {
            0 => drop(stored::<L>(L::F::load(&vec![0.0; short]))),
            1 => L::F::splat(0.0).store(&mut vec![0.0; short]),
            2 => drop(unsigneds::<L>(L::U::load(&vec![0; short]))),
            3 => drop(unsigneds::<L>(L::U::load_u16(&vec![0; short]))),
            4 => L::U::splat(0).store(&mut vec![0; short]),
            5 => drop(stored64(L::D::load(&vec![0.0; half]))),
            6 => L::D::splat(0.0).store(&mut vec![0.0; half]),
            _ => L::D::splat(0.0).store_f32(&mut vec![0.0; half]),
        }
    }
}

#[test]
fn a_slice_that_is_too_short_stops_the_program_and_is_not_passed() {
    // Also a set that the processor lacks: the portable one takes its place.
    for lanes in LaneSet::ALL {
        for what in 0..8 {
            let ran = catch_unwind(AssertUnwindSafe(|| dispatch(lanes, TooShort(what))));
            assert!(ran.is_err(), "slice {what} on {}", lanes.name());
        }
    }
}
