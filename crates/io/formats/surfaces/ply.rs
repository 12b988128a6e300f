//! PLY (Turk 1994), by the crate ply-rs-bw: the elements `vertex` and `face` with their properties.

use crate::formats::polygons::Polygons;
use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult, PropertyType};
use voltet_core::grid::Association;
use voltet_core::parameters::suggest;
use voltet_core::{Error, Result};

/// Values of an element: single ones in the order of the header, and its last list of whole numbers.
struct Row {
    values: Vec<f64>,
    list: Vec<u32>,
}

impl PropertyAccess for Row {
    fn new() -> Row {
        Row { values: Vec::new(), list: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let value = match property {
            Property::Char(x) => x.into(),
            Property::UChar(x) => x.into(),
            Property::Short(x) => x.into(),
            Property::UShort(x) => x.into(),
            Property::Int(x) => x.into(),
            Property::UInt(x) => x.into(),
            Property::Float(x) => x.into(),
            Property::Double(x) => x,
            list if CORNERS.contains(&name) => {
                let Some(corners) = list.to_u32_list() else { return PropertyAccessResult::UnsupportedType };
                self.list = corners;
                return PropertyAccessResult::Set;
            }
            _ => return PropertyAccessResult::Ignored,
        };
        self.values.push(value);
        PropertyAccessResult::Set
    }
}

/// Names of the list of a face's points.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads the faces and an array of points or faces.
pub(super) fn read(bytes: &[u8], array: Option<&str>) -> Result<Polygons> {
    let damaged = |error: ply_rs_bw::parser::ParseError| Error::run("the PLY file is damaged").got(error);
    let (parser, mut reader) = (Parser::<Row>::new(), Reader::new(bytes));
    let header = parser.read_header(&mut reader).map_err(damaged)?;
    let mut polygons = Polygons::default();
    let mut names = Vec::new();
    for (name, element) in &header.elements {
        // Of no bytes each there may be any number.
        if element.properties.is_empty() && element.count > 0 {
            return Err(
                Error::run(format!("the element '{name}' has no properties")).expected("at least one")
            );
        }
        let rows = parser.read_payload_for_element(&mut reader, element, &header).map_err(damaged)?;
        let single = |(_, property): &(&String, &ply_rs_bw::ply::PropertyDef)| {
            matches!(property.data_type, PropertyType::Scalar(_))
        };
        let singles: Vec<&str> =
            element.properties.iter().filter(single).map(|(name, _)| name.as_str()).collect();
        let place = |name: &str| singles.iter().position(|single| *single == name);
        let values = |place: usize| rows.iter().map(|row| row.values[place]).collect::<Vec<f64>>();
        let vectors = |names: [&str; 3]| -> Option<Vec<DVec3>> {
            let [x, y, z] = names.map(place);
            let (x, y, z) = (x?, y?, z?);
            Some(rows.iter().map(|row| DVec3::new(row.values[x], row.values[y], row.values[z])).collect())
        };
        let association = match name.as_str() {
            "vertex" => {
                polygons.points = vectors(["x", "y", "z"]).ok_or_else(|| {
                    Error::run("the points of the PLY file have no places").expected("properties x, y and z")
                })?;
                polygons.normals = vectors(["nx", "ny", "nz"]).unwrap_or_default();
                Association::Point
            }
            "face" => {
                rows.iter().for_each(|row| polygons.add(row.list.iter().copied()));
                Association::Cell
            }
            _ => continue,
        };
        if let (Some(name), None) = (array, &polygons.values) {
            polygons.values = place(name).map(|place| (association, values(place)));
        }
        names.extend(singles.into_iter().map(str::to_owned));
    }
    match array.filter(|_| polygons.values.is_none()) {
        Some(name) => Err(Error::run(format!("the file holds no array '{name}'"))
            .expected(suggest(name, names.iter().map(String::as_str)))),
        None => Ok(polygons),
    }
}
