//! The cases that the program carries: exact values computed elsewhere with many digits, and chains too long for a file,
//! whose values are closed forms.

use super::case::{Case, Kind, SegmentCase, parse};
use voltet_core::Result;
use voltet_optics::Contribution;

/// 1,519 cases, computed with 90 digits and checked by a second route.
const SEGMENTS: &str = include_str!("fixtures/segments.jsonl");

/// Random variations of the same kinds, computed apart with 77 digits by quadrature alone.
const VARIATIONS: &str = include_str!("fixtures/variations.jsonl");

/// Triangular Gaussians over fields, computed with 60 digits by `fixtures/triangular_gaussian_nd.py`.
const TRIANGULAR_ND: &str = include_str!("fixtures/triangular_gaussian_nd.jsonl");

/// Stiff, steep and narrow segments of up to 1e30 of depth, summed with 60 digits (`stiff.py` beside them).
const STIFF: &str = include_str!("fixtures/stiff.jsonl");

/// Length of the chains beyond those in the files.
const CHAIN_LENGTH: i32 = 100_000;

/// Opacities of their segments, 2 to these powers: exact in 32 bits.
const CHAIN_OPACITIES: [i32; 3] = [-8, -14, -20];

/// Every case that the program carries.
pub fn shipped() -> Result<Vec<Case>> {
    let lines = [SEGMENTS, VARIATIONS, TRIANGULAR_ND].into_iter().flat_map(str::lines);
    let lines = lines.filter(|line| !line.trim().is_empty());
    let mut cases = lines.map(parse).collect::<Result<Vec<Case>>>()?;
    cases.extend(CHAIN_OPACITIES.map(|power| chain(CHAIN_LENGTH, power)));
    Ok(cases)
}

/// The segments of the first of these files, each with its name and category.
pub fn segment_cases() -> Result<Vec<(String, String, SegmentCase)>> {
    let cases = SEGMENTS.lines().map(parse).collect::<Result<Vec<Case>>>()?;
    let segments = cases.into_iter().filter_map(|case| match case.kind {
        Kind::Segment(segment) => Some((case.id, case.category, *segment)),
        Kind::Ray { .. } | Kind::Chain { .. } | Kind::Table { .. } => None,
    });
    Ok(segments.collect())
}

/// Segments for a quadrature of 64 bits alone: closed forms lose digits on the narrowest of them, as rounding their values
/// does.
pub fn stiff() -> Result<Vec<Case>> {
    STIFF.lines().map(parse).collect()
}

/// n equal segments of opacity a = 2^power: 1 − A = (1 − a)^n, and C = c A of the colour c·a of each.
fn chain(length: i32, power: i32) -> Case {
    let opacity = 2f64.powi(power);
    // ln (1 − A); its rounding is 1e-16 of a number under 4,000, far under the bound of so many steps.
    let log = f64::from(length) * (-opacity).ln_1p();
    let whole = -log.exp_m1();
    let color = [1.0, 0.5, 0.25];
    let segment = Contribution { optical_depth: 0.0, color: color.map(|c| c * opacity), opacity };
    let (segments, color) = (vec![segment; length as usize], color.map(|c| c * whole));
    Case {
        id: format!("chain-{length}-equal{power}"),
        category: "chain".into(),
        subject: length.to_string(),
        kind: Kind::Chain { segments, color, opacity: whole, transparency: log.exp() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_generated_chain_has_the_values_of_its_steps() {
        let case = chain(100_000, -14);
        let Kind::Chain { segments, color, opacity, transparency } = case.kind else { panic!("no chain") };
        // Kahan's sum of logarithms: another route to ln (1 − A).
        let (mut sum, mut rest) = (0.0, 0.0);
        for segment in &segments {
            let term = f64::ln_1p(-segment.opacity) - rest;
            let next: f64 = sum + term;
            rest = (next - sum) - term;
            sum = next;
        }
        assert!((transparency / f64::exp(sum) - 1.0).abs() < 1e-14);
        assert!((opacity + transparency - 1.0).abs() < 1e-15);
        assert_eq!(color[1], 0.5 * opacity);
    }
}
