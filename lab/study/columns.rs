//! Tables in columns: of plain text, and in Markdown.

/// Rows with columns of equal width: names to the left, figures to the right.
pub(crate) fn aligned(rows: &[Vec<String>], is_name: impl Fn(usize) -> bool) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |c: usize| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cell = |c: usize| match is_name(c) {
            true => format!("{:<1$}", row[c], widths[c]),
            false => format!("{:>1$}", row[c], widths[c]),
        };
        text += (0..columns).map(cell).collect::<Vec<_>>().join("  ").trim_end();
        text += "\n";
    }
    text
}

/// A Markdown table: names to the left, figures to the right.
pub(crate) fn markdown<H: AsRef<str>, R: AsRef<[String]>>(
    heads: &[H],
    is_name: impl Fn(usize) -> bool,
    rows: impl IntoIterator<Item = R>,
) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(heads.iter().map(AsRef::as_ref).collect());
    text += &line((0..heads.len()).map(|column| if is_name(column) { "---" } else { "---:" }).collect());
    rows.into_iter().for_each(|row| text += &line(row.as_ref().iter().map(String::as_str).collect()));
    text
}

/// A text as a cell of CSV, quoted where it has to be.
pub(crate) fn csv_cell(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_string(),
    }
}
