//! Patterns in names of entries: regular expressions, which the whole of a name must fit.

/// Longest pattern that is read, in bytes.
const LONGEST: usize = 256;

/// A step of a pattern; distances are from the step itself.
#[derive(Clone)]
enum PatternStep {
    /// One letter that is in a range, or, if not `is_in`, in none.
    Letter { ranges: Vec<(char, char)>, is_in: bool },
    /// Goes on at both places.
    Fork(isize, isize),
}

/// A regular expression of letters, `. * + ? | ( ) [ ]` and signs behind a backslash.
pub(super) struct Pattern(Vec<PatternStep>);

impl Pattern {
    /// The pattern of a text; `None` of one that is not understood.
    pub fn new(text: &str) -> Option<Pattern> {
        if text.len() > LONGEST {
            return None;
        }
        let letters: Vec<char> = text.chars().collect();
        let mut rest = &letters[..];
        let steps = choice(&mut rest)?;
        rest.is_empty().then_some(Pattern(steps))
    }

    /// The pattern that every name fits.
    pub fn any() -> Pattern {
        Pattern(repeated(vec![any_letter()]))
    }

    /// True if the whole of a name fits.
    pub fn fits(&self, name: &str) -> bool {
        let mut places = self.reached([0]);
        for letter in name.chars() {
            let is_next = |place: &usize| match self.0.get(*place) {
                Some(PatternStep::Letter { ranges, is_in }) => {
                    ranges.iter().any(|range| (range.0..=range.1).contains(&letter)) == *is_in
                }
                _ => false,
            };
            let next: Vec<usize> = (0..places.len())
                .filter(|&place| places[place])
                .filter(is_next)
                .map(|place| place + 1)
                .collect();
            places = self.reached(next);
        }
        places[self.0.len()]
    }

    /// True at places that are reached without a letter.
    fn reached(&self, from: impl IntoIterator<Item = usize>) -> Vec<bool> {
        let mut places = vec![false; self.0.len() + 1];
        let mut open: Vec<usize> = from.into_iter().collect();
        while let Some(place) = open.pop() {
            if std::mem::replace(&mut places[place], true) {
                continue;
            }
            if let Some(PatternStep::Fork(one, other)) = self.0.get(place) {
                open.extend([one, other].map(|&distance| place.saturating_add_signed(distance)));
            }
        }
        places
    }
}

fn any_letter() -> PatternStep {
    PatternStep::Letter { ranges: Vec::new(), is_in: false }
}

/// Steps any number of times.
fn repeated(steps: Vec<PatternStep>) -> Vec<PatternStep> {
    let back = -(steps.len() as isize) - 1;
    let skip = PatternStep::Fork(1, steps.len() as isize + 2);
    [vec![skip], steps, vec![PatternStep::Fork(back, back)]].concat()
}

/// Sequences between bars.
fn choice(rest: &mut &[char]) -> Option<Vec<PatternStep>> {
    let one = sequence(rest)?;
    let Some(after) = rest.strip_prefix(&['|']) else { return Some(one) };
    *rest = after;
    let other = choice(rest)?;
    let over = other.len() as isize + 1;
    let fork = PatternStep::Fork(1, one.len() as isize + 2);
    Some([vec![fork], one, vec![PatternStep::Fork(over, over)], other].concat())
}

/// Parts one after the other, each with the sign of its repetition.
fn sequence(rest: &mut &[char]) -> Option<Vec<PatternStep>> {
    let mut all = Vec::new();
    while !matches!(rest.first(), None | Some('|' | ')')) {
        let part = part(rest)?;
        let length = part.len() as isize;
        let sign = rest.first().copied();
        if matches!(sign, Some('*' | '+' | '?')) {
            *rest = &rest[1..];
        }
        all.extend(match sign {
            Some('*') => repeated(part),
            Some('+') => [part, vec![PatternStep::Fork(-length, 1)]].concat(),
            Some('?') => [vec![PatternStep::Fork(1, length + 1)], part].concat(),
            _ => part,
        });
    }
    Some(all)
}

/// A letter, a set of letters, or what brackets hold.
fn part(rest: &mut &[char]) -> Option<Vec<PatternStep>> {
    let (&first, after) = rest.split_first()?;
    *rest = after;
    match first {
        '(' => {
            let steps = choice(rest)?;
            *rest = rest.strip_prefix(&[')'])?;
            Some(steps)
        }
        '[' => set(rest).map(|step| vec![step]),
        '.' => Some(vec![any_letter()]),
        '*' | '+' | '?' | '{' | '}' | ']' | '^' | '$' => None,
        '\\' => escaped(rest)
            .map(|letter| vec![PatternStep::Letter { ranges: vec![(letter, letter)], is_in: true }]),
        letter => Some(vec![PatternStep::Letter { ranges: vec![(letter, letter)], is_in: true }]),
    }
}

/// The sign behind a backslash; of letters and digits the meaning is another.
fn escaped(rest: &mut &[char]) -> Option<char> {
    let (&sign, after) = rest.split_first()?;
    *rest = after;
    (!sign.is_alphanumeric() && !"<>".contains(sign)).then_some(sign)
}

/// Letters and ranges of them to the bracket's end.
fn set(rest: &mut &[char]) -> Option<PatternStep> {
    let is_in = rest.first() != Some(&'^');
    *rest = &rest[usize::from(!is_in)..];
    let mut ranges = Vec::new();
    loop {
        let (&first, after) = rest.split_first()?;
        *rest = after;
        let first = match first {
            ']' if ranges.is_empty() => return None,
            ']' => return Some(PatternStep::Letter { ranges, is_in }),
            '[' => return None,
            '\\' => escaped(rest)?,
            letter => letter,
        };
        let last = match **rest {
            ['-', last, ..] if !matches!(last, ']' | '[' | '\\') => {
                *rest = &rest[2..];
                last
            }
            _ => first,
        };
        ranges.push((first, last));
    }
}

#[cfg(test)]
mod tests {
    use super::Pattern;

    #[test]
    fn patterns_name_patches() {
        let fits = |pattern: &str, name: &str| Pattern::new(pattern).map(|own| own.fits(name));
        for (pattern, names) in [
            (".*", "a wall1 "),
            ("(wall|inlet).*", "wall1 inlet"),
            ("wall(1|2)", "wall1 wall2"),
            ("w.*l.*", "wall1 wl"),
            ("wall[0-9]+", "wall1 wall20"),
            ("(a|b)*c?", "abba abc c"),
            (r"a\.[^x-z_]", "a.b"),
            ("((a))|(b|)", "a b"),
        ] {
            assert!(names.split_whitespace().all(|name| fits(pattern, name) == Some(true)), "{pattern}");
        }
        for (pattern, name) in [
            ("wall", "wall1"),
            ("(a|b)", "ab"),
            ("wall(1|2)", "wall"),
            ("w.*2", "wall"),
            ("wall[0-9]+", "wall"),
            (r"a\.[^x-z_]", "a.y"),
            ("a+", ""),
        ] {
            assert_eq!(fits(pattern, name), Some(false), "{pattern} {name}");
        }
        for pattern in ["(a", "a)", "a{2}", "*a", "[[:alpha:]]", r"\d", "(?i)a", "^a$", "[]", "[a"] {
            assert!(Pattern::new(pattern).is_none(), "{pattern}");
        }
        assert!(Pattern::any().fits("wall"));
    }

    #[test]
    fn long_patterns_end_at_once() {
        assert!(Pattern::new(&"()".repeat(200_000)).is_none());
        assert!(Pattern::new(&"(".repeat(256)).is_none());
        let slow = Pattern::new(&format!("{}b", ".*a".repeat(80))).map(|own| own.fits(&"a".repeat(2000)));
        assert_eq!(slow, Some(false));
        let nested = format!("{}a{}", "(".repeat(80), ")*".repeat(80));
        assert_eq!(Pattern::new(&nested).map(|own| own.fits(&"a".repeat(200))), Some(true));
    }
}
