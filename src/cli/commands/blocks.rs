//! The blocks of a data file as a tree, shortened where they are many.

use crate::cli::present::name;
use crate::core::grid::CellType;
use crate::core::{counted, with_commas};
use crate::io::formats::BlockSummary;
use std::collections::{BTreeMap, HashMap};

/// Most lines of one level, and lines after which no further level is opened: together a screen.
const MAX_OF_LEVEL: usize = 16;
const MAX_LINES: usize = 48;

/// A block, or a group of blocks: a node of the tree.
#[derive(Default)]
struct TreeEntry<'a> {
    name: &'a str,
    children: Vec<usize>,
    /// Blocks in it, and their cells.
    blocks: u64,
    cells: u64,
    /// VTK type codes of a block's own cells.
    types: Vec<u8>,
}

/// A heading and a line for each group and block: its cells, its name below that of its group, types of its cells.
pub(super) fn tree(blocks: &[BlockSummary]) -> String {
    if blocks.is_empty() {
        return String::new();
    }
    let entries = entries(blocks);
    let mut lines = Vec::new();
    add_lines(&entries, 0, 0, &mut lines);
    format!("\n{}\n{}\n", counted(blocks.len(), "block"), lines.join("\n"))
}

fn entries(blocks: &[BlockSummary]) -> Vec<TreeEntry<'_>> {
    let mut entries = vec![TreeEntry::default()];
    let mut groups: HashMap<(usize, &str), usize> = HashMap::new();
    for block in blocks {
        let mut at = 0;
        let mut add = |entries: &mut Vec<TreeEntry>, at: usize| {
            (entries[at].blocks, entries[at].cells) =
                (entries[at].blocks + 1, entries[at].cells + block.cell_count());
        };
        add(&mut entries, at);
        let (path, own) = block.name.rsplit_once('/').unwrap_or(("", &block.name));
        for group in path.split('/').filter(|group| !group.is_empty()) {
            at = *groups.entry((at, group)).or_insert_with(|| new_entry(&mut entries, at, group));
            add(&mut entries, at);
        }
        // A block is a line of its own, also where another has its name.
        let leaf = new_entry(&mut entries, at, own);
        add(&mut entries, leaf);
        entries[leaf].types = block.cells_by_type.keys().copied().collect();
    }
    entries
}

fn new_entry<'a>(entries: &mut Vec<TreeEntry<'a>>, parent: usize, name: &'a str) -> usize {
    entries.push(TreeEntry { name, ..TreeEntry::default() });
    let number = entries.len() - 1;
    entries[parent].children.push(number);
    number
}

fn add_lines(entries: &[TreeEntry], parent: usize, depth: usize, lines: &mut Vec<String>) {
    let children = &entries[parent].children;
    // No line is spent on leaving out one.
    let shown = if children.len() <= MAX_OF_LEVEL + 1 { children.len() } else { MAX_OF_LEVEL };
    let indent = "  ".repeat(depth);
    let line = |cells: u64, text: String| format!("  {:>12}  {indent}{text}", with_commas(cells));
    for &child in &children[..shown] {
        let entry = &entries[child];
        let own = name(entry.name);
        if entry.children.is_empty() {
            lines.push(line(entry.cells, format!("{own}  {}", types(entry))));
            continue;
        }
        lines.push(line(entry.cells, format!("{own}/  {}", counted(entry.blocks, "block"))));
        if lines.len() < MAX_LINES {
            add_lines(entries, child, depth + 1, lines);
        }
    }
    let rest = children[shown..].iter().map(|&child| &entries[child]);
    let (blocks, cells) = rest.fold((0, 0), |sum, entry| (sum.0 + entry.blocks, sum.1 + entry.cells));
    if blocks > 0 {
        lines.push(line(cells, format!("… {} more; all with --json", counted(blocks, "block"))));
    }
}

/// Names of the types of a block's cells.
fn types(entry: &TreeEntry) -> String {
    let names: BTreeMap<u8, String> =
        entry.types.iter().map(|&code| (code, CellType::name_of(code, 2))).collect();
    match names.is_empty() {
        true => "not read, or empty".into(),
        false => names.into_values().collect::<Vec<_>>().join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(name: &str, count: u64) -> BlockSummary {
        BlockSummary { name: name.into(), cells_by_type: BTreeMap::from([(12, count)]) }
    }

    #[test]
    fn groups_stand_over_their_blocks() {
        let text = tree(&[block("fluid/rotor", 4000), block("fluid/stator", 30), block("solid", 2)]);
        let lines: Vec<&str> = text.trim().lines().collect();
        assert_eq!(lines[0], "3 blocks");
        assert!(lines[1].ends_with("4,030  fluid/  2 blocks"), "{text}");
        assert!(lines[2].ends_with("4,000    rotor  hexahedra"), "{text}");
        assert!(lines[4].ends_with("2  solid  hexahedra"), "{text}");
    }

    #[test]
    fn many_blocks_are_a_screen() {
        let blocks: Vec<BlockSummary> =
            (0..100_000).map(|i| block(&format!("group {}/part {i}", i % 300), 5)).collect();
        let text = tree(&blocks);
        assert!(text.lines().count() < 2 * MAX_LINES, "{text}");
        assert!(text.contains("more; all with --json") && text.contains("100000 blocks"), "{text}");
    }
}
