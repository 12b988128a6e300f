//! Demands on nodes, which the demand pass collects from the sinks upward.

use super::value::TransferFunctionSpec;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::parameters::{ArrayOrigin, SourceSpan};
use voltet_core::picture_parts::PictureLayer;
use voltet_core::transfer::TransferFunction;

/// Demand on a node's outputs. Nothing else is read, computed or sorted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Demand {
    /// Point arrays beside the scalar.
    pub arrays: Arrays,
    /// Arrays of the file's cells, as they are.
    pub cell_arrays: Arrays,
    /// *g* = |∇s| at every point.
    pub gradient_magnitude: bool,
    /// ∇s at every point.
    pub gradient: bool,
    /// The transfer functions for whose widgets alone g and ∇s are looked at: at points of cells that no widget can touch, whatever
    /// g is there, they may be what they are at another point. `None`: everywhere. Asked by nodes that have a transfer function or
    /// cells ([`crate::DemandContext::ask`]); of others, which may give another scalar than they get, everything is asked.
    pub gradient_for: Option<Vec<Arc<TransferFunctionSpec>>>,
    /// True if the scalar is not looked at, as where a node replaces it: it need not be read. A node that looks at the scalar of an
    /// input leaves this false there.
    pub without_scalar: bool,
    /// An order of the cells.
    pub order: bool,
    /// The file's own cells, to write them back.
    pub file_cells: bool,
    /// True if the file's cells and arrays are enough: a source may give a grid without tetrahedra, none of whose points and cells is
    /// left out. Nodes with inputs never see it, since they may look at tetrahedra: what they ask for has some.
    pub without_tetrahedra: bool,
    /// Numbers a tetrahedron, at ports of that type.
    pub cell_values: bool,
    /// The list of kept cells as a result of its own: every cell is tested, also where a picture would be drawn sooner without.
    pub kept_cells: bool,
    /// Numbers of each pixel beside its colour, at ports of images.
    pub layers: BTreeSet<PictureLayer>,
    /// The annotation of a picture as shapes apart from it, at ports of images.
    pub shapes: bool,
}

/// Requested arrays: some by name, or those and all others of the file.
#[derive(Debug, Clone, Default)]
pub struct Arrays {
    /// Arrays that some node named, also one of several components or a length (`velocity:0`, `velocity:magnitude`): each must
    /// be there.
    pub named: BTreeSet<String>,
    /// Arrays that are requested where they are there.
    pub optional: BTreeSet<String>,
    /// True if all other arrays are requested, too.
    pub and_all_others: bool,
    /// Nodes that name them, as far as they are known.
    pub origins: BTreeMap<String, ArrayOrigin>,
}

/// Equal if the same arrays are requested, whoever names them.
impl PartialEq for Arrays {
    fn eq(&self, other: &Self) -> bool {
        (&self.named, &self.optional, self.and_all_others)
            == (&other.named, &other.optional, other.and_all_others)
    }
}

impl Eq for Arrays {}

impl Arrays {
    /// True if this array is requested, by name or with all.
    pub fn contains(&self, name: &str) -> bool {
        self.and_all_others || self.named.contains(name) || self.optional.contains(name)
    }

    fn join(&mut self, other: &Arrays) {
        self.named.extend(other.named.iter().cloned());
        self.optional.extend(other.optional.iter().cloned());
        self.and_all_others |= other.and_all_others;
        for (name, origin) in &other.origins {
            self.origins.entry(name.clone()).or_insert(origin.clone());
        }
    }

    /// Requests an array whose name is written at `span`.
    pub fn request(&mut self, name: &str, span: SourceSpan) {
        self.named.insert(name.to_owned());
        self.origins.entry(name.to_owned()).or_insert(ArrayOrigin { node: None, span });
    }

    /// States the node that names some of the arrays, of which none is known yet. `span`: its location.
    pub(crate) fn are_named_by(&mut self, node: &str, span: &SourceSpan, is_one: impl Fn(&str) -> bool) {
        for name in self.named.iter().filter(|name| is_one(name)) {
            let own = || ArrayOrigin { node: None, span: span.clone() };
            let origin = self.origins.entry(name.clone()).or_insert_with(own);
            origin.node.get_or_insert_with(|| node.to_owned());
        }
    }

    /// An error about an array, with the node that names it and the place, where they are known; otherwise as it is.
    pub fn locate(&self, name: &str, error: Error) -> Error {
        match self.origins.get(name) {
            Some(origin) => origin.locate(error),
            None => error,
        }
    }
}

impl FromIterator<String> for Arrays {
    fn from_iter<I: IntoIterator<Item = String>>(names: I) -> Self {
        Arrays { named: names.into_iter().collect(), ..Arrays::default() }
    }
}

impl Demand {
    /// Arrays and gradient magnitude that a transfer function looks at.
    pub fn of_function(function: &TransferFunction) -> Self {
        Demand {
            arrays: function.fields().iter().map(|name| name.to_string()).collect(),
            gradient_magnitude: function.uses_gradient_magnitude(),
            ..Demand::default()
        }
    }

    /// Everything that a node downstream could ever ask for: what holds when it cannot be known beforehand.
    pub fn unknown() -> Self {
        Demand { gradient_magnitude: true, gradient: false, order: true, ..Demand::default() }
    }

    /// Adds a demand to those on the same node, of which there may be none yet.
    pub(crate) fn add_to(&self, all: &mut Option<Demand>) {
        match all {
            Some(all) => all.join(self),
            none => *none = Some(self.clone()),
        }
    }

    /// Adds another demand on the same node.
    pub fn join(&mut self, other: &Demand) {
        self.gradient_for = match (self.looks_at_gradient(), other.looks_at_gradient()) {
            (_, false) => self.gradient_for.take(),
            (false, true) => other.gradient_for.clone(),
            (true, true) => {
                self.gradient_for.take().zip(other.gradient_for.as_ref()).map(|(mut all, more)| {
                    let new: Vec<_> = more.iter().filter(|look| !all.contains(look)).cloned().collect();
                    all.extend(new);
                    all
                })
            }
        };
        self.arrays.join(&other.arrays);
        self.cell_arrays.join(&other.cell_arrays);
        self.gradient_magnitude |= other.gradient_magnitude;
        self.gradient |= other.gradient;
        self.without_scalar &= other.without_scalar;
        self.order |= other.order;
        self.file_cells |= other.file_cells;
        self.without_tetrahedra &= other.without_tetrahedra;
        self.cell_values |= other.cell_values;
        self.kept_cells |= other.kept_cells;
        self.layers.extend(&other.layers);
        self.shapes |= other.shapes;
    }

    /// True if an output made for this demand satisfies the other one, which then adds nothing to it.
    pub fn covers(&self, other: &Demand) -> bool {
        let mut both = self.clone();
        both.join(other);
        both == *self
    }

    /// This demand with g and ∇s at all points, where they are requested.
    pub fn everywhere(&self) -> Demand {
        Demand { gradient_for: None, ..self.clone() }
    }

    fn looks_at_gradient(&self) -> bool {
        self.gradient_magnitude || self.gradient
    }
}
