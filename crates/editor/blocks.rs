//! Blocks of a data file as a tree of groups, with a tick at those that are read.

use crate::focus;
use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{Checkbox, PopupCloseBehavior, ScrollArea, Ui};
use std::collections::HashSet;
use voltet_io::formats::blocks_named;

/// Height of the tree's window on its rows, points.
const HEIGHT: f32 = 300.0;

/// A menu of the blocks that a file has, and of their groups, with a tick at what is named, by itself, its group or a pattern; the names,
/// where a hand changed them. `is_all`: without names all blocks are read, else none.
pub(crate) fn block_tree(
    ui: &mut Ui,
    names: &[String],
    blocks: &[String],
    is_all: bool,
) -> Option<Vec<String>> {
    if blocks.is_empty() {
        return None;
    }
    let mut changed = None;
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new("blocks").config(config).ui(ui, |ui| {
        let (entries, ticked) = (with_groups(blocks), ticks(names, blocks, is_all));
        let ticked_count = ticked.iter().filter(|ticked| **ticked).count();
        let height = ui.spacing().interact_size.y;
        let area = ScrollArea::vertical().max_height(HEIGHT).min_scrolled_height(HEIGHT);
        area.show_rows(ui, height, entries.len(), |ui, rows| {
            for entry in &entries[rows] {
                let held = || (0..blocks.len()).filter(|&i| is_of(&blocks[i], entry));
                let is_read = held().all(|i| ticked[i]);
                let own = entry.rsplit('/').next().unwrap_or(entry);
                let mut now = is_read;
                // Nothing at all is no choice: at least one block is read.
                let is_last = is_all && is_read && held().count() == ticked_count;
                ui.horizontal(|ui| {
                    ui.add_space(16.0 * entry.matches('/').count() as f32);
                    ui.add_enabled(!is_last, Checkbox::new(&mut now, own));
                });
                if now != is_read {
                    changed = Some(with_tick(&ticked, entry, now, blocks));
                }
            }
            focus::follow(ui);
        });
    });
    changed
}

/// For each block: true if it is read. A name that no block has ticks none; the run says so.
fn ticks(names: &[String], blocks: &[String], is_all: bool) -> Vec<bool> {
    let mut ticked = vec![is_all && names.is_empty(); blocks.len()];
    for named in names.iter().filter_map(|name| blocks_named(blocks, std::slice::from_ref(name)).ok()) {
        ticked.iter_mut().zip(named).for_each(|(ticked, named)| *ticked |= named);
    }
    ticked
}

/// Names of the blocks that are read with an entry ticked or not: the largest groups that are read whole, and single blocks.
fn with_tick(ticked: &[bool], entry: &str, is_read: bool, blocks: &[String]) -> Vec<String> {
    let is_read = |(block, was): (&String, &bool)| if is_of(block, entry) { is_read } else { *was };
    let mut partly = HashSet::new();
    for (block, _) in blocks.iter().zip(ticked).filter(|one| !is_read(*one)) {
        partly.extend(groups(block));
    }
    let mut names: Vec<String> = Vec::new();
    let mut known = HashSet::new();
    for (block, _) in blocks.iter().zip(ticked).filter(|one| is_read(*one)) {
        let whole = groups(block).find(|group| !partly.contains(group)).unwrap_or(block);
        if known.insert(whole) {
            names.push(whole.to_string());
        }
    }
    names
}

/// True of the block of this name, and of those in the group of this name.
fn is_of(block: &str, entry: &str) -> bool {
    block.strip_prefix(entry).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// The groups of a block, the outermost first, and itself.
fn groups(block: &str) -> impl Iterator<Item = &str> {
    block.match_indices('/').map(|(end, _)| end).chain([block.len()]).map(|end| &block[..end])
}

/// The blocks of a file, each after the groups that it is the first of.
fn with_groups(blocks: &[String]) -> Vec<&str> {
    let mut known = HashSet::new();
    blocks.iter().flat_map(|block| groups(block)).filter(|entry| known.insert(*entry)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| name.to_string()).collect()
    }

    #[test]
    fn ticks_follow_names_groups_and_patterns() {
        let blocks = list(&["fluid/inlet/a", "fluid/b", "solid"]);
        assert_eq!(with_groups(&blocks), ["fluid", "fluid/inlet", "fluid/inlet/a", "fluid/b", "solid"]);
        let ticks = |names: &[&str], is_all| ticks(&list(names), &blocks, is_all);
        assert_eq!(ticks(&[], true), [true; 3], "a reader without names reads all");
        assert_eq!(ticks(&[], false), [false; 3]);
        assert_eq!(ticks(&["fluid"], true), [true, true, false]);
        assert_eq!(ticks(&["*/b", "gone"], true), [false, true, false]);
        assert_eq!(ticks(&["flu*", "solid"], true), [true; 3]);
    }

    #[test]
    fn the_first_block_that_is_unticked_leaves_the_others() {
        let blocks = list(&["fluid/inlet/a", "fluid/b", "solid"]);
        let after = |ticked: [bool; 3], entry: &str, now| with_tick(&ticked, entry, now, &blocks);
        assert_eq!(after([true; 3], "solid", false), ["fluid"]);
        assert_eq!(after([true; 3], "fluid/b", false), ["fluid/inlet", "solid"]);
        assert_eq!(after([true; 3], "fluid", false), ["solid"]);
        assert_eq!(after([false, true, false], "fluid/inlet", true), ["fluid"]);
        assert_eq!(after([false; 3], "solid", true), ["solid"]);
        assert_eq!(after([false, false, true], "solid", false), [""; 0]);
    }

    #[test]
    fn blocks_are_ticked_in_a_menu_that_stays_open() {
        use egui_kittest::{Harness, kittest::Queryable};
        let blocks = list(&["fluid/a", "fluid/b", "solid"]);
        let show = move |ui: &mut Ui, names: &mut Vec<String>| {
            if let Some(changed) = block_tree(ui, names, &blocks, true) {
                *names = changed;
            }
        };
        let mut harness = Harness::new_ui_state(show, Vec::new());
        harness.get_by_label("blocks").click();
        harness.run_steps(3);
        for (own, wanted) in [
            ("b", &["fluid/a", "solid"][..]),
            ("solid", &["fluid/a"]),
            ("a", &["fluid/a"]),
            ("fluid", &["fluid"]),
            ("solid", &["fluid", "solid"]),
        ] {
            harness.get_by_label(own).click();
            harness.run_steps(3);
            assert_eq!(*harness.state(), wanted, "after a click at {own}");
        }
    }
}
