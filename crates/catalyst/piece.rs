//! The piece of one process of a grid that several hold together, with cells of the others around it.
//!
//! Of every process all others get the keys of points that it shares (24 bytes a point; 12 with global ids), then the cells near these. So
//! each holds these of all processes for a time, which is what limits their number.

use crate::mesh::Mesh;
use glam::DVec3;
use serde::Serialize;
use serde::de::DeserializeOwned;
use voltet::nodes::in_memory_grid::HostGrid;
use voltet_core::grid::{
    Halo, Options, PointKeys, RawGrid, SharedPoints, boxes_of_others, extent, join_part,
};
use voltet_core::{Error, Result};
use voltet_graph::ranks::Ranks;

/// Note on a domain that all processes get: its block, its box, its number of cells, and whether it has ghosts and global ids.
type Outline = (usize, Option<[DVec3; 2]>, u64, bool, bool);

/// Numbers the blocks of all processes by their names, in the order of these. All processes call it together.
/// Errors: another process ended, or the network failed.
pub fn number_blocks(mesh: &mut Mesh, ranks: &dyn Ranks) -> Result<()> {
    let mut names = gather(&mesh.blocks, ranks)?.concat();
    names.sort_unstable();
    names.dedup();
    let number = |name: &String| names.partition_point(|other| other < name);
    mesh.pieces.iter_mut().for_each(|piece| piece.block = number(&mesh.blocks[piece.block]));
    mesh.blocks = names;
    Ok(())
}

/// Builds the piece of this process: `None` where its domains have no cells. `layers`: rings of cells of others that nodes may look at. All
/// processes call it together. Errors: no process has a domain with the fields; domains that contradict each other.
pub fn build(mesh: Mesh, layers: usize, options: &Options, ranks: &dyn Ranks) -> Result<Option<HostGrid>> {
    let mut own: Vec<RawGrid> = mesh.pieces.into_iter().filter(|piece| piece.cells.count() > 0).collect();
    let outline = |piece: &RawGrid| -> Outline {
        let bounds = extent::bounds(&piece.points);
        let count = piece.cells.count() as u64;
        (piece.block, bounds, count, piece.ghost.is_some(), piece.global_ids.is_some())
    };
    let of_ranks = gather(&own.iter().map(outline).collect(), ranks)?;
    let first: usize = of_ranks[..ranks.rank()].iter().map(Vec::len).sum();
    let outlines: Vec<Outline> = of_ranks.concat();
    if outlines.is_empty() {
        let nothing = Error::usage("no process has a domain of the mesh").expected("cells on one of them");
        return Err(mesh.refusal.unwrap_or(nothing));
    }
    let has_ghosts = outlines.iter().any(|own| own.3);
    let boxes: Vec<_> = outlines.iter().map(|own| (own.0, own.1)).collect();
    let mut keys: Vec<PointKeys> = match outlines.iter().all(|own| own.4) {
        true => own.iter().map(|piece| PointKeys::of_ids(piece, has_ghosts)).collect(),
        false => {
            let others = boxes_of_others(&boxes);
            let keyed = own.iter().zip(&others[first..]);
            keyed.map(|(piece, others)| PointKeys::of_places(piece, others)).collect()
        }
    };
    PointKeys::retain_shared(&mut keys, ranks.count(), &|to_each| ranks.exchange(to_each))?;
    let shared = SharedPoints::find(&gather(&keys, ranks)?.concat());
    let layers = layers.max(usize::from(has_ghosts));
    let halos = own.iter_mut().enumerate();
    let halos = halos.map(|(place, piece)| Halo::from_piece(piece, &shared, first + place, layers));
    let halos = gather(&halos.collect::<Result<Vec<Option<Halo>>>>()?, ranks)?.concat();
    if own.is_empty() {
        return Ok(None);
    }
    let starts = outlines.iter().scan(0, |sum, own| Some(std::mem::replace(sum, *sum + own.2)));
    let numbered = own.into_iter().enumerate().map(|(place, piece)| (first + place, piece)).collect();
    let joined = join_part(numbered, &halos, &shared, &starts.collect::<Vec<u64>>())?;
    let arrays = joined.point_arrays.iter().chain(&joined.cell_arrays);
    let scalars: Vec<&String> =
        arrays.filter(|(_, array)| array.component_count == 1).map(|(name, _)| name).collect();
    let only = match scalars[..] {
        [only] => Some(only.clone()),
        _ => None,
    };
    HostGrid::build_piece(joined, only.as_deref(), options)
}

/// The values of all processes, in order of their numbers.
fn gather<T: Serialize + DeserializeOwned>(own: &Vec<T>, ranks: &dyn Ranks) -> Result<Vec<Vec<T>>> {
    let bytes = postcard::to_allocvec(own)
        .map_err(|error| Error::run("a piece of the mesh cannot be sent to another process").got(error))?;
    let broken = |error| {
        let error = Error::run("another process sent a broken piece of the mesh").got(error);
        error.expected("the library in one version on all processes")
    };
    let received = ranks.exchange(vec![bytes; ranks.count()])?;
    received.iter().map(|bytes| postcard::from_bytes(bytes).map_err(broken)).collect()
}
