//! Meshes in Conduit's Mesh Blueprint (<https://llnl-conduit.readthedocs.io/en/latest/blueprint_mesh.html>) to pieces of a grid: one for
//! each domain and topology with volume.

mod cells;
mod coordinates;
mod fields;

pub use fields::FieldSelection;

use crate::conduit::{Loan, Node};
use cells::{Topology, topology};
use voltet_core::grid::RawGrid;
use voltet_core::{Error, Result};

/// The mesh of a channel on one process.
#[derive(Default)]
pub struct Mesh {
    /// Its pieces, whose blocks are places in `blocks`.
    pub pieces: Vec<RawGrid>,
    /// Names of the parts of a `multimesh`, in the order of the channel; one without a name for a `mesh`.
    pub blocks: Vec<String>,
    /// Why a domain was left out that has no cells with volume and the fields: an error where no process has a piece.
    pub refusal: Option<Error>,
}

/// The mesh of a channel, with the selected fields: without pieces where the channel holds no domain. The parts of a `multimesh` become
/// blocks. Domains without the fields or without volume are left out.
/// Errors: a type of channel that is not read; a node that the Blueprint demands and that is missing or wrong, with its path.
pub fn read(channel: &Node, selection: &FieldSelection, loan: &Loan) -> Result<Mesh> {
    let (data, kind) = (channel.require("data")?, channel.require("type")?);
    let meshes = match kind.text()?.as_str() {
        "mesh" => vec![(String::new(), data)],
        "multimesh" => data.children().into_iter().map(|mesh| (mesh.name().into(), mesh)).collect(),
        other => return Err(kind.wrong("is not read", format!("\"{other}\""), "\"mesh\" or \"multimesh\"")),
    };
    let mut own = Mesh::default();
    for (block, (name, mesh)) in meshes.into_iter().enumerate() {
        own.blocks.push(name);
        for domain in domains(&mesh)? {
            match pieces_of_domain(&domain, selection, loan) {
                Ok(pieces) => own.pieces.extend(pieces.into_iter().map(|piece| RawGrid { block, ..piece })),
                Err(error) if lacks(&domain, selection)? => own.refusal = Some(error),
                Err(error) => return Err(error),
            }
        }
    }
    Ok(own)
}

/// The domains of a mesh: itself, or its children.
fn domains<'a>(mesh: &Node<'a>) -> Result<Vec<Node<'a>>> {
    if ["coordsets", "topologies", "fields"].into_iter().any(|name| mesh.get(name).is_some()) {
        return Ok(vec![mesh.clone()]);
    }
    let children = mesh.children();
    for domain in &children {
        domain.require("coordsets")?;
    }
    Ok(children)
}

/// True if a domain has no topology with volume and all fields.
fn lacks(domain: &Node, selection: &FieldSelection) -> Result<bool> {
    for topology in domain.require("topologies")?.children() {
        if cells::has_volume(domain, &topology)? && selection.missing(domain, topology.name())?.is_none() {
            return Ok(false);
        }
    }
    Ok(true)
}

fn pieces_of_domain(domain: &Node, selection: &FieldSelection, loan: &Loan) -> Result<Vec<RawGrid>> {
    domain.require("coordsets")?;
    let topologies = domain.require("topologies")?;
    let mut pieces = Vec::new();
    let mut missing = None;
    for node in topologies.children() {
        if !cells::has_volume(domain, &node)? {
            continue;
        }
        if let Some(field) = selection.missing(domain, node.name())? {
            missing = Some((node, field));
            continue;
        }
        if let Some(counts) = cells::stated_counts(domain, &node)? {
            fields::check_lengths(domain, node.name(), selection, counts)?;
        }
        let Topology { points, cells } = topology(domain, &node, loan)?;
        let mut piece = RawGrid::new(points, cells);
        fields::add(&mut piece, domain, node.name(), selection, loan)?;
        pieces.push(piece);
    }
    match missing {
        _ if !pieces.is_empty() => Ok(pieces),
        Some((topology, field)) => {
            let names = fields::names(domain, topology.name())?;
            let error = Error::usage(format!("{} has no field '{field}'", topology.path()));
            Err(error.expected(if names.is_empty() { "a field".into() } else { names.join(", ") }))
        }
        None => {
            let names: Vec<String> =
                topologies.children().iter().map(|node| node.name().to_string()).collect();
            Err(topologies.wrong(
                "has no cells with volume",
                names.join(", "),
                "a topology in three dimensions",
            ))
        }
    }
}
