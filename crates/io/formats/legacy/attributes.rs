//! Arrays of legacy files: attributes by their keywords, and fields.

use super::scanner::Scanner;
use crate::formats::contents::Stored;
use voltet_core::Result;

/// Attributes by their keywords, with the components of a tuple; 0: a number after the name states them.
const ATTRIBUTES: [(&str, usize); 10] = [
    ("COLOR_SCALARS", 0),
    ("TEXTURE_COORDINATES", 0),
    ("VECTORS", 3),
    ("NORMALS", 3),
    ("TANGENTS", 3),
    ("TENSORS", 9),
    ("TENSORS6", 6),
    ("GLOBAL_IDS", 1),
    ("PEDIGREE_IDS", 1),
    ("EDGE_FLAGS", 1),
];

/// Reads the attribute of a keyword with `count` tuples; `None` for text and for colours.
pub(super) fn attribute(scanner: &mut Scanner, keyword: &str, count: u64) -> Result<Option<Stored>> {
    if keyword == "LOOKUP_TABLE" {
        let name = name(scanner)?;
        let size = scanner.number("the number of colours")?;
        return scanner.array(&name, Some(scanner.color_type()), 4, size).map(|_| None);
    }
    if keyword == "SCALARS" {
        let name = name(scanner)?;
        let number_type = scanner.number_type()?;
        let rest = scanner.rest_of_line()?.unwrap_or_default();
        let component_count = match rest.as_str() {
            "" => 1,
            rest => rest.parse().ok().filter(|n| (1..=1 << 16).contains(n)).ok_or_else(|| {
                scanner
                    .error(format!("the number of components of '{name}' is wrong"))
                    .got(format_args!("'{rest}'"))
                    .expected("1 to 65536")
            })?,
        };
        if !scanner.cursor.word_if("LOOKUP_TABLE")? {
            let what = format!("the scalars '{name}' do not name their look-up table");
            return Err(scanner.error(what).expected("LOOKUP_TABLE default"));
        }
        scanner.required("the name of a look-up table")?;
        return scanner.array(&name, number_type, component_count, count);
    }
    let Some(&(_, component_count)) = ATTRIBUTES.iter().find(|attribute| attribute.0 == keyword) else {
        let found = format!("'{}'", keyword.escape_default());
        return Err(scanner.error("an unknown keyword").got(found).expected(
            "SCALARS, VECTORS, NORMALS, TENSORS, TEXTURE_COORDINATES, COLOR_SCALARS, LOOKUP_TABLE, FIELD, \
             GLOBAL_IDS, METADATA, POINT_DATA or CELL_DATA",
        ));
    };
    let name = name(scanner)?;
    let component_count = match component_count {
        0 => scanner.number("the number of components")?,
        count => count,
    };
    let number_type = match keyword {
        "COLOR_SCALARS" => Some(scanner.color_type()),
        _ => scanner.number_type()?,
    };
    scanner.array(&name, number_type, component_count, count)
}

/// The arrays of a FIELD, without those of text.
pub(super) fn field(scanner: &mut Scanner) -> Result<Vec<Stored>> {
    scanner.required("the name of the field")?;
    let array_count: u64 = scanner.number("the number of arrays")?;
    let mut arrays = Vec::new();
    let mut seen = 0;
    while seen < array_count {
        let name = name(scanner)?;
        match name.as_str() {
            "METADATA" => {
                scanner.skip_metadata()?;
                continue;
            }
            "NULL_ARRAY" => {}
            _ => {
                let component_count: usize = scanner.number("the number of components")?;
                let tuple_count = scanner.number("the number of tuples")?;
                let number_type = scanner.number_type()?;
                arrays.extend(scanner.array(&name, number_type, component_count.max(1), tuple_count)?);
            }
        }
        seen += 1;
    }
    Ok(arrays)
}

/// A name, whose special characters are written as `%20`.
fn name(scanner: &mut Scanner) -> Result<String> {
    let word = scanner.required("a name")?;
    let mut bytes = Vec::with_capacity(word.len());
    let mut rest = word.as_bytes();
    while let [first, after @ ..] = rest {
        let code =
            after.get(..2).filter(|_| *first == b'%').and_then(|digits| std::str::from_utf8(digits).ok());
        match code.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
