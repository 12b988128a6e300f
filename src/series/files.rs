//! Names of files with `*` for any letters and `?` for one, in any part of a path.

use std::cmp::Ordering;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};
use voltet_core::{Error, Result};

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
    found.retain(|path| path.exists() || !pattern.contains(['*', '?']));
    found.sort_by(|a, b| by_numbers(&a.to_string_lossy(), &b.to_string_lossy()));
    found
}

/// The files that patterns name, one pattern after the other. Error: one names none.
pub fn data_files(patterns: &[String]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for pattern in patterns {
        let found = files_named(pattern);
        if found.is_empty() {
            let error = Error::usage("no file has such a name").got(format!("'{pattern}'"));
            return Err(
                error.expected("data files; * stands for any letters within the name of a file or folder")
            );
        }
        files.extend(found);
    }
    Ok(files)
}

/// Short names of files, each its own: without the ending, else with it, else with as many of its folders as tell it from the others.
pub(super) fn stems(paths: &[PathBuf]) -> Vec<String> {
    let names: Vec<Vec<String>> = paths.iter().map(|path| names(path)).collect();
    let level = |names: &[String], level: usize| names[level.min(names.len() - 1)].clone();
    let count = names.iter().map(Vec::len).max().unwrap_or(0);
    let own = |(place, own): (usize, &Vec<String>)| {
        let alike = names.iter().enumerate().filter(|(other, names)| *other != place && names[0] == own[0]);
        let alike: Vec<&Vec<String>> = alike.map(|(_, names)| names).collect();
        // Those alike are told apart at one level, so that their names have one form.
        let differ = |at: &usize| {
            let mut all: Vec<String> = alike.iter().chain([&own]).map(|names| level(names, *at)).collect();
            all.sort();
            all.windows(2).all(|pair| pair[0] != pair[1])
        };
        level(own, (0..count).find(differ).unwrap_or(count))
    };
    names.iter().enumerate().map(own).collect()
}

/// Names of a file, from the shortest to the longest.
fn names(path: &Path) -> Vec<String> {
    let text = |name: Option<&OsStr>| name.unwrap_or_default().to_string_lossy().into_owned();
    let (stem, whole) = (text(path.file_stem()), text(path.file_name()).replace('.', "_"));
    let folders: Vec<String> = path
        .parent()
        .into_iter()
        .flat_map(Path::components)
        .filter(|part| matches!(part, Component::Normal(_)))
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect();
    let within = |count: usize, name: &str| {
        let inner = &folders[folders.len() - count..];
        [inner, &[name.to_string()]].concat().join("_")
    };
    let mut names = vec![stem.clone(), whole.clone()];
    names.extend((1..=folders.len()).map(|count| within(count, &stem)));
    names.push(within(folders.len(), &whole));
    names
}

/// Entries of a folder whose names fit; hidden ones only where the pattern begins with a point.
fn named_in(folder: &Path, pattern: &str) -> Vec<PathBuf> {
    let own = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = std::fs::read_dir(own).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let shown = names.filter(|name| pattern.starts_with('.') || !name.starts_with('.'));
    shown.filter(|name| fits(name, pattern)).map(|name| folder.join(name)).collect()
}

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
    fn files_of_one_name_are_told_apart_by_their_folders() {
        let stems = |paths: &[&str]| stems(&paths.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(stems(&["a/run_1.vtu", "a/run_2.vtu"]), ["run_1", "run_2"]);
        assert_eq!(
            stems(&["x/case_1/out.vtu", "./x/case_2/out.vtu", "b.vtu"]),
            ["case_1_out", "case_2_out", "b"]
        );
        assert_eq!(stems(&["p/case/out.vtu", "q/case/out.vtu"]), ["p_case_out", "q_case_out"]);
        assert_eq!(stems(&["out.vtu", "out.vtk"]), ["out_vtu", "out_vtk"]);
        assert_eq!(stems(&["p/out.vtu", "p/out.vtk", "q/out.vtu"]), ["p_out_vtu", "p_out_vtk", "q_out_vtu"]);
        assert_eq!(stems(&["case.1", "case.2"]), ["case_1", "case_2"]);
    }

    #[test]
    fn numbers_count_by_their_value() {
        let mut names = ["run_10.vtu", "run_9.vtu", "run_100.vtu", "a.vtu", "run.vtu"];
        names.sort_by(|a, b| by_numbers(a, b));
        assert_eq!(names, ["a.vtu", "run.vtu", "run_9.vtu", "run_10.vtu", "run_100.vtu"]);
    }
}
