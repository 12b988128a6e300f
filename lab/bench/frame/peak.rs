//! The machine's 32-bit multiply-adds a second: what times are held against.

use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;
use voltet::lanes::{Float, Kernel, LaneSet, Lanes, dispatch};

/// Chains that wait for nothing but themselves: more than a processor's units times their latency, and few enough for 16
/// registers of AVX2.
const CHAINS: usize = 12;
const ROUNDS: usize = 1 << 20;

struct Chains;

impl Kernel for Chains {
    type Output = f32;
    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        // Sums stay near 1: no number that a processor might treat apart.
        let (factor, summand) = (L::F::splat(black_box(0.5)), L::F::splat(black_box(0.5)));
        let start = L::F::splat(0.5);
        // Names, not an array: an array would stay in memory.
        macro_rules! chains {
            ($($sum:ident)*) => {{
                $(let mut $sum = start;)*
                // A range is called in builds that are optimised lightly, and then these leave their registers.
                let mut round = 0;
                while round < ROUNDS {
                    $($sum = $sum.mul_add(factor, summand);)*
                    round += 1;
                }
                [$($sum),*]
            }};
        }
        let sums: [L::F; CHAINS] = chains!(a b c d e f g h i j k l);
        let mut lanes = [0.0; 16];
        sums.into_iter().fold(L::F::splat(0.0), |whole, sum| whole + sum).store(&mut lanes);
        lanes[0]
    }
}

/// Lanes of a set.
struct Width;

impl Kernel for Width {
    type Output = usize;
    #[inline(always)]
    fn run<L: Lanes>(self) -> usize {
        L::WIDTH
    }
}

/// Multiply-adds a second of all threads of the pool that this runs in; the best of some tries, as what else runs only slows
/// it down.
pub fn multiply_adds_per_second(lanes: LaneSet) -> f64 {
    let threads = rayon::current_num_threads();
    let each = (CHAINS * ROUNDS * dispatch(lanes, Width)) as f64;
    let once = || {
        let start = Instant::now();
        (0..threads).into_par_iter().with_max_len(1).for_each(|_| {
            black_box(dispatch(lanes, Chains));
        });
        each * threads as f64 / start.elapsed().as_secs_f64()
    };
    (0..7).map(|_| once()).fold(0.0, f64::max)
}
