//! POINT_DATA and CELL_DATA of legacy files: SCALARS, VECTORS, NORMALS, TENSORS, FIELD and the rest.

use super::scanner::Scanner;
use crate::formats::numbers::NumberType;
use crate::formats::piece::PieceArray;
use crate::formats::stored::Stored;
use voltet_core::Result;

/// Reads attributes to the end of the file, from a POINT_DATA or CELL_DATA keyword on; returns the name of the first
/// SCALARS.
pub(super) fn read(
    scanner: &mut Scanner,
    keyword: &str,
    (point_count, cell_count): (u64, u64),
    arrays: &mut Vec<PieceArray>,
) -> Result<Option<String>> {
    let mut active_scalars = None;
    let mut keyword = keyword.to_owned();
    let (mut per_cell, mut count) = (false, 0);
    loop {
        let mut add = |stored: Option<Stored>| {
            arrays.extend(stored.map(|stored| PieceArray { per_cell, stored }));
        };
        match keyword.as_str() {
            "POINT_DATA" | "CELL_DATA" => {
                per_cell = keyword == "CELL_DATA";
                count = scanner.number("the number of tuples")?;
                let accepted = if per_cell { cell_count } else { point_count };
                if count != accepted {
                    let what = format!("the number of {keyword} does not fit the grid");
                    return Err(scanner.error(what).got(count).expected(accepted));
                }
            }
            "METADATA" => scanner.skip_metadata()?,
            "FIELD" => field(scanner)?.into_iter().for_each(|stored| add(Some(stored))),
            "LOOKUP_TABLE" => {
                let name = name(scanner)?;
                let size = scanner.number("the number of colours")?;
                let number_type = if scanner.binary { NumberType::U8 } else { NumberType::F32 };
                scanner.array(&name, Some(number_type), 4, size)?;
            }
            "SCALARS" => {
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
                if scanner.word_if("LOOKUP_TABLE")? {
                    scanner.required("the name of a look-up table")?;
                    add(scanner.array(&name, number_type, component_count, count)?);
                } else {
                    let what = format!("the scalars '{name}' do not name their look-up table");
                    return Err(scanner.error(what).expected("LOOKUP_TABLE default"));
                }
                active_scalars = active_scalars.or(Some(name));
            }
            "COLOR_SCALARS" => {
                let name = name(scanner)?;
                let component_count = scanner.number("the number of components")?;
                let number_type = if scanner.binary { NumberType::U8 } else { NumberType::F32 };
                add(scanner.array(&name, Some(number_type), component_count, count)?);
            }
            "TEXTURE_COORDINATES" => {
                let name = name(scanner)?;
                let component_count = scanner.number("the number of components")?;
                let number_type = scanner.number_type()?;
                add(scanner.array(&name, number_type, component_count, count)?);
            }
            "VECTORS" | "NORMALS" | "TENSORS" | "TENSORS6" | "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS"
            | "TANGENTS" => {
                let component_count = match keyword.as_str() {
                    "VECTORS" | "NORMALS" | "TANGENTS" => 3,
                    "TENSORS" => 9,
                    "TENSORS6" => 6,
                    _ => 1,
                };
                let name = name(scanner)?;
                let number_type = scanner.number_type()?;
                add(scanner.array(&name, number_type, component_count, count)?);
            }
            _ => {
                let found = format!("'{}'", keyword.escape_default());
                return Err(scanner.error("an unknown keyword").got(found).expected(
                    "SCALARS, VECTORS, NORMALS, TENSORS, TEXTURE_COORDINATES, COLOR_SCALARS, LOOKUP_TABLE, FIELD, \
                     GLOBAL_IDS, METADATA, POINT_DATA or CELL_DATA",
                ));
            }
        }
        match scanner.word()? {
            Some(word) => keyword = word.to_ascii_uppercase(),
            None => return Ok(active_scalars),
        }
    }
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
