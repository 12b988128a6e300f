//! `surface-reader`: triangles of a surface file.

use crate::reader::refuse_missing;
use crate::surfacing::{self, SMOOTH, Shape, with_paint};
use voltet_core::probing::value_range;
use voltet_core::transfer::{DataStatistics, resolved};
use voltet_core::{Error, Result};
use voltet_graph::{
    ArrayRef, DefaultValue, Node, Outputs, Parameter, ParameterType, Parameters, Range, RunContext,
};
use voltet_io::formats::{SURFACE_FILES, read_surface};

/// The declaration.
pub const NODE: Node = Node {
    name: "surface-reader",
    summary: "Reads a surface file: polygons as triangles, their normals, and an array to colour them by.",
    outputs: surfacing::OUTPUTS,
    parameters: &PARAMETERS,
    example: include_str!("examples/surface_reader.toml"),
    check: &check,
    // A source has no inputs to ask.
    demand: &|_| Ok(()),
    prepare: &|preparation| refuse_missing(&preparation.path("path")?),
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 11] = {
    let mut all = with_paint(
        [
            Parameter {
                name: "path",
                parameter_type: ParameterType::InputPath,
                unit: "",
                default: DefaultValue::Required,
                help: SURFACE_FILES,
            },
            Parameter {
                default: DefaultValue::Unset("true where the file has normals"),
                help: "true: light by the file's normals, or averages over triangles; false: by each triangle's own",
                ..SMOOTH
            },
            Parameter {
                name: "bad",
                parameter_type: ParameterType::Color(Range::at_least(0.0)),
                unit: "linear RGB",
                default: DefaultValue::Unset("they are left out, with a warning"),
                help: "colour of triangles with a value of color_by that is not finite, such as nan",
            },
        ],
        "one colour",
        1.0,
        0.3,
    );
    all[4] = Parameter {
        help: "colours by values: an array of the file; \"NAME:magnitude\" or \"NAME:0\" for vectors",
        ..all[4]
    };
    all
};

/// Mistakes in the paint, and a colour of values where there are none.
fn check(p: &Parameters) -> Result<()> {
    if p.is_set("bad") && !p.is_set("color_by") {
        let error = p.error("bad", "'bad' is a colour of values, and nothing is coloured by values");
        return Err(error.expected("color_by = \"ARRAY\" too"));
    }
    surfacing::check(p)
}

/// Values of a surface.
struct SurfaceStatistics<'a>(&'a [f64]);

impl DataStatistics for SurfaceStatistics<'_> {
    fn range(&self, _: &ArrayRef) -> Result<[f64; 2]> {
        value_range(self.0)
    }

    fn percentile(&self, _: &ArrayRef, _: f64) -> Result<f64> {
        let error = Error::usage("percentiles are of a volume, and a surface has none");
        Err(error.expected("a number, or a percentage of the range"))
    }
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, path) = (call.parameters, call.path("path")?);
    let color_by = surfacing::color_by(p, None);
    let file = call.stage("read", |progress| read_surface(&path, color_by, progress))?;
    call.notes.warnings.extend(file.warnings);
    let values = SurfaceStatistics(file.values.as_deref().unwrap_or_default());
    let own = surfacing::known(call, color_by.is_some(), |p, _| resolved(p, &values))?;
    let shape = Shape {
        points: file.points,
        triangles: file.triangles,
        normals: file.normals,
        values: file.values,
        bad: p.optional_color("bad")?,
    };
    let shape = match p.optional("smooth") {
        None => shape,
        Some(_) if p.flag("smooth")? && !shape.normals.is_empty() => shape,
        Some(_) => Shape { normals: Vec::new(), ..shape }.smoothed(p)?,
    };
    shape.painted(call, &own, "the file holds no polygons")
}
