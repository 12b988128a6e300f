//! `surface-reader`: triangles of a surface file.

use crate::reader::refuse_missing;
use crate::surfacing::{self, SMOOTH, Shape, with_paint};
use voltet_core::probing::value_range;
use voltet_core::transfer::{DataStatistics, resolved};
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, DefaultValue, Node, Outputs, Parameter, ParameterType, RunContext};
use voltet_io::formats::{SURFACE_FILES, read_surface};

/// The declaration.
pub const NODE: Node = Node {
    name: "surface-reader",
    summary: "Reads a surface file: polygons as triangles, their normals, and an array to colour them by.",
    outputs: surfacing::OUTPUTS,
    parameters: &PARAMETERS,
    example: include_str!("examples/surface_reader.toml"),
    check: &surfacing::check,
    // A source has no inputs to ask.
    demand: &|_| Ok(()),
    prepare: &|preparation| refuse_missing(&preparation.path("path")?),
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 10] = {
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
        ],
        "one colour",
        1.0,
        0.3,
    );
    all[3] = Parameter {
        help: "colours by values: an array of the file; \"NAME:magnitude\" or \"NAME:0\" for vectors",
        ..all[3]
    };
    all
};

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
    let shape =
        Shape { points: file.points, triangles: file.triangles, normals: file.normals, values: file.values };
    let shape = match p.optional("smooth") {
        None => shape,
        Some(_) if p.flag("smooth")? && !shape.normals.is_empty() => shape,
        Some(_) => Shape { normals: Vec::new(), ..shape }.smoothed(p)?,
    };
    shape.painted(call, &own, "the file holds no polygons")
}
