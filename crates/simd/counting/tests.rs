//! Counts of operations.

use super::*;
use crate::{Kernel, LaneSet, dispatch};

/// (x² + x)/2 − √x in 32 bits, and a product in 64: a product, a multiply-add, a root, a difference, and one that counts alike.
struct Known;

impl Kernel for Known {
    type Output = f32;
    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let x = L::F::splat(4.0);
        let value = (x.mul_add(x, x) * L::F::splat(0.5) - x.sqrt()).max(L::F::splat(0.0));
        let mut lanes = [0.0; 16];
        value.store(&mut lanes);
        let mut wide = [0.0; 8];
        (L::D::splat(3.0) * L::D::splat(2.0)).store(&mut wide);
        lanes[0] + wide[0] as f32
    }
}

#[test]
fn a_kernel_counts_what_it_computes_and_computes_the_same() {
    for set in LaneSet::ALL.into_iter().filter(|set| set.is_supported()) {
        let (found, counted) = count(|| dispatch(set, Known));
        assert_eq!(found, 14.0, "{}", set.name());
        assert_eq!(counted, 5 * set.width() as u64, "{}", set.name());
        assert_eq!(dispatch(set, Known), 14.0);
    }
    assert_eq!(count(|| ()).1, 0, "what came before, or was not asked for, is not counted");
}
