//! Axes in powers of ten, and what letters can show.

/// An axis in powers of ten.
pub struct Axis {
    /// Decadic logarithm of its least value.
    pub low: f64,
    /// Decadic logarithm of its largest value.
    pub high: f64,
    start: f64,
    end: f64,
}

impl Axis {
    /// Covers the values with some room, one power of ten at least.
    pub fn over(values: impl Iterator<Item = f64>, start: f64, end: f64) -> Axis {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|v| v.is_finite() && *v > 0.0) {
            (low, high) = (low.min(value.log10()), high.max(value.log10()));
        }
        if low > high {
            (low, high) = (-0.5, 0.5);
        }
        let room = (0.06 * (high - low)).max(0.5 * (1.0 - (high - low))).max(0.05);
        Axis { low: low - room, high: high + room, start, end }
    }

    /// Coordinate of a value.
    pub fn place(&self, value: f64) -> f64 {
        self.start + (value.log10() - self.low) / (self.high - self.low) * (self.end - self.start)
    }

    /// Ticks with their labels: the powers of ten, between them 2 … 9, labelled where there is room.
    pub fn ticks(&self) -> Vec<(f64, Option<String>)> {
        let span = self.high - self.low;
        let mut ticks = Vec::new();
        for power in self.low.floor() as i32..=self.high.ceil() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(power);
                if (self.low..=self.high).contains(&value.log10()) {
                    let labelled = digit == 1 || span < 2.2 && matches!(digit, 2 | 5);
                    ticks.push((value, labelled.then(|| number(digit, power))));
                }
            }
        }
        ticks
    }
}

/// digit × 10^power, as short as can be.
fn number(digit: i32, power: i32) -> String {
    match power {
        0..=4 => (i64::from(digit) * 10i64.pow(power as u32)).to_string(),
        -2..=-1 => format!("{:.*}", (-power) as usize, f64::from(digit) * 10f64.powi(power)),
        _ => format!("{digit}e{power}"),
    }
}

/// Text cut to this length, without characters that the font lacks (beyond Latin-1).
pub fn shown(text: &str, most: usize) -> String {
    let known = |c: char| matches!(c, ' '..='~' | '\u{a0}'..='\u{ff}');
    text.chars().map(|c| if known(c) { c } else { '?' }).take(most).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_short() {
        assert_eq!(number(2, 3), "2000");
        assert_eq!(number(5, -1), "0.5");
        assert_eq!(number(1, -4), "1e-4");
        assert_eq!(shown("52 °C → 1", 8), "52 °C ? ");
    }
}
