//! Pages of the reference, made from what the program, the headers and the Python module declare.
//!
//! `VOLTET_WRITE_DOCS=1 cargo test --test documentation reference` writes them; without the variable the tests compare.

use crate::{files, printed, report, root, text};
use std::fmt::Write;

/// First line of a page below its title.
const MADE: &str = "<!-- Made by `VOLTET_WRITE_DOCS=1 cargo test --test documentation reference`. -->";

/// Compares a page of `docs/src/reference` with what it ought to be, or writes it.
fn hold(name: &str, page: &str) {
    let path = root().join("docs/src/reference").join(name);
    if std::env::var_os("VOLTET_WRITE_DOCS").is_some() {
        return std::fs::write(&path, page).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
    let difference = found.lines().zip(page.lines()).enumerate().find(|(_, (found, made))| found != made);
    assert!(
        found == page,
        "docs/src/reference/{name} is out of date, first at {difference:?}.\n\
         VOLTET_WRITE_DOCS=1 cargo test --test documentation reference writes it anew."
    );
}

/// Names of the first column below a heading of a listing, up to the next empty line.
fn names<'a>(listing: &'a str, heading: &str) -> Vec<&'a str> {
    let mut lines = listing.lines().skip_while(|line| !line.starts_with(heading)).skip(1).peekable();
    while lines.next_if(|line| line.trim().is_empty()).is_some() {}
    let rows = lines.take_while(|line| !line.trim().is_empty());
    rows.filter_map(|line| line.split_whitespace().next()).collect()
}

/// Commands that only some builds have; their pages are written by hand.
const OPTIONAL_COMMANDS: [&str; 2] = ["papers", "help"];

#[test]
fn the_reference_of_commands_is_what_help_prints() {
    let folder = tempfile::tempdir().unwrap();
    let whole = printed(&["--help"], folder.path());
    let listed = names(&whole, "Commands:");
    let commands = || listed.iter().filter(|name| !OPTIONAL_COMMANDS.contains(*name));
    assert!(commands().count() > 5, "{whole}");
    let mut page = format!(
        "# Commands\n\n{MADE}\n\nEach section is what `voltet COMMAND --help` prints.\n\n| command | |\n| --- | --- |\n"
    );
    for name in commands() {
        let row = whole.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
        let summary = row.trim().strip_prefix(name).unwrap().trim();
        writeln!(page, "| [`{name}`](#voltet-{name}) | {} |", summary.replace('|', "\\|")).unwrap();
    }
    for name in commands() {
        let help = printed(&[name, "--help"], folder.path());
        let lines: Vec<&str> = help.trim_end().lines().map(str::trim_end).collect();
        write!(page, "\n## voltet {name}\n\n```text\n{}\n```\n", lines.join("\n")).unwrap();
    }
    hold("commands.md", &page);
}

#[cfg(feature = "gpu")]
#[test]
fn the_reference_of_nodes_and_gradient_filters_is_what_they_declare() {
    let folder = tempfile::tempdir().unwrap();
    let nodes = printed(&["nodes", "--markdown"], folder.path());
    let body = nodes.strip_prefix("# Node types\n").expect("the title");
    hold("nodes.md", &format!("# Node types\n\n{MADE}\n\n{}\n", body.trim()));

    let listing = printed(&["nodes"], folder.path());
    let filters = names(&listing, "Gradient filters");
    assert!(filters.len() >= 4, "{listing}");
    let mut page = format!(
        "# Gradient filters\n\n{MADE}\n\nMethods of the node [`gradient-magnitude`](nodes.md#gradient-magnitude); \
         [optics](../explanation/optics.md), section 3, has their formulas.\n"
    );
    for name in filters {
        write!(page, "\n{}\n", printed(&["nodes", name, "--markdown"], folder.path()).trim()).unwrap();
    }
    hold("gradient-filters.md", &page);
}

#[test]
fn the_reference_of_the_report_names_every_key() {
    let folder = tempfile::tempdir().unwrap();
    hold("report.md", &report::page(MADE, folder.path()));
}

#[test]
fn the_references_for_c_are_the_headers() {
    hold("c.md", &header_page("The renderer for C", "include/voltet.h"));
    hold("c-plug-ins.md", &header_page("Plug-ins for C", "include/voltet_plugin.h"));
}

/// Page of a header: its sections, the comment of each declaration and the declaration.
fn header_page(title: &str, path: &str) -> String {
    let header = text(path).replace("\r\n", "\n");
    let mut page = format!(
        "# {title}\n\n{MADE}\n\nThe comments and declarations of \
         [`{path}`](https://github.com/voltet/voltet/blob/main/{path}).\n"
    );
    let mut lines = header.lines().peekable();
    let mut about = String::new();
    while let Some(line) = lines.next() {
        if let Some(section) = line.strip_prefix("/* ----") {
            let name = section.trim_end_matches(['*', '/']).trim().trim_matches('-').trim();
            write!(page, "{about}\n## {name}\n").unwrap();
            about.clear();
        } else if line.starts_with("/*") {
            let mut comment = vec![line.trim_start_matches("/*").trim_start_matches('*')];
            while !comment.last().unwrap().trim_end().ends_with("*/") {
                comment.push(lines.next().expect("a comment ends"));
            }
            write!(page, "{about}").unwrap();
            about = format!("\n{}\n", prose(&comment));
        } else if !line.is_empty() && !is_scaffold(line) {
            let mut declaration = vec![line];
            let depth = |lines: &[&str]| {
                let all = lines.concat();
                all.matches('{').count() as i64 - all.matches('}').count() as i64
            };
            while depth(&declaration) > 0
                || lines
                    .peek()
                    .is_some_and(|next| !next.is_empty() && !next.starts_with("/*") && !is_scaffold(next))
            {
                declaration.push(lines.next().expect("a declaration ends"));
            }
            let heading = name_of(line).map(|name| format!("\n### {name}\n")).unwrap_or_default();
            write!(page, "{heading}{about}\n```c\n{}\n```\n", declaration.join("\n")).unwrap();
            about.clear();
        }
    }
    page
}

/// Name of a function or struct by the first line of its declaration; none of constants.
fn name_of(line: &str) -> Option<&str> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    if let Some(rest) = line.strip_prefix("typedef struct ") {
        return rest.split(|c| !is_word(c)).next();
    }
    let before =
        line.split_once("(*").map(|(_, rest)| rest.split(')').next()).unwrap_or(line.split('(').next())?;
    let is_declared = line.contains('(') && !line.starts_with('#');
    before.rsplit(|c| !is_word(c)).next().filter(|name| is_declared && !name.is_empty())
}

/// Include guards and what only a compiler reads.
fn is_scaffold(line: &str) -> bool {
    let words = [
        "#if",
        "#endif",
        "#el",
        "#include",
        "extern \"C\"",
        "}",
        "#define VOLTET_H",
        "#define VOLTET_PLUGIN_H",
    ];
    words.iter().any(|word| line.starts_with(word))
        || line.contains("VOLTET_PLUGIN_EXPORT ")
        || line.ends_with("_EXPORT")
}

/// Text of a comment as Markdown; what is indented in it stays code.
fn prose(comment: &[&str]) -> String {
    let strip = |line: &str| {
        let line = line.trim_end().trim_end_matches("*/").trim_end();
        let line = line.strip_prefix(" *").unwrap_or(line);
        let line = line.strip_prefix(' ').unwrap_or(line);
        let is_code = line.starts_with("    ");
        if is_code { line.to_string() } else { line.replace('*', "\\*").replace('<', "\\<") }
    };
    let lines: Vec<String> = comment.iter().map(|line| strip(line)).collect();
    lines.join("\n").trim_matches('\n').to_string()
}

/// The script needs Python alone, not the built module.
#[test]
fn the_reference_for_python_is_what_its_docstrings_say() {
    let output = std::process::Command::new("python3")
        .arg(root().join("python/scripts/reference.py"))
        .arg(MADE)
        .current_dir(root())
        .output();
    match output {
        Ok(output) if output.status.success() => {
            hold("python.md", &String::from_utf8(output.stdout).unwrap().replace("\r\n", "\n"));
        }
        Ok(output) => panic!("{}", String::from_utf8_lossy(&output.stderr)),
        Err(error) => eprintln!("\n*** SKIPPED: python3: {error} ***\n"),
    }
}

/// True if a quoted or bare word occurs in the program's sources.
pub fn is_in_sources(word: &str) -> bool {
    let has = |folder: &str| {
        files(&root().join(folder), &[".rs"])
            .iter()
            .any(|file| std::fs::read_to_string(file).is_ok_and(|text| text.contains(word)))
    };
    ["nodes", "crates", "src", "lab"].into_iter().any(has)
}
