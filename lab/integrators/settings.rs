//! Parameters of the integrators with their defaults and limits, and what their kernels and shader text share.

use voltet_core::Result;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range};
use voltet_core::transfer::TransferFunction;
use voltet_cpu::integrator::{FallbackReason, LaneIntegrator, LaneKernel, LaneScene};
use voltet_optics::integrators::{Integrator, SegmentIntegrator};
use voltet_shaders::WgslPiece;

pub const DEFAULT_PIECES: usize = 16;

pub const DEFAULT_SIDE: usize = 256;

/// Largest side of a three-dimensional table: 512³ colours take 1.5 GiB.
pub const MAX_TABLE_SIDE: usize = 512;

/// Pieces of a path from one entry of a pre-integrated table to the next by default: enough by Roettger and Ertl 2002, section 3.
pub const DEFAULT_OVERSAMPLING: usize = 2;

/// Largest number of pieces of such a path: a step is resolved long before, and the table takes long to fill.
pub const MAX_OVERSAMPLING: usize = 64;

/// Tiles of a cylindrical table for each entry of a side by default: as much memory as the table.
pub const DEFAULT_PLANES: usize = 1;

/// Largest number of tiles for each entry: twice what loses nothing by Roettger and Ertl 2002, section 4.
pub const MAX_PLANES: usize = 8;

pub const MAX_PARTIAL_SIDE: usize = 4096;

/// Parameter: pieces or samples of a segment.
pub(crate) const PIECES: &str = "segments";
/// Parameter: entries a side of a table.
pub(crate) const SIDE: &str = "table_size";
/// Parameter: pieces of a path between entries of a table.
pub(crate) const OVERSAMPLING: &str = "oversampling";
/// Parameter: planes of a cylindrical table.
pub(crate) const PLANES: &str = "planes";

const fn whole(
    name: &'static str,
    min: usize,
    max: usize,
    unit: &'static str,
    default: usize,
    help: &'static str,
) -> Parameter {
    let parameter_type = ParameterType::Integer(Range::within(min as f64, max as f64));
    Parameter { name, parameter_type, unit, default: DefaultValue::Integer(default as i64), help }
}

pub(crate) const PIECES_PARAMETER: Parameter =
    whole(PIECES, 1, 65536, "", DEFAULT_PIECES, "segments and riemann: pieces of each ray segment");

pub(crate) const PARTIAL_SIDE_PARAMETER: Parameter =
    whole(SIDE, 2, MAX_PARTIAL_SIDE, "entries a side", DEFAULT_SIDE, "side of the table");

pub(crate) const SIDE_PARAMETER: Parameter = whole(
    SIDE,
    2,
    MAX_TABLE_SIDE,
    "entries a side",
    DEFAULT_SIDE,
    "side of the table, which has three dimensions",
);

pub(crate) const OVERSAMPLING_PARAMETER: Parameter = whole(
    OVERSAMPLING,
    1,
    MAX_OVERSAMPLING,
    "pieces",
    DEFAULT_OVERSAMPLING,
    "pieces of a path from one entry of the table to the next",
);

pub(crate) const PLANES_PARAMETER: Parameter = whole(
    PLANES,
    1,
    MAX_PLANES,
    "times table_size",
    DEFAULT_PLANES,
    "planes that the table is resampled to; in all no more entries than for 512 once",
);

/// Setting as a whole number; 0 where the kind has no such parameter.
pub(crate) fn count(integrator: &Integrator, name: &str) -> usize {
    integrator.count(name).unwrap_or(0)
}

/// Checks the settings of a kind with pieces, of which a program may set more than the range that pipelines declare.
pub(crate) fn check_pieces(integrator: &Integrator) -> Result<()> {
    match count(integrator, PIECES) {
        0 => Err(integrator.out_of_range("the number of segments", 0, "1 or more")),
        _ => integrator.with(PIECES, DEFAULT_PIECES as f64).check_ranges(),
    }
}

/// A widget with the reason that it cannot be integrated.
pub(crate) fn widget_label(transfer_function: &TransferFunction, number: usize, why: &str) -> String {
    format!("widgets[{number}] ({}), {why}", transfer_function.widgets[number].profile.name())
}

pub(crate) type PreparedKernel = std::result::Result<Box<dyn LaneIntegrator>, FallbackReason>;

pub(crate) fn boxed(kernel: impl LaneKernel + 'static) -> Box<dyn LaneIntegrator> {
    Box::new(kernel)
}

/// The table of the integrator in 64 bits.
pub(crate) fn shared_table<'a, T: 'static>(
    scene: &LaneScene<'a>,
) -> std::result::Result<&'a T, FallbackReason> {
    let table = scene.exact.and_then(SegmentIntegrator::table);
    table.and_then(|table| table.downcast_ref()).ok_or(FallbackReason::Integrator)
}

macro_rules! piece {
    ($name:literal) => {
        WgslPiece {
            name: $name,
            file: concat!("lab/integrators/wgsl/", $name, ".wgsl"),
            text: include_str!(concat!("wgsl/", $name, ".wgsl")),
        }
    };
}

/// Shader text: the pieces under `wgsl/`, by name.
pub static WGSL_PIECES: &[WgslPiece] = &[
    piece!("pre_integrated/bilinear"),
    piece!("pre_integrated/cylinder"),
    piece!("pre_integrated/fill_slices"),
    piece!("pre_integrated/fill_tiles"),
    piece!("pre_integrated/light"),
    piece!("pre_integrated/mean_extinctions"),
    piece!("pre_integrated/table"),
    piece!("pre_integrated/tiles"),
    piece!("pre_integrated/trilinear"),
    piece!("sampled/partial_constant"),
    piece!("sampled/partial_density"),
    piece!("sampled/partial_table"),
    piece!("sampled/riemann"),
    piece!("sampled/segments"),
];
