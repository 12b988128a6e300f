//! Elements of lists and tables that are written in place: `[…]` and `{…}`.

use super::draft::Draft;
use super::lines;
use super::syntax::{Element, Value, ValueKind};
use std::ops::Range;

impl Draft {
    /// Adds elements before the one at `place`, or at the end. On lines of their own where the others are.
    pub(super) fn add_elements(&mut self, holder: &Value, place: usize, texts: &[String]) {
        let text = self.text.clone();
        let elements = holder.elements();
        let Some(beside) = elements.get(place).or(elements.last()) else {
            let inner = holder.span.start + 1..holder.span.end - 1;
            let joined = texts.join(", ");
            let is_blank = text[inner.clone()].trim().is_empty();
            match (&holder.kind, is_blank) {
                (ValueKind::Table(_), true) => self.replace(inner, &format!(" {joined} ")),
                (_, true) => self.replace(inner, &joined),
                // Comments alone stand there.
                (_, false) => self.replace(inner.start..inner.start, &format!(" {joined},")),
            }
            return;
        };
        let start = beside.span().start;
        let is_own_line = lines::is_first(&text, start) && lines::start(&text, start) > holder.span.start;
        let between = match is_own_line {
            true => format!(",\n{}", lines::indent(&text, start)),
            false => ", ".to_string(),
        };
        let joined = texts.join(&between);
        if place < elements.len() {
            self.replace(start..start, &format!("{joined}{between}"));
            return;
        }
        let end = beside.value.span.end;
        match (beside.comma, is_own_line) {
            (Some(comma), true) => {
                let at = self.end_of_line(comma + 1, holder);
                self.replace(at..at, &format!("{}{joined},", &between[1..]));
            }
            (Some(comma), false) => self.replace(comma + 1..comma + 1, &format!(" {joined},")),
            (None, true) => {
                let at = self.end_of_line(end, holder);
                self.replace(end..end, ",");
                self.replace(at..at, &format!("{}{joined}", &between[1..]));
            }
            (None, false) => self.replace(end..end, &format!("{between}{joined}")),
        }
    }

    /// The end of the words on the line of a byte within a list or table, a comment included.
    fn end_of_line(&self, at: usize, holder: &Value) -> usize {
        let line = &self.text[at..lines::end(&self.text, at).min(holder.span.end - 1)];
        at + line.trim_end().len()
    }

    /// Removes elements, by their numbers in rising order, with the comments on their lines.
    pub(super) fn remove_elements(&mut self, holder: &Value, gone: &[usize]) {
        let elements = holder.elements();
        if gone.len() == elements.len() {
            self.replace(holder.span.start + 1..holder.span.end - 1, "");
            return;
        }
        let mut runs: Vec<Range<usize>> = Vec::new();
        for &i in gone {
            match runs.last_mut() {
                Some(run) if run.end == i => run.end = i + 1,
                _ => runs.push(i..i + 1),
            }
        }
        for run in runs {
            self.remove_run(holder, elements, run);
        }
    }

    fn remove_run(&mut self, holder: &Value, elements: &[Element], run: Range<usize>) {
        let text = self.text.clone();
        let own_line = |at: usize| lines::is_first(&text, at) && lines::start(&text, at) > holder.span.start;
        let first = elements[run.start].span().start;
        let last = &elements[run.end - 1];
        let after_comma = last.comma.map_or(last.value.span.end, |comma| comma + 1);
        if let Some(next) = elements.get(run.end) {
            let next = next.span().start;
            match own_line(first) && own_line(next) {
                true => self.replace(lines::start(&text, first)..lines::end(&text, after_comma), ""),
                false => self.replace(first..next, ""),
            }
            return;
        }
        let kept = &elements[run.start - 1];
        let comma = kept.comma.unwrap_or(kept.value.span.end);
        let after_kept = if kept.comma.is_some() { comma + 1 } else { comma };
        match (own_line(first), last.comma) {
            (true, Some(_)) => self.replace(lines::start(&text, first)..lines::end(&text, after_comma), ""),
            (true, None) => {
                self.replace(comma..after_kept, "");
                let from = lines::start(&text, first);
                let to = lines::end(&text, after_comma).min(holder.span.end - 1);
                self.replace(from..to.max(last.value.span.end), "");
            }
            (false, Some(_)) => self.replace(after_kept..after_comma, ""),
            (false, None) => self.replace(comma..after_comma, ""),
        }
    }
}
