//! The referee's segments by the exact values.

use voltet_core::transfer::OpticalModel;
use voltet_judge::{Kind, parse, stiff};
use voltet_optics::WidgetBlend;
use voltet_reference::integrate;

/// The fixtures' exact values, by the bound that they state for quadrature: 1e-10 (narrow: 1e-9) of the value
/// and the condition number's share. C has the fixtures' floor; values below 1e-290 are not judged. Of the
/// cases with thousands of bands every sixth is enough.
#[test]
fn segments_equal_the_exact_values() {
    let read = |name: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../judge/fixtures").join(name);
        std::fs::read_to_string(path).expect("the case file is part of the source")
    };
    let text = ["segments.jsonl", "triangular_gaussian_nd.jsonl"].map(read).concat();
    let mut judged = 0;
    for (line_number, line) in text.lines().enumerate() {
        let case = parse(line).expect("the case file is well formed");
        let Kind::Segment(segment) = &case.kind else { continue };
        if case.category == "bands" && line_number % 6 != 0 {
            continue;
        }
        let found = integrate(&segment.segment(), &segment.transfer_function, WidgetBlend::Exact)
            .expect("integrates");
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
        let [k_t, k_c, k_a] = segment.conditions.differences.map(|k| k.unwrap_or(f64::INFINITY));
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

/// Stiff, steep and narrow segments, up to 1e30 of depth in one cell, against values that were summed with 60 digits
/// (`fixtures/stiff.py`): ten times what the quadrature allows itself. What is behind a depth of 37 need not be found.
#[test]
fn stiff_segments_equal_the_exact_values() {
    let (mut wrong, mut judged) = (Vec::new(), 0);
    for case in stiff().expect("the case file is well formed") {
        let Kind::Segment(segment) = &case.kind else { continue };
        judged += 1;
        let found = match integrate(&segment.segment(), &segment.transfer_function, WidgetBlend::Exact) {
            Ok(found) => found,
            Err(error) => {
                wrong.push(format!("{} ({}): {error}", case.id, case.subject));
                continue;
            }
        };
        let exact = &segment.exact;
        let most = match segment.transfer_function.model {
            OpticalModel::DensityEmitter => exact.optical_depth.min(1.0),
            OpticalModel::ConstantEmitter { .. } => exact.color.iter().copied().fold(0.0, f64::max),
        };
        let floor = 1e-16 * segment.brightest() * most;
        let mut compare = |what: &str, found: f64, exact: f64, floor: f64| {
            let error = (found - exact).abs();
            if error.is_nan() || error > 1e-10 * exact + floor {
                wrong.push(format!("{} ({}) {what}: {found:e} for {exact:e}", case.id, case.subject));
            }
        };
        compare("T", found.optical_depth, exact.optical_depth, 1e-290);
        compare("A", found.opacity, exact.opacity, 1e-290);
        (0..3).for_each(|c| compare("C", found.color[c], exact.color[c], floor + 1e-290));
    }
    assert!(wrong.is_empty(), "{} of {judged} cases:\n{}", wrong.len(), wrong.join("\n"));
    assert!(judged > 180, "{judged} cases judged");
}
