//! The tolerance of `adaptive` is kept on every exact case.

use voltet_core::transfer::TransferFunction;
use voltet_judge::{Kind, SegmentCase, parse};
use voltet_optics::integrators::{Adaptive, SegmentIntegrator};
use voltet_optics::{Contribution, Segment};

const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Relative error that is allowed in place of the tolerance where a colour is so bright (constant-emitter, long segments) that
/// this is larger.
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

#[test]
fn the_tolerance_is_met_on_every_exact_case() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/segments.jsonl");
    let text = std::fs::read_to_string(path).expect("the case file is part of the source");
    let mut judged = 0;
    for case in text.lines().map(|line| parse(line).expect("well formed")) {
        // Where the result is discontinuous, or its condition leaves no digits, no tolerance can be met.
        let known = |s: &SegmentCase| s.conditions.differences.iter().all(|k| k.is_some_and(|k| k < 1e7));
        if let Kind::Segment(found) = &case.kind
            && (known(found) || case.category == "edges")
        {
            let broken = breaks(&found.transfer_function, &found.segment(), &found.exact);
            assert_eq!(broken, None, "{}", case.id);
            judged += 1;
        }
    }
    assert!(judged > 900, "only {judged} cases were judged");
}
