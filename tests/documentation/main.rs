//! The documentation is true: links lead to files, reference pages follow from the declarations, and the commands of the
//! tutorials run as they stand.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

mod links;
mod reference;
mod report;
mod tutorials;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Folder of the repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Text of a file of the repository.
fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Program `voltet` in the folder `work`, without the user's own configuration and cache.
fn voltet(arguments: &[&str], work: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voltet"))
        .args(arguments)
        .current_dir(work)
        .env("XDG_CONFIG_HOME", work.join("configuration"))
        .env("XDG_CACHE_HOME", work.join("cache"))
        .output()
        .expect("the program starts")
}

/// Standard output of the program, which must succeed.
fn printed(arguments: &[&str], work: &Path) -> String {
    let output = voltet(arguments, work);
    assert!(output.status.success(), "voltet {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("the program writes UTF-8")
}

/// Files below a folder whose names end so, in order; build outputs and hidden folders left out.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for entry in entries {
        let path = entry.expect("a folder entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if path.is_symlink() || name.starts_with('.') || ["target", "shared", "out"].contains(&name) {
            continue;
        }
        if path.is_dir() {
            found.extend(files(&path, endings));
        } else if endings.iter().any(|ending| name.ends_with(ending)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Contents of the fenced blocks of a page whose opening fence bears exactly these words.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if let Some(words) = line.strip_prefix("```") {
            let inside: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("```")).collect();
            if words.trim() == language {
                found.push(inside.join("\n"));
            }
        }
    }
    found
}
