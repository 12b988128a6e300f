//! Text for the standard output and standard error, safe to show on a terminal.

use crate::core::Result;
use crate::nodes::files;
use std::io::Write;

/// Writes text to the standard output; false if it was closed, which is no error.
pub fn print(text: &str) -> Result<bool> {
    files::standard_output(printable(text).as_bytes())
}

/// Writes lines to standard error. A failure is ignored.
pub fn say(lines: &str) {
    let ended = lines.is_empty() || lines.ends_with('\n');
    let _ = write!(std::io::stderr().lock(), "{lines}{}", if ended { "" } else { "\n" });
}

/// A name on one line: control characters, and those that turn the direction of writing, as Rust writes them.
pub fn name(text: &str) -> String {
    escaped(text, |_| false)
}

/// Text of several lines, otherwise like [`name`].
pub fn printable(text: &str) -> String {
    escaped(text, |c| c == '\n')
}

fn escaped(text: &str, is_kept: impl Fn(char) -> bool) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match is_unsafe(c) && !is_kept(c) {
            true => shown.extend(c.escape_default()),
            false => shown.push(c),
        }
    }
    shown
}

/// The text of a file for a message that points into it: what a terminal would act on becomes dots of as many bytes.
pub fn pointed(text: &str) -> String {
    let dot = |c: char| match c.len_utf8() {
        1 => ".",
        2 => "·",
        _ => "‥",
    };
    let safe = |c: char| !is_unsafe(c) || matches!(c, '\n' | '\r' | '\t');
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if safe(c) { shown.push(c) } else { shown.push_str(dot(c)) }
    }
    shown
}

/// Control characters (a terminal acts on them), marks of direction and line separators (they hide what is written).
fn is_unsafe(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_act_on_is_shown_instead() {
        let text = "a\u{1b}[31m\u{9b}1m\u{7f}\r\tb\u{202e}ü\n";
        assert_eq!(name(text), "a\\u{1b}[31m\\u{9b}1m\\u{7f}\\r\\tb\\u{202e}ü\\n");
        assert_eq!(printable("a\u{7}\nb"), "a\\u{7}\nb");
        assert_eq!(pointed(text).len(), text.len(), "places in the text stay");
        assert_eq!(pointed(text), "a.[31m·1m.\r\tb‥ü\n");
    }
}
