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
                // Only the first eight lanes, so that sixteen and eight lanes write the same list.
                result.store(&mut buffer);
                self.out.extend_from_slice(&buffer[..8]);
            }
        }
    }
}

#[test]
fn lane_sets_agree() {
    // Eight different values, repeated twice so that sixteen lanes see the same first eight.
    let a8 = [1.5f32, -2.25, 0.0, 1e-3, 7.75, -1e6, 3.5, 2.5];
    let b8 = [2.0f32, -3.0, 1.0, 5.0, -7.5, 1e-6, 3.5, -0.5];
    let run = |lanes: LaneSet| {
        let width = if lanes == LaneSet::Avx512 { 16 } else { 8 };
        let repeat = |v: &[f32; 8]| v.iter().cycle().take(width).copied().collect::<Vec<_>>();
        let mut out = Vec::new();
        dispatch(lanes, Everything { a: &repeat(&a8), b: &repeat(&b8), out: &mut out });
        out
    };
    let expected = run(LaneSet::Portable);
    assert_eq!(expected.len(), 19 * 8);
    for lanes in [LaneSet::Avx2, LaneSet::Avx512] {
        if !lanes.is_supported() {
            eprintln!("skipped: this processor has no {}", lanes.name());
            continue;
        }
        for (k, (got, want)) in run(lanes).iter().zip(&expected).enumerate() {
            assert_eq!(got.to_bits(), want.to_bits(), "{} operation {} lane {}", lanes.name(), k / 8, k % 8);
        }
    }
}
