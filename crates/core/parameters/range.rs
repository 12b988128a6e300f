//! Ranges of numbers.

/// The range of a number. Numbers are finite unless the range says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// True if `min` itself is excluded.
    pub above_min: bool,
    /// True if `max` itself is excluded.
    pub below_max: bool,
    /// True if infinite values are allowed.
    pub infinite: bool,
}

impl Range {
    /// Any finite number.
    pub const ANY: Range = Range {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        above_min: false,
        below_max: false,
        infinite: false,
    };
    /// Any number, infinite ones too.
    pub const ANY_OR_INFINITE: Range = Range { infinite: true, ..Range::ANY };

    /// `min` or more.
    pub const fn at_least(min: f64) -> Range {
        Range { min, ..Range::ANY }
    }

    /// More than `min`.
    pub const fn above(min: f64) -> Range {
        Range { min, above_min: true, ..Range::ANY }
    }

    /// From `min` to `max`, both included.
    pub const fn within(min: f64, max: f64) -> Range {
        Range { min, max, ..Range::ANY }
    }

    /// Between `min` and `max`, both excluded.
    pub const fn between(min: f64, max: f64) -> Range {
        Range { min, max, above_min: true, below_max: true, infinite: false }
    }

    /// True if `x` lies in the range; NaN never does.
    pub fn holds(&self, x: f64) -> bool {
        (x.is_finite() || (self.infinite && x.is_infinite()))
            && (x > self.min || (x == self.min && !self.above_min))
            && (x < self.max || (x == self.max && !self.below_max))
    }
}

impl std::fmt::Display for Range {
    /// "above 0", "0 or more", "from 0 to 1", "between 0 and 180", or nothing.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Range { min, max, above_min, below_max, infinite } = *self;
        match (min.is_finite(), max.is_finite()) {
            (false, false) => Ok(()),
            (true, false) if above_min => write!(f, "above {min}"),
            (true, false) => write!(f, "{min} or more"),
            (false, true) if below_max => write!(f, "below {max}"),
            (false, true) => write!(f, "{max} or less"),
            (true, true) if above_min && below_max => write!(f, "between {min} and {max}"),
            (true, true) if above_min => write!(f, "above {min}, up to {max}"),
            (true, true) if below_max => write!(f, "from {min} to below {max}"),
            (true, true) => write!(f, "from {min} to {max}"),
        }?;
        if infinite && (min.is_finite() || max.is_finite()) {
            f.write_str(", or inf")?;
        }
        Ok(())
    }
}
