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

/// Pieces of the mesh of a channel, with the selected fields: none where the channel holds no domain. The parts of a `multimesh` become
/// blocks, of which those without the fields are left out.
///
/// # Errors
/// - a type of channel that is not read;
/// - a node that the Blueprint demands and that is missing or wrong, with its path;
/// - a domain that lacks a field.
pub fn pieces(channel: &Node, selection: &FieldSelection, loan: &Loan) -> Result<Vec<RawGrid>> {
    let (data, kind) = (channel.require("data")?, channel.require("type")?);
    let mut pieces = Vec::new();
    match kind.text()?.as_str() {
        "mesh" => {
            for domain in domains(&data)? {
                pieces.extend(pieces_of_domain(&domain, selection, loan)?);
            }
        }
        "multimesh" => {
            let mut refusal = None;
            for (block, mesh) in data.children().iter().enumerate() {
                for domain in domains(mesh)? {
                    match pieces_of_domain(&domain, selection, loan) {
                        Ok(own) => pieces.extend(own.into_iter().map(|piece| RawGrid { block, ..piece })),
                        Err(error) if lacks(&domain, selection)? => refusal = Some(error),
                        Err(error) => return Err(error),
                    }
                }
            }
            if let Some(error) = refusal.filter(|_| pieces.is_empty()) {
                return Err(error);
            }
        }
        other => return Err(kind.wrong("is not read", format!("\"{other}\""), "\"mesh\" or \"multimesh\"")),
    }
    Ok(pieces)
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
