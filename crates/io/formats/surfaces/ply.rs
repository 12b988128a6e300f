//! PLY (Turk 1994), by the crate ply-rs-bw: the elements `vertex`, `face` and `edge` with their properties. Colours are taken as sRGB, of
//! whatever type, and alpha as straight.

use crate::formats::elements::{ElementKind, Elements, SurfaceColors, linear_colors};
use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType, ScalarType,
};
use voltet_core::grid::Association;
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

/// Names of the points of an edge.
const ENDS: [&str; 2] = ["vertex1", "vertex2"];
/// Names of the colours' components.
const COLOR: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Reads points, faces, edges, and what gives their colours.
pub(super) fn read(bytes: &[u8], colors: SurfaceColors<'_>) -> Result<Elements> {
    let damaged = |error: ply_rs_bw::parser::ParseError| Error::run("the PLY file is damaged").got(error);
    let (parser, mut reader) = (Parser::<Row>::new(), Reader::new(bytes));
    let header = parser.read_header(&mut reader).map_err(damaged)?;
    let mut elements = Elements::default();
    // Values of the elements of the file from one of this number on.
    let (mut values, mut own_colors) = (None, None);
    let mut names = Vec::new();
    for (name, element) in &header.elements {
        // Of no bytes each there may be any number.
        if element.properties.is_empty() && element.count > 0 {
            return Err(
                Error::run(format!("the element '{name}' has no properties")).expected("at least one")
            );
        }
        let rows = parser.read_payload_for_element(&mut reader, element, &header).map_err(damaged)?;
        let columns = Columns::new(&rows, element);
        let first = elements.kinds.len();
        let association = match name.as_str() {
            "vertex" => {
                elements.points = columns.vectors(["x", "y", "z"]).ok_or_else(|| {
                    Error::run("the points of the PLY file have no places").expected("properties x, y and z")
                })?;
                elements.normals = columns.vectors(["nx", "ny", "nz"]).unwrap_or_default();
                Association::Point
            }
            "face" => {
                rows.iter().for_each(|row| elements.add_polygon(row.list.iter().copied()));
                Association::Cell
            }
            "edge" => {
                let ends = columns.tuples(&ENDS).ok_or_else(|| {
                    let error =
                        Error::run("the edges of the PLY file have no ends").got(columns.names.join(", "));
                    error.expected("properties vertex1 and vertex2")
                })?;
                for ends in ends.as_chunks::<2>().0 {
                    let [from, to] = ends.map(point_number);
                    elements.add(ElementKind::Line, [from?, to?]);
                }
                Association::Cell
            }
            _ => continue,
        };
        match colors {
            SurfaceColors::Array(name) if values.is_none() => {
                values = columns.place(name).map(|place| (association, first, columns.values(place)));
            }
            SurfaceColors::Own if own_colors.is_none() => {
                own_colors = columns.colors()?.map(|colors| (association, first, colors));
            }
            _ => {}
        }
        names.extend(columns.names.into_iter().map(str::to_owned));
    }
    if let (Some(name), None) = (colors.array(), &values) {
        return Err(Error::run(format!("the file holds no array '{name}'"))
            .not_among(name, names.iter().map(String::as_str)));
    }
    let count = elements.kinds.len();
    elements.values = values.map(|own| of_all(own, f64::NAN, count));
    elements.colors = own_colors.map(|own| of_all(own, NO_COLOR, count));
    Ok(elements)
}

/// Colour of elements that have none, in a file in which others have: the light grey of surfaces without a colour.
const NO_COLOR: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

/// Values of all elements, from those of some that begin with this number.
fn of_all<T: Copy>(
    (association, first, own): (Association, usize, Vec<T>),
    none: T,
    count: usize,
) -> (Association, Vec<T>) {
    if association == Association::Point {
        return (association, own);
    }
    let mut all = vec![none; count];
    all[first..first + own.len()].copy_from_slice(&own);
    (association, all)
}

/// A point's number from a property of any type.
fn point_number(value: f64) -> Result<u32> {
    let number = value as u32;
    let error = || Error::run("an edge of the PLY file has a point that does not exist").got(value);
    if f64::from(number) == value { Ok(number) } else { Err(error().expected("its number, from 0 on")) }
}

/// The single properties of an element.
struct Columns<'a> {
    rows: &'a [Row],
    names: Vec<&'a str>,
    types: Vec<&'a ScalarType>,
}

impl<'a> Columns<'a> {
    fn new(rows: &'a [Row], element: &'a ElementDef) -> Columns<'a> {
        let single = |(name, property): (&'a String, &'a PropertyDef)| match &property.data_type {
            PropertyType::Scalar(scalar) => Some((name.as_str(), scalar)),
            PropertyType::List(..) => None,
        };
        let (names, types) = element.properties.iter().filter_map(single).unzip();
        Columns { rows, names, types }
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|own| *own == name)
    }

    fn values(&self, place: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row.values[place]).collect()
    }

    /// The numbers of several properties, row by row; none where one is missing.
    fn tuples(&self, names: &[&str]) -> Option<Vec<f64>> {
        let places: Vec<usize> = names.iter().map(|name| self.place(name)).collect::<Option<_>>()?;
        Some(self.rows.iter().flat_map(|row| places.iter().map(|&place| row.values[place])).collect())
    }

    fn vectors(&self, names: [&str; 3]) -> Option<Vec<DVec3>> {
        let numbers = self.tuples(&names)?;
        Some(numbers.as_chunks::<3>().0.iter().map(|&vector| vector.into()).collect())
    }

    /// Colours: whole numbers to the end of their type's range, or 0 to 1.
    fn colors(&self) -> Result<Option<Vec<[f64; 4]>>> {
        let Some(red) = self.place(COLOR[0]) else { return Ok(None) };
        let full = match self.types[red] {
            ScalarType::Float | ScalarType::Double => 1.0,
            ScalarType::UShort => f64::from(u16::MAX),
            _ => f64::from(u8::MAX),
        };
        let names = if self.place(COLOR[3]).is_some() { &COLOR[..] } else { &COLOR[..3] };
        let numbers = self.tuples(names);
        numbers.map(|numbers| linear_colors(&numbers, names.len(), full)).transpose()
    }
}
