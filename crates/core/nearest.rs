//! The nearest known names to a mistyped one.

use std::collections::BTreeSet;

/// Characters of a name that are compared.
const COMPARED: usize = 64;

/// Edit distance with transpositions of neighbours (optimal string alignment), in characters, of names in any case. Only their
/// first characters count where they are long, since files make names of any length.
pub fn edit_distance(a: &str, b: &str) -> usize {
    let [a, b] = [a, b].map(|name| name.to_lowercase().chars().take(COMPARED).collect::<String>());
    strsim::osa_distance(&a, &b)
}

/// The candidate nearest to `name`, if any is near enough to be what was meant: at most a third of the longer
/// name's characters differ, or one name begins with the other.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let longest = name.chars().count().max(candidate.chars().count());
        let mut steps = edit_distance(name, candidate);
        let begins = name.len() >= 3 && (candidate.starts_with(name) || name.starts_with(candidate));
        if begins && !candidate.is_empty() {
            steps = steps.min(longest / 3);
        }
        if steps <= (longest / 3).max(1) && steps < longest && best.is_none_or(|(least, _)| steps < least) {
            best = Some((steps, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// The candidates, each once, the nearest to `name` first; equally near ones stay in their order.
pub fn nearest_first<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    let mut candidates: Vec<&str> = candidates.into_iter().filter(|name| seen.insert(*name)).collect();
    candidates.sort_by_cached_key(|candidate| edit_distance(name, candidate));
    if let Some(near) = nearest(name, candidates.iter().copied()) {
        // A name that begins with the other is the nearest, whatever its length.
        candidates.sort_by_key(|candidate| *candidate != near);
    }
    candidates
}

/// A clause for an error's `expected`: the nearest of the candidates, and all of them where they are few; otherwise those that are
/// nearest.
pub fn suggest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    const SHOWN: usize = 24;
    let mut seen = BTreeSet::new();
    let candidates: Vec<&str> = candidates.into_iter().filter(|name| seen.insert(*name)).collect();
    let listed = match candidates[..] {
        [] => "another: there are no names to choose from".to_string(),
        [only] => format!("'{only}'"),
        _ if candidates.len() <= SHOWN => format!("one of {}", candidates.join(", ")),
        _ => {
            let first = &nearest_first(name, candidates.iter().copied())[..SHOWN];
            format!("one of {} and {} more", first.join(", "), candidates.len() - SHOWN)
        }
    };
    match nearest(name, candidates.iter().copied()) {
        Some(_) if candidates.len() == 1 => listed,
        Some(near) => format!("'{near}', the nearest name, or {listed}"),
        None => listed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_mistakes_find_the_name_that_was_meant() {
        let names = ["scalar", "association", "path", "subdivision", "time_step"];
        assert_eq!(nearest("scaler", names), Some("scalar"));
        assert_eq!(nearest("scalra", names), Some("scalar"));
        assert_eq!(nearest("assoc", names), Some("association"));
        assert_eq!(nearest("Path", names), Some("path"));
        assert_eq!(nearest("colour", names), None);
        assert_eq!(nearest("x", ["y"]), None);
    }

    #[test]
    fn of_many_names_the_nearest_are_listed_first() {
        let names: Vec<String> = (0..100).map(|i| format!("array_{i}")).collect();
        let names = || names.iter().map(String::as_str);
        let suggested = suggest("array_97x", names());
        assert!(
            suggested.starts_with("'array_97', the nearest name, or one of array_97, array_7, "),
            "{suggested}"
        );
        assert!(suggested.ends_with(" and 76 more"), "{suggested}");
        assert_eq!(
            nearest_first("pres", ["Temperature", "Press", "Pressure", "Press"]),
            ["Press", "Pressure", "Temperature"]
        );
        assert_eq!(suggest("Pres", ["b", "a"]), "one of b, a");
    }

    #[test]
    fn a_transposition_is_one_step() {
        assert_eq!(edit_distance("ab", "ba"), 1);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }
}
