//! Which integrator, with its settings, and which transfer functions it serves.

use crate::transfer::{ColorSource, TransferFunction};
use crate::{Error, Result};

/// The integrators (docs/optics.md, section 10).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Closed forms; quadrature with closed-form optical depth where widgets overlap.
    Analytic,
    /// Closed forms, subdivided until the error of (C, A) is under the tolerance.
    Adaptive {
        /// Largest error of a channel of C and of A, > 0.
        tolerance: f64,
    },
    /// Equal pieces, linear in each, combined by the partial pre-integration table.
    Segments {
        /// Pieces of a segment, ≥ 1.
        count: usize,
        /// Entries a side of the two-dimensional table, ≥ 2.
        table_size: usize,
    },
    /// Point samples.
    Riemann {
        /// Samples of a segment, ≥ 1.
        count: usize,
    },
    /// A three-dimensional table, for transfer functions of the scalar alone.
    PreIntegrated {
        /// Entries a side, 2 … [`TABLE_SIDE_MOST`].
        table_size: usize,
    },
    /// The same table, resampled to two-dimensional tiles.
    PreIntegratedCylindrical {
        /// Entries a side, 2 … [`TABLE_SIDE_MOST`].
        table_size: usize,
    },
    /// One piecewise-linear function, cut at its control points.
    Clipped,
    /// 64-bit adaptive quadrature.
    Reference,
}

/// Largest side of a three-dimensional table: 512³ colours take 1.5 GiB.
pub const TABLE_SIDE_MOST: usize = 512;

/// Largest side of the two-dimensional table of [`Integrator::Segments`].
pub const PARTIAL_SIDE_MOST: usize = 4096;

impl Integrator {
    /// One of each kind, at its least numbers: for asking which kinds there are and which serve.
    pub const EVERY: [Integrator; 8] = [
        Integrator::Analytic,
        Integrator::Adaptive { tolerance: 1e-3 },
        Integrator::Segments { count: 1, table_size: 2 },
        Integrator::Riemann { count: 1 },
        Integrator::PreIntegrated { table_size: 2 },
        Integrator::PreIntegratedCylindrical { table_size: 2 },
        Integrator::Clipped,
        Integrator::Reference,
    ];

    /// The name in pipeline files.
    pub fn name(&self) -> &'static str {
        match self {
            Integrator::Analytic => "analytic",
            Integrator::Adaptive { .. } => "adaptive",
            Integrator::Segments { .. } => "segments",
            Integrator::Riemann { .. } => "riemann",
            Integrator::PreIntegrated { .. } => "pre-integrated",
            Integrator::PreIntegratedCylindrical { .. } => "pre-integrated-cylindrical",
            Integrator::Clipped => "clipped",
            Integrator::Reference => "reference",
        }
    }

    /// Whether it tabulates over lengths, so that [`super::new`] looks at the data's extent.
    pub fn has_table_of_lengths(&self) -> bool {
        matches!(self, Integrator::PreIntegrated { .. } | Integrator::PreIntegratedCylindrical { .. })
    }

    /// Whether it builds a table.
    pub fn has_table(&self) -> bool {
        self.has_table_of_lengths() || matches!(self, Integrator::Segments { .. })
    }

    /// Checks that its settings are in range.
    pub fn check(&self) -> Result<()> {
        let within = |what: &str, value: usize, low: usize, high: usize| {
            if (low..=high).contains(&value) {
                return Ok(());
            }
            let what = format!("{what} of the integrator '{}' is out of range", self.name());
            Err(Error::usage(what).found(value).accepted(format!("{low} to {high}")))
        };
        match *self {
            Integrator::Adaptive { tolerance } if !(tolerance > 0.0 && tolerance.is_finite()) => {
                Err(Error::usage("the tolerance of the integrator 'adaptive' is out of range")
                    .found(tolerance)
                    .accepted("a number above 0"))
            }
            Integrator::Segments { count, table_size } => {
                within("the number of segments", count, 1, usize::MAX)?;
                within("table_size", table_size, 2, PARTIAL_SIDE_MOST)
            }
            Integrator::Riemann { count } => within("the number of segments", count, 1, usize::MAX),
            Integrator::PreIntegrated { table_size }
            | Integrator::PreIntegratedCylindrical { table_size } => {
                within("table_size", table_size, 2, TABLE_SIDE_MOST)
            }
            _ => Ok(()),
        }
    }

    /// Why it cannot serve the transfer function: what of it is beyond the integrator.
    fn obstacle(&self, transfer_function: &TransferFunction) -> Option<String> {
        let widgets = &transfer_function.widgets;
        let named = |i: usize, why: &str| format!("widgets[{i}] ({}), {why}", widgets[i].profile.name());
        match self {
            Integrator::PreIntegrated { .. } | Integrator::PreIntegratedCylindrical { .. } => {
                widgets.iter().enumerate().find_map(|(i, widget)| {
                    if widget.uses_gradient_magnitude() {
                        Some(named(i, "which looks at the gradient magnitude"))
                    } else if !widget.profile.properties().fields.is_empty() {
                        Some(named(i, "which looks at fields of its own"))
                    } else {
                        None
                    }
                })
            }
            Integrator::Clipped => match widgets.as_slice() {
                [widget] => match widget.profile.properties().color {
                    ColorSource::Points(_) => None,
                    ColorSource::Widget | ColorSource::Texels(_) => {
                        Some(named(0, "which is not piecewise-linear"))
                    }
                },
                [] => Some("no widget".into()),
                _ => Some(format!("{} widgets", widgets.len())),
            },
            _ => None,
        }
    }
}

/// Checks, without any data, that the integrator's settings are in range and that it can serve the transfer
/// function; the error says which integrators can.
pub fn can_serve(integrator: &Integrator, transfer_function: &TransferFunction) -> Result<()> {
    integrator.check()?;
    let Some(obstacle) = integrator.obstacle(transfer_function) else { return Ok(()) };
    let needs = match integrator {
        Integrator::Clipped => "one piecewise-linear widget",
        _ => "widgets of the scalar alone",
    };
    let serving: Vec<&str> = Integrator::EVERY
        .iter()
        .filter(|other| other.obstacle(transfer_function).is_none())
        .map(Integrator::name)
        .collect();
    let what = format!("the integrator '{}' cannot serve this transfer function", integrator.name());
    Err(Error::usage(what)
        .found(obstacle)
        .accepted(format!("{needs}, or one of the integrators {}", serving.join(", "))))
}
