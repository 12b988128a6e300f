//! Units that files state, as texts such as `kg/(m s²)`.

/// Longest unit that is shown, in letters.
const LONGEST: usize = 40;

/// Symbols of the SI for products of kilogram, metre and second, by the exponents of these.
const DERIVED: [(&str, [f64; 3]); 4] =
    [("Pa", [1.0, -1.0, -2.0]), ("N", [1.0, 1.0, -2.0]), ("J", [1.0, 2.0, -2.0]), ("W", [1.0, 2.0, -3.0])];

/// A unit as a file writes it; `None`: it is blank, or too long to be one.
pub(super) fn stated(text: &str) -> Option<String> {
    let text = text.trim_matches(|letter: char| letter.is_whitespace() || letter == '\0');
    let is_unit = !text.is_empty()
        && text.chars().count() <= LONGEST
        && !text.chars().any(|letter| letter.is_control());
    is_unit.then(|| text.to_owned())
}

/// The product of powers of units; `None`: all exponents are 0, or one is no number.
pub(super) fn product(factors: &[(&str, f64)]) -> Option<String> {
    if factors.iter().any(|factor| !factor.1.is_finite()) {
        return None;
    }
    let exponent = |symbol: &str| factors.iter().find(|own| own.0 == symbol).map_or(0.0, |own| own.1);
    let own = ["kg", "m", "s"].map(exponent);
    let others = || factors.iter().any(|factor| !["kg", "m", "s"].contains(&factor.0) && factor.1 != 0.0);
    if let Some((symbol, _)) = DERIVED.iter().find(|unit| unit.1 == own).filter(|_| !others()) {
        return Some((*symbol).to_owned());
    }
    let side = |sign: f64| -> Vec<String> {
        let own = factors.iter().filter(|factor| sign * factor.1 > 0.0);
        own.map(|&(symbol, exponent)| power(symbol, exponent.abs())).collect()
    };
    let (above, below) = (side(1.0), side(-1.0));
    let numerator = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
    match below.as_slice() {
        [] if above.is_empty() => None,
        [] => Some(numerator),
        [one] => Some(format!("{numerator}/{one}")),
        several => Some(format!("{numerator}/({})", several.join(" "))),
    }
}

fn power(symbol: &str, exponent: f64) -> String {
    if exponent == 1.0 {
        return symbol.to_owned();
    }
    match [(2.0, '²'), (3.0, '³')].iter().find(|raised| raised.0 == exponent) {
        Some((_, raised)) => format!("{symbol}{raised}"),
        None => format!("{symbol}^{exponent}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::expression::Dimension;

    #[test]
    fn products_are_written_as_units_are_read() {
        let of = |exponents: [f64; 4]| {
            let factors: Vec<(&str, f64)> = ["kg", "m", "s", "K"].into_iter().zip(exponents).collect();
            product(&factors)
        };
        for (exponents, text) in [
            ([0.0, 1.0, -1.0, 0.0], "m/s"),
            ([1.0, -1.0, -2.0, 0.0], "Pa"),
            ([0.0, 2.0, -2.0, 0.0], "m²/s²"),
            ([1.0, 0.0, -3.0, -1.0], "kg/(s³ K)"),
            ([0.0, 0.0, -1.0, 0.0], "1/s"),
            ([0.0, 0.5, -4.0, 0.0], "m^0.5/s^4"),
        ] {
            assert_eq!(of(exponents).as_deref(), Some(text));
            if text != "m^0.5/s^4" {
                assert!(Dimension::parse(text).is_ok(), "{text}");
            }
        }
        assert_eq!([of([0.0; 4]), of([f64::NAN, 0.0, 0.0, 0.0])], [None, None]);
        assert_eq!(
            [stated(" m/s \0"), stated("  "), stated(&"m".repeat(41))],
            [Some("m/s".into()), None, None]
        );
    }
}
