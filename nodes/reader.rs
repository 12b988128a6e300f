//! `reader`: a data file to a grid of tetrahedra with the arrays that nodes downstream use.

use crate::between_steps::{StepPair, around, interpolated};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Grid;
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result};
use voltet_cpu::drawing_bytes;
use voltet_graph::{
    DefaultValue, Demand, Diagnostics, GridPart, Node, Outputs, PIECES_READ, Parameter, ParameterType,
    ParameterValue, Parameters, PartWork, PlanContext, Port, PortType, Preparation, Range, RunContext,
    SavedWork, Steps, TimeSeries, Value,
};
use voltet_io::formats::{
    self, Association, CellValues, Options, PieceBorders, Request, SelectedArrays, TimeStep, existing_file,
};
use voltet_io::memory::GridSize;

pub const NODE: Node = Node {
    name: "reader",
    summary: "Reads a data file: its cells as tetrahedra, one scalar, and the arrays that other nodes use.",
    outputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "points, tetrahedra, arrays" }],
    parameters: &[
        PATH,
        SCALAR,
        Parameter {
            name: "association",
            parameter_type: ParameterType::Choice(&[
                ("auto", "the point array of that name, or else the cell array"),
                ("point", "a point array"),
                ("cell", "a cell array"),
            ]),
            unit: "",
            default: DefaultValue::Text("auto"),
            help: "where the scalar is looked for",
        },
        CELL_VALUES,
        Parameter {
            name: "blocks",
            parameter_type: ParameterType::Texts,
            unit: "",
            default: DefaultValue::Unset("all"),
            help: "the blocks that are read, by their names or groups; * stands for any letters: \"fluid/*\"",
        },
        Parameter {
            name: "displacement",
            parameter_type: ParameterType::ArrayName,
            unit: "",
            default: DefaultValue::Unset("none"),
            help: "a vector at points by which they are moved, such as \"disp\": the deformed shape",
        },
        Parameter {
            name: "displacement_factor",
            parameter_type: ParameterType::Number(Range::ANY),
            unit: "",
            default: DefaultValue::Number(1.0),
            help: "how much farther points are moved than the displacement says",
        },
        Parameter {
            name: "time_step",
            parameter_type: ParameterType::IntegerOr(Range::at_least(0.0), ALL_STEPS),
            unit: "",
            default: DefaultValue::Unset("the first"),
            help: "number of the step of a time series, from 0; \"all\": `voltet run` draws each, as by --steps all",
        },
        Parameter {
            name: "time",
            parameter_type: ParameterType::Number(Range::ANY),
            unit: "as in the file",
            default: DefaultValue::Unset("time_step"),
            help: "time within a time series, in place of time_step: the nearest step is read",
        },
        Parameter {
            name: "between_steps",
            parameter_type: ParameterType::Choice(&[
                (NEAREST, "the nearest step"),
                (
                    "linear",
                    "values on a straight line from the step before to the step after, whose meshes must be equal",
                ),
            ]),
            unit: "",
            default: DefaultValue::Text(NEAREST),
            help: "what is read at a time between two steps",
        },
        Parameter {
            name: "subdivision",
            parameter_type: ParameterType::Integer(Range::within(1.0, 64.0)),
            unit: "pieces",
            default: DefaultValue::Integer(1),
            help: "pieces between neighbouring nodes of a curved cell's edge; 1 goes straight through the mid-edge nodes",
        },
        Parameter {
            name: "solution",
            parameter_type: ParameterType::InputPath,
            unit: "",
            default: DefaultValue::Unset("none"),
            help: "PLOT3D, MFEM, SU2: the solution (.q, .gf, .csv, .dat) that belongs to the grid",
        },
    ],
    example: include_str!("examples/stages.toml"),
    check: &|parameters| request(parameters, None).map(drop),
    // A source has no inputs to ask.
    demand: &|_| Ok(()),
    foresee: &|foresight| foresee(foresight, None),
    steps: &|preparation| steps(preparation, None),
    files_beside: &files_beside,
    foreign_head: &formats::foreign_head,
    prepare: &prepare,
    part_work: PartWork::Each,
    begin_parts: &|call, parts| begin_parts(call, parts, None),
    piece_bytes: &piece_bytes,
    run: &|call| run(call, None),
    ..Node::BLANK
};

/// The word for every step of a series in place of one's number.
const ALL_STEPS: &str = "all";

/// The word for the nearest step at a time between two.
const NEAREST: &str = "nearest";

/// The file that is read.
pub const PATH: Parameter = Parameter {
    name: "path",
    parameter_type: ParameterType::InputPath,
    unit: "",
    default: DefaultValue::Required,
    help: formats::FILES,
};

/// The scalar that is drawn.
pub const SCALAR: Parameter = Parameter {
    name: "scalar",
    parameter_type: ParameterType::ArrayName,
    unit: "",
    default: DefaultValue::Unset("the only array, or the one that the file marks"),
    help: "the array to draw; \"NAME:magnitude\" or \"NAME:0\" for vectors",
};

/// Conversion of cell values to point values.
pub const CELL_VALUES: Parameter = Parameter {
    name: "cell_values",
    parameter_type: ParameterType::Choice(&[
        ("average", "averaged to the points, weighted by volume"),
        ("constant", "constant in every cell, with jumps between cells"),
    ]),
    unit: "",
    default: DefaultValue::Text("average"),
    help: "what becomes of a scalar that is given per cell",
};

/// The conversion that the parameter [`CELL_VALUES`] names.
pub fn cell_values(p: &Parameters) -> Result<CellValues> {
    Ok(match p.text("cell_values")? {
        "constant" => CellValues::Constant,
        _ => CellValues::Average,
    })
}

fn prepare(preparation: &Preparation) -> Result<()> {
    refuse_missing(&preparation.path("path")?)?;
    match preparation.parameters.optional("solution") {
        Some(_) => refuse_missing(&preparation.path("solution")?),
        None => Ok(()),
    }
}

/// Reads; by the reader of a format from outside where there is one.
pub(crate) fn run(call: &mut RunContext, chosen: Option<SelectedArrays>) -> Result<Outputs> {
    let request = asked(call.parameters, call.demand, chosen, &|path| call.resolve(path))?;
    let path = call.path("path")?;
    if call.parameters.optional("time_step").is_some_and(|step| step.text().is_some()) {
        let what = "time_step = \"all\" is for `voltet run`; the first step alone is read here";
        call.notes.warnings.push(what.into());
    }
    let read = |request: &Request| formats::read(&path, request, call.progress()).map_err(with_file_named);
    let steps = step_pair(call.parameters, &path, &request)?;
    let grid = match (call.part().cloned(), steps) {
        (Some(_), Some(_)) => {
            let what = "values between steps are found of whole grids";
            let error = call.parameters.error("between_steps", what).got("a grid in parts (--memory)");
            return Err(error.expected("between_steps = \"nearest\", or a larger --memory"));
        }
        (Some(part), None) => match read_part(call, &part, &path, &request).map_err(with_file_named)? {
            Some(grid) => grid,
            None => return Ok(Vec::new()),
        },
        (None, None) => read(&request)?,
        (None, Some(StepPair { steps, share })) => {
            let at = |step: usize| Request { time_step: Some(TimeStep::Index(step)), ..request.clone() };
            let [first, second] = [read(&at(steps[0]))?, read(&at(steps[1]))?];
            let grid = interpolated(first, &second, share)
                .map_err(|error| call.parameters.locate("between_steps", error))?;
            let what = format!("between the steps {} and {}: {share:?} of the second", steps[0], steps[1]);
            call.notes.find(what, json!({ "between_steps": { "steps": steps, "share": share } }));
            grid
        }
    };
    let origin = &grid.origin;
    call.notes.warnings.extend(origin.warnings.iter().cloned());
    if !origin.arrays_unread.is_empty() {
        record_unread(&mut call.notes, &origin.arrays_unread, origin.values_unread);
    }
    if grid.tetrahedra.is_empty() {
        call.notes.record_skipped("tetrahedra", "the cells are written as they are", None);
    }
    call.notes.counts.insert("arrays_decoded", origin.arrays_decoded);
    for (name, count) in [
        ("cells_not_finite", origin.cells_not_finite),
        ("cells_ghost", origin.cells_ghost),
        ("cells_not_volume", origin.cells_not_volume),
    ] {
        if count > 0 {
            call.notes.counts.insert(name, count);
        }
    }
    Ok(vec![Value::Grid(Arc::new(grid))])
}

/// The grid of a part; none where it has no cells that are drawn.
fn read_part(call: &mut RunContext, part: &GridPart, path: &Path, request: &Request) -> Result<Option<Grid>> {
    // Finding them takes all processes, so it is not done here.
    let borders = call.keep_for_parts(|| -> Result<PieceBorders> {
        Err(Error::run("a part is read before the borders of the pieces are found"))
    })?;
    let drawn = part.pieces.iter().filter(|&&piece| borders.is_drawn(piece)).count();
    let count = drawn - borders.kept_count(&part.pieces);
    call.notes.counts.insert(PIECES_READ, count as u64);
    formats::read_part(path, request, &part.pieces, &borders, call.progress())
}

/// Finds the borders of the pieces that this process reads.
pub(crate) fn begin_parts(
    call: &mut RunContext,
    parts: &[GridPart],
    chosen: Option<SelectedArrays>,
) -> Result<()> {
    let request = asked(call.parameters, call.demand, chosen, &|path| call.resolve(path))?;
    let path = call.path("path")?;
    let own: Vec<usize> = parts.iter().flat_map(|part| &part.pieces).copied().collect();
    let share = Some((own.as_slice(), call.ranks()));
    let (layers, first) = parts.first().map_or((0, &[][..]), |part| (part.layers, &part.pieces));
    let borders = call.keep_for_parts(|| {
        formats::piece_borders(&path, &request, layers, first, share, call.progress())
            .map_err(with_file_named)
    })?;
    call.notes.counts.insert(PIECES_READ, borders.reads);
    Ok(())
}

/// Quantities that segments carry in a scene with all of them: s, g and the components of ∇s.
const LIT_ATTRIBUTES: u64 = 5;

fn piece_bytes(preparation: &Preparation) -> Result<Vec<u64>> {
    let request = request(preparation.parameters, None)?;
    let bytes = |size: GridSize| {
        // The picture is there once, whatever the parts.
        let drawing = drawing_bytes(size.tetrahedra, size.points, LIT_ATTRIBUTES, [0; 2]);
        // Cells without a volume, which become no tetrahedra, take room as they are read.
        size.reading_bytes().max(size.bytes().saturating_add(drawing))
    };
    // What is wrong with the file is said when it is read.
    let sizes = formats::piece_sizes(&preparation.path("path")?, &request).unwrap_or_default();
    Ok(sizes.into_iter().map(bytes).collect())
}

/// The steps around the time that the parameters name, where values between them are asked for.
fn step_pair(p: &Parameters, path: &Path, request: &Request) -> Result<Option<StepPair>> {
    let time =
        p.optional_number("time").filter(|_| p.text("between_steps").is_ok_and(|word| word != NEAREST));
    let Some(time) = time else { return Ok(None) };
    let (times, _) = formats::steps(path, request).map_err(with_file_named)?;
    Ok(around(&times, time))
}

/// Pieces, the files of the step, a solution that no parameter names. Mistakes are reported when it runs.
fn files_beside(preparation: &Preparation, steps: Steps) -> Vec<PathBuf> {
    let (Ok(path), Ok(mut request)) = (preparation.path("path"), request(preparation.parameters, None))
    else {
        return Vec::new();
    };
    if preparation.parameters.is_set("solution") {
        request.solution = preparation.path("solution").ok();
    }
    match steps {
        Steps::Read => match step_pair(preparation.parameters, &path, &request) {
            Ok(Some(StepPair { steps, .. })) => {
                let at = |step: usize| Request { time_step: Some(TimeStep::Index(step)), ..request.clone() };
                steps.iter().flat_map(|&step| formats::files_read_beside(&path, &at(step))).collect()
            }
            _ => formats::files_read_beside(&path, &request),
        },
        Steps::All => formats::files_beside(&path),
    }
}

/// Each step of a series by its number.
pub(crate) fn steps(preparation: &Preparation, chosen: Option<SelectedArrays>) -> Result<TimeSeries> {
    let p = preparation.parameters;
    let mut request = request(p, chosen)?;
    if p.is_set("solution") {
        request.solution = Some(preparation.path("solution")?);
    }
    // A step that is not there is said when it is read.
    let (times, own) = formats::steps(&preparation.path("path")?, &request)?;
    if times.len() < 2 {
        return Ok(TimeSeries { times, ..TimeSeries::of_one(p) });
    }
    let at = |step: usize| p.with("time", None).with("time_step", Some(ParameterValue::Integer(step as i64)));
    Ok(TimeSeries { steps: (0..times.len()).map(at).collect(), own, times })
}

/// Notes the arrays that are left out, from the headers of the file alone.
pub(crate) fn foresee(foresight: &mut PlanContext, chosen: Option<SelectedArrays>) -> Result<()> {
    let parameters = foresight.parameters;
    let request = asked(parameters, foresight.demand, chosen, &|path| foresight.resolve(path))?;
    let path = foresight.resolve(parameters.text("path")?);
    let unread = formats::unread(&path, &request).map_err(with_file_named)?;
    if !unread.arrays.is_empty() {
        record_unread(foresight.notes, &unread.arrays, unread.value_count);
    }
    Ok(())
}

/// An error that has its place in the pipeline names the data file in its text.
fn with_file_named(mut error: Error) -> Error {
    if error.location.span.is_some()
        && let Some(file) = error.location.file.take()
    {
        error.what += &format!(" ({file})");
    }
    error
}

/// Records the arrays that are not read: each number of them would become one of 64 bits.
fn record_unread(notes: &mut Diagnostics, arrays: &[String], value_count: u64) {
    let saving = (value_count > 0).then(|| SavedWork::Bytes(value_count.saturating_mul(8)));
    notes.record_skipped(format!("arrays {}", arrays.join(", ")), "nothing looks at them", saving);
}

fn asked(
    p: &Parameters,
    demand: &Demand,
    chosen: Option<SelectedArrays>,
    resolve: &dyn Fn(&str) -> PathBuf,
) -> Result<Request> {
    let mut request = request(p, chosen)?;
    request.point_arrays = demand.arrays.named.iter().cloned().collect();
    request.cell_arrays = demand.cell_arrays.named.iter().cloned().collect();
    request.origins = [&demand.arrays, &demand.cell_arrays].map(|arrays| arrays.origins.clone());
    request.without_scalar = demand.without_scalar;
    request.options.keep_cells = demand.file_cells;
    request.options.without_tetrahedra = demand.file_cells && demand.without_tetrahedra;
    request.every_array = demand.arrays.and_all_others || demand.cell_arrays.and_all_others;
    if p.is_set("solution") {
        request.solution = Some(resolve(p.text("solution")?));
    }
    if !demand.arrays.optional.is_empty() {
        let heads = formats::arrays(&resolve(p.text("path")?), &request).map_err(with_file_named)?;
        let is_there = |name: &&String| {
            let is_it = |head: &FileArray| head.association == Association::Point && head.name == **name;
            !demand.arrays.named.contains(*name) && heads.iter().any(is_it)
        };
        request.point_arrays.extend(demand.arrays.optional.iter().filter(is_there).cloned());
    }
    Ok(request)
}

pub(crate) fn request(p: &Parameters, chosen: Option<SelectedArrays>) -> Result<Request> {
    let association = match p.text("association")? {
        "point" => Some(Association::Point),
        "cell" => Some(Association::Cell),
        _ => None,
    };
    let cell_values = cell_values(p)?;
    let time_step = match (p.is_set("time_step"), p.optional_number("time")) {
        (true, Some(_)) => {
            return Err(p.error("time", "'time' and 'time_step' exclude each other").expected("one of them"));
        }
        (true, None) if p.get("time_step")?.text().is_some() => None,
        (true, None) => Some(TimeStep::Index(p.integer("time_step")? as usize)),
        (false, time) => time.map(TimeStep::Time),
    };
    let blocks = blocks(p)?;
    let factor = p.number("displacement_factor")?;
    let displacement = p.optional("displacement").and_then(|name| name.text());
    if p.is_set("displacement_factor") && displacement.is_none() {
        let error = p.error("displacement_factor", "there is no displacement that is multiplied");
        return Err(error.expected("displacement = \"NAME\""));
    }
    let displacement = displacement.map(|name| (name.to_string(), factor));
    let scalar = p.optional("scalar").and_then(|s| s.text()).map(str::to_string);
    let subdivision = p.integer("subdivision")? as u32;
    let options = Options { cell_values, subdivision, ..Options::default() };
    Ok(Request {
        scalar,
        association,
        blocks,
        displacement,
        options,
        time_step,
        chosen,
        ..Request::default()
    })
}

/// The names of blocks that the parameter `blocks` holds; none where it is not set.
pub(crate) fn blocks(p: &Parameters) -> Result<Vec<String>> {
    if !p.is_set("blocks") {
        return Ok(Vec::new());
    }
    match p.texts("blocks")? {
        none if none.is_empty() => {
            Err(p.error("blocks", "there are no blocks").got("[]").expected("at least one name"))
        }
        names => Ok(names),
    }
}

/// Finds out before any work whether the file is there, and which name was meant if not.
pub(crate) fn refuse_missing(path: &Path) -> Result<()> {
    let Err(error) = std::fs::File::open(path) else { return Ok(()) };
    let expected = format!("{} (paths are relative to the pipeline file)", existing_file(path));
    Err(Error::run("the data file cannot be opened").got(error).expected(expected).in_file(path))
}
