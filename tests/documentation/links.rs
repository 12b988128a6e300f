//! Links of every page, the table of contents of the book, and the lengths of the two first pages.

use crate::{blocks, files, root, text};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Addresses of the repository's files and folders, for links that leave the book.
const REPOSITORY: [&str; 2] =
    ["https://github.com/voltet/voltet/blob/main/", "https://github.com/voltet/voltet/tree/main/"];

/// Targets of a page's links, anchors included.
fn targets(page: &str) -> Vec<&str> {
    let mut is_code = false;
    let lines = page.lines().filter(move |line| {
        is_code ^= line.starts_with("```");
        !is_code
    });
    let links = lines.flat_map(|line| line.split("](").skip(1));
    links.filter_map(|rest| rest.split_once(')')).map(|(target, _)| target).collect()
}

/// File that a link of `page` names; `None` of other sites and of anchors within the page.
fn file_of(page: &Path, target: &str) -> Option<PathBuf> {
    let target = target.split('#').next().unwrap_or_default();
    if let Some(path) = REPOSITORY.iter().find_map(|start| target.strip_prefix(start)) {
        return Some(root().join(path));
    }
    let is_elsewhere = target.is_empty() || target.contains("://") || target.starts_with("mailto:");
    (!is_elsewhere).then(|| page.parent().expect("a page lies in a folder").join(target))
}

#[test]
fn every_link_leads_to_a_file() {
    let mut broken = Vec::new();
    for page in files(root(), &[".md"]) {
        let content = std::fs::read_to_string(&page).unwrap();
        for target in targets(&content) {
            if file_of(&page, target).is_some_and(|file| !file.exists()) {
                broken.push(format!("{}: {target}", page.strip_prefix(root()).unwrap().display()));
            }
        }
    }
    assert!(broken.is_empty(), "links without a file:\n{}", broken.join("\n"));
}

#[test]
fn the_contents_list_every_page_of_the_book() {
    let summary = root().join("docs/src/SUMMARY.md");
    let content = std::fs::read_to_string(&summary).unwrap();
    let listed: BTreeSet<PathBuf> =
        targets(&content).into_iter().filter_map(|target| file_of(&summary, target)).collect();
    let pages: BTreeSet<PathBuf> =
        files(&root().join("docs/src"), &[".md"]).into_iter().filter(|page| *page != summary).collect();
    let missing: Vec<_> = pages.difference(&listed).collect();
    assert!(missing.is_empty(), "docs/src/SUMMARY.md lacks {missing:?}");
}

/// Paths "docs/….md" in sources and scripts, where no link is checked.
#[test]
fn sources_name_pages_that_exist() {
    let mut broken = Vec::new();
    for file in files(root(), &[".rs", ".py", ".sh", ".toml", ".h", ".c", ".f90", ".wgsl"]) {
        // This file names the form of such a path, which is no path.
        if file.ends_with("documentation/links.rs") {
            continue;
        }
        let Ok(content) = std::fs::read_to_string(&file) else { continue };
        for (start, _) in content.match_indices("docs/") {
            let rest = &content[start..];
            let end = rest.find(|c: char| !(c.is_alphanumeric() || "/-_.".contains(c))).unwrap_or(rest.len());
            let path = rest[..end].trim_end_matches('.');
            if path.ends_with(".md") && !root().join(path).exists() {
                broken.push(format!("{}: {path}", file.strip_prefix(root()).unwrap().display()));
            }
        }
    }
    assert!(broken.is_empty(), "sources name pages that do not exist:\n{}", broken.join("\n"));
}

/// The first doctest of the library compiles and runs.
#[test]
fn the_program_of_the_readme_is_the_first_doctest() {
    let library = text("src/lib.rs");
    let tested: BTreeSet<&str> =
        library.lines().filter_map(|line| line.strip_prefix("//!")).map(str::trim).collect();
    let program = blocks(&text("README.md"), "rust").concat();
    let missing: Vec<&str> = program.lines().map(str::trim).filter(|line| !tested.contains(line)).collect();
    assert!(program.contains("voltet::prelude") && missing.is_empty(), "src/lib.rs has no {missing:#?}");
}

#[test]
fn the_first_pages_stay_short() {
    for (page, limit) in [("README.md", 120), ("ARCHITECTURE.md", 150)] {
        let count = text(page).lines().count();
        assert!(count <= limit, "{page}: {count} lines, at most {limit}: details belong into docs/src");
    }
}
