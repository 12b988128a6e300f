//! `grid-writer`: the grid with what was computed of it, as a VTK file, on the cells of the file that it came from.

use crate::drawing::Culled;
use crate::files::{self, PATH};
use std::path::Path;
use voltet_core::grid::Array;
use voltet_core::progress::refuse_beyond_memory;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, agreeing, counted};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType,
    RunContext, suggest,
};
use voltet_io::vtu::{self, Contents, Precision, Role};

/// The declaration.
pub const NODE: Node = Node {
    name: "grid-writer",
    summary: "Writes the grid with what was computed of it as .vtu: gradient, culled cells, bands, arrays of the file.",
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
        Parameter { help: "the file, .vtu; \"-\": the standard output", ..PATH },
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
            help: "of the arrays",
        },
    ],
    example: include_str!("examples/grid_writer.toml"),
    check: &|parameters| wanted(parameters).and_then(|_| refuse_ending(parameters)),
    demand: &demand,
    prepare: &files::prepare,
    run: &run,
    ..Node::BLANK
};

const ARRAYS: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Texts,
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

fn refuse_ending(p: &Parameters) -> Result<()> {
    let path = p.text("path")?;
    let ending = Path::new(path).extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("vtu") => Ok(()),
        None if files::is_stream(path) => Ok(()),
        _ => Err(p
            .error("path", "the grid is written as a VTK file of an unstructured grid")
            .got(path)
            .expected("a path that ends in .vtu")),
    }
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
    let demand = Demand {
        arrays: names(p, "point_arrays")?.into_iter().collect(),
        cell_arrays: names(p, "cell_arrays")?.into_iter().collect(),
        gradient_magnitude: wants("gradient-magnitude", given),
        gradient: wants("gradient", given),
        file_cells: p.text("cells")? != "tetrahedra",
        ..Demand::default()
    };
    let cell_values = wants("cell-values", true);
    asking.ask("volume", &demand)?;
    asking.ask("cells", &Demand { kept_cells: wants("culled", true), ..Demand::default() })?;
    asking.ask("cell_values", &Demand { cell_values, ..Demand::default() })
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let volume = call.volume("volume")?;
    let contents = contents(call, &volume)?;
    let bytes = vtu::encoding_bytes(&contents);
    let [points, cells] = [contents.points.len(), contents.cells.types.len()];
    let what = || format!("writing {} and {}", counted(points, "point"), counted(cells, "cell"));
    refuse_beyond_memory(call.progress(), what, bytes)?;
    let precision = match call.parameters.text("precision")? {
        "single" => Precision::Single,
        "double" => Precision::Double,
        _ => Precision::Lossless,
    };
    let compress = call.parameters.text("compression")? == "zlib";
    let arrays = contents.point_arrays.len() + contents.cell_arrays.len();
    call.notes.counts.insert("arrays_written", arrays as u64);
    let encoded = call.stage("encode", |_| vtu::encode(contents, precision, compress))?;
    if compress && !encoded.compressed {
        let why = "not compressed: an array fills whole blocks of 32,768 bytes, which the library that writes gets wrong";
        call.notes.warnings.push(why.into());
    }
    files::write(call, &encoded.bytes)?;
    Ok(Vec::new())
}

/// Contents of the file.
fn contents<'a>(call: &mut RunContext, volume: &'a Volume) -> Result<Contents<'a>> {
    let p = call.parameters;
    let wanted = wanted(p)?;
    let grid = &*volume.grid;
    let file = match (p.text("cells")?, &grid.file_cells) {
        ("tetrahedra", _) | ("auto", None) => None,
        (_, Some(file)) => Some(&**file),
        (_, None) => {
            let why = "the grid does not keep the cells of a file: it was not read from one, a node on the way changed them, or \
                       cells keep constant values";
            return Err(p.error("cells", why).expected("cells = \"tetrahedra\", or \"auto\""));
        }
    };
    let mut contents = Contents::new(grid, file);
    let wants = |word: &str| wanted.as_ref().is_none_or(|words| words.iter().any(|w| w == word));
    let missing = |word: &str, what: &str| -> Result<()> {
        match wanted.is_some() && wants(word) {
            true => Err(p
                .error("arrays", format!("the volume has no {what}"))
                .expected(format!("inputs from a node that computes it, or arrays without \"{word}\""))),
            false => Ok(()),
        }
    };
    let name = &grid.scalar_name;
    if wants("scalar") {
        contents.add_point_values(name, Role::Scalar, &volume.scalar, 1);
    }
    match &volume.gradient_magnitude {
        Some(g) if wants("gradient-magnitude") => {
            contents.add_point_values(&format!("{name}_gradient_magnitude"), Role::Plain, g, 1);
        }
        Some(_) => {}
        None => missing("gradient-magnitude", "gradient magnitude")?,
    }
    match &volume.gradient {
        Some(gradient) if wants("gradient") => {
            let vectors: Vec<f64> = gradient.iter().flat_map(|v| v.to_array()).collect();
            contents.add_point_values(&format!("{name}_gradient"), Role::Vectors, &vectors, 3);
        }
        Some(_) => {}
        None => missing("gradient", "gradient")?,
    }
    let asked = |parameter: &str| -> Result<Option<Vec<String>>> {
        p.optional(parameter).is_some().then(|| names(p, parameter)).transpose()
    };
    let listed = |names: &Option<Vec<String>>, name: &String| names.as_ref().is_none_or(|n| n.contains(name));
    let points = asked("point_arrays")?;
    let written: Vec<String> = contents.point_arrays.iter().map(|array| array.name.clone()).collect();
    for (name, array) in grid.point_arrays.iter().filter(|(name, _)| listed(&points, name)) {
        // The scalar may have been asked for twice.
        if !written.contains(name) {
            let Array { component_count, values } = &**array;
            contents.add_point_values(name, Role::Plain, values, *component_count);
        }
    }
    let cells = asked("cell_arrays")?;
    let cell_arrays = grid.cell_arrays.iter().filter(|(name, _)| listed(&cells, name));
    contents.add_cell_arrays(cell_arrays);
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
    let without = contents.points_without_values();
    if without > 0 {
        let of = counted(contents.points.len(), "point");
        let (belong, their) = (agreeing(&without, "belongs", "belong"), agreeing(&without, "its", "their"));
        let why = format!("{belong} to no cell with a volume; {their} values are written as nan");
        call.notes.warnings.push(format!("{without} of {of} {why}"));
    }
    Ok(contents)
}

/// An error where an input is of another grid.
fn refuse_other(p: &Parameters, port: &str, found: usize, expected: usize) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    let error = Error::usage(format!("the inputs 'volume' and '{port}' are of different grids"));
    Err(p.locate("path", error.got(counted(found, "tetrahedron")).expected(expected)))
}
