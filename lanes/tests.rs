//! The three lane sets agree, operation by operation.

use super::*;

/// A few operations on every lane: what a processor without the features would get wrong first.
struct Everything<'a> {
    a: &'a [f32],
    b: &'a [f32],
    out: &'a mut Vec<f32>,
}

impl Kernel for Everything<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let mut buffer = [f32::NAN; 16];
        for (a, b) in self.a.chunks_exact(L::WIDTH).zip(self.b.chunks_exact(L::WIDTH)) {
            let (x, y) = (L::F::load(a), L::F::load(b));
            let low = L::U::iota().and(L::U::splat(3));
            let results = [
                x + y,
                x - y,
                x * y,
                x / y,
                -x,
                x.min(y),
                x.max(y),
                x.abs().sqrt(),
                x.round(),
                x.floor(),
                L::F::select(x.lt(y), x, y),
                L::F::select(x.le(y).not(), x, y),
                L::F::from_bits(x.to_bits().and(L::U::splat(0x7fff_ffff))),
                x.abs().to_unsigned().to_float(),
                x.permute(low),
                L::F::from_bits(x.to_bits().shr::<3>().shl::<2>()),
                L::F::select(low.test(L::U::splat(1)), x, y),
                L::F::select(low.equal(L::U::splat(2)).or(x.lt(y)), x, y),
                low.min(L::U::splat(2)).max(L::U::splat(1)).to_float(),
            ];
            for result in results {
                // Only the first four lanes, so that all sets write the same list.
                result.store(&mut buffer);
                self.out.extend_from_slice(&buffer[..4]);
            }
        }
    }
}

#[test]
fn lane_sets_agree() {
    // Four values at a time, repeated so that wider sets see the same first four.
    let pairs: [([f32; 4], [f32; 4]); 2] =
        [([1.5, -2.25, 0.0, 1e-3], [2.0, -3.0, 1.0, 5.0]), ([7.75, -1e6, 3.5, 2.5], [-7.5, 1e-6, 3.5, -0.5])];
    let run = |lanes: LaneSet| {
        let width = lanes.width();
        let repeat = |v: &[f32; 4]| v.iter().cycle().take(width).copied().collect::<Vec<_>>();
        let mut out = Vec::new();
        for (a, b) in &pairs {
            dispatch(lanes, Everything { a: &repeat(a), b: &repeat(b), out: &mut out });
        }
        out
    };
    let expected = run(LaneSet::Portable);
    assert_eq!(expected.len(), 2 * 19 * 4);
    for lanes in [LaneSet::Avx2, LaneSet::Avx512] {
        if !lanes.is_supported() {
            eprintln!("skipped: this processor has no {}", lanes.name());
            continue;
        }
        for (k, (got, want)) in run(lanes).iter().zip(&expected).enumerate() {
            assert_eq!(got.to_bits(), want.to_bits(), "{} operation {} lane {}", lanes.name(), k / 4, k % 4);
        }
    }
}
