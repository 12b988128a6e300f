//! Colour map files of ParaView: JSON, as it exports them now, and XML, as it did.
//!
//! Taken are the points and the colour space. Opacities are the widget's; a colour for missing values has no place in a volume, in
//! which cells of such values are left out.

use quick_xml::events::{BytesStart, Event};
use serde_json::Value;
use std::path::Path;
use voltet_core::colormap::{ColorCurve, ColorSpace};
use voltet_core::{Error, Result};

/// Largest file: every map that ParaView has takes less.
const LARGEST: u64 = 16 << 20;

/// Colours and colour space of a map as a file states them.
type StatedMap = (String, Vec<(f64, [f64; 3])>);

/// Colours of the one map that a file holds; its points are stretched over levels 0 to 1.
///
/// # Errors
/// - the file cannot be read, holds no map or several, one of listed colours or of another space than RGB, Lab or Diverging.
pub fn read(path: &Path) -> Result<ColorCurve> {
    let of = || -> Result<ColorCurve> {
        let failed = |error: std::io::Error| Error::run("the colour map file cannot be read").got(error);
        let length = std::fs::metadata(path).map_err(failed)?.len();
        if length > LARGEST {
            return Err(Error::run("the colour map file is too large")
                .got(length)
                .expected("16 MiB at most"));
        }
        let text = std::fs::read_to_string(path).map_err(failed)?;
        let maps = if text.trim_start().starts_with('<') { of_xml(&text)? } else { of_json(&text)? };
        let [(space, points)] = &maps[..] else {
            return Err(Error::run("the file does not hold one colour map").got(maps.len()).expected("one"));
        };
        ColorCurve::interpolated(points, named_space(space)?)
    };
    of().map_err(|error| error.in_file(path))
}

fn named_space(name: &str) -> Result<ColorSpace> {
    match name {
        "RGB" => Ok(ColorSpace::Rgb),
        "Lab" => Ok(ColorSpace::Lab),
        "Diverging" => Ok(ColorSpace::Diverging),
        _ => Err(Error::run("the colour space of the map is not known")
            .got(name)
            .not_among(name, ["RGB", "Lab", "Diverging"])),
    }
}

fn of_json(text: &str) -> Result<Vec<StatedMap>> {
    let failed = |error: serde_json::Error| {
        let place = error.line();
        Error::run("the colour map file is no JSON").got(error).at_line(place)
    };
    let value: Value = serde_json::from_str(text).map_err(failed)?;
    let maps = match &value {
        Value::Array(maps) => &maps[..],
        map => std::slice::from_ref(map),
    };
    maps.iter().map(stated).collect()
}

fn stated(map: &Value) -> Result<StatedMap> {
    if map.get("IndexedColors").is_some() {
        return Err(listed_colors());
    }
    let wrong = || {
        Error::run("the map's RGBPoints are wrong")
            .expected("RGBPoints = [x, r, g, b, x, r, g, b, …], four numbers a point")
    };
    let list = map.get("RGBPoints").and_then(Value::as_array).ok_or_else(wrong)?;
    let numbers: Vec<f64> = list.iter().map(Value::as_f64).collect::<Option<_>>().ok_or_else(wrong)?;
    if !numbers.len().is_multiple_of(4) {
        return Err(wrong().got(format!("{} numbers", numbers.len())));
    }
    let space = map.get("ColorSpace").map_or(Some("RGB"), Value::as_str).unwrap_or_default();
    Ok((space.to_string(), numbers.chunks_exact(4).map(|of| (of[0], [of[1], of[2], of[3]])).collect()))
}

fn listed_colors() -> Error {
    Error::run("the map lists colours of categories").expected("a map of points over a range")
}

fn of_xml(text: &str) -> Result<Vec<StatedMap>> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut maps: Vec<StatedMap> = Vec::new();
    loop {
        let at = reader.buffer_position() as usize;
        let line = || text.get(..at).map_or(1, |before| before.lines().count().max(1));
        let event = reader.read_event();
        let event = event.map_err(|error| Error::run("the XML is damaged").got(error).at_line(line()))?;
        match event {
            Event::Start(tag) | Event::Empty(tag) => match tag.name().as_ref() {
                "ColorMap" => {
                    if attribute(&tag, "indexedLookup").is_some_and(|is_listed| is_listed != "0") {
                        return Err(listed_colors().at_line(line()));
                    }
                    maps.push((attribute(&tag, "space").unwrap_or_else(|| "RGB".into()), Vec::new()));
                }
                "Point" => {
                    let number = |name: &str| {
                        attribute(&tag, name).and_then(|text| text.trim().parse::<f64>().ok()).ok_or_else(
                            || {
                                let error =
                                    Error::run(format!("'{name}' of a <Point> is no number")).at_line(line());
                                error.expected("<Point x=\"0\" o=\"1\" r=\"0\" g=\"0\" b=\"0\"/>")
                            },
                        )
                    };
                    let point = (number("x")?, [number("r")?, number("g")?, number("b")?]);
                    if let Some((_, points)) = maps.last_mut() {
                        points.push(point);
                    }
                }
                _ => {}
            },
            Event::Eof => return Ok(maps),
            _ => {}
        }
    }
}

fn attribute(tag: &BytesStart, name: &str) -> Option<String> {
    let found = tag.try_get_attribute(name).ok()??;
    Some(found.normalized_value(quick_xml::XmlVersion::Implicit1_0).ok()?.into_owned())
}
