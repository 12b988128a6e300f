//! Cells of any types: the set that readers add cells to, parts of it, and several as one.

use super::code::POLYHEDRON;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Point numbers that one task handles.
const CHUNK: usize = 1 << 13;

/// Cells of a file, in VTK's terms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellSet {
    /// VTK cell type code of every cell.
    pub types: Vec<u8>,
    /// `offsets[i] .. offsets[i + 1]` is cell i's part of `connectivity`; `types.len() + 1` entries.
    pub offsets: Vec<u64>,
    /// Point numbers, in VTK's vertex order.
    pub connectivity: Vec<u32>,
    /// Faces of the polyhedra (type 42); empty where there are none.
    pub polyhedra: Vec<Polyhedron>,
}

/// The faces of one polyhedral cell.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Polyhedron {
    /// Number of the cell.
    pub cell: u32,
    /// Each face a closed loop of point numbers.
    pub faces: Vec<Vec<u32>>,
}

impl Default for CellSet {
    /// No cells.
    fn default() -> CellSet {
        CellSet { types: Vec::new(), offsets: vec![0], connectivity: Vec::new(), polyhedra: Vec::new() }
    }
}

impl CellSet {
    /// Cells of one VTK type, all of so many points, by the points of all. Points behind the last whole cell are left out.
    pub fn of_type(code: u8, point_count: usize, mut connectivity: Vec<u32>) -> CellSet {
        let count = connectivity.len().checked_div(point_count).unwrap_or(0);
        connectivity.truncate(count * point_count);
        let offsets = (0..=count).into_par_iter().map(|cell| (cell * point_count) as u64).collect();
        CellSet { types: vec![code; count], offsets, connectivity, polyhedra: Vec::new() }
    }

    /// Adds a cell of a VTK type with its points in VTK's order.
    pub fn push(&mut self, code: u8, corners: impl IntoIterator<Item = u32>) {
        self.connectivity.extend(corners);
        self.offsets.push(self.connectivity.len() as u64);
        self.types.push(code);
    }

    /// Adds cells of one VTK type as [`of_type`](Self::of_type) makes them.
    pub fn push_all(&mut self, code: u8, point_count: usize, corners: &[u32]) {
        let (begin, count) = (self.connectivity.len(), corners.len().checked_div(point_count).unwrap_or(0));
        self.connectivity.extend_from_slice(&corners[..count * point_count]);
        self.offsets.extend((1..=count).map(|cell| (begin + cell * point_count) as u64));
        self.types.resize(self.types.len() + count, code);
    }

    /// Adds a polyhedron by the points of its faces.
    pub fn push_polyhedron(&mut self, faces: Vec<Vec<u32>>) {
        let mut corners = faces.concat();
        corners.sort_unstable();
        corners.dedup();
        self.polyhedra.push(Polyhedron { cell: self.types.len() as u32, faces });
        self.push(POLYHEDRON, corners);
    }

    /// Adds the cells of another set, with its points by other numbers.
    pub fn append(&mut self, other: CellSet, number: impl Fn(u32) -> u32 + Sync) {
        let (begin, first) = (self.connectivity.len() as u64, self.types.len() as u32);
        let corners = other.connectivity.into_par_iter().with_min_len(CHUNK);
        self.connectivity.par_extend(corners.map(&number));
        self.offsets.extend(other.offsets[1..].iter().map(|end| begin + end));
        self.types.extend(other.types);
        self.polyhedra.extend(other.polyhedra.into_iter().map(|mut polyhedron| {
            polyhedron.cell += first;
            polyhedron.faces.iter_mut().flatten().for_each(|point| *point = number(*point));
            polyhedron
        }));
    }

    /// Some of the cells, by their numbers in ascending order, with their points by other numbers.
    pub(super) fn subset(&self, cells: &[u32], number: impl Fn(u32) -> u32) -> CellSet {
        let mut some = CellSet::default();
        for cell in cells.iter().map(|&cell| cell as usize) {
            let corners = self.offsets[cell] as usize..self.offsets[cell + 1] as usize;
            // Damaged offsets are an error once the grid is built.
            let corners = self.connectivity.get(corners).unwrap_or(&[]);
            some.push(self.types[cell], corners.iter().map(|&point| number(point)));
        }
        let polyhedron = |polyhedron: &Polyhedron| {
            let cell = cells.binary_search(&polyhedron.cell).ok()? as u32;
            let face = |face: &Vec<u32>| face.iter().map(|&point| number(point)).collect();
            Some(Polyhedron { cell, faces: polyhedron.faces.iter().map(face).collect() })
        };
        some.polyhedra = self.polyhedra.iter().filter_map(polyhedron).collect();
        some
    }
}
