//! PolyData (.vtp): the vertices, lines, polygons and strips of all pieces.

use super::header::{self, Element};
use super::serial::{Context, marked, points};
use crate::formats::assemble::{column, load_points};
use crate::formats::contents::{GHOST_TYPE, Geometry, Meter, Piece, Stored};
use crate::formats::elements::{ElementKind, Elements, SurfaceColors, linear_colors, too_many_points};
use crate::formats::numbers::NumberType;
use crate::formats::request;
use crate::formats::source::Source;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

/// The kinds of cells in the order of their values, and the attributes that count them.
const SECTIONS: [(&str, &str, ElementKind); 4] = [
    ("Verts", "NumberOfVerts", ElementKind::Vertices),
    ("Lines", "NumberOfLines", ElementKind::Line),
    ("Polys", "NumberOfPolys", ElementKind::Polygon),
    (STRIPS, "NumberOfStrips", ElementKind::Polygon),
];
const STRIPS: &str = "Strips";

/// Flags of cells that other pieces own or that are hidden (vtkDataSetAttributes).
const NOT_DRAWN: u8 = 1 | 32;

/// Reads the cells of all pieces, and what gives their colours.
pub(in crate::formats) fn read(
    source: &Arc<Source>,
    colors: SurfaceColors<'_>,
    meter: &Meter,
) -> Result<Elements> {
    let (root, appended) = header::read(source)?;
    let context = Context::new(source.clone(), &root, appended)?;
    let kind = root.required("type")?;
    let (Some(grid), "PolyData") = (root.child("PolyData"), kind) else {
        let error = Error::run("this VTK file holds no surface").got(format!("type '{kind}'"));
        return Err(error.expected("PolyData; a node of type reader reads grids"));
    };
    let mut all = Elements::default();
    for (index, element) in grid.children_of("Piece").enumerate() {
        let added = add_piece(&context, element, colors, meter, &mut all);
        added.map_err(|error: Error| error.at_item(format!("piece {index}")))?;
    }
    Ok(all)
}

fn add_piece(
    context: &Context,
    element: &Element,
    colors: SurfaceColors<'_>,
    meter: &Meter,
    all: &mut Elements,
) -> Result<()> {
    let count = |name: &str| element.number::<u64>(name).map(|count| count.unwrap_or(0));
    let point_count = count("NumberOfPoints")?;
    let mut counts = [0_u64; 4];
    for (count_of, (_, attribute, _)) in counts.iter_mut().zip(SECTIONS) {
        *count_of = count(attribute)?;
    }
    let cell_count = counts
        .iter()
        .try_fold(0_u64, |sum, count| sum.checked_add(*count))
        .ok_or_else(|| Error::run("the piece cannot hold that many cells").got(format!("{counts:?}")))?;
    if point_count == 0 || cell_count == 0 {
        return Ok(());
    }
    let mut arrays = context.section(element, "PointData", Association::Point, point_count)?;
    arrays.extend(context.section(element, "CellData", Association::Cell, cell_count)?);
    // The points as a row; the polygons stand beside it.
    let geometry = Geometry::Curvilinear {
        dimensions: [point_count, 1, 1],
        points: points(context, element, point_count)?,
    };
    let piece = Piece::new([point_count, cell_count], geometry, arrays);
    let values = match colors.array() {
        Some(name) => {
            let choice = request::scalar_of(&piece.arrays.iter().collect::<Vec<_>>(), name, None)?;
            Some((choice.association, column(&piece, &choice, meter)?))
        }
        None => None,
    };
    let own_colors = if colors == SurfaceColors::Own { marked_colors(element, &piece, meter)? } else { None };
    let normals = marked(element, &["PointData"], "Normals")
        .and_then(|name| piece.array(Association::Point, &name))
        .filter(|stored| stored.component_count == 3)
        .map(|stored| stored.load_tuples::<f64, DVec3>(meter))
        .transpose()?
        .unwrap_or_default();
    let flags =
        piece.array(Association::Cell, GHOST_TYPE).map(|stored| stored.load::<u8>(meter)).transpose()?;
    let (before, first) = (all.points.len(), all.kinds.len());
    all.points.extend(load_points(&piece, meter)?);
    if all.points.len() > u32::MAX as usize {
        return Err(too_many_points(all.points.len()));
    }
    // Either all pieces have normals, or none counts.
    if all.normals.len() == before {
        all.normals.extend(normals);
    }
    if all.normals.len() < all.points.len() {
        all.normals.clear();
    }
    let mut cell_of_each = Vec::new();
    let mut cell = 0;
    for ((tag, _, kind), count) in SECTIONS.into_iter().zip(counts) {
        for corners in cells(context, element, tag, count, meter)? {
            let is_drawn = flags.as_ref().is_none_or(|flags| flags[cell] & NOT_DRAWN == 0);
            if let Some(&point) = corners.iter().find(|&&p| u64::from(p) >= point_count) {
                return Err(Error::run(format!("a cell of <{tag}> has a point that does not exist"))
                    .got(point)
                    .expected(format!("below {point_count}")));
            }
            let corners: Vec<u32> = corners.iter().map(|p| before as u32 + p).collect();
            match tag == STRIPS {
                _ if !is_drawn => {}
                true => corners.windows(3).enumerate().for_each(|(k, t)| {
                    // Every other one turns the other way.
                    all.add(kind, if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
                }),
                false => all.add(kind, corners),
            }
            cell_of_each.resize(all.kinds.len() - first, cell);
            cell += 1;
        }
    }
    if let Some(values) = values {
        join(&mut all.values, values, &cell_of_each)?;
    }
    if let Some(colors) = own_colors {
        join(&mut all.colors, colors, &cell_of_each)?;
    }
    // Either all pieces have colours, or none counts.
    let (point_count, cell_count) = (all.points.len(), all.kinds.len());
    all.colors.take_if(|(association, colors)| match association {
        Association::Point => colors.len() != point_count,
        Association::Cell => colors.len() != cell_count,
    });
    Ok(())
}

/// Adds the values of a piece, of its points or cells, to those of the pieces before.
fn join<T: Copy>(
    all: &mut Option<(Association, Vec<T>)>,
    (association, values): (Association, Vec<T>),
    cell_of_each: &[usize],
) -> Result<()> {
    let values = match association {
        Association::Point => values,
        Association::Cell => cell_of_each.iter().map(|&cell| values[cell]).collect(),
    };
    match all {
        Some((own, known)) if *own == association => known.extend(values),
        Some(_) => return Err(Error::run("an array is of points in one piece and of cells in another")),
        none => *none = Some((association, values)),
    }
    Ok(())
}

/// The colours of an array of three or four bytes that the file marks as its scalars, as VTK's mappers take it: sRGB, and alpha.
fn marked_colors(
    element: &Element,
    piece: &Piece,
    meter: &Meter,
) -> Result<Option<(Association, Vec<[f64; 4]>)>> {
    for (section, association) in [("PointData", Association::Point), ("CellData", Association::Cell)] {
        let Some(name) = marked(element, &[section], "Scalars") else { continue };
        let is_color = |stored: &&Stored| {
            stored.number_type == NumberType::U8 && matches!(stored.component_count, 3 | 4)
        };
        if let Some(stored) = piece.array(association, &name).filter(is_color) {
            let colors = linear_colors(&stored.load::<f64>(meter)?, stored.component_count, 255.0)?;
            return Ok(Some((association, colors)));
        }
    }
    Ok(None)
}

/// The points of each cell of a section.
fn cells(
    context: &Context,
    element: &Element,
    tag: &str,
    count: u64,
    meter: &Meter,
) -> Result<Vec<Vec<u32>>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let section = element.child(tag).ok_or_else(|| Error::run(format!("the piece holds no <{tag}>")))?;
    let array = |name, count| -> Result<Stored> { context.required(section, name, count) };
    let connectivity: Vec<u32> = array("connectivity", None)?.load(meter)?;
    let offsets: Vec<u64> = array("offsets", Some(count))?.load(meter)?;
    let mut start = 0;
    let of_each = offsets.into_iter().enumerate().map(|(cell, end)| {
        let corners = usize::try_from(end).ok().and_then(|end| connectivity.get(start..end));
        let corners = corners.ok_or_else(|| {
            Error::run(format!("the end of cell {cell} of <{tag}> is wrong"))
                .got(end)
                .expected(format!("{start} to {}", connectivity.len()))
        })?;
        start = end as usize;
        Ok(corners.to_vec())
    });
    of_each.collect()
}
