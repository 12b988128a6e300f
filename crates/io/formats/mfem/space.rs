//! Grid functions of MFEM: the finite element space that their head names, and values at its degrees of freedom.
//!
//! Names of spaces as `FiniteElementCollection::New` of MFEM (`fem/fe_coll.cpp`) takes them: `H1_3D_P2` are continuous functions of the
//! second order by their values at nodes, `L2_3D_P0` one value in each element.

use super::elements::MfemElements;
use super::numbering::MfemNodes;
use super::orders::{ContinuousLayout, MAX_ORDER, legendre_mean, lobatto_mean};
use super::shapes::{CUBE, PRISM, SHAPES, TETRAHEDRON};
use crate::formats::cursor::Cursor;
use crate::formats::numbers::NumberType;
use crate::formats::text::{TextRange, is_space};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

/// Spaces that are read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldSpace {
    /// Continuous functions, by their values at points: of Gauss and Lobatto, or at even distances.
    Continuous { order: u32, is_even: bool },
    /// A value in each element.
    Constant,
    /// A polynomial in each element, of which the mean over the reference element is read.
    Discontinuous { order: u32, basis: Basis },
}

/// Functions whose coefficients the values of a discontinuous space are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Basis {
    /// Lagrange's polynomials through the points of Gauss and Legendre, or of Gauss and Lobatto.
    Legendre,
    Lobatto,
    Bernstein,
}

/// Weights of an element's values in their mean; `None` where they are not known: in simplices of higher order, by values at points.
fn mean_weights(number: usize, order: u32, basis: Basis) -> Option<Vec<f64>> {
    let p = order as usize;
    let even = |count: usize| vec![1.0 / count as f64; count];
    let line = match basis {
        Basis::Legendre => legendre_mean(p + 1),
        Basis::Lobatto => lobatto_mean(p),
        Basis::Bernstein => even(p + 1),
    };
    // Bernstein's polynomials of an order have one mean, and so have those of the first order by symmetry.
    let simplex = |count: usize| (p == 1 || basis == Basis::Bernstein).then(|| even(count));
    let product = |inner: &[f64], outer: &[f64]| -> Vec<f64> {
        outer.iter().flat_map(|outer| inner.iter().map(move |inner| inner * outer)).collect()
    };
    match number {
        TETRAHEDRON => simplex((p + 1) * (p + 2) * (p + 3) / 6),
        CUBE => Some(product(&product(&line, &line), &line)),
        PRISM => Some(product(&simplex((p + 1) * (p + 2) / 2)?, &line)),
        _ => None,
    }
}

impl FieldSpace {
    /// Order of the nodes at which values are.
    pub fn order(self) -> u32 {
        if let FieldSpace::Continuous { order, .. } = self { order } else { 1 }
    }

    /// Place of the values that are read.
    pub fn association(self) -> Association {
        match self {
            FieldSpace::Continuous { .. } => Association::Point,
            FieldSpace::Constant | FieldSpace::Discontinuous { .. } => Association::Cell,
        }
    }

    /// True if the values of all elements of a mesh can be read.
    pub fn serves(self, elements: &MfemElements) -> bool {
        let FieldSpace::Discontinuous { order, basis } = self else { return true };
        let types: BTreeSet<u8> = elements.types.iter().copied().collect();
        types.into_iter().all(|number| mean_weights(number.into(), order, basis).is_some())
    }

    /// The space of a name; `None` for others.
    fn of_name(name: &str) -> Option<FieldSpace> {
        let continuous = |order| Some(FieldSpace::Continuous { order, is_even: false });
        match name {
            "Linear" => return continuous(1),
            "Quadratic" => return continuous(2),
            "Cubic" => return Some(FieldSpace::Continuous { order: 3, is_even: true }),
            "Const2D" | "Const3D" => return Some(FieldSpace::Constant),
            _ => {}
        }
        let mut parts = name.split('_');
        let family = parts.next()?;
        let order: u32 = parts.find_map(|part| part.strip_prefix('P'))?.parse().ok()?;
        if order > MAX_ORDER {
            return None;
        }
        // Other bases have other values at nodes, but of the first order at vertices, and none where they are constant.
        match (family, order) {
            _ if name.contains("Trace") => None,
            ("H1", 1..) | ("H1Pos" | "H1Ser", 1) => continuous(order),
            ("H1@G", 1..) => continuous(order),
            (_, 1 | 2) if family.starts_with("H1@") => continuous(order),
            ("L2", 0) => Some(FieldSpace::Constant),
            ("L2", _) => {
                let basis = match name.split('_').nth(1)? {
                    "T1" => Basis::Lobatto,
                    "T2" => Basis::Bernstein,
                    "T0" | "2D" | "3D" => Basis::Legendre,
                    _ => return None,
                };
                Some(FieldSpace::Discontinuous { order, basis })
            }
            _ => None,
        }
    }
}

/// A grid function whose head was read.
pub(super) struct GridFunction {
    pub name: String,
    path: PathBuf,
    pub space: FieldSpace,
    pub collection: String,
    pub component_count: usize,
    /// True if the components of a node stand side by side.
    is_interleaved: bool,
    values: TextRange,
}

/// The words before the entries of a head.
const ENTRIES: [&str; 3] = ["FiniteElementCollection:", "VDim:", "Ordering:"];

impl GridFunction {
    /// Reads the head at the cursor; the name of the space where it is not read.
    pub fn open(
        cursor: &mut Cursor,
        name: &str,
        path: &Path,
    ) -> Result<std::result::Result<GridFunction, String>> {
        cursor.skip_comments()?;
        let head = cursor.text_line("FiniteElementSpace")?;
        if head == "QuadratureSpace" {
            return Ok(Err(head));
        }
        let is_newer = head == "MFEM FiniteElementSpace v1.0";
        if !is_newer && head != "FiniteElementSpace" {
            let error = cursor.error("this is no grid function").got(format_args!("'{head}'"));
            return Err(error.expected("FiniteElementSpace"));
        }
        let mut entries = [const { String::new() }; 3];
        for (entry, word) in entries.iter_mut().zip(ENTRIES) {
            let line = cursor.text_line(word)?;
            let value = line.strip_prefix(word).ok_or_else(|| {
                let error = cursor.error("the head of a grid function is damaged");
                error.got(format_args!("'{line}'")).expected(word)
            })?;
            *entry = value.trim().to_owned();
        }
        let [collection, components, ordering] = entries;
        let Some(space) = FieldSpace::of_name(&collection) else { return Ok(Err(collection)) };
        let damaged = |found: &str, accepted: &str| {
            cursor
                .error("the head of a grid function is damaged")
                .got(format_args!("'{found}'"))
                .expected(accepted)
        };
        let component_count = components.parse().ok().filter(|count| (1..=MAX_COMPONENTS).contains(count));
        let component_count =
            component_count.ok_or_else(|| damaged(&components, &format!("VDim: 1 to {MAX_COMPONENTS}")))?;
        let is_interleaved = match ordering.as_str() {
            "0" => false,
            "1" => true,
            _ => return Err(damaged(&ordering, "Ordering: 0 or 1")),
        };
        if is_newer {
            cursor.skip_comments()?;
            let line = cursor.text_line("End: MFEM FiniteElementSpace v1.0")?;
            if !line.starts_with("End:") {
                return Ok(Err(format!("{collection} with {line}")));
            }
        }
        cursor.skip_comments()?;
        // Meshes of the versions 1.2 and 1.3 go on after their nodes.
        let values = cursor.rest();
        let values = match cursor.skip_past(b"mfem_")? {
            Some(end) => values.until(end),
            None => values,
        };
        Ok(Ok(GridFunction {
            name: name.to_owned(),
            path: path.to_owned(),
            space,
            collection,
            component_count,
            is_interleaved,
            values,
        }))
    }

    /// Errors: the values are not as many as those of a mesh.
    pub fn check_count(&self, nodes: &MfemNodes, elements: &MfemElements) -> Result<()> {
        let count = self.values.word_count()? as usize;
        let places = match self.space {
            FieldSpace::Constant => vec![elements.types.len()],
            FieldSpace::Discontinuous { order, basis } => {
                vec![means(elements, order, basis).map(|(_, weights)| weights.len()).sum()]
            }
            FieldSpace::Continuous { order, is_even } => {
                layouts(nodes, elements, order, is_even).map(|own| own.count).to_vec()
            }
        };
        match places.iter().any(|&places| places.checked_mul(self.component_count) == Some(count)) {
            true => Ok(()),
            false => Err(self.misfit(count, places[0]).in_file(&self.path)),
        }
    }

    /// The error about values of another mesh.
    fn misfit(&self, found: usize, places: usize) -> Error {
        let error = Error::run(format!("the values of '{}' do not fit the mesh", self.name)).got(found);
        self.values.locate_end(error.expected(places.saturating_mul(self.component_count)))
    }

    /// Tuples at the nodes of a mesh, or in its elements.
    pub fn load(&self, nodes: &MfemNodes, elements: &MfemElements) -> Result<Vec<f64>> {
        self.tuples(nodes, elements).map_err(|error| error.in_file(&self.path))
    }

    fn tuples(&self, nodes: &MfemNodes, elements: &MfemElements) -> Result<Vec<f64>> {
        let mut values: Vec<f64> = Vec::new();
        self.values.numbers(NumberType::F64, is_space, &mut values, |_| Ok(()))?;
        let n = self.component_count;
        let count = values.len() / n;
        let value = |place: usize, component: usize| match self.is_interleaved {
            true => values[place * n + component],
            false => values[component * count + place],
        };
        let is_in_order = n == 1 || self.is_interleaved;
        if let FieldSpace::Discontinuous { order, basis } = self.space {
            let own: Vec<(usize, Rc<Vec<f64>>)> = means(elements, order, basis).collect();
            let end = own.last().map_or(0, |(first, weights)| first + weights.len());
            if values.len() != n * end {
                return Err(self.misfit(values.len(), end));
            }
            let mean = |first: usize, weights: &[f64], component: usize| -> f64 {
                (first..).zip(weights).map(|(place, weight)| weight * value(place, component)).sum()
            };
            let tuple = |(first, weights): (usize, Rc<Vec<f64>>)| {
                (0..n).map(|component| mean(first, &weights, component)).collect::<Vec<f64>>()
            };
            return Ok(own.into_iter().flat_map(tuple).collect());
        }
        let FieldSpace::Continuous { order, is_even } = self.space else {
            let element_count = elements.types.len();
            if values.len() != n * element_count {
                return Err(self.misfit(values.len(), element_count));
            }
            let tuple = |cell: usize| (0..n).map(move |component| (cell, component));
            return Ok(match is_in_order {
                true => values,
                false => (0..count).flat_map(tuple).map(|(cell, component)| value(cell, component)).collect(),
            });
        };
        let layouts = layouts(nodes, elements, order, is_even);
        let layout = layouts.iter().find(|layout| layout.count * n == values.len());
        let layout = layout.ok_or_else(|| self.misfit(values.len(), layouts[0].count))?;
        if is_in_order && layout.is_of_nodes() {
            return Ok(values);
        }
        let tuple = |node: usize| (0..n).map(move |component| (node, component));
        let at = |(node, component)| layout.at(node, |place| value(place, component));
        Ok((0..nodes.len()).into_par_iter().flat_map_iter(tuple).map(at).collect())
    }
}

/// For each element the first of its values, and their weights in the mean.
fn means(elements: &MfemElements, order: u32, basis: Basis) -> impl Iterator<Item = (usize, Rc<Vec<f64>>)> {
    let mut known: [Option<Rc<Vec<f64>>>; SHAPES.len()] = Default::default();
    elements.types.iter().scan(0, move |end, &number| {
        let number = usize::from(number);
        let weights = known[number]
            .get_or_insert_with(|| Rc::new(mean_weights(number, order, basis).unwrap_or_default()));
        let first = *end;
        *end += weights.len();
        Some((first, weights.clone()))
    })
}

/// Places of the values of an order, by either set of functions on pyramids.
fn layouts<'a>(
    nodes: &'a MfemNodes,
    elements: &MfemElements,
    order: u32,
    is_even: bool,
) -> [ContinuousLayout<'a>; 2] {
    [false, true].map(|is_bergot| {
        let layout = ContinuousLayout::new(nodes, elements, order, is_bergot);
        if is_even { layout.with_even_points() } else { layout }
    })
}

/// The error about a space that is not read.
pub(super) fn refusal(name: &str, space: &str) -> Error {
    let error = Error::run(format!("the finite element space of {name} is not read")).got(space);
    error.expected(
        "H1; L2 of the order 0; in hexahedra L2, L2_T1 and L2_T2; in tetrahedra and prisms these of the order 1, and L2_T2 (by MFEM's ProjectGridFunction, or as .vtu by its ParaViewDataCollection)",
    )
}

/// Components of a field that a file may have.
const MAX_COMPONENTS: usize = 1 << 10;
