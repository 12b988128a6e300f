//! Zones of Tecplot data as both forms have them, and the data set that they are.

use crate::formats::blocks::{left_out, selected};
use crate::formats::contents::{Dataset, Piece};
use crate::formats::request::Request;
use crate::formats::source::Source;
use voltet_core::grid::{Association, CellSet, Cells};
use voltet_core::{Error, Result};

#[derive(Clone, Copy, PartialEq)]
pub(super) enum ZoneKind {
    Tetrahedra,
    Bricks,
    Polyhedra,
    /// Numbers of points along three axes.
    Ordered([u64; 3]),
    /// Lines and surfaces, whose cells list so many nodes each.
    Flat(u64),
}

impl ZoneKind {
    /// Nodes of a cell that the file lists.
    pub fn corners(self) -> u64 {
        match self {
            ZoneKind::Tetrahedra => 4,
            ZoneKind::Bricks => 8,
            ZoneKind::Ordered(_) | ZoneKind::Polyhedra => 0,
            ZoneKind::Flat(count) => count,
        }
    }

    /// An ordered zone by its numbers of points, and its numbers of nodes and of cells.
    pub fn ordered(points: [u64; 3]) -> (ZoneKind, u64, u64) {
        let product = |n: [u64; 3]| n.iter().fold(1_u64, |product, &n| product.saturating_mul(n));
        let is_flat = points.iter().any(|&n| n < 2);
        let kind = if is_flat { ZoneKind::Flat(0) } else { ZoneKind::Ordered(points) };
        (kind, product(points), product(points.map(|n| n.saturating_sub(1).max(1))))
    }
}

pub(super) struct ZoneHead {
    pub name: String,
    pub kind: ZoneKind,
    pub node_count: u64,
    pub cell_count: u64,
    /// For each variable: true if its values are at cells.
    pub at_cells: Vec<bool>,
    /// For each variable the zone that holds its numbers, if it is another.
    pub shared: Vec<Option<usize>>,
    /// For each variable: true if the zone has no values of it.
    pub passive: Vec<bool>,
    /// The zone that holds the connectivity, if it is another.
    pub shared_cells: Option<usize>,
    pub time: Option<f64>,
}

impl ZoneHead {
    /// A zone of a file of so many variables, which holds all of them at its nodes.
    pub fn new(
        name: String,
        kind: ZoneKind,
        [node_count, cell_count]: [u64; 2],
        variable_count: usize,
    ) -> Self {
        let (at_cells, passive) = (vec![false; variable_count], vec![false; variable_count]);
        let (shared, shared_cells, time) = (vec![None; variable_count], None, None);
        ZoneHead { name, kind, node_count, cell_count, at_cells, shared, passive, shared_cells, time }
    }

    /// True if the zone itself holds numbers of a variable.
    pub fn holds(&self, variable: usize) -> bool {
        self.shared[variable].is_none() && !self.passive[variable]
    }

    pub fn len(&self, variable: usize) -> u64 {
        if self.at_cells[variable] { self.cell_count } else { self.node_count }
    }

    /// Shares a variable with the zone `number`. Errors: it has others.
    pub fn share(&mut self, variable: usize, number: usize, zone: &ZoneHead) -> Result<()> {
        let size = |zone: &ZoneHead| format!("{} nodes and {} cells", zone.node_count, zone.cell_count);
        if zone.at_cells[variable] != self.at_cells[variable] {
            let error = Error::run("a zone shares a variable with one that has it in another place");
            return Err(error.expected("both at nodes, or both at cells"));
        }
        // Values at cells of ordered points lie by the points along the axes.
        let is_other_order = self.at_cells[variable]
            && zone.kind != self.kind
            && [zone.kind, self.kind].iter().any(|kind| matches!(kind, ZoneKind::Ordered(_)));
        if zone.len(variable) != self.len(variable) || is_other_order {
            let error = Error::run("a zone shares variables with one of another size");
            return Err(error.got(size(zone)).expected(size(self)));
        }
        self.passive[variable] = zone.passive[variable];
        self.shared[variable] = Some(number);
        Ok(())
    }
}

/// Polyhedra of a zone by their faces: the bounds of each face's nodes, the nodes of all, and the cells on the left of each face, then on
/// the right, below 0 where there is none of the zone.
pub(super) fn polyhedra(zone: &ZoneHead, bounds: &[u64], nodes: &[u32], sides: &[i64]) -> Result<Cells> {
    let face_count = bounds.len().saturating_sub(1).max(1);
    // A cell takes memory before a face names it.
    if zone.cell_count > sides.len() as u64 {
        let error = Error::run("a zone has more cells than sides of faces").got(zone.cell_count);
        return Err(error.expected(format_args!("at most {}", sides.len())).at_item(&zone.name));
    }
    let mut cells: Vec<Vec<Vec<u32>>> = vec![Vec::new(); zone.cell_count as usize];
    for (side, &cell) in sides.iter().enumerate() {
        let face = side % face_count;
        let points = bounds.get(face..face + 2).and_then(|own| nodes.get(own[0] as usize..own[1] as usize));
        let points = points.ok_or_else(|| {
            let error = Error::run(format!("face {face} has nodes that are not there"))
                .got(format_args!("{:?}", bounds.get(face..face + 2)));
            error.expected(format_args!("ascending, and at most {}", nodes.len())).at_item(&zone.name)
        })?;
        // Beyond some faces is no cell, or that of another zone.
        let Ok(cell) = usize::try_from(cell) else { continue };
        let own = cells.get_mut(cell).ok_or_else(|| {
            let error = Error::run(format!("face {face} is of a cell that is not there")).got(cell);
            error.expected(format_args!("below {}", zone.cell_count)).at_item(&zone.name)
        })?;
        own.push(points.to_vec());
    }
    let mut gathered = CellSet::default();
    cells.into_iter().for_each(|faces| gathered.push_polyhedron(faces));
    Ok(Cells::Mixed(gathered))
}

/// Places of x, y and z among the variables.
pub(super) fn axes(variables: &[String]) -> [usize; 3] {
    let place = |axis: &str| {
        let is_axis = |name: &String| {
            let stem = name.split([' ', '[', '(']).next().unwrap_or_default();
            stem.eq_ignore_ascii_case(axis) || stem.eq_ignore_ascii_case(&format!("coordinate{axis}"))
        };
        variables.iter().position(is_axis)
    };
    match (place("x"), place("y"), place("z")) {
        (Some(x), Some(y), Some(z)) => [x, y, z],
        _ => [0, 1, 2],
    }
}

/// Errors: a zone has no coordinates at its nodes.
fn check_axes(zone: &ZoneHead, axes: [usize; 3]) -> Result<()> {
    match axes.iter().any(|&axis| zone.at_cells[axis] || zone.passive[axis]) {
        false => Ok(()),
        true => {
            let error = Error::run("a zone has no coordinates at its nodes");
            Err(error.got(format_args!("zone '{}'", zone.name)).expected("x, y and z at nodes"))
        }
    }
}

/// Variables that are arrays of a zone: all but coordinates and those without values there.
pub(super) fn quantities(zone: &ZoneHead, axes: [usize; 3]) -> impl Iterator<Item = (usize, Association)> {
    let association = |variable: usize| match zone.at_cells[variable] {
        true => Association::Cell,
        false => Association::Point,
    };
    (0..zone.at_cells.len())
        .filter(move |variable| !axes.contains(variable) && !zone.passive[*variable])
        .map(move |variable| (variable, association(variable)))
}

/// The volumes among zones at the requested time, each as a piece that `piece` makes by its number and that of its block.
pub(super) fn dataset(
    source: &Source,
    format: String,
    zones: &[&ZoneHead],
    axes: [usize; 3],
    request: &Request,
    piece: impl Fn(usize, usize) -> Piece,
) -> Result<Dataset> {
    let is_volume = |zone: &ZoneHead| !matches!(zone.kind, ZoneKind::Flat(_)) && zone.cell_count > 0;
    let volumes: Vec<usize> = (0..zones.len()).filter(|&zone| is_volume(zones[zone])).collect();
    let mut times: Vec<f64> = volumes.iter().filter_map(|&zone| zones[zone].time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let only_time = if let [time] = times[..] { Some(time) } else { None };
    let times = if times.len() > 1 { times } else { Vec::new() };
    let time = if times.is_empty() { None } else { Some(times[request.step_index(&times)?]) };
    let is_of_time = |zone: &ZoneHead| time.is_none() || zone.time.is_none() || zone.time == time;
    let volumes: Vec<usize> = volumes.into_iter().filter(|&zone| is_of_time(zones[zone])).collect();
    let name = |&zone: &usize| {
        let own = &zones[zone].name;
        let is_unique = volumes.iter().filter(|&&other| zones[other].name == *own).count() == 1;
        if is_unique && !own.is_empty() { own.clone() } else { format!("{own} ({})", zone + 1) }
    };
    let is_flat = |zone: &ZoneHead| matches!(zone.kind, ZoneKind::Flat(_)) && zone.cell_count > 0;
    let flat = zones.iter().filter(|zone| is_flat(zone) && is_of_time(zone)).map(|zone| &*zone.name);
    let blocks: Vec<String> = if volumes.len() > 1 { volumes.iter().map(name).collect() } else { Vec::new() };
    let mut is_selected = selected(&blocks, request)?;
    is_selected.resize(volumes.len(), true);
    let mut dataset = Dataset {
        format,
        has_blocks: volumes.len() > 1,
        blocks,
        time_steps: times,
        time: only_time,
        file_bytes: source.len(),
        ..Dataset::default()
    };
    dataset.warnings.extend(left_out("Zones without cells of three dimensions", flat));
    for (block, &zone) in volumes.iter().enumerate().filter(|(block, _)| is_selected[*block]) {
        check_axes(zones[zone], axes)?;
        dataset.pieces.push(piece(zone, block));
    }
    Ok(dataset)
}
