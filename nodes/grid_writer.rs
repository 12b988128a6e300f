//! `grid-writer`: the grid with what was computed of it, as a file of VTK or VTKHDF, on the cells of the file that it came from.

use crate::drawing::Culled;
use crate::files::{self, PATH};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::grid::{Array, Grid};
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, agreeing, counted};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType,
    RunContext, suggest,
};
use voltet_io::grids::{Contents, GridFormat, Precision, Role};

pub const NODE: Node = Node {
    name: "grid-writer",
    summary: "Writes the grid with what was computed of it as .vtu or .vtkhdf: gradient, culled cells, bands, arrays of the file.",
    inputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the points and their values" }],
    optional_inputs: &[
        Port {
            name: "cells",
            port_type: PortType::Cells,
            summary: "cells that cull has left, of the same volume",
        },
        Port {
            name: "cell_values",
            port_type: PortType::CellValues,
            summary: "numbers of cells, such as those of the node bands, of the same volume",
        },
    ],
    parameters: &[
        Parameter { help: "the file, .vtu or .vtkhdf; \"-\": the standard output, as .vtu", ..PATH },
        Parameter {
            name: "arrays",
            parameter_type: ParameterType::Texts,
            unit: "",
            default: DefaultValue::Unset("all that the inputs give"),
            help: "of what is computed: \"scalar\", \"gradient-magnitude\", \"gradient\", \"culled\", \"cell-values\"",
        },
        Parameter {
            name: "point_arrays",
            help: "further arrays of the file, per point; \"NAME:0\" and \"NAME:magnitude\" for parts of vectors",
            ..ARRAYS
        },
        Parameter {
            name: "cell_arrays",
            help: "further arrays of the file, per cell, as they are",
            ..ARRAYS
        },
        Parameter {
            name: "cells",
            parameter_type: ParameterType::Choice(&[
                ("auto", "the file's where the grid keeps them, else tetrahedra"),
                ("file", "the file's own points and cells, of their own types and in their order"),
                (
                    "tetrahedra",
                    "the tetrahedra that they were split into; the array file_cell says of which cell",
                ),
            ]),
            unit: "",
            default: DefaultValue::Text("auto"),
            help: "which cells are written",
        },
        Parameter {
            name: "precision",
            parameter_type: ParameterType::Choice(&[
                ("auto", "32 bits for an array whose values all fit into them, else 64"),
                ("single", "32 bits, rounded"),
                ("double", "64 bits"),
            ]),
            unit: "",
            default: DefaultValue::Text("auto"),
            help: "of positions and quantities",
        },
        Parameter {
            name: "compression",
            parameter_type: ParameterType::Choice(&[("none", "none"), ("zlib", "zlib, as VTK's own writer")]),
            unit: "",
            default: DefaultValue::Text("none"),
            help: "of the arrays of a .vtu",
        },
    ],
    example: include_str!("examples/grid_writer.toml"),
    check: &|parameters| wanted(parameters).and_then(|_| format(parameters)).map(drop),
    demand: &demand,
    prepare: &files::prepare,
    run: &run,
    ..Node::BLANK
};

const ARRAYS: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::ArrayNames,
    unit: "",
    default: DefaultValue::Unset("those that other nodes ask for"),
    help: "",
};

/// Names valid for `arrays`.
const NAMES: [&str; 5] = ["scalar", "gradient-magnitude", "gradient", "culled", "cell-values"];

/// Arrays named by `arrays`; `None`: all that there are.
fn wanted(p: &Parameters) -> Result<Option<Vec<String>>> {
    if p.optional("arrays").is_none() {
        return Ok(None);
    }
    let words = p.texts("arrays")?;
    match words.iter().find(|word| !NAMES.contains(&word.as_str())) {
        None => Ok(Some(words)),
        Some(word) => {
            let error = p.error("arrays", "'arrays' does not know this word").got(format!("\"{word}\""));
            let known = suggest(word, NAMES);
            Err(error.expected(format!("{known}; point_arrays and cell_arrays name arrays of the file")))
        }
    }
}

/// The format that the path's ending means.
///
/// Errors: it means none; compression that the format has not.
fn format(p: &Parameters) -> Result<GridFormat> {
    let path = p.text("path")?;
    let ending = Path::new(path).extension().map(|e| e.to_string_lossy().to_lowercase());
    let format = match ending.as_deref() {
        None if files::is_stream(path) => Some(GridFormat::ALL[0]),
        ending => GridFormat::ALL.into_iter().find(|format| ending == Some(format.ending())),
    };
    let Some(format) = format else {
        let endings = GridFormat::ALL.map(|format| format!(".{}", format.ending())).join(" or ");
        let error = p.error("path", "the path does not say a format that grids are written in").got(path);
        return Err(error.expected(format!("a path that ends in {endings}")));
    };
    if is_compressed(p)? && !format.can_compress() {
        let error = p.error("compression", "arrays are not compressed in this format").got(path);
        return Err(error.expected("a path that ends in .vtu, or compression = \"none\""));
    }
    Ok(format)
}

fn is_compressed(p: &Parameters) -> Result<bool> {
    Ok(p.text("compression")? == "zlib")
}

/// The names that a parameter lists; none where it is not given.
fn names(p: &Parameters, name: &str) -> Result<Vec<String>> {
    if p.optional(name).is_some() { p.texts(name) } else { Ok(Vec::new()) }
}

fn demand(asking: &mut DemandContext) -> Result<()> {
    let p = asking.parameters;
    let wanted = wanted(p)?;
    // A grid alone has no gradient to give, and none is requested.
    let given = asking.fed_by("volume")? == Some(PortType::Volume);
    let wants = |word: &str, there: bool| match &wanted {
        Some(words) => words.iter().any(|w| w == word),
        None => there,
    };
    for (word, port) in [("culled", "cells"), ("cell-values", "cell_values")] {
        if wanted.is_some() && wants(word, false) && asking.fed_by(port)?.is_none() {
            let error =
                p.error("arrays", format!("\"{word}\" is asked for, and the input '{port}' is not wired"));
            return Err(error.expected(match port {
                "cells" => "inputs = { cells = \"NODE\" }, a node of type \"cull\"",
                _ => "inputs = { cell_values = \"NODE\" }, a node of type \"bands\"",
            }));
        }
    }
    let file_cells = p.text("cells")? != "tetrahedra";
    let [gradient_magnitude, gradient] = ["gradient-magnitude", "gradient"].map(|word| wants(word, given));
    let without_scalar = !(wants("scalar", true) || gradient_magnitude || gradient);
    let has_tetrahedra_values = asking.fed_by("cells")?.is_some() || asking.fed_by("cell_values")?.is_some();
    let demand = Demand {
        arrays: names(p, "point_arrays")?.into_iter().collect(),
        cell_arrays: names(p, "cell_arrays")?.into_iter().collect(),
        gradient_magnitude,
        gradient,
        without_scalar,
        file_cells,
        without_tetrahedra: file_cells && without_scalar && !has_tetrahedra_values,
        ..Demand::default()
    };
    let cell_values = wants("cell-values", true);
    asking.ask("volume", &demand)?;
    asking.ask("cells", &Demand { kept_cells: wants("culled", true), ..Demand::default() })?;
    asking.ask("cell_values", &Demand { cell_values, ..Demand::default() })
}

/// A volume, or a grid without a scalar.
enum Written {
    Volume(Arc<Volume>),
    Grid(Arc<Grid>),
}

impl Written {
    fn grid(&self) -> &Grid {
        match self {
            Written::Volume(volume) => &volume.grid,
            Written::Grid(grid) => grid,
        }
    }
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let of_scalar = ["scalar", "gradient-magnitude", "gradient"];
    let needs_scalar =
        wanted(call.parameters)?.is_some_and(|words| words.iter().any(|word| of_scalar.contains(&&**word)));
    let written = match call.volume("volume") {
        Ok(volume) => Written::Volume(volume),
        Err(error) if needs_scalar => return Err(error),
        Err(_) => Written::Grid(call.grid("volume")?),
    };
    let contents = contents(call, &written)?;
    let (format, is_compressed) = (format(call.parameters)?, is_compressed(call.parameters)?);
    if is_compressed {
        // Its blocks are written behind their sizes.
        let bytes = contents.largest_array_bytes();
        refuse_beyond_memory(call.progress(), || "compressing the largest array".into(), bytes)?;
    }
    for name in contents.array_names().filter(|name| format.array_name(name) != *name) {
        let warning = format!("the array '{name}' is called '{}' in the file", format.array_name(name));
        call.notes.warnings.push(warning);
    }
    for (name, count) in [
        ("points_written", contents.point_count()),
        ("cells_written", contents.cell_count()),
        ("arrays_written", contents.array_count()),
    ] {
        call.notes.counts.insert(name, count as u64);
    }
    let start = Instant::now();
    files::write_parts(call, &mut |progress, out| {
        let byte_count = contents.byte_count() as f64;
        format.write(&contents, is_compressed, &mut Watched { out, progress, byte_count, written: 0.0 })
    })?;
    call.notes.stages.push(("write".into(), start.elapsed().as_secs_f64()));
    Ok(Vec::new())
}

/// An output whose progress is reported, and that ends with an error where a stop was asked for.
struct Watched<'a> {
    out: &'a mut dyn Write,
    progress: &'a dyn Progress,
    byte_count: f64,
    /// Bytes written so far.
    written: f64,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.progress.check_cancelled().map_err(io::Error::other)?;
        let count = self.out.write(bytes)?;
        self.written += count as f64;
        self.progress.report("writing", (self.written / self.byte_count).min(1.0));
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

fn contents<'a>(call: &mut RunContext, written: &'a Written) -> Result<Contents<'a>> {
    let p = call.parameters;
    let grid = written.grid();
    let file = match (p.text("cells")?, &grid.file_cells) {
        ("tetrahedra", _) | ("auto", None) => None,
        (_, Some(file)) => Some(&**file),
        (_, None) => {
            let why = "the grid does not keep the cells of a file: it was not read from one, a node on the way changed them, or \
                       cells keep constant values";
            return Err(p.error("cells", why).expected("cells = \"tetrahedra\", or \"auto\""));
        }
    };
    let precision = match p.text("precision")? {
        "single" => Precision::Single,
        "double" => Precision::Double,
        _ => Precision::Lossless,
    };
    let mut contents = Contents::new(grid, file, precision);
    if let Written::Volume(volume) = written {
        add_quantities(p, volume, &mut contents)?;
    }
    add_arrays(p, grid, &mut contents)?;
    add_of_tetrahedra(call, grid, &mut contents)?;
    let without = contents.points_without_values();
    if without > 0 {
        let of = counted(contents.point_count(), "point");
        let (belong, their) = (agreeing(&without, "belongs", "belong"), agreeing(&without, "its", "their"));
        let why = format!("{belong} to no cell with a volume; {their} values are written as nan");
        call.notes.warnings.push(format!("{without} of {of} {why}"));
    }
    Ok(contents)
}

/// Adds the scalar and its gradient.
fn add_quantities<'a>(p: &Parameters, volume: &'a Volume, contents: &mut Contents<'a>) -> Result<()> {
    let wanted = wanted(p)?;
    let wants = |word: &str| wanted.as_ref().is_none_or(|words| words.iter().any(|w| w == word));
    let missing = |word: &str, what: &str| -> Result<()> {
        match wanted.is_some() && wants(word) {
            true => Err(p
                .error("arrays", format!("the volume has no {what}"))
                .expected(format!("inputs from a node that computes it, or arrays without \"{word}\""))),
            false => Ok(()),
        }
    };
    let name = &volume.grid.scalar_name;
    if wants("scalar") {
        contents.add_point_values(name, Role::Scalar, &volume.scalar[..], 1);
    }
    match &volume.gradient_magnitude {
        Some(g) if wants("gradient-magnitude") => {
            contents.add_point_values(&format!("{name}_gradient_magnitude"), Role::Plain, &g[..], 1);
        }
        Some(_) => {}
        None => missing("gradient-magnitude", "gradient magnitude")?,
    }
    match &volume.gradient {
        Some(gradient) if wants("gradient") => {
            let vectors = bytemuck::cast_slice::<_, f64>(gradient.as_slice());
            contents.add_point_values(&format!("{name}_gradient"), Role::Vectors, vectors, 3);
        }
        Some(_) => {}
        None => missing("gradient", "gradient")?,
    }
    Ok(())
}

fn add_arrays<'a>(p: &Parameters, grid: &'a Grid, contents: &mut Contents<'a>) -> Result<()> {
    let asked = |parameter: &str| -> Result<Option<Vec<String>>> {
        p.optional(parameter).is_some().then(|| names(p, parameter)).transpose()
    };
    let listed = |names: &Option<Vec<String>>, name: &String| names.as_ref().is_none_or(|n| n.contains(name));
    let points = asked("point_arrays")?;
    for (name, array) in grid.point_arrays.iter().filter(|(name, _)| listed(&points, name)) {
        // The scalar may have been asked for twice.
        if !contents.has_point_array(name) {
            let Array { component_count, values } = &**array;
            contents.add_point_values(name, Role::Plain, &values[..], *component_count);
        }
    }
    let cells = asked("cell_arrays")?;
    contents.add_cell_arrays(grid.cell_arrays.iter().filter(|(name, _)| listed(&cells, name)));
    Ok(())
}

/// Adds what other nodes found of the tetrahedra.
fn add_of_tetrahedra(call: &RunContext, grid: &Grid, contents: &mut Contents) -> Result<()> {
    let p = call.parameters;
    let wanted = wanted(p)?;
    let wants = |word: &str| wanted.as_ref().is_none_or(|words| words.iter().any(|w| w == word));
    if let Some(culled) = call.optional_cells::<Culled>("cells")?.filter(|_| wants("culled")) {
        let mut kept = vec![false; grid.tetrahedra.len()];
        refuse_other(p, "cells", culled.cells.volume.grid.tetrahedra.len(), kept.len())?;
        culled.cells.selection.ids.iter().for_each(|&tetrahedron| kept[tetrahedron as usize] = true);
        contents.add_culled("culled", &kept);
    }
    for values in call.cell_values("cell_values")?.iter().filter(|_| wants("cell-values")) {
        for (name, numbers) in &values.arrays {
            refuse_other(p, "cell_values", numbers.len(), grid.tetrahedra.len())?;
            contents.add_tetrahedra_values(name, numbers);
        }
    }
    Ok(())
}

/// An error where an input is of another grid.
fn refuse_other(p: &Parameters, port: &str, found: usize, expected: usize) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    let error = Error::usage(format!("the inputs 'volume' and '{port}' are of different grids"));
    Err(p.locate("path", error.got(counted(found, "tetrahedron")).expected(expected)))
}
