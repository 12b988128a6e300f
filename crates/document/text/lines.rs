//! Lines: where they begin and end, and which comments belong to what stands below or above them.
//!
//! Comment lines directly above a header or an assignment, with no blank line between, belong to it; so does a comment on its
//! own line's end. Comment lines directly below the last assignment of a table, followed by a blank line or the end, belong to
//! the table. What stands by itself between blank lines belongs to nobody and stays.

use std::ops::Range;

/// Start of the line of a byte.
pub fn start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |end| end + 1)
}

/// End of the line of a byte, its line end included.
pub fn end(text: &str, at: usize) -> usize {
    text[at..].find('\n').map_or(text.len(), |end| at + end + 1)
}

/// The spaces at the beginning of the line of a byte.
pub fn indent(text: &str, at: usize) -> &str {
    let line = &text[start(text, at)..];
    let spaces = line.find(|c| c != ' ' && c != '\t').unwrap_or(line.len());
    &line[..spaces]
}

/// True if nothing but spaces stands before a byte on its line.
pub fn is_first(text: &str, at: usize) -> bool {
    text[start(text, at)..at].trim().is_empty()
}

fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with('#')
}

fn is_blank(line: &str) -> bool {
    line.trim().is_empty()
}

/// Start of the comment lines directly above the line which begins at `at`, not before `floor`, which is the
/// beginning of a line.
pub fn with_comments_above(text: &str, at: usize, floor: usize) -> usize {
    let mut from = at;
    while from > floor {
        let before = start(text, from - 1);
        if before < floor || !is_comment(&text[before..from]) {
            break;
        }
        from = before;
    }
    from
}

/// Words of comment lines, as one text, without rulers and what was commented out; `None` where there are none.
pub fn comment(text: &str) -> Option<String> {
    let words = text.lines().map(|line| line.trim().trim_start_matches('#').trim());
    let joined = words.filter(|line| is_prose(line)).collect::<Vec<_>>().join(" ");
    Some(joined).filter(|joined| !joined.is_empty())
}

/// True unless a comment's line has no letter, or is a key with its value, a header, or an entry of a list.
fn is_prose(line: &str) -> bool {
    let key = line.split_once('=').map(|(key, _)| key.trim_end());
    let is_key_letter = |c: char| c.is_alphanumeric() || "_-.\"'".contains(c);
    let is_setting = key.is_some_and(|key| !key.is_empty() && key.chars().all(is_key_letter));
    line.contains(char::is_alphabetic) && !is_setting && !line.starts_with(['[', '{', ']', '}'])
}

/// Words of the comment that follows on the line of a byte at which a value, or a header, ends.
pub fn comment_after(text: &str, at: usize) -> Option<String> {
    let rest = text[at..end(text, at)].trim_start_matches([',', ' ', '\t']);
    if is_comment(rest) { comment(rest) } else { None }
}

/// End of the comment lines directly below the line which ends at `at`, where a blank line, or `ceiling`, which
/// is the beginning of a line, follows them after no other.
pub fn with_comments_below(text: &str, at: usize, ceiling: usize) -> usize {
    let mut to = at;
    while to < ceiling {
        let after = end(text, to);
        if !is_comment(&text[to..after]) {
            break;
        }
        to = after;
    }
    to.min(ceiling)
}

/// The range with the blank lines before it; where it begins the text, with those after it.
pub fn with_blanks(text: &str, range: Range<usize>) -> Range<usize> {
    let Range { start: mut from, end: mut to } = range;
    while from > 0 && is_blank(&text[start(text, from - 1)..from]) {
        from = start(text, from - 1);
    }
    if from == 0 {
        while to < text.len() && is_blank(&text[to..end(text, to)]) {
            to = end(text, to);
        }
    }
    from..to
}

/// True if a line begins at `at` that is not blank.
pub fn is_followed(text: &str, at: usize) -> bool {
    at < text.len() && !is_blank(&text[at..end(text, at)])
}

/// Line end of a text.
pub fn line_end(text: &str) -> &'static str {
    match text.find('\n') {
        Some(at) if text[..at].ends_with('\r') => "\r\n",
        _ => "\n",
    }
}
