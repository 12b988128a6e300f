//! The referee's segments by the exact values.

use voltet_core::optics::Overlap;
use voltet_core::reference::integrate;
use voltet_core::transfer::OpticalModel;
use voltet_judge::{Kind, parse};

/// The fixtures' exact values, by the bound that they state for quadrature: 1e-10 (narrow: 1e-9) of the value
/// and the condition number's share. C has the fixtures' floor; values below 1e-290 are not judged. Of the
/// cases with thousands of bands every sixth is enough.
#[test]
fn segments_equal_the_exact_values() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/segments.jsonl");
    let text = std::fs::read_to_string(path).expect("the case file is part of the source");
    let mut judged = 0;
    for (line_number, line) in text.lines().enumerate() {
        let case = parse(line).expect("the case file is well formed");
        let Kind::Segment(segment) = &case.kind else { continue };
        if case.category == "bands" && line_number % 6 != 0 {
            continue;
        }
        let found =
            integrate(&segment.segment(), &segment.transfer_function, Overlap::Exact).expect("integrates");
        let relative = if case.category == "narrow" { 1e-9 } else { 1e-10 };
        let condition = |k: f64| if case.category == "edges" { 5.0 } else { k };
        let exact = &segment.exact;
        let mut compare = |what: &str, found: f64, exact: f64, k: f64, floor: f64| {
            let k = condition(k);
            if !k.is_finite() {
                return;
            }
            let allowed = (relative + 8.0 * f64::EPSILON * (4.0 + k)) * exact.abs() + floor;
            assert!((found - exact).abs() <= allowed, "{} {what}: {found:e} for {exact:e}", case.id);
            judged += 1;
        };
        let [k_t, k_c, k_a] = segment.condition.map(|k| k.unwrap_or(f64::INFINITY));
        compare("T", found.optical_depth, exact.optical_depth, k_t, 1e-290);
        compare("A", found.opacity, exact.opacity, k_a, 1e-290);
        let depth = exact.optical_depth;
        let most = match segment.transfer_function.model {
            OpticalModel::DensityEmitter => depth.min(1.0),
            OpticalModel::ConstantEmitter { .. } => {
                segment.length / segment.transfer_function.unit_distance * (1.0 / depth).min(1.0)
            }
        };
        for c in 0..3 {
            compare("C", found.color[c], exact.color[c], k_c, 1e-16 * segment.brightest() * most + 1e-290);
        }
    }
    assert!(judged > 6000, "{judged} values judged");
}
