//! Tables of plain text in columns.

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
