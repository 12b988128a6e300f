//! Counts with their nouns in messages: "1 cell", "2 cells", "3 vertices".

use std::fmt::Display;

/// A count with its noun, which is given in the singular.
pub fn counted<N: Display + PartialEq + From<u8>>(count: N, noun: &str) -> String {
    let noun = noun_of(&count, noun);
    format!("{count} {noun}")
}

/// A whole number with its thousands apart.
pub fn with_commas(count: impl Display) -> String {
    let digits = count.to_string().into_bytes();
    let groups = digits.rchunks(3).rev().map(String::from_utf8_lossy);
    groups.collect::<Vec<_>>().join(",")
}

/// A noun, given in the singular, in the number of a count.
pub fn noun_of<N: PartialEq + From<u8>>(count: &N, noun: &str) -> String {
    agreeing(count, noun, &plural(noun)).into()
}

/// The word for one, or that for any other count: "is", "are".
pub fn agreeing<'a, N: PartialEq + From<u8>>(count: &N, one: &'a str, other: &'a str) -> &'a str {
    if *count == N::from(1) { one } else { other }
}

/// The plural of a noun of the field; of several words, the last changes.
fn plural(noun: &str) -> String {
    for (ending, plural) in [("hedron", "hedra"), ("vertex", "vertices")] {
        if let Some(stem) = noun.strip_suffix(ending) {
            return format!("{stem}{plural}");
        }
    }
    format!("{noun}s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noun_agrees_with_its_count() {
        assert_eq!(counted(1_u64, "ghost cell"), "1 ghost cell");
        assert_eq!(counted(0_usize, "cell"), "0 cells");
        assert_eq!(counted(21_u32, "tetrahedron"), "21 tetrahedra");
        assert_eq!(counted(2_u8, "poly-vertex"), "2 poly-vertices");
        assert_eq!([0, 999, 1000, 12_345_678].map(with_commas), ["0", "999", "1,000", "12,345,678"]);
        assert_eq!([1, 2].map(|count: u64| agreeing(&count, "is", "are")), ["is", "are"]);
    }
}
