//! The blocks of a data file as a tree, shortened where they are many.

use crate::cli::present::{grouped, name};
use crate::core::grid::CellType;
use crate::core::with_commas;
use crate::io::formats::BlockSummary;
use std::collections::{BTreeMap, HashMap};

/// Lines of the whole tree: a screen.
const MAX_LINES: usize = 48;
/// Fewest lines for which a group is opened.
const MIN_LINES: usize = 3;

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
    add_lines(&entries, 0, 0, MAX_LINES, &mut lines);
    format!("\n{}\n{}\n", grouped(blocks.len() as u64, "block"), lines.join("\n"))
}

fn entries(blocks: &[BlockSummary]) -> Vec<TreeEntry<'_>> {
    let mut entries = vec![TreeEntry::default()];
    let mut groups: HashMap<(usize, &str), usize> = HashMap::new();
    for block in blocks {
        let mut at = 0;
        let add = |entries: &mut Vec<TreeEntry>, at: usize| {
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

/// Adds the lines below an entry, at most `budget`: of its children first, what is left in equal parts to the groups among these.
fn add_lines(entries: &[TreeEntry], parent: usize, depth: usize, budget: usize, lines: &mut Vec<String>) {
    let children = &entries[parent].children;
    let shown = if children.len() <= budget { children.len() } else { budget.saturating_sub(1) };
    let groups = children[..shown].iter().filter(|&&child| !entries[child].children.is_empty()).count();
    let share = (budget - shown) / groups.max(1);
    let indent = "  ".repeat(depth);
    let line = |cells: u64, text: String| format!("  {:>12}  {indent}{text}", with_commas(cells));
    for &child in &children[..shown] {
        let entry = &entries[child];
        let own = name(entry.name);
        if entry.children.is_empty() {
            lines.push(line(entry.cells, format!("{own}  {}", types(entry))));
            continue;
        }
        lines.push(line(entry.cells, format!("{own}/  {}", grouped(entry.blocks, "block"))));
        if share >= MIN_LINES.min(entry.children.len()) {
            add_lines(entries, child, depth + 1, share, lines);
        }
    }
    let rest = children[shown..].iter().map(|&child| &entries[child]);
    let (blocks, cells) = rest.fold((0, 0), |sum, entry| (sum.0 + entry.blocks, sum.1 + entry.cells));
    if blocks > 0 {
        lines.push(line(cells, format!("… {} more; all with --json", grouped(blocks, "block"))));
    }
}

/// Names of the types of a block's cells.
fn types(entry: &TreeEntry) -> String {
    let names: BTreeMap<u8, String> =
        entry.types.iter().map(|&code| (code, CellType::name_of(code, 2))).collect();
    match names.is_empty() {
        true => "no cells that are read".into(),
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
        let tree_of = |name: &dyn Fn(u64) -> String| {
            let blocks: Vec<BlockSummary> = (0..100_000).map(|i| block(&name(i), 5)).collect();
            let text = tree(&blocks);
            assert!(text.lines().count() <= MAX_LINES + 2, "{text}");
            assert!(
                text.contains("blocks more; all with --json") && text.contains("100,000 blocks"),
                "{text}"
            );
            text
        };
        let groups = tree_of(&|i| format!("group {}/part {i}", i % 300));
        assert!(groups.contains("1,670  group 46/  334 blocks"), "{groups}");
        let few = tree_of(&|i| format!("group {}/part {i}", i % 2));
        assert!(
            few.contains("part 1 ") && few.contains("99,956 blocks") || few.contains("49,978 blocks"),
            "{few}"
        );
        tree_of(&|i| format!("part {i}"));
    }
}
