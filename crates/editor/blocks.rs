//! Blocks of a data file as a tree of groups, with a tick at those that are read.

use eframe::egui::{Checkbox, ScrollArea, Ui};

/// Most of the tree's height, points.
const HEIGHT: f32 = 300.0;

/// A menu of the blocks that a file has, and of their groups; the names that are read then, where a hand changed them. Without names all
/// are read. A group stands for all that it holds.
pub(crate) fn block_tree(ui: &mut Ui, names: &[String], blocks: &[String]) -> Option<Vec<String>> {
    if blocks.is_empty() {
        return None;
    }
    let mut changed = None;
    ui.menu_button("blocks", |ui| {
        ScrollArea::vertical().max_height(HEIGHT).show(ui, |ui| {
            for entry in with_groups(blocks) {
                let is_held = names.iter().any(|name| is_in_group(&entry, name));
                let mut is_read = is_held || names.contains(&entry);
                let own = entry.rsplit('/').next().unwrap_or(&entry);
                let tick = |ui: &mut Ui| {
                    ui.add_space(16.0 * entry.matches('/').count() as f32);
                    ui.add_enabled(!is_held, Checkbox::new(&mut is_read, own)).changed()
                };
                if ui.horizontal(tick).inner {
                    changed = Some(with_tick(names, &entry, is_read));
                }
            }
        });
    });
    changed
}

/// Names with an entry ticked or not; what a ticked group holds needs no name of its own.
fn with_tick(names: &[String], entry: &str, is_read: bool) -> Vec<String> {
    let others = names.iter().filter(|name| *name != entry && !is_in_group(name, entry)).cloned();
    others.chain(is_read.then(|| entry.to_string())).collect()
}

fn is_in_group(block: &str, group: &str) -> bool {
    block.strip_prefix(group).is_some_and(|rest| rest.starts_with('/'))
}

/// The blocks of a file, each after the groups that it is the first of.
fn with_groups(blocks: &[String]) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for block in blocks {
        let ends = block.match_indices('/').map(|(end, _)| end).chain([block.len()]);
        for entry in ends.map(|end| &block[..end]) {
            if !all.iter().any(|known| known == entry) {
                all.push(entry.to_string());
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_come_before_what_they_hold_and_stand_for_it() {
        let blocks = ["fluid/inlet/a", "fluid/b", "solid"].map(String::from);
        assert_eq!(with_groups(&blocks), ["fluid", "fluid/inlet", "fluid/inlet/a", "fluid/b", "solid"]);
        assert!(
            is_in_group("fluid/b", "fluid")
                && !is_in_group("fluids/b", "fluid")
                && !is_in_group("fluid", "fluid")
        );
        assert_eq!(with_tick(&blocks, "fluid", true), ["solid", "fluid"]);
        assert_eq!(with_tick(&blocks, "solid", false), ["fluid/inlet/a", "fluid/b"]);
    }
}
