//! Taking out what a path leads to, with the comments that belong to it, and giving it another name.

use super::draft::{Draft, nothing_at};
use super::find::{InsertionPoint, Match, Piece};
use super::lines;
use crate::path::Path;
use std::ops::Range;
use voltet_core::parameters::key_text;
use voltet_core::{Error, Result};

impl Draft {
    /// Takes out what a path leads to; nothing where there is nothing.
    pub fn unset(&mut self, path: &Path) -> Result<()> {
        let syntax = self.syntax.clone();
        match syntax.find(&path.0)? {
            Match::Nothing => {}
            Match::Value(InsertionPoint { holder: Some((holder, number)), .. }) => {
                self.remove_elements(holder, &[number])
            }
            Match::Value(spot) => self.remove_lines(spot.section, spot.assignment),
            Match::Pieces(pieces) => {
                // Sections that follow each other go as one, with the blank lines between.
                let mut blocks: Vec<(usize, Range<usize>)> = Vec::new();
                for piece in pieces {
                    match piece {
                        Piece::Assignment(i, k) => self.remove_lines(i, k),
                        Piece::Section(i) => {
                            let block = syntax.block(&self.text, i);
                            match blocks.last_mut().filter(|(last, range)| {
                                last + 1 == i && self.text[range.end..block.start].trim().is_empty()
                            }) {
                                Some(last) => *last = (i, last.1.start..block.end),
                                None => blocks.push((i, block)),
                            }
                        }
                    }
                }
                for (_, block) in blocks {
                    let range = lines::with_blanks(&self.text, block, 0);
                    self.replace(range, "");
                }
            }
        }
        Ok(())
    }

    /// Takes out an assignment that has lines of its own. Comments above it go with it unless they may be meant for what
    /// follows directly, too.
    fn remove_lines(&mut self, section: usize, assignment: usize) {
        let syntax = self.syntax.clone();
        let this = &syntax.sections[section];
        let place = this.assignments[assignment].span();
        let (from, to) = (lines::start(&self.text, place.start), lines::end(&self.text, place.end));
        let floor = match assignment.checked_sub(1) {
            Some(above) => lines::end(&self.text, this.assignments[above].span().end),
            None if this.header.is_some() => lines::end(&self.text, this.start()),
            None => 0,
        };
        let next = this.assignments.get(assignment + 1);
        let shares = next.is_some_and(|next| lines::start(&self.text, next.span().start) == to);
        let from = if shares { from } else { lines::with_comments_above(&self.text, from, floor) };
        self.replace(from..to, "");
    }

    /// Gives a table or an assignment another last key, wherever it is written.
    pub fn rename(&mut self, path: &Path, name: &str) -> Result<()> {
        let syntax = self.syntax.clone();
        let depth = path.0.len().checked_sub(1).ok_or_else(|| Error::usage("a path must name something"))?;
        let new = key_text(name);
        match syntax.find(&path.0)? {
            Match::Nothing => return Err(nothing_at(path)),
            Match::Value(spot) => match spot.element.keys.last() {
                Some(key) => self.replace(key.span.clone(), &new),
                None => return Err(nothing_at(path)),
            },
            Match::Pieces(pieces) => {
                for piece in pieces {
                    let key = match piece {
                        Piece::Section(i) => {
                            // Numbers of entries are not among the keys.
                            let before = syntax.sections[i].path.0[..depth].iter();
                            let numbers =
                                before.filter(|step| matches!(step, crate::path::Step::Entry(_))).count();
                            let header = syntax.sections[i].header.as_ref();
                            header.and_then(|header| header.keys.get(depth - numbers))
                        }
                        Piece::Assignment(i, k) => {
                            let section = &syntax.sections[i];
                            section.assignments[k].keys.get(depth - section.path.0.len())
                        }
                    };
                    if let Some(key) = key {
                        self.replace(key.span.clone(), &new);
                    }
                }
            }
        }
        Ok(())
    }
}
