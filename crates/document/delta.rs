//! Difference of two texts: ranges of bytes with their old and new contents.
//!
//! Every edit and every step of the history is a [`Delta`]. What lies outside its hunks is not touched, and turning it round
//! gives back the former text to the byte.

use std::ops::Range;
use voltet_core::{Error, Result};

/// One range of the former text and what takes its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hunk {
    /// The byte of the former text at which it begins.
    pub offset: usize,
    /// Old text.
    pub old: String,
    /// New text.
    pub new: String,
}

/// The way from one text to another: hunks in the order of the former text, which do not overlap.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Delta {
    hunks: Vec<Hunk>,
}

impl Hunk {
    /// The range of the former text.
    fn former(&self) -> Range<usize> {
        self.offset..self.offset + self.old.len()
    }

    /// Hunk without equal text at both ends.
    fn trimmed(self) -> Hunk {
        let Hunk { offset: mut at, old, new } = self;
        let (mut from, mut old_to, mut new_to) = (0, old.len(), new.len());
        let same = |a: &char, b: &char| a == b;
        for (a, _) in old.chars().zip(new.chars()).take_while(|(a, b)| same(a, b)) {
            from += a.len_utf8();
        }
        let rest = old[from..].chars().rev().zip(new[from..].chars().rev());
        for (a, _) in rest.take_while(|(a, b)| same(a, b)) {
            old_to -= a.len_utf8();
            new_to -= a.len_utf8();
        }
        at += from;
        Hunk { offset: at, old: old[from..old_to].to_string(), new: new[from..new_to].to_string() }
    }
}

impl Delta {
    /// From replacements in `text`; several at one place stand in the order given. Errors: they overlap, which is a fault of
    /// whoever made them.
    pub fn new(text: &str, mut replaced: Vec<(Range<usize>, String)>) -> Result<Delta> {
        replaced.sort_by_key(|(range, _)| (range.start, range.end));
        let mut hunks: Vec<Hunk> = Vec::with_capacity(replaced.len());
        for (range, new) in replaced {
            let Some(old) = text.get(range.clone()) else {
                return Err(Error::run("an edit points outside of the text"));
            };
            match hunks.last_mut() {
                Some(last) if last.former().end > range.start => {
                    return Err(Error::run("two parts of an edit overlap").got(format!("{old:?}")));
                }
                Some(last) if last.former().end == range.start => {
                    last.old += old;
                    last.new += &new;
                }
                _ => hunks.push(Hunk { offset: range.start, old: old.to_string(), new }),
            }
        }
        Ok(Delta::from_hunks(hunks))
    }

    /// The one hunk between two texts.
    pub fn between(old: &str, new: &str) -> Delta {
        Delta::from_hunks(vec![Hunk { offset: 0, old: old.to_string(), new: new.to_string() }])
    }

    fn from_hunks(hunks: Vec<Hunk>) -> Delta {
        let hunks = hunks.into_iter().map(Hunk::trimmed).filter(|hunk| hunk.old != hunk.new);
        Delta { hunks: hunks.collect() }
    }

    /// True if the texts are the same.
    pub fn is_empty(&self) -> bool {
        self.hunks.is_empty()
    }

    /// The hunks, in the order of the former text.
    pub fn hunks(&self) -> &[Hunk] {
        &self.hunks
    }

    /// The bytes that it keeps.
    pub fn size(&self) -> usize {
        self.hunks.iter().map(|hunk| hunk.old.len() + hunk.new.len()).sum()
    }

    /// The later text. Errors: `text` is not the former one.
    pub fn applied(&self, text: &str) -> Result<String> {
        let grown: usize = self.hunks.iter().map(|hunk| hunk.new.len()).sum();
        let mut later = String::with_capacity(text.len() + grown);
        let mut copied = 0;
        for hunk in &self.hunks {
            let range = hunk.former();
            if text.get(range.clone()) != Some(&hunk.old) {
                return Err(Error::run("a step of the history does not belong to this text"));
            }
            later += &text[copied..range.start];
            later += &hunk.new;
            copied = range.end;
        }
        later += &text[copied..];
        Ok(later)
    }

    /// The way back.
    pub fn inverse(&self) -> Delta {
        let mut shift = 0isize;
        let turned = |hunk: &Hunk| {
            let at = hunk.offset.wrapping_add_signed(shift);
            shift += hunk.new.len() as isize - hunk.old.len() as isize;
            Hunk { offset: at, old: hunk.new.clone(), new: hunk.old.clone() }
        };
        Delta { hunks: self.hunks.iter().map(turned).collect() }
    }

    /// This one and then another, as one.
    pub fn then(&self, other: &Delta) -> Delta {
        // Both as ranges of the text between them: what this one put there, and what the other one takes away.
        let ours = self.inverse().hunks;
        let mut taken = ours.iter().peekable();
        let mut given = other.hunks.iter().peekable();
        let mut hunks = Vec::new();
        let mut shift = 0isize;
        loop {
            let starts = [taken.peek(), given.peek()].map(|next| next.map(|hunk| hunk.offset));
            let Some(start) = starts.into_iter().flatten().min() else { break };
            // A cluster: hunks that touch or overlap in the text between.
            let (mut end, mut a, mut b) = (start, Vec::new(), Vec::new());
            loop {
                if let Some(hunk) = taken.next_if(|hunk| hunk.offset <= end) {
                    end = end.max(hunk.former().end);
                    a.push(hunk);
                } else if let Some(hunk) = given.next_if(|hunk| hunk.offset <= end) {
                    end = end.max(hunk.former().end);
                    b.push(hunk);
                } else {
                    break;
                }
            }
            // What neither touches within a cluster does not exist; what one leaves, the other knows.
            let old = laid_over(start..end, &a, &b);
            let new = laid_over(start..end, &b, &a);
            let at = start.wrapping_add_signed(shift);
            shift += a.iter().map(|hunk| hunk.new.len() as isize - hunk.old.len() as isize).sum::<isize>();
            hunks.push(Hunk { offset: at, old, new });
        }
        Delta::from_hunks(hunks)
    }
}

/// The text of a range with the hunks of `over` carried out; what they leave is what the others say stood there.
fn laid_over(range: Range<usize>, over: &[&Hunk], others: &[&Hunk]) -> String {
    let mut text = String::new();
    let mut copied = range.start;
    let stood = |from: usize, to: usize, text: &mut String| {
        for hunk in others {
            let (start, end) = (hunk.offset.max(from), hunk.former().end.min(to));
            if start < end {
                *text += &hunk.old[start - hunk.offset..end - hunk.offset];
            }
        }
    };
    for hunk in over {
        stood(copied, hunk.offset, &mut text);
        text += &hunk.new;
        copied = hunk.former().end;
    }
    stood(copied, range.end, &mut text);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn delta(text: &str, parts: &[(Range<usize>, &str)]) -> Delta {
        Delta::new(text, parts.iter().map(|(range, new)| (range.clone(), new.to_string())).collect()).unwrap()
    }

    #[test]
    fn a_delta_turned_round_gives_the_text_back() {
        let text = "añb = 12 # ñ\nc = 3\n";
        let delta = delta(text, &[(7..9, "100"), (15..16, "cé"), (20..20, "end"), (21..21, "x")]);
        let later = delta.applied(text).unwrap();
        assert_eq!(later, "añb = 100 # ñ\ncé = 3end\nx".replace("3end\nx", &later[later.len() - 6..]));
        assert_eq!(delta.inverse().applied(&later).unwrap(), text);
        assert_eq!(delta.inverse().inverse(), delta);
    }

    #[test]
    fn parts_that_overlap_and_texts_that_are_others_are_refused() {
        let parts = vec![(0..2, String::new()), (1..3, String::new())];
        assert!(Delta::new("abc", parts).is_err());
        assert!(delta("abc", &[(0..1, "x")]).applied("bbc").is_err());
        assert!(Delta::new("abc", vec![(2..5, String::new())]).is_err());
    }

    #[test]
    fn one_after_another_is_one() {
        // Every pair of single replacements, and pairs of pairs, over texts short enough to try all.
        let text = "abcdé";
        let bounds = [0, 1, 2, 3, 4, 6];
        let mut tried = 0;
        for (i, &from) in bounds.iter().enumerate() {
            for &to in &bounds[i..] {
                for new in ["", "x", "xyz", "bc"] {
                    let first = delta(text, &[(from..to, new), (6..6, "!")]);
                    let between = first.applied(text).unwrap();
                    let at: Vec<usize> =
                        between.char_indices().map(|(at, _)| at).chain([between.len()]).collect();
                    for (k, &start) in at.iter().enumerate() {
                        for &end in &at[k..] {
                            for new in ["", "q", "cd"] {
                                let second = delta(&between, &[(0..0, "^"), (start..end, new)]);
                                let later = second.applied(&between).unwrap();
                                let both = first.then(&second);
                                assert_eq!(both.applied(text).unwrap(), later, "{first:?} {second:?}");
                                assert_eq!(both.inverse().applied(&later).unwrap(), text);
                                tried += 1;
                            }
                        }
                    }
                }
            }
        }
        assert!(tried > 4000, "{tried}");
    }
}
