//! The integrators that sample or look up, in lanes: the same batches, the same reach of widgets and the same 32 bits as the
//! closed forms, so that their times compare methods.
//!
//! | file | integrator |
//! | --- | --- |
//! | `sampled` | what those that sample share: the widgets that a vector of segments meets, at places of it |
//! | `riemann` | `riemann` |
//! | `pieces` | `segments` |
//! | `tables` | `pre-integrated`, `pre-integrated-cylindrical` |
//! | `tabulated` | `tabulated` |
//! | `vertex_sampled` | `vertex-sampled` |

#![expect(
    clippy::needless_range_loop,
    reason = "adapters of iterators are functions where a build inlines little"
)]

mod pieces;
mod riemann;
mod sampled;
mod tables;
mod tabulated;
mod vertex_sampled;

use crate::shade::kinds::{LaneWidget, Making};
use crate::shade::roads::{Part, serve};
use crate::shade::shaded::{Left, Shaded};
use crate::shade::shader::Scene;
use pieces::Pieces;
use riemann::Riemann;
use sampled::Sampled;
use tables::Table;
use tabulated::Tabulated;
use vertex_sampled::VertexSampled;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::integrators::SegmentIntegrator;
use voltet_optics::shading::Integrator;
use voltet_simd::LaneSet;
use voltet_simd::optics::partial_table::LanePartialTable;

/// An integrator of its own roads.
pub(crate) enum LaneMethod {
    /// `riemann`.
    Riemann(Sampled),
    /// `segments`.
    Pieces(Pieces),
    /// `pre-integrated` and `pre-integrated-cylindrical`.
    Table(Box<Table>),
    /// `tabulated`.
    Tabulated(Tabulated),
    /// `vertex-sampled`.
    VertexSampled(VertexSampled),
}

/// Who serves an integrator.
pub(crate) enum Served {
    /// The closed forms.
    InClosedForm,
    /// A road of its own.
    By(LaneMethod),
    /// 64 bits.
    Not(Left),
}

impl From<std::result::Result<LaneMethod, Left>> for Served {
    fn from(method: std::result::Result<LaneMethod, Left>) -> Served {
        method.map_or_else(Served::Not, Served::By)
    }
}

impl Served {
    /// `exact`: the same integrator in 64 bits, for all but tables over lengths.
    ///
    /// Errors: data without a domain for a table.
    pub fn new(
        integrator: &Integrator,
        exact: Option<&dyn SegmentIntegrator>,
        transfer_function: &TransferFunction,
        widgets: &[LaneWidget],
        making: &Making,
        scene: &Scene<'_>,
    ) -> Result<Served> {
        let sampled = |count, together| Sampled::new(count, together, widgets, making);
        let table = |size, oversampling, planes| -> Result<Served> {
            let table = Table::new(transfer_function, size, oversampling, planes, making, scene)?;
            Ok(Served::By(LaneMethod::Table(Box::new(table))))
        };
        let count = |name: &str| integrator.count(name).unwrap_or(0);
        Ok(match integrator.name() {
            "analytic" | "adaptive" => Served::InClosedForm,
            "riemann" => sampled(count("segments"), false).map(LaneMethod::Riemann).into(),
            "segments" => match exact.and_then(SegmentIntegrator::partial_table) {
                Some(table) => {
                    let pieces = |ends| Pieces { ends, table: LanePartialTable::new(table) };
                    sampled(count("segments"), true).map(pieces).map(LaneMethod::Pieces).into()
                }
                None => Served::Not(Left::Integrator),
            },
            "pre-integrated" => table(count("table_size"), count("oversampling"), None)?,
            "pre-integrated-cylindrical" => {
                table(count("table_size"), count("oversampling"), Some(count("planes")))?
            }
            "tabulated" => match exact.and_then(SegmentIntegrator::gaussian_tables) {
                Some(tables) => Tabulated::new(tables, widgets, making).map(LaneMethod::Tabulated).into(),
                None => Served::Not(Left::Integrator),
            },
            "vertex-sampled" => {
                VertexSampled::new(making, scene.length).map(LaneMethod::VertexSampled).into()
            }
            _ => Served::Not(Left::Integrator),
        })
    }
}

impl LaneMethod {
    /// Bytes of the tables that it made.
    pub fn table_bytes(&self) -> usize {
        match self {
            LaneMethod::Riemann(_) | LaneMethod::Pieces(_) | LaneMethod::VertexSampled(_) => 0,
            LaneMethod::Tabulated(tabulated) => tabulated.bytes(),
            LaneMethod::Table(table) => table.bytes(),
        }
    }

    /// Integrates a part of a batch.
    pub(super) fn shade(&self, lanes: LaneSet, part: Part<'_>, out: &mut Shaded) {
        match self {
            LaneMethod::Riemann(sampled) => match sampled.count {
                1 => serve(lanes, &Riemann::<1>(sampled), part, out),
                2 => serve(lanes, &Riemann::<2>(sampled), part, out),
                _ => serve(lanes, &Riemann::<0>(sampled), part, out),
            },
            LaneMethod::Pieces(pieces) => serve(lanes, pieces, part, out),
            LaneMethod::Table(table) => serve(lanes, &**table, part, out),
            LaneMethod::Tabulated(tabulated) => serve(lanes, tabulated, part, out),
            LaneMethod::VertexSampled(sampled) => serve(lanes, sampled, part, out),
        }
    }
}
