//! Entries of lists, written in one list or each under a header of its own: added, copied and moved.

use super::syntax::{Match, Piece, Syntax, Value};
use super::{Draft, headed, no_entry, nothing_at};
use crate::path::{Path, Step};
use std::ops::Range;
use voltet_core::{Error, Result};
use voltet_graph::{LocatedValue, ParameterValue};

enum Entries<'a> {
    Inline(&'a Value),
    Blocks(Vec<Range<usize>>),
    Nowhere,
}

impl Draft {
    /// Adds an entry before the one at `place`, or at the end: as the others are written.
    pub fn insert(&mut self, list: &Path, place: usize, entry: &ParameterValue) -> Result<()> {
        let syntax = self.syntax.clone();
        match self.entries(&syntax, list)? {
            Entries::Inline(value) => {
                self.refuse_beyond(list, place, value.elements().len() + 1)?;
                self.add_elements(value, place, &[entry.to_string()]);
                Ok(())
            }
            Entries::Blocks(blocks) => {
                self.refuse_beyond(list, place, blocks.len() + 1)?;
                let text = headed(list, entry)?;
                self.insert_block(&blocks, place, &text);
                Ok(())
            }
            Entries::Nowhere => {
                self.refuse_beyond(list, place, 1)?;
                match (self.own_block(list), entry) {
                    (Some(block), ParameterValue::Table(_)) => {
                        self.add_section(block.end, &headed(list, entry)?);
                        Ok(())
                    }
                    _ => self.set(list, &ParameterValue::List(vec![LocatedValue::from(entry.clone())])),
                }
            }
        }
    }

    /// Adds a copy of an entry after it, word by word.
    pub fn duplicate(&mut self, list: &Path, place: usize) -> Result<()> {
        let syntax = self.syntax.clone();
        match self.entries(&syntax, list)? {
            Entries::Inline(value) => {
                self.refuse_beyond(list, place, value.elements().len())?;
                let copy = self.text[value.elements()[place].span()].to_string();
                self.add_elements(value, place + 1, &[copy]);
            }
            Entries::Blocks(blocks) => {
                self.refuse_beyond(list, place, blocks.len())?;
                let block = &self.text[blocks[place].clone()];
                let copy = format!("{block}{}", if block.ends_with('\n') { "" } else { "\n" });
                self.insert_block(&blocks, place + 1, &copy);
            }
            Entries::Nowhere => return Err(nothing_at(list)),
        }
        Ok(())
    }

    /// Moves an entry to another place of its list; those between move up or down.
    pub fn move_entry(&mut self, list: &Path, from: usize, to: usize) -> Result<()> {
        let syntax = self.syntax.clone();
        let slots: Vec<Range<usize>> = match self.entries(&syntax, list)? {
            Entries::Inline(value) => value.elements().iter().map(|element| element.span()).collect(),
            Entries::Blocks(blocks) => blocks,
            Entries::Nowhere => return Err(nothing_at(list)),
        };
        self.refuse_beyond(list, from.max(to), slots.len())?;
        let mut order: Vec<usize> = (0..slots.len()).collect();
        let moved = order.remove(from);
        order.insert(to, moved);
        let text = self.text.clone();
        // The last block may lack its line end, which belongs to the place, not to the entry.
        let without_end = |slot: &Range<usize>| text[slot.clone()].trim_end_matches(['\r', '\n']);
        for (slot, i) in slots.iter().zip(order) {
            let end = &text[slot.start + without_end(slot).len()..slot.end];
            self.replace(slot.clone(), &format!("{}{end}", without_end(&slots[i])));
        }
        Ok(())
    }

    fn insert_block(&mut self, blocks: &[Range<usize>], place: usize, text: &str) {
        match blocks.get(place) {
            Some(block) => self.add_text(block.start, &format!("{text}\n")),
            None => {
                let end = blocks.last().map_or(self.text.len(), |last| last.end);
                self.add_section(end, text);
            }
        }
    }

    fn entries<'a>(&self, syntax: &'a Syntax, list: &Path) -> Result<Entries<'a>> {
        let pieces = match syntax.find(&list.0)? {
            Match::Value(spot) => return Ok(Entries::Inline(&spot.element.value)),
            Match::Nothing => return Ok(Entries::Nowhere),
            Match::Pieces(pieces) => pieces,
        };
        let scattered = || {
            Error::usage("the entries of this list are not written one after the other").got(list).expected(
                "each [[…]] with what belongs to it directly below, before others can be added or moved",
            )
        };
        let mut blocks: Vec<Range<usize>> = Vec::new();
        let mut before = None;
        for piece in pieces {
            let Piece::Section(i) = piece else { return Err(scattered()) };
            let Some(Step::Entry(number)) = syntax.sections[i].path.0.get(list.0.len()) else {
                return Err(scattered());
            };
            let block = syntax.block(&self.text, i);
            match blocks.get_mut(*number) {
                Some(known) if before == Some(i - 1) => known.end = block.end,
                Some(_) => return Err(scattered()),
                None => blocks.push(block),
            }
            before = Some(i);
        }
        Ok(Entries::Blocks(blocks))
    }

    /// The lines of the table that a list belongs to, with all that is headed below it; none where it has no header.
    fn own_block(&self, list: &Path) -> Option<Range<usize>> {
        let (_, owner) = list.0.split_last()?;
        let Match::Pieces(pieces) = self.syntax.find(owner).ok()? else { return None };
        let sections: Vec<usize> = pieces.iter().map(Piece::section).collect::<Option<_>>()?;
        // Headers below it that stand elsewhere may be of any place.
        let from = *sections.first()?;
        let last = sections.iter().enumerate().take_while(|(k, i)| **i == from + k).last()?;
        Some(self.syntax.block(&self.text, from).start..self.syntax.block(&self.text, *last.1).end)
    }

    fn refuse_beyond(&self, list: &Path, place: usize, count: usize) -> Result<()> {
        if place < count {
            return Ok(());
        }
        Err(no_entry(&list.with(place), count))
    }
}
