//! Which integrator, with its settings, and which transfer functions it serves.

use super::last_tile;
use voltet_core::transfer::{ColorSource, Profile, TransferFunction};
use voltet_core::{Error, Result};

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
        /// Pieces of a path from one entry to the next, 1 … [`OVERSAMPLING_MOST`].
        oversampling: usize,
    },
    /// The same table, resampled to two-dimensional tiles.
    PreIntegratedCylindrical {
        /// Entries a side, 2 … [`TABLE_SIDE_MOST`].
        table_size: usize,
        /// Pieces of a path from one entry to the next, 1 … [`OVERSAMPLING_MOST`].
        oversampling: usize,
        /// Tiles for each entry of a side, 1 … [`PLANES_MOST`]; all of them take no more memory than those of the
        /// largest side with one.
        planes: usize,
    },
    /// One piecewise-linear function, cut at its control points.
    Clipped,
    /// The transfer function applied at the grid's points, and what absorbs and glows linear between them.
    VertexSampled,
    /// The integrals of uniform and Gaussian widgets from tables.
    Tabulated {
        /// Entries a side, 2 … [`PARTIAL_SIDE_MOST`].
        table_size: usize,
    },
    /// 64-bit adaptive quadrature.
    Reference,
}

/// Pieces of a ray segment where nobody says how many.
pub const STANDARD_PIECES: usize = 16;

/// Side of a table where nobody says it.
pub const STANDARD_SIDE: usize = 256;

/// Largest side of a three-dimensional table: 512³ colours take 1.5 GiB.
pub const TABLE_SIDE_MOST: usize = 512;

/// Pieces of a path from one entry of a pre-integrated table to the next where nobody says how many: what Roettger and
/// Ertl 2002 (section 3) hold for enough.
pub const STANDARD_OVERSAMPLING: usize = 2;

/// The most of them; a step is long resolved, and filling the table slow.
pub const OVERSAMPLING_MOST: usize = 64;

/// Tiles of a cylindrical table for each entry of a side where nobody says how many: as much memory as the table.
pub const STANDARD_PLANES: usize = 1;

/// The most of them: twice what Roettger and Ertl 2002 (section 4) hold for enough to lose nothing.
pub const PLANES_MOST: usize = 8;

/// Entries of the largest cylindrical table.
const TILES_MOST: usize = TABLE_SIDE_MOST * TABLE_SIDE_MOST * (last_tile(TABLE_SIDE_MOST, 1) + 1);

/// Largest side of the two-dimensional table of [`Integrator::Segments`].
pub const PARTIAL_SIDE_MOST: usize = 4096;

impl Integrator {
    /// One of each kind, at its least numbers: for asking which kinds there are and which serve.
    pub const EVERY: [Integrator; 10] = [
        Integrator::Analytic,
        Integrator::Adaptive { tolerance: 1e-3 },
        Integrator::Segments { count: 1, table_size: 2 },
        Integrator::Riemann { count: 1 },
        Integrator::PreIntegrated { table_size: 2, oversampling: 1 },
        Integrator::PreIntegratedCylindrical { table_size: 2, oversampling: 1, planes: 1 },
        Integrator::Clipped,
        Integrator::VertexSampled,
        Integrator::Tabulated { table_size: 2 },
        Integrator::Reference,
    ];

    /// The words for them in pipeline files, each with its meaning, in the order of [`Integrator::EVERY`].
    pub const WORDS: [(&'static str, &'static str); Integrator::EVERY.len()] = {
        let mut words = [("", ""); Integrator::EVERY.len()];
        let mut k = 0;
        while k < words.len() {
            words[k] = Integrator::EVERY[k].word();
            k += 1;
        }
        words
    };

    const fn word(&self) -> (&'static str, &'static str) {
        match self {
            Integrator::Analytic => {
                ("analytic", "closed forms; quadrature with closed-form optical depth where widgets overlap")
            }
            Integrator::Adaptive { .. } => {
                ("adaptive", "closed forms, subdivided until the error is under the tolerance")
            }
            Integrator::Segments { .. } => {
                ("segments", "equal pieces, linear in each, combined by the partial pre-integration table")
            }
            Integrator::Riemann { .. } => ("riemann", "point samples"),
            Integrator::PreIntegrated { .. } => {
                ("pre-integrated", "a three-dimensional table, for transfer functions of the scalar alone")
            }
            Integrator::PreIntegratedCylindrical { .. } => {
                ("pre-integrated-cylindrical", "the same table as tiles")
            }
            Integrator::Clipped => ("clipped", "piecewise-linear functions clipped at their control points"),
            Integrator::VertexSampled => (
                "vertex-sampled",
                "the transfer function applied at the grid's points only, linear between them",
            ),
            Integrator::Tabulated { .. } => {
                ("tabulated", "integrals of Gaussians from tables, widgets mixed without their order")
            }
            Integrator::Reference => ("reference", "64-bit adaptive quadrature, slow"),
        }
    }

    /// The name in pipeline files.
    pub fn name(&self) -> &'static str {
        self.word().0
    }

    /// Whether both are of one kind, whatever their numbers.
    pub fn is_kind_of(&self, other: &Integrator) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }

    /// Its numbers.
    pub fn numbers(&self) -> Numbers {
        match *self {
            Integrator::Adaptive { tolerance } => {
                Numbers { tolerance: Some(tolerance), ..Numbers::default() }
            }
            Integrator::Segments { count, table_size } => {
                Numbers { count: Some(count), table_size: Some(table_size), ..Numbers::default() }
            }
            Integrator::Riemann { count } => Numbers { count: Some(count), ..Numbers::default() },
            Integrator::PreIntegrated { table_size, oversampling } => Numbers {
                table_size: Some(table_size),
                oversampling: Some(oversampling),
                ..Numbers::default()
            },
            Integrator::PreIntegratedCylindrical { table_size, oversampling, planes } => Numbers {
                table_size: Some(table_size),
                oversampling: Some(oversampling),
                planes: Some(planes),
                ..Numbers::default()
            },
            Integrator::Tabulated { table_size } => {
                Numbers { table_size: Some(table_size), ..Numbers::default() }
            }
            Integrator::Analytic
            | Integrator::Clipped
            | Integrator::VertexSampled
            | Integrator::Reference => Numbers::default(),
        }
    }

    /// The same kind with other numbers, as far as it has them.
    pub fn with(&self, numbers: Numbers) -> Integrator {
        let mut with = *self;
        match &mut with {
            Integrator::Adaptive { tolerance } => set(tolerance, numbers.tolerance),
            Integrator::Segments { count, table_size } => {
                set(count, numbers.count);
                set(table_size, numbers.table_size);
            }
            Integrator::Riemann { count } => set(count, numbers.count),
            Integrator::PreIntegrated { table_size, oversampling } => {
                set(table_size, numbers.table_size);
                set(oversampling, numbers.oversampling);
            }
            Integrator::PreIntegratedCylindrical { table_size, oversampling, planes } => {
                set(table_size, numbers.table_size);
                set(oversampling, numbers.oversampling);
                set(planes, numbers.planes);
            }
            Integrator::Tabulated { table_size } => set(table_size, numbers.table_size),
            Integrator::Analytic
            | Integrator::Clipped
            | Integrator::VertexSampled
            | Integrator::Reference => {}
        }
        with
    }

    /// Whether it tabulates over lengths, so that [`super::new`] looks at the data's extent.
    pub fn has_table_of_lengths(&self) -> bool {
        matches!(self, Integrator::PreIntegrated { .. } | Integrator::PreIntegratedCylindrical { .. })
    }

    /// Whether it builds a table.
    pub fn has_table(&self) -> bool {
        let own = matches!(self, Integrator::Segments { .. } | Integrator::Tabulated { .. });
        self.has_table_of_lengths() || own
    }

    /// Checks that its settings are in range.
    pub fn check(&self) -> Result<()> {
        let within = |what: &str, value: usize, low: usize, high: usize| {
            if (low..=high).contains(&value) {
                return Ok(());
            }
            let what = format!("{what} of the integrator '{}' is out of range", self.name());
            Err(Error::usage(what).got(value).expected(format!("{low} to {high}")))
        };
        match *self {
            Integrator::Adaptive { tolerance } if !(tolerance > 0.0 && tolerance.is_finite()) => {
                Err(Error::usage("the tolerance of the integrator 'adaptive' is out of range")
                    .got(tolerance)
                    .expected("a number above 0"))
            }
            Integrator::Segments { count, table_size } => {
                within("the number of segments", count, 1, usize::MAX)?;
                within("table_size", table_size, 2, PARTIAL_SIDE_MOST)
            }
            Integrator::Riemann { count } => within("the number of segments", count, 1, usize::MAX),
            Integrator::Tabulated { table_size } => within("table_size", table_size, 2, PARTIAL_SIDE_MOST),
            Integrator::PreIntegrated { table_size, oversampling } => {
                within("table_size", table_size, 2, TABLE_SIDE_MOST)?;
                within("oversampling", oversampling, 1, OVERSAMPLING_MOST)
            }
            Integrator::PreIntegratedCylindrical { table_size, oversampling, planes } => {
                within("table_size", table_size, 2, TABLE_SIDE_MOST)?;
                within("oversampling", oversampling, 1, OVERSAMPLING_MOST)?;
                within("planes", planes, 1, PLANES_MOST)?;
                let fit = |planes: &usize| {
                    table_size * table_size * (last_tile(table_size, *planes) + 1) <= TILES_MOST
                };
                let most = (1..=PLANES_MOST).rev().find(fit).unwrap_or(1);
                within(&format!("planes, with table_size = {table_size},"), planes, 1, most)
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
            Integrator::Tabulated { .. } => {
                let has_table = |profile: &Profile| match profile {
                    Profile::Uniform
                    | Profile::Gaussian { .. }
                    | Profile::GaussianNd { .. }
                    | Profile::TriangularGaussian { .. }
                    | Profile::TriangularGaussianNd { .. } => true,
                    Profile::TriangleWave(_)
                    | Profile::SineWave(_)
                    | Profile::PiecewiseLinear { .. }
                    | Profile::Table(_) => false,
                };
                let without = widgets.iter().position(|widget| !has_table(&widget.profile));
                without.map(|i| named(i, "whose integral it has no table of"))
            }
            Integrator::Analytic
            | Integrator::Adaptive { .. }
            | Integrator::Segments { .. }
            | Integrator::Riemann { .. }
            | Integrator::VertexSampled
            | Integrator::Reference => None,
        }
    }
}

/// The numbers that integrators go by; `None`: not given, or none that the integrator has.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Numbers {
    /// Largest error of a channel of C and of A.
    pub tolerance: Option<f64>,
    /// Pieces or samples of a segment.
    pub count: Option<usize>,
    /// Entries a side of the table.
    pub table_size: Option<usize>,
    /// Pieces from one entry of a pre-integrated table to the next.
    pub oversampling: Option<usize>,
    /// Tiles of a cylindrical table for each entry of a side.
    pub planes: Option<usize>,
}

fn set<T>(number: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *number = given;
    }
}

/// Checks, without any data, that the integrator's settings are in range and that it can serve the transfer
/// function; the error says which integrators can.
pub fn can_serve(integrator: &Integrator, transfer_function: &TransferFunction) -> Result<()> {
    integrator.check()?;
    let Some(obstacle) = integrator.obstacle(transfer_function) else { return Ok(()) };
    let needs = match integrator {
        Integrator::Clipped => "one piecewise-linear widget",
        Integrator::Tabulated { .. } => "uniform widgets and Gaussians",
        _ => "widgets of the scalar alone",
    };
    let serving: Vec<&str> = Integrator::EVERY
        .iter()
        .filter(|other| other.obstacle(transfer_function).is_none())
        .map(Integrator::name)
        .collect();
    let what = format!("the integrator '{}' cannot serve this transfer function", integrator.name());
    Err(Error::usage(what)
        .got(obstacle)
        .expected(format!("{needs}, or one of the integrators {}", serving.join(", "))))
}
