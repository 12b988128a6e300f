//! `surface-reader`: polygons, lines and points of a surface file.

use crate::reader::{PATH, refuse_missing};
use crate::surfacing::tubing::{self, tube_parameters};
use crate::surfacing::{self, SMOOTH, Shape, with_paint};
use voltet_core::grid::extent;
use voltet_core::probing::value_range;
use voltet_core::transfer::{DataStatistics, resolved};
use voltet_core::{Error, Result};
use voltet_graph::{
    ArrayRef, DefaultValue, Node, Outputs, Parameter, ParameterType, Parameters, Range, RunContext,
};
use voltet_io::formats::{SURFACE_FILES, SurfaceColors, SurfaceFile, read_surface};

pub const NODE: Node = Node {
    name: "surface-reader",
    summary: "Reads a surface file: polygons as triangles, lines as tubes, points as spheres, and what they are coloured by.",
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

const PARAMETERS: [Parameter; 14] = {
    let [radius, sides] = tube_parameters("0.5 %");
    let mut all = with_paint(
        [
            Parameter { help: SURFACE_FILES, ..PATH },
            Parameter {
                name: "style",
                parameter_type: ParameterType::Choice(&[
                    ("surface", "triangles"),
                    ("wireframe", "their edges as tubes, those of the file's own polygons"),
                ]),
                unit: "",
                default: DefaultValue::Text("surface"),
                help: "what polygons become; lines are tubes and points are spheres with either",
            },
            Parameter {
                default: DefaultValue::Unset("true where the file has normals"),
                help: "true: light by the file's normals, or averages over triangles; false: by each triangle's own",
                ..SMOOTH
            },
            radius,
            sides,
            Parameter {
                name: "bad",
                parameter_type: ParameterType::Color(Range::at_least(0.0)),
                unit: "linear RGB",
                default: DefaultValue::Unset("they are left out, with a warning"),
                help: "colour of triangles with a value of color_by that is not finite, such as nan",
            },
        ],
        "the file's own colours, or else one colour",
        1.0,
        0.3,
    );
    all[7] = Parameter {
        help: "colours by values: an array of the file; \"NAME:magnitude\" or \"NAME:0\" for vectors",
        ..all[7]
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

struct SurfaceStatistics<'a>(&'a SurfaceFile);

impl DataStatistics for SurfaceStatistics<'_> {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        match quantity {
            ArrayRef::Named("diagonal") => {
                Ok([0.0, extent::bounds(&self.0.points).map_or(0.0, extent::diagonal)])
            }
            _ => value_range(self.0.values.as_deref().unwrap_or_default()),
        }
    }

    fn percentile(&self, _: &ArrayRef, _: f64) -> Result<f64> {
        let error = Error::usage("percentiles are of a volume, and a surface has none");
        Err(error.expected("a number, or a percentage of the range"))
    }
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, path) = (call.parameters, call.path("path")?);
    let colors = match surfacing::color_by(p, None) {
        Some(name) => SurfaceColors::Array(name),
        None if p.is_set("color") => SurfaceColors::Uniform,
        None => SurfaceColors::Own,
    };
    let edges = p.text("style")? == "wireframe";
    let mut file = call.stage("read", |progress| read_surface(&path, colors, edges, progress))?;
    call.notes.warnings.append(&mut file.warnings);
    let has_tubes = !(file.lines.is_empty() && file.vertices.is_empty());
    if let Some(name) = ["radius", "sides"].into_iter().find(|name| !has_tubes && p.is_set(name)) {
        call.notes
            .warnings
            .push(format!("the file has no lines and no points of their own: no '{name}' counts"));
    }
    let unused: Vec<&str> = [("range", file.values.is_some()), ("radius", has_tubes)]
        .into_iter()
        .filter_map(|(name, is_used)| (!is_used).then_some(name))
        .collect();
    let own = surfacing::known(call, &unused, |p, _| resolved(p, &SurfaceStatistics(&file)))?;
    let tubes = match has_tubes {
        true => {
            let tubes = tubing::made(call, &own, &file.points, &file.lines, &file.vertices)?;
            Shape::of_tubes(tubes, file.values.as_deref(), file.colors.as_deref())
        }
        false => Shape::default(),
    };
    let SurfaceFile { points, triangles, normals, values, colors, .. } = file;
    let shape = Shape { points, triangles, normals, values, colors, bad: None };
    let shape = match p.optional("smooth") {
        None => shape,
        Some(_) if p.flag("smooth")? && !shape.normals.is_empty() => shape,
        Some(_) => Shape { normals: Vec::new(), ..shape }.smoothed(p)?,
    };
    let shape = Shape { bad: p.optional_color("bad")?, ..shape.joined(tubes) };
    shape.painted(call, &own, "the file holds no polygons, lines or points of their own")
}
