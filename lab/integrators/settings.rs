//! Parameters of the integrators, their defaults and their limits.

use super::last_tile;
use voltet_core::Result;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range};
use voltet_optics::integrators::Integrator;

/// Pieces of a ray segment by default.
pub const DEFAULT_PIECES: usize = 16;

/// Side of a table by default.
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

/// Entries of the largest cylindrical table.
pub(crate) const MAX_TILE_ENTRIES: usize =
    MAX_TABLE_SIDE * MAX_TABLE_SIDE * (last_tile(MAX_TABLE_SIDE, 1) + 1);

/// Largest side of a two-dimensional table.
pub const MAX_PARTIAL_SIDE: usize = 4096;

/// Parameter: pieces or samples of a segment.
pub(crate) const PIECES: &str = "segments";
/// Parameter: entries a side of a table.
pub(crate) const SIDE: &str = "table_size";
/// Parameter: pieces of a path between entries of a table.
pub(crate) const OVERSAMPLING: &str = "oversampling";
/// Parameter: planes of a cylindrical table.
pub(crate) const PLANES: &str = "planes";

pub(crate) const PIECES_PARAMETER: Parameter = Parameter {
    name: PIECES,
    parameter_type: ParameterType::Integer(Range::within(1.0, 65536.0)),
    unit: "",
    default: DefaultValue::Integer(DEFAULT_PIECES as i64),
    help: "segments and riemann: pieces of each ray segment",
};

pub(crate) const PARTIAL_SIDE_PARAMETER: Parameter = Parameter {
    name: SIDE,
    parameter_type: ParameterType::Integer(Range::within(2.0, MAX_PARTIAL_SIDE as f64)),
    unit: "entries a side",
    default: DefaultValue::Integer(DEFAULT_SIDE as i64),
    help: "side of the table",
};

pub(crate) const SIDE_PARAMETER: Parameter = Parameter {
    name: SIDE,
    parameter_type: ParameterType::Integer(Range::within(2.0, MAX_TABLE_SIDE as f64)),
    unit: "entries a side",
    default: DefaultValue::Integer(DEFAULT_SIDE as i64),
    help: "side of the table, which has three dimensions",
};

pub(crate) const OVERSAMPLING_PARAMETER: Parameter = Parameter {
    name: OVERSAMPLING,
    parameter_type: ParameterType::Integer(Range::within(1.0, MAX_OVERSAMPLING as f64)),
    unit: "pieces",
    default: DefaultValue::Integer(DEFAULT_OVERSAMPLING as i64),
    help: "pieces of a path from one entry of the table to the next",
};

pub(crate) const PLANES_PARAMETER: Parameter = Parameter {
    name: PLANES,
    parameter_type: ParameterType::Integer(Range::within(1.0, MAX_PLANES as f64)),
    unit: "times table_size",
    default: DefaultValue::Integer(DEFAULT_PLANES as i64),
    help: "planes that the table is resampled to; in all no more entries than for 512 once",
};

/// Setting as a whole number; 0 where the kind has no such parameter.
pub(crate) fn count(integrator: &Integrator, name: &str) -> usize {
    integrator.count(name).unwrap_or(0)
}

/// Checks that a setting lies between two whole numbers.
pub(crate) fn check_count(integrator: &Integrator, name: &str, min: usize, max: usize) -> Result<()> {
    let count = count(integrator, name);
    match (min..=max).contains(&count) {
        true => Ok(()),
        false => Err(integrator.out_of_range(name, count, format!("{min} to {max}"))),
    }
}

/// Checks the number of pieces. A program may set more than the range that pipelines declare.
pub(crate) fn check_pieces(integrator: &Integrator) -> Result<()> {
    match count(integrator, PIECES) {
        0 => Err(integrator.out_of_range("the number of segments", 0, "1 or more")),
        _ => Ok(()),
    }
}
