//! Names of files with `*` for any letters and `?` for one, in any part of a path.

use std::cmp::Ordering;
use std::path::{Component, Path, PathBuf};

/// The files that a pattern names, in the order of the numbers in their names; the path itself where it has no `*` and no `?`.
pub fn files_named(pattern: &str) -> Vec<PathBuf> {
    let mut found = vec![PathBuf::new()];
    for component in Path::new(pattern).components() {
        let text = component.as_os_str().to_string_lossy().into_owned();
        let is_pattern = matches!(component, Component::Normal(_)) && text.contains(['*', '?']);
        found = match is_pattern {
            false => found.into_iter().map(|folder| folder.join(&text)).collect(),
            true => found.iter().flat_map(|folder| named_in(folder, &text)).collect(),
        };
    }
    found.retain(|path| path.is_file() || !pattern.contains(['*', '?']));
    found.sort_by(|a, b| by_numbers(&a.to_string_lossy(), &b.to_string_lossy()));
    found
}

/// Entries of a folder whose names fit; hidden ones only where the pattern begins with a point.
fn named_in(folder: &Path, pattern: &str) -> Vec<PathBuf> {
    let own = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = std::fs::read_dir(own).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let shown = names.filter(|name| pattern.starts_with('.') || !name.starts_with('.'));
    shown.filter(|name| fits(name, pattern)).map(|name| folder.join(name)).collect()
}

/// True if a name fits a pattern.
fn fits(name: &str, pattern: &str) -> bool {
    let (name, pattern): (Vec<char>, Vec<char>) = (name.chars().collect(), pattern.chars().collect());
    // The last star, and the place in the name from which what follows it is tried.
    let (mut at, mut in_pattern, mut star) = (0, 0, None);
    while at < name.len() {
        match pattern.get(in_pattern) {
            Some('*') => {
                star = Some((in_pattern, at));
                in_pattern += 1;
            }
            Some(letter) if *letter == '?' || *letter == name[at] => {
                (at, in_pattern) = (at + 1, in_pattern + 1)
            }
            _ => match star {
                Some((place, from)) => {
                    star = Some((place, from + 1));
                    (at, in_pattern) = (from + 1, place + 1);
                }
                None => return false,
            },
        }
    }
    pattern[in_pattern..].iter().all(|letter| *letter == '*')
}

/// Order of names in which numbers count by their value: run_2 before run_10.
fn by_numbers(a: &str, b: &str) -> Ordering {
    parts(a).cmp(&parts(b)).then_with(|| a.cmp(b))
}

/// Texts and numbers of a name in turn.
fn parts(name: &str) -> Vec<(String, u128)> {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits = rest.find(|letter: char| letter.is_ascii_digit()).unwrap_or(rest.len());
        let (text, from) = rest.split_at(digits);
        let end = from.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(from.len());
        parts.push((text.to_string(), from[..end].parse().unwrap_or(u128::MAX)));
        rest = &from[end..];
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_and_question_marks_stand_for_letters() {
        for (name, pattern) in [
            ("run_1.vtu", "*.vtu"),
            ("run_1.vtu", "run_?.vtu"),
            ("aab", "*ab"),
            ("a", "a*"),
            ("abcabd", "*ab?"),
        ] {
            assert!(fits(name, pattern), "{name} {pattern}");
        }
        for (name, pattern) in [("run_10.vtu", "run_?.vtu"), ("a.vtk", "*.vtu"), ("ab", "a"), ("", "?")] {
            assert!(!fits(name, pattern), "{name} {pattern}");
        }
    }

    #[test]
    fn numbers_count_by_their_value() {
        let mut names = ["run_10.vtu", "run_9.vtu", "run_100.vtu", "a.vtu", "run.vtu"];
        names.sort_by(|a, b| by_numbers(a, b));
        assert_eq!(names, ["a.vtu", "run.vtu", "run_9.vtu", "run_10.vtu", "run_100.vtu"]);
    }
}
