//! The tutorials' commands run as they stand, in a copy of the files that they name; whole pipelines of any page check.

use crate::{blocks, files, root, voltet};
use std::path::Path;
use std::process::Command;

/// Copies a folder of the repository, its subfolders and all.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::copy(&path, &target).unwrap();
        }
    }
}

/// Commands of a page's blocks, continued lines joined, each with its comment.
fn commands(page: &str) -> Vec<(String, String)> {
    let text = blocks(page, "sh").join("\n").replace("\\\n", " ");
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let parts = lines.map(|line| line.split_once(" #").unwrap_or((line, "")));
    parts.map(|(command, comment)| (command.trim().to_string(), comment.trim().to_string())).collect()
}

/// Result of one command: of the program, or of a compiler, without which it is skipped (`None`).
fn carry_out(command: &str, work: &Path) -> Option<std::process::Output> {
    let words: Vec<&str> = command.split_whitespace().collect();
    match &words[..] {
        ["voltet", arguments @ ..] | ["cargo", "run", "--release", "--", arguments @ ..] => {
            Some(voltet(arguments, work))
        }
        [compiler @ ("cc" | "c++" | "gfortran"), arguments @ ..] => {
            let output = Command::new(compiler).args(arguments).current_dir(work).output();
            assert!(
                output.is_ok() || std::env::var_os("VOLTET_REQUIRE_COMPILERS").is_none(),
                "{compiler} is not there"
            );
            output.ok()
        }
        _ => panic!("a tutorial's command that no test can run (a block of `text` is not run): {command}"),
    }
}

#[test]
fn the_commands_of_the_tutorials_run() {
    let mut count = 0;
    for page in files(&root().join("docs/src/tutorials"), &[".md"]) {
        let folder = tempfile::tempdir().unwrap();
        for name in ["pipelines", "data", "include", "examples"] {
            copy(&root().join(name), &folder.path().join(name));
        }
        let name = page.file_name().unwrap().to_string_lossy();
        for (command, comment) in commands(&std::fs::read_to_string(&page).unwrap()) {
            let Some(output) = carry_out(&command, folder.path()) else {
                eprintln!("\n*** SKIPPED: the rest of {name}, as there is no compiler for {command} ***\n");
                break;
            };
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{name}: {command}\n{errors}");
            if let Some(file) = comment.strip_prefix("writes ") {
                assert!(folder.path().join(file).exists(), "{name}: {command} wrote no {file}");
            }
            count += 1;
        }
    }
    assert!(count >= 15, "{count} commands: the tutorials are gone, or their blocks are not found");
}

#[test]
fn whole_pipelines_of_the_pages_check() {
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    for page in files(&root().join("docs/src"), &[".md"]) {
        let text = std::fs::read_to_string(&page).unwrap();
        for block in blocks(&text, "toml").iter().filter(|block| block.starts_with("[pipeline]")) {
            let path = folder.path().join("page.toml");
            std::fs::write(&path, block).unwrap();
            let output = voltet(&["check", "page.toml"], folder.path());
            assert!(
                output.status.success(),
                "{}: {}",
                page.display(),
                String::from_utf8_lossy(&output.stderr)
            );
            count += 1;
        }
    }
    assert!(count >= 1, "no page shows a whole pipeline");
}
