//! First place on a ray where something is seen: in a cell or on a surface.
//!
//! The optical depth up to a place is that of the cells and surfaces before, a surface of opacity α adding −ln(1 − α).

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use voltet_core::grid::{Grid, feature_edges};
use voltet_core::surface::Surface;
use voltet_core::volume::Volume;
use voltet_optics::trace::{CellCrossing, Walk};
use voltet_optics::{CompiledTransferFunction, Segment};

/// Opacity from which on something is seen: half of a level of the 256 that a screen shows.
const SEEN: f64 = 0.5 / 255.0;

/// Halvings of a cell's crossing: beyond the digits that are shown.
const HALVINGS: u32 = 30;

/// Barycentric distance outside of a cell within which a point still counts as in it: rounding of a surface on its faces.
const IN_CELL: f64 = 1e-6;

/// Point that is seen first, and the data there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hit {
    /// World units.
    pub point: DVec3,
    /// None on a surface beside all cells.
    pub cell: Option<HitCell>,
    /// True if a surface is seen first, false if a cell is.
    pub is_on_surface: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HitCell {
    /// Number of the cell in the file.
    pub number: usize,
    /// Ends of its edges, world units; empty while they are not looked for.
    pub edges: Vec<[DVec3; 2]>,
    /// s at the point.
    pub s: f64,
    /// g at the point; none where the data have no gradient.
    pub g: Option<f64>,
}

/// The first hit of a ray that was walked. `ray`: its origin and unit direction, world units.
pub(super) fn first_hit(
    volume: &Volume,
    function: &CompiledTransferFunction,
    walk: &Walk,
    surfaces: &[Arc<Surface>],
    [origin, direction]: [DVec3; 2],
) -> Option<Hit> {
    let mut crossed: Vec<[f64; 2]> = surfaces.iter().flat_map(|s| crossings(s, origin, direction)).collect();
    crossed.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut crossed = crossed.into_iter().peekable();
    let (mut left, at) = (-(-SEEN).ln_1p(), |distance: f64| origin + distance * direction);
    let on_surface = |point: DVec3| Hit { point, cell: find_cell(volume, point), is_on_surface: true };
    for step in &walk.steps {
        let ([entry, exit], mut from) = (step.distance, 0.0);
        loop {
            let surface = crossed.next_if(|[distance, _]| *distance <= exit);
            let until =
                surface.map_or(1.0, |[distance, _]| ((distance - entry) / (exit - entry)).clamp(from, 1.0));
            let own = optical_depth(function, step, [from, until]);
            if own >= left {
                let share = where_reached(function, step, [from, until], left);
                let point = at(entry + share * (exit - entry));
                let cell = in_cell(volume, step.cell as usize, point).map(|(_, cell)| cell);
                return Some(Hit { point, cell, is_on_surface: false });
            }
            left -= own;
            let Some([distance, opacity]) = surface else { break };
            left += (-opacity).ln_1p();
            if left <= 0.0 {
                return Some(on_surface(at(distance)));
            }
            from = until;
        }
    }
    crossed.find_map(|[distance, opacity]| {
        left += (-opacity).ln_1p();
        (left <= 0.0).then(|| on_surface(at(distance)))
    })
}

/// Optical depth of a part of a crossing, between two shares of it.
fn optical_depth(function: &CompiledTransferFunction, step: &CellCrossing, [from, to]: [f64; 2]) -> f64 {
    let values = |share: f64| -> Vec<f64> {
        step.front.iter().zip(&step.back).map(|(front, back)| front + share * (back - front)).collect()
    };
    let (front, back) = (values(from), values(to));
    function.optical_depth_of_values(&Segment::of_values((to - from) * step.length, &front, &back))
}

/// The share of a crossing up to which a part of it has an optical depth.
fn where_reached(
    function: &CompiledTransferFunction,
    step: &CellCrossing,
    [from, to]: [f64; 2],
    level: f64,
) -> f64 {
    let (mut low, mut high) = (from, to);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if optical_depth(function, step, [from, middle]) < level {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Distances at which a ray crosses a surface, each with the opacity there (Möller and Trumbore 1997).
fn crossings(surface: &Surface, origin: DVec3, direction: DVec3) -> Vec<[f64; 2]> {
    let crossing = |(number, corners): (usize, &[u32; 3])| {
        let [a, b, c] = corners.map(|corner| surface.points[corner as usize]);
        let (ab, ac, from) = (b - a, c - a, origin - a);
        let (across, aside) = (direction.cross(ac), from.cross(ab));
        let determinant = ab.dot(across);
        let [v, w] = [from.dot(across), direction.dot(aside)].map(|x| x / determinant);
        let distance = ac.dot(aside) / determinant;
        let is_hit = v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance > 0.0 && distance.is_finite();
        // Facing changes colours, not opacity.
        is_hit.then(|| [distance, surface.color(number, [1.0 - v - w, v, w], 1.0)[3]])
    };
    surface.triangles.par_iter().enumerate().filter_map(crossing).collect()
}

fn find_cell(volume: &Volume, point: DVec3) -> Option<HitCell> {
    let cells = (0..volume.grid.tetrahedra.len()).into_par_iter();
    let found = cells.filter_map(|cell| in_cell(volume, cell, point));
    let deepest = found.max_by(|(a, _), (b, _)| a.total_cmp(b));
    deepest.filter(|(inside, _)| *inside >= -IN_CELL).map(|(_, cell)| cell)
}

/// A cell as that of a point, with its least barycentric coordinate; `None` where it lies apart, or the cell has no volume.
fn in_cell(volume: &Volume, cell: usize, point: DVec3) -> Option<(f64, HitCell)> {
    let at = volume.grid.tetrahedra[cell].map(|corner| corner as usize);
    let corners = at.map(|corner| volume.grid.points[corner]);
    let [low, high] = [DVec3::min as fn(DVec3, DVec3) -> DVec3, DVec3::max]
        .map(|of| corners.into_iter().reduce(of).unwrap_or_default());
    let room = IN_CELL * (high - low).max_element();
    if point.cmplt(low - room).any() || point.cmpgt(high + room).any() {
        return None;
    }
    let edges = DMat3::from_cols(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
    let [b, c, d] = (edges.inverse() * (point - corners[0])).to_array();
    let weights = [1.0 - b - c - d, b, c, d];
    let inside = weights.into_iter().fold(f64::INFINITY, f64::min);
    let of = |values: &[f64]| (0..4).map(|k| weights[k] * values[at[k]]).sum::<f64>();
    let (s, g) = (of(&volume.scalar), volume.gradient_magnitude.as_ref().map(|g| of(g)));
    let number = volume.grid.source_cell(cell);
    inside.is_finite().then(|| (inside, HitCell { number, edges: Vec::new(), s, g }))
}

/// Turn of the normals, degrees, up to which two triangles are of one face of a cell: faces of four corners may be bent.
const BENT: f64 = 15.0;

/// Ends of the edges of a cell of the file, those between the tetrahedra that it was split into left out.
pub(super) fn edges(grid: &Grid, cell: usize) -> Vec<[DVec3; 2]> {
    let parts: Vec<[u32; 4]> = match &grid.source_cells {
        None => grid.tetrahedra.get(cell).copied().into_iter().collect(),
        Some(cells) => {
            let own = cells.par_iter().enumerate().filter(|(_, source)| **source as usize == cell);
            own.map(|(part, _)| grid.tetrahedra[part]).collect()
        }
    };
    let corners: BTreeSet<u32> = parts.iter().flatten().copied().collect();
    let points: Vec<DVec3> = corners.iter().map(|corner| grid.points[*corner as usize]).collect();
    let place = |corner: u32| corners.range(..corner).count() as u32;
    // Faces that two parts share lie within.
    let mut faces = BTreeMap::<[u32; 3], usize>::new();
    for [a, b, c, d] in parts.iter().map(|part| part.map(place)) {
        for face in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
            *faces.entry(face).or_default() += 1;
        }
    }
    let outer: Vec<[u32; 3]> =
        faces.into_iter().filter(|(_, count)| *count == 1).map(|(face, _)| face).collect();
    // A tetrahedron has all of them, however flat it is.
    let angle = if parts.len() == 1 { 0.0 } else { BENT };
    let ends = feature_edges(&points, &outer, angle);
    ends.into_iter().map(|ends| ends.map(|end| points[end as usize])).collect()
}
