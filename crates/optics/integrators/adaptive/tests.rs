//! The tolerance of `adaptive` is kept, whatever the widgets and the segment.

use super::*;
use crate::integrators::Analytic;
use crate::tests::segment;
use proptest::prelude::*;
use voltet_testing::random::transfer_function;

const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Where a colour is so bright (constant-emitter, long segments) that 1e-10 of it exceeds the tolerance, the
/// exact integral's own error is asked for.
const WORKING: f64 = 1e-10;

/// The first tolerance that is not met.
fn breaks(transfer_function: &TransferFunction, segment: &Segment, exact: &Contribution) -> Option<String> {
    for tolerance in TOLERANCES {
        let adaptive = Adaptive::new(transfer_function, tolerance).expect("valid");
        let found = adaptive.integrate(segment);
        let pairs = found.color.iter().zip(&exact.color).chain([(&found.opacity, &exact.opacity)]);
        for (found, exact) in pairs {
            let error = (found - exact).abs();
            if error.is_nan() || error > tolerance.max(WORKING * exact) {
                return Some(format!("tolerance {tolerance}: {found}, not {exact}: error {error:e}"));
            }
        }
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(3000) })]

    #[test]
    fn the_tolerance_is_met_on_random_segments(
        transfer_function in transfer_function(), segment in segment(),
    ) {
        let exact = Analytic::new(&transfer_function, WidgetBlend::Exact).expect("valid").integrate(&segment);
        prop_assert_eq!(breaks(&transfer_function, &segment, &exact), None);
    }
}
