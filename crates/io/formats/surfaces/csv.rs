//! Points of a table in text: columns by the names of their first line, separated by commas, semicolons or tabs.
//!
//! Places are the columns x, y and z, or Points:0 to Points:2 as ParaView writes them. An empty field has no value.

use crate::formats::elements::Elements;
use crate::formats::numbers::{NumberType, parse};
use glam::DVec3;
use voltet_core::grid::Association;
use voltet_core::{Error, Result, counted};

/// Names of the places' columns, in lower case.
const PLACES: [[&str; 3]; 3] =
    [["x", "y", "z"], ["points:0", "points:1", "points:2"], ["points_0", "points_1", "points_2"]];

/// Reads the points, and the values of the column of this name.
pub(super) fn read(bytes: &[u8], array: Option<&str>) -> Result<Elements> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut lines =
        bytes.split(|&byte| byte == b'\n').enumerate().filter(|(_, line)| !line.trim_ascii().is_empty());
    let Some((_, head)) = lines.next() else {
        return Err(Error::run("the table is empty").expected("a line of names: x, y, z"));
    };
    let separator = *[b',', b';', b'\t'].iter().find(|mark| head.contains(mark)).unwrap_or(&b',');
    let names: Vec<String> =
        fields(head, separator).iter().map(|field| String::from_utf8_lossy(field).into_owned()).collect();
    let places = PLACES.iter().find_map(|wanted| places(&names, wanted)).ok_or_else(|| {
        let error = Error::run("the table has no columns of places").got(names.join(", "));
        error.expected("a first line with the names x, y and z, or Points:0, Points:1 and Points:2")
    })?;
    let column = array.map(|name| {
        names.iter().position(|own| own == name).ok_or_else(|| {
            Error::run(format!("the table has no column '{name}'"))
                .not_among(name, names.iter().map(String::as_str))
        })
    });
    let column = column.transpose()?;
    let (mut elements, mut values) = (Elements::default(), Vec::new());
    for (number, line) in lines {
        let mut add = || {
            let fields = fields(line, separator);
            if fields.len() != names.len() {
                let error = Error::run("a line of the table has another number of fields than the first");
                return Err(error.got(fields.len()).expected(counted(names.len(), "field")));
            }
            let [x, y, z] = places.map(|place| parse(NumberType::F64, fields[place]));
            elements.points.push(DVec3::new(x?, y?, z?));
            values.extend(match column {
                Some(place) if fields[place].is_empty() => Some(f64::NAN),
                Some(place) => Some(parse(NumberType::F64, fields[place])?),
                None => None,
            });
            Ok(())
        };
        add().map_err(|error: Error| error.at_line(number + 1))?;
    }
    elements.values = column.map(|_| (Association::Point, values));
    Ok(elements)
}

fn places(names: &[String], wanted: &[&str; 3]) -> Option<[usize; 3]> {
    let [x, y, z] = wanted.map(|wanted| names.iter().position(|own| own.eq_ignore_ascii_case(wanted)));
    Some([x?, y?, z?])
}

/// The fields of a line, without the space and the quotation marks around them; within marks there may be separators.
fn fields(line: &[u8], separator: u8) -> Vec<&[u8]> {
    let mut is_quoted = false;
    let is_end = |&byte: &u8| {
        is_quoted ^= byte == b'"';
        byte == separator && !is_quoted
    };
    line.split(is_end)
        .map(|field| {
            let field = field.trim_ascii();
            field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\"")).unwrap_or(field)
        })
        .collect()
}
