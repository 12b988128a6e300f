//! Cells from a file: types, connectivity, faces of polyhedra.

use super::contents::{Geometry, Meter, Piece, Stored, StoredCells, StoredFaces};
use rayon::prelude::*;
use voltet_core::grid::{CellSet, CellType, Cells, Polyhedron, code, structured_corners};
use voltet_core::{Error, Result};

pub(super) fn load(piece: &Piece, meter: &Meter) -> Result<Cells> {
    match &piece.geometry {
        Geometry::Unstructured { cells, .. } => match &**cells {
            StoredCells::Offsets { connectivity, offsets, types, faces } => {
                let count = types.count_if_all(meter, &|_, _, own: &[u8]| all_tetrahedra(own))?;
                if let Some(count) = count.filter(|&count| count > 0)
                    && let Some(own) = tetrahedra(connectivity, offsets, count, meter)?
                {
                    return Ok(Cells::Tetrahedra(own.into()));
                }
                mixed(types.load(meter)?, connectivity, offsets, faces, meter).map(Cells::Mixed)
            }
            StoredCells::Counted { list, types } => counted(list, types, meter),
            StoredCells::Converted(convert) => convert(meter),
        },
        Geometry::Open(open) => open.take(None, |read| read.cells.take(), meter.progress()),
        Geometry::Adaptive(lattice) => Ok(lattice.cells()),
        Geometry::Curvilinear { dimensions, .. }
        | Geometry::Rectilinear { dimensions, .. }
        | Geometry::Uniform { dimensions, .. } => Ok(Cells::Structured(dimensions.map(|n| n as usize))),
    }
}

/// True if a piece may have cells of this kind; where types lie apart from the cells, nothing else is read.
pub(super) fn has_types(piece: &Piece, is_of_kind: impl Fn(u8) -> bool, meter: &Meter) -> Result<bool> {
    let types = match &piece.geometry {
        Geometry::Unstructured { cells, .. } => match &**cells {
            StoredCells::Offsets { types, .. } | StoredCells::Counted { types, .. } => types.load(meter)?,
            StoredCells::Converted(_) => types_of(load(piece, meter)?),
        },
        Geometry::Open(_) | Geometry::Adaptive(_) => types_of(load(piece, meter)?),
        _ => Vec::new(),
    };
    Ok(types.into_iter().any(is_of_kind))
}

/// Leaves out points of cells beyond those that their type has, as VTK passes over them; a sentence for the user where there are such.
pub(super) fn leave_out_further_points(cells: &mut Cells) -> Option<String> {
    let Cells::Mixed(set) = cells else { return None };
    let end_of = |code: u8, ends: &[u64]| {
        let own = CellType::from_code(code).and_then(|own| own.point_count).map_or(u64::MAX, u64::from);
        ends[1].min(ends[0].saturating_add(own))
    };
    let ends = set.offsets.par_windows(2).with_min_len(PART);
    let cells = set.types.par_iter().with_min_len(PART).zip(ends);
    let count = cells.filter(|&(&code, ends)| end_of(code, ends) < ends[1]).count();
    if count == 0 {
        return None;
    }
    let mut trimmed = CellSet::default();
    for (&code, ends) in set.types.iter().zip(set.offsets.windows(2)) {
        // Damaged offsets are an error once the grid is built.
        let own = set.connectivity.get(ends[0] as usize..end_of(code, ends) as usize)?;
        trimmed.push(code, own.iter().copied());
    }
    let polyhedra = std::mem::take(&mut set.polyhedra);
    *set = CellSet { polyhedra, ..trimmed };
    let cells = voltet_core::counted(count, "cell");
    Some(format!("The points of {cells} beyond those that their type of cell has are left out."))
}

/// The points of a cell; what is damaged is found out when the grid is built.
pub(super) fn corners(cells: &Cells, number: usize) -> Box<dyn Iterator<Item = u32> + '_> {
    match cells {
        Cells::Tetrahedra(tetrahedra) => Box::new(tetrahedra[number].into_iter()),
        Cells::Mixed(set) => {
            let range = set.offsets[number] as usize..set.offsets[number + 1] as usize;
            Box::new(set.connectivity.get(range).unwrap_or(&[]).iter().copied())
        }
        &Cells::Structured(dimensions) => Box::new(structured_corners(dimensions, number).into_iter()),
    }
}

fn types_of(cells: Cells) -> Vec<u8> {
    match cells {
        Cells::Mixed(set) => set.types,
        _ => Vec::new(),
    }
}

fn all_tetrahedra(types: &[u8]) -> bool {
    types.iter().fold(true, |all, &own| all & (own == code::TETRA))
}

/// Bounds that one task looks at.
const PART: usize = 1 << 14;

/// Connectivity of tetrahedra alone, straight into its destination; `None` where one has not four points.
fn tetrahedra(
    connectivity: &Stored,
    offsets: &Stored,
    count: usize,
    meter: &Meter,
) -> Result<Option<Vec<[u32; 4]>>> {
    let is_regular = offsets.count_if_all(meter, &|begin, found, own: &[u64]| {
        // The first bound, 0, may be left out.
        let first = (count + 1).wrapping_sub(found);
        let bounds = own.iter().zip(begin.wrapping_add(first)..);
        first <= 1
            && bounds.fold(true, |is_regular, (&bound, number)| is_regular & (bound == 4 * number as u64))
    })?;
    if is_regular.is_none_or(|found| found < count) {
        let bounds = bounds(offsets, count, meter)?;
        if bounds.iter().enumerate().any(|(i, &bound)| bound != 4 * i as u64) {
            return Ok(None);
        }
    }
    let mut connectivity = connectivity.clone();
    (connectivity.tuple_count, connectivity.component_count) = (Some(count as u64), 4);
    connectivity.load_tuples::<u32, _>(meter).map(Some)
}

/// Beginning of each cell's part of the connectivity, and the end of the last one. Most writers leave the first, 0, out.
fn bounds(offsets: &Stored, cell_count: usize, meter: &Meter) -> Result<Vec<u64>> {
    let (mut bounds, name): (Vec<u64>, _) = (offsets.load(meter)?, &offsets.name);
    let found = bounds.len();
    if found == cell_count {
        bounds.insert(0, 0);
    } else if found != cell_count + 1 {
        let error = Error::run("the cells have the wrong number of offsets");
        return Err(error.got(found).expected(cell_count).at_item(name));
    } else if bounds[0] != 0 {
        let error = Error::run("the offsets, one more than cells, do not begin at 0").got(bounds[0]);
        return Err(error.expected(format!("0, or {cell_count} offsets")).at_item(name));
    }
    Ok(bounds)
}

fn mixed(
    types: Vec<u8>,
    connectivity: &Stored,
    offsets: &Stored,
    faces: &StoredFaces,
    meter: &Meter,
) -> Result<CellSet> {
    let names = [&offsets.name, &connectivity.name];
    let offsets = bounds(offsets, types.len(), meter)?;
    let connectivity: Vec<u32> = connectivity.load(meter)?;
    check_offsets(&offsets, connectivity.len(), names)?;
    if !types.contains(&code::POLYHEDRON) {
        return Ok(CellSet { types, offsets, connectivity, polyhedra: Vec::new() });
    }
    match faces {
        StoredFaces::None => Err(Error::run("the file holds polyhedra without their faces")
            .expected("the arrays faces and faceoffsets")),
        StoredFaces::InConnectivity => from_streams(types, &offsets, connectivity),
        StoredFaces::Stream { faces, offsets: ends } => {
            let (faces, ends): (Vec<u32>, Vec<i64>) = (faces.load(meter)?, ends.load(meter)?);
            let mut polyhedra = Vec::new();
            let mut begin = 0;
            for number in polyhedra_of(&types) {
                let end = ends.get(number).and_then(|&end| usize::try_from(end).ok()).unwrap_or(0);
                let stream = faces.get(begin..end).ok_or_else(|| damaged_faces(number))?;
                polyhedra.push(Polyhedron { cell: number as u32, faces: face_stream(stream, number)? });
                begin = end;
            }
            if begin < faces.len() {
                let error = Error::run("the faces hold more numbers than the polyhedra take");
                return Err(error.got(faces.len()).expected(begin).at_item("faces"));
            }
            Ok(CellSet { types, offsets, connectivity, polyhedra })
        }
        StoredFaces::Indexed { points, point_offsets, faces, face_offsets } => {
            let (points, faces): (Vec<u32>, Vec<u32>) = (points.load(meter)?, faces.load(meter)?);
            let (point_ends, face_ends): (Vec<u64>, Vec<u64>) =
                (point_offsets.load(meter)?, face_offsets.load(meter)?);
            let mut polyhedra = Vec::new();
            for number in polyhedra_of(&types) {
                let own = slice_of(&faces, &face_ends, number).ok_or_else(|| damaged_faces(number))?;
                let own: Option<Vec<Vec<u32>>> = own
                    .iter()
                    .map(|&face| slice_of(&points, &point_ends, face as usize).map(<[u32]>::to_vec))
                    .collect();
                let own = own.ok_or_else(|| damaged_faces(number))?;
                polyhedra.push(Polyhedron { cell: number as u32, faces: own });
            }
            Ok(CellSet { types, offsets, connectivity, polyhedra })
        }
    }
}

/// Refuses offsets that descend or do not end with the connectivity. `names`: of both arrays.
fn check_offsets(offsets: &[u64], connectivity_len: usize, [name, connectivity]: [&String; 2]) -> Result<()> {
    let wrong = |number: usize, accepted: String| {
        Err(Error::run(format!("the offset of cell {number} is wrong"))
            .got(offsets[number + 1])
            .expected(accepted)
            .at_item(name))
    };
    if let Some(number) = offsets.windows(2).position(|pair| pair[1] < pair[0]) {
        return wrong(number, format!("at least {}", offsets[number]));
    }
    match offsets.last() {
        Some(&end) if end > connectivity_len as u64 && offsets.len() > 1 => {
            let number = offsets.partition_point(|&offset| offset <= connectivity_len as u64);
            wrong(
                number.saturating_sub(1),
                format!("at most {connectivity_len}, the length of the connectivity"),
            )
        }
        Some(&end) if end < connectivity_len as u64 => {
            let error = Error::run("the connectivity holds more point numbers than the cells take");
            Err(error
                .got(connectivity_len)
                .expected(format!("{end}, the last of the {name}"))
                .at_item(connectivity))
        }
        _ => Ok(()),
    }
}

fn polyhedra_of(types: &[u8]) -> impl Iterator<Item = usize> {
    types.iter().enumerate().filter(|&(_, &code)| code == code::POLYHEDRON).map(|(number, _)| number)
}

fn damaged_faces(number: usize) -> Error {
    Error::run(format!("the faces of cell {number}, a polyhedron, are damaged"))
        .expected("face counts and offsets that lie in the arrays of the faces")
}

/// Part `index` of `values` by the ends of the parts.
fn slice_of<'a>(values: &'a [u32], ends: &[u64], index: usize) -> Option<&'a [u32]> {
    let begin = if index == 0 { 0 } else { *ends.get(index - 1)? };
    values.get(usize::try_from(begin).ok()?..usize::try_from(*ends.get(index)?).ok()?)
}

/// The faces of a polyhedron from the stream that begins with their number, then has each face's count and points; `number`: of
/// the cell, for the error where the stream ends before.
pub fn face_stream(stream: &[u32], number: usize) -> Result<Vec<Vec<u32>>> {
    let damaged = || damaged_faces(number);
    let (&face_count, mut rest) = stream.split_first().ok_or_else(damaged)?;
    let mut faces = Vec::new();
    for _ in 0..face_count {
        let (&count, after) = rest.split_first().ok_or_else(damaged)?;
        let (face, after) = after.split_at_checked(count as usize).ok_or_else(damaged)?;
        faces.push(face.to_vec());
        rest = after;
    }
    Ok(faces)
}

/// Polyhedra whose connectivity is their face stream: it becomes the list of their points.
fn from_streams(types: Vec<u8>, offsets: &[u64], streams: Vec<u32>) -> Result<CellSet> {
    let mut cells = CellSet::default();
    for (number, code) in types.into_iter().enumerate() {
        let own = &streams[offsets[number] as usize..offsets[number + 1] as usize];
        match code {
            code::POLYHEDRON => cells.push_polyhedron(face_stream(own, number)?),
            _ => cells.push(code, own.iter().copied()),
        }
    }
    Ok(cells)
}

/// The list of legacy files before 5.0.
fn counted(list: &Stored, types: &Stored, meter: &Meter) -> Result<Cells> {
    let types: Vec<u8> = types.load(meter)?;
    let list: Vec<u32> = list.load(meter)?;
    if types.par_chunks(PART).all(all_tetrahedra)
        && !types.is_empty()
        && list.len() == types.len() * 5
        && list.par_chunks(5).all(|cell| cell[0] == 4)
    {
        let corners = |cell: &[u32]| [cell[1], cell[2], cell[3], cell[4]];
        return Ok(Cells::Tetrahedra(
            list.par_chunks(5).with_min_len(1 << 12).map(corners).collect::<Vec<_>>().into(),
        ));
    }
    let mut cells = CellSet::default();
    let mut rest = &list[..];
    for (number, &code) in types.iter().enumerate() {
        let own = rest.split_first().and_then(|(&count, after)| after.split_at_checked(count as usize));
        let Some((own, after)) = own else {
            return Err(Error::run(format!("the list of cells ends within cell {number}"))
                .got(voltet_core::counted(list.len(), "number"))
                .expected("each cell's count and its points")
                .at_item("CELLS"));
        };
        cells.push(code, own.iter().copied());
        rest = after;
    }
    if !rest.is_empty() {
        return Err(Error::run("the list of cells holds more numbers than the cells take")
            .got(list.len())
            .expected(list.len() - rest.len())
            .at_item("CELLS"));
    }
    if types.contains(&code::POLYHEDRON) {
        return from_streams(types, &cells.offsets, cells.connectivity).map(Cells::Mixed);
    }
    Ok(Cells::Mixed(cells))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::contents::Encoding;
    use crate::formats::numbers::{ByteOrder, NumberType};
    use crate::formats::source::Source;
    use voltet_core::progress::NoProgress;

    /// An array of text in a file of its own.
    fn stored(folder: &tempfile::TempDir, name: &str, text: &str) -> Stored {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        Stored {
            source: Source::open(&path).unwrap(),
            name: name.to_owned(),
            number_type: NumberType::I64,
            order: ByteOrder::Little,
            component_count: 1,
            tuple_count: None,
            encoding: Encoding::Text(std::iter::once(0..text.len() as u64).collect()),
        }
    }

    /// Four tetrahedra, two of them as polyhedra, in every form in which its faces are written.
    #[test]
    fn faces_of_polyhedra_read_the_same_in_every_form() {
        let folder = tempfile::tempdir().unwrap();
        let array = |name: &str, text: &str| stored(&folder, name, text);
        let boxed = |name: &str, text: &str| Box::new(array(name, text));
        let meter = Meter::new(&NoProgress, 1);
        let connectivity = array("connectivity", "0 1 2 3 1 2 3 4 2 3 4 5 1 2 3 4");
        let (offsets, types) = (array("offsets", "4 8 12 16"), vec![10, 42, 10, 42]);
        let stream = "4 3 1 2 3 3 1 2 4 3 1 3 4 3 2 3 4";
        let streams = StoredFaces::Stream {
            faces: boxed("faces", &format!("{stream} {stream}")),
            offsets: boxed("faceoffsets", "-1 17 -1 34"),
        };
        let indexed = StoredFaces::Indexed {
            points: boxed("face_connectivity", "1 2 3 1 2 4 1 3 4 2 3 4 1 2 3"),
            point_offsets: boxed("face_offsets", "3 6 9 12 15"),
            faces: boxed("polyhedron_to_faces", "0 1 2 3 4 1 2 3"),
            face_offsets: boxed("polyhedron_offsets", "0 4 4 8"),
        };
        let expected = CellSet {
            types: types.clone(),
            offsets: vec![0, 4, 8, 12, 16],
            connectivity: vec![0, 1, 2, 3, 1, 2, 3, 4, 2, 3, 4, 5, 1, 2, 3, 4],
            polyhedra: [1, 3]
                .map(|cell| Polyhedron {
                    cell,
                    faces: vec![vec![1, 2, 3], vec![1, 2, 4], vec![1, 3, 4], vec![2, 3, 4]],
                })
                .to_vec(),
        };
        for faces in [streams, indexed] {
            assert_eq!(mixed(types.clone(), &connectivity, &offsets, &faces, &meter).unwrap(), expected);
        }
        let legacy = array("CONNECTIVITY", &format!("0 1 2 3 {stream} 2 3 4 5 {stream}"));
        let ends = array("OFFSETS", "0 4 21 25 42");
        let inside = StoredFaces::InConnectivity;
        assert_eq!(mixed(types.clone(), &legacy, &ends, &inside, &meter).unwrap(), expected);
        let list = array("CELLS", &format!("4 0 1 2 3 17 {stream} 4 2 3 4 5 17 {stream}"));
        let codes = array("CELL_TYPES", "10 42 10 42");
        assert_eq!(counted(&list, &codes, &meter).unwrap(), Cells::Mixed(expected));
        let long = array("CELLS", &format!("4 0 1 2 3 17 {stream} 4 2 3 4 5 17 {stream} 1 0"));
        let long = counted(&long, &codes, &meter).unwrap_err().to_string();
        assert!(long.contains("more numbers") && long.contains("found 48") && long.contains("46"), "{long}");
        let long = StoredFaces::Stream {
            faces: boxed("faces", &format!("{stream} {stream} 1")),
            offsets: boxed("faceoffsets", "-1 17 -1 34"),
        };
        let long = mixed(types.clone(), &connectivity, &offsets, &long, &meter).unwrap_err().to_string();
        assert!(long.contains("more numbers") && long.contains("found 35") && long.contains("34"), "{long}");
        let none = mixed(types.clone(), &connectivity, &offsets, &StoredFaces::None, &meter).unwrap_err();
        assert!(none.to_string().contains("without their faces"), "{none}");
        let short = StoredFaces::Stream {
            faces: boxed("faces", "4 3 1 2 3"),
            offsets: boxed("faceoffsets", "-1 5 -1 5"),
        };
        let short = mixed(types, &connectivity, &offsets, &short, &meter).unwrap_err();
        assert!(short.to_string().contains("faces of cell 1"), "{short}");
    }
}
