//! `threshold`: the cells in which an array has some of its values, that lie in a part of space, or that are of some blocks.

use crate::drawing::{CLIP, INVERT, check_clips, clips};
use crate::reader::blocks;
use crate::relative::{self, DataScope, RELATIVE_TO, demand_for, known_of_series, note_numbers, placed};
use crate::surfacing::{self, QUANTITY, VolumeStatistics, quantity, range_message};
use std::collections::BTreeSet;
use std::sync::Arc;
use voltet_core::grid::{
    Array, CellValues, Grid, Subset, add_from_cells, cells_above, cells_by_points, whole_cells,
};
use voltet_core::parameters::suggest;
use voltet_core::transfer::{resolved, with_placeholders};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, counted};
use voltet_graph::{
    ArrayRef, AxisRef, DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType,
    Parameters, PartWork, Port, PortType, Range, RelativeNumberType, RunContext, StatisticKind, Value,
};
use voltet_io::formats::{BLOCK, blocks_named};

pub const NODE: Node = Node {
    name: "threshold",
    summary: "Keeps the cells in which an array has values of a range or a list, or those of a part of space or of blocks.",
    inputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" }],
    outputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the cells that are kept" }],
    parameters: &[
        Parameter {
            help: "the array: \"s\", the scalar; \"g\", its gradient magnitude; a point array, or a cell array",
            ..QUANTITY
        },
        Parameter {
            name: "association",
            parameter_type: ParameterType::Choice(&[
                ("point", "a point array, s or g: a cell has several values"),
                ("cell", "a cell array: a cell of the file has one value"),
            ]),
            unit: "",
            default: DefaultValue::Text("point"),
            help: "where the array is",
        },
        Parameter {
            name: "range",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Numbers(Some(2), Range::ANY_OR_INFINITE),
                statistic: StatisticKind::Value,
                axis: AxisRef::Every("array"),
            }),
            unit: "units of array",
            default: DefaultValue::Unset("values, clip or blocks"),
            help: "lowest and highest value that is kept; -inf or inf: no limit there",
        },
        Parameter {
            name: "values",
            parameter_type: ParameterType::Numbers(None, Range::ANY),
            unit: "units of array",
            default: DefaultValue::Unset("range, clip or blocks"),
            help: "the values that are kept, such as numbers of materials",
        },
        Parameter {
            default: DefaultValue::Unset("range, values or blocks"),
            help: "the parts of space in all of which points count; cells stay whole (crinkled)",
            ..CLIP
        },
        Parameter {
            name: "blocks",
            parameter_type: ParameterType::Texts,
            unit: "",
            default: DefaultValue::Unset("range, values or clip"),
            help: "the blocks of the file that are kept, by their names or groups; * stands for any letters",
        },
        Parameter {
            name: "keep",
            parameter_type: ParameterType::Choice(&[
                ("all", "cells of the file of which all points count"),
                ("any", "cells of the file of which any point counts"),
            ]),
            unit: "",
            default: DefaultValue::Text("all"),
            help: "which cells are kept by values or places of their points",
        },
        Parameter {
            name: "smooth",
            parameter_type: ParameterType::Boolean,
            unit: "",
            default: DefaultValue::Boolean(false),
            help: "true: cells are cut where the array has the ends of the range, exactly; false: cells stay whole",
        },
        Parameter { help: "keeps the rest", ..INVERT },
        RELATIVE_TO,
    ],
    example: include_str!("examples/threshold.toml"),
    check: &|p| {
        check_clips(p)?;
        Condition::new(&with_placeholders(p)?).map(drop)
    },
    demand: &demand,
    part_work: PartWork::Each,
    drops_cells: true,
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

enum Condition {
    Range([f64; 2]),
    Values(Vec<f64>),
    /// Parts of space that the parameter `clip` states.
    Space,
    Blocks(Vec<String>),
}

impl Condition {
    fn new(p: &Parameters) -> Result<Condition> {
        const CONDITIONS: [&str; 4] = ["range", "values", "clip", "blocks"];
        let given: Vec<&str> = CONDITIONS.into_iter().filter(|name| p.is_set(name)).collect();
        let [given] = given[..] else {
            let error = match given.first() {
                None => p.error("range", "the threshold has no condition"),
                Some(name) => p.error(name, "the threshold has several conditions").got(given.join(", ")),
            };
            return Err(error.expected("one of range, values, clip and blocks; a node each for several"));
        };
        let refused = |name: &str, why: &str, expected: &str| Err(p.error(name, why).expected(expected));
        let (by_cells, smooth) = (p.text("association")? == "cell", p.flag("smooth")?);
        match given {
            "blocks" => {
                let others = ["array", "association", "keep", "smooth"];
                match others.into_iter().find(|name| p.is_set(name)) {
                    Some(other) => {
                        return refused(other, "'blocks' looks at names of blocks", "no such parameter");
                    }
                    None => return Ok(Condition::Blocks(blocks(p)?)),
                }
            }
            "clip" if p.is_set("array") => {
                return refused("array", "'clip' looks at no array", "range or values");
            }
            "clip" if by_cells => return refused("association", "'clip' looks at points", "range or values"),
            "clip" if smooth => {
                return refused(
                    "smooth",
                    "'clip' keeps whole cells",
                    "the clip of a renderer, which cuts exactly",
                );
            }
            "values" if smooth => return refused("smooth", "'values' keep whole cells", "range"),
            _ if by_cells && smooth => {
                return refused(
                    "smooth",
                    "a cell has one value, so no cell is cut",
                    "association = \"point\"",
                );
            }
            _ if by_cells && p.is_set("keep") => {
                return refused("keep", "a cell has one value", "no 'keep', or association = \"point\"");
            }
            _ if by_cells && !p.is_set("array") => {
                return refused("association", "the cell array is not named", "array = \"NAME\"");
            }
            _ if smooth && p.is_set("keep") => {
                return refused(
                    "keep",
                    "cells are cut, and none is kept whole",
                    "no 'keep', or smooth = false",
                );
            }
            _ => {}
        }
        Ok(match given {
            "clip" => Condition::Space,
            "values" => Condition::Values(values(p)?),
            _ => Condition::Range(range(p, smooth && p.flag("invert")?)?),
        })
    }

    /// True if a value is one of those that count; a value that is no number never is.
    fn holds(&self, value: f64) -> bool {
        match self {
            Condition::Range([low, high]) => (*low..=*high).contains(&value),
            Condition::Values(values) => values.contains(&value),
            Condition::Space | Condition::Blocks(_) => false,
        }
    }
}

fn values(p: &Parameters) -> Result<Vec<f64>> {
    match p.numbers("values")? {
        none if none.is_empty() => {
            Err(p.error("values", "there are no values").got("[]").expected("at least one"))
        }
        values => Ok(values),
    }
}

/// The range. `must_part`: its ends must differ.
fn range(p: &Parameters, must_part: bool) -> Result<[f64; 2]> {
    let [low, high] = p.vector("range")?;
    if low < high || (low == high && !must_part) {
        return Ok([low, high]);
    }
    let error = p.error("range", "the range is empty").got(format!("[{low:?}, {high:?}]"));
    Err(error.expected("the smaller number first; invert = true keeps what is outside"))
}

fn demand(asking: &mut DemandContext) -> Result<()> {
    let p = asking.parameters;
    let mut demand = asking.asked.clone();
    // Cells that are left out, or cut, are none of the file's.
    (demand.file_cells, demand.without_scalar) = (false, false);
    if p.is_set("blocks") {
        demand.cell_arrays.request(BLOCK, p.get("blocks")?.origin.clone());
    } else if !p.is_set("clip") {
        let array = p.get("array")?;
        let name = p.text("array")?;
        match (p.text("association")?, quantity(name)) {
            ("cell", _) => demand.cell_arrays.request(name, array.origin.clone()),
            (_, ArrayRef::Array(name)) => demand.arrays.request(&name, array.origin.clone()),
            (_, quantity) => demand.join(&demand_for([&quantity])),
        }
    }
    asking.ask("volume", &demand)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let own = known(call, &volume)?;
    let condition = Condition::new(&own)?;
    let kept = match condition {
        Condition::Range(range) if p.flag("smooth")? => cut(call, &volume, range)?,
        condition => whole(call, &own, volume.clone(), &condition)?,
    };
    if kept.grid.tetrahedra.is_empty() && call.part().is_some() {
        return Ok(Vec::new());
    }
    if kept.grid.tetrahedra.is_empty() {
        return Err(nothing_kept(&own, &volume)?);
    }
    call.notes.counts.insert("cells_selected", kept.grid.tetrahedra.len() as u64);
    Ok(vec![Value::Volume(kept)])
}

/// The parameters with numbers for those relative to the array, or to the bounds of the volume.
fn known(call: &mut RunContext, volume: &Volume) -> Result<Parameters> {
    let p = call.parameters;
    if p.relative_numbers().is_empty() {
        return Ok(p.clone());
    }
    if p.is_set("clip") {
        let own = placed(p, volume.grid.bounds())?;
        note_numbers(&mut call.notes, "threshold", "over the bounds", p, &own);
        return Ok(own);
    }
    let array = p.text("array")?;
    let is_of_cells = p.text("association")? == "cell";
    let view = |volume: &Volume| is_of_cells.then(|| cells_as_points(p, volume)).transpose();
    let scope = DataScope::from_parameters(p)?;
    let (own, over) = match scope {
        DataScope::Step => {
            let own = call.stage("range", |progress| {
                let cells = view(volume)?;
                let volume = cells.as_ref().unwrap_or(volume);
                resolved(
                    p,
                    &VolumeStatistics { volume, array, color_by: None, progress, series: None, bounds: None },
                )
            })?;
            (own, "over the data".to_string())
        }
        _ => {
            let asked = match is_of_cells {
                true => {
                    Demand { cell_arrays: [array.to_string()].into_iter().collect(), ..Demand::default() }
                }
                false => demand_for(&[quantity(array)]),
            };
            let of_name = |named: &ArrayRef| (*named == ArrayRef::Named("array")).then(|| quantity(array));
            let found = known_of_series(call, p, scope, &asked, &of_name, &view)?;
            let (progress, series) = (call.progress(), Some(found.statistics()));
            let own = resolved(
                p,
                &VolumeStatistics { volume, array, color_by: None, progress, series, bounds: None },
            )?;
            (own, found.over)
        }
    };
    note_numbers(&mut call.notes, "threshold", &over, p, &own);
    Ok(own)
}

/// The volume in which each cell has points of its own, at which the array has the value of the cell.
fn cells_as_points(p: &Parameters, volume: &Volume) -> Result<Volume> {
    let mut grid = Grid { point_arrays: Default::default(), ..Grid::clone(&volume.grid) };
    let values = cell_array(p, &volume.grid)?.clone();
    add_from_cells(&mut grid, p.text("array")?, values, CellValues::Constant)?;
    Ok(Volume { grid: Arc::new(grid), gradient: None, gradient_magnitude: None, ..volume.clone() })
}

fn point_values<'a>(p: &Parameters, volume: &'a Volume) -> Result<&'a [f64]> {
    let name = p.text("array")?;
    if volume.grid.origin.arrays_of_cells.iter().any(|own| own == name) {
        let error = p.error("array", format!("'{name}' is an array of cells"));
        return Err(error.expected("association = \"cell\""));
    }
    surfacing::values(p, "array", volume, name)
}

fn cell_array<'a>(p: &Parameters, grid: &'a Grid) -> Result<&'a Array> {
    let name = p.text("array")?;
    let scalars = || grid.cell_arrays.iter().filter(|(_, array)| array.component_count == 1);
    match grid.cell_arrays.get(name) {
        Some(array) if array.component_count == 1 => Ok(array),
        Some(array) => Err(p
            .error("array", format!("'{name}' has several numbers a cell"))
            .got(counted(array.component_count, "component"))
            .expected(format!("'{name}:magnitude', or '{name}:0' for a component"))),
        None => {
            let known = suggest(name, scalars().map(|(name, _)| name.as_str()));
            Err(p.error("array", format!("there is no cell array '{name}'")).expected(known))
        }
    }
}

/// For each block of the file: true if the condition names it.
fn named_blocks(p: &Parameters, grid: &Grid, names: &[String]) -> Result<Vec<bool>> {
    blocks_named(&grid.origin.blocks, names).map_err(|error| p.locate("blocks", error))
}

fn block_numbers<'a>(p: &Parameters, grid: &'a Grid) -> Result<&'a [f64]> {
    let none =
        || p.error("blocks", "the data have no blocks").expected("a file with blocks, or no names of blocks");
    grid.cell_arrays.get(BLOCK).map(|array| &array.values[..]).ok_or_else(none)
}

/// The whole cells that the condition keeps; the volume itself where these are all.
fn whole(
    call: &mut RunContext,
    p: &Parameters,
    volume: Arc<Volume>,
    condition: &Condition,
) -> Result<Arc<Volume>> {
    let grid = &volume.grid;
    let (is_all, invert) = (p.text("keep")? == "all", p.flag("invert")?);
    let mut is_kept = match condition {
        Condition::Space => {
            let clips = clips(p)?;
            let holds = |p: u32| clips.iter().all(|clip| clip.keeps(grid.points[p as usize]));
            cells_by_points(grid, is_all, holds)
        }
        Condition::Blocks(names) => {
            let (is_named, numbers) = (named_blocks(p, grid, names)?, block_numbers(p, grid)?);
            let is_named = |cell: usize| is_named.get(numbers[cell] as usize) == Some(&true);
            (0..grid.tetrahedra.len()).map(|i| is_named(grid.source_cell(i))).collect()
        }
        _ if p.text("association")? == "cell" => {
            let values = &cell_array(p, grid)?.values;
            (0..grid.tetrahedra.len()).map(|i| condition.holds(values[grid.source_cell(i)])).collect()
        }
        _ => {
            let values = point_values(p, &volume)?;
            cells_by_points(grid, is_all, |p| condition.holds(values[p as usize]))
        }
    };
    is_kept.iter_mut().for_each(|kept| *kept ^= invert);
    leave_out_missing(call, &volume, &mut is_kept)?;
    note_missing_values(call, &volume, condition)?;
    if is_kept.iter().all(|&kept| kept) {
        return Ok(volume);
    }
    let subset = call.stage("threshold", |progress| whole_cells(&volume.grid, |i| is_kept[i], progress))?;
    Ok(Arc::new(volume.subset(&subset)))
}

/// Leaves out the cells whose value is no number, which an inverted condition would keep, and says how many.
fn leave_out_missing(call: &mut RunContext, volume: &Volume, is_kept: &mut [bool]) -> Result<()> {
    let (p, grid) = (call.parameters, &volume.grid);
    if p.is_set("clip") || p.is_set("blocks") || p.text("association")? == "point" {
        return Ok(());
    }
    let (name, values) = (p.text("array")?, &cell_array(p, grid)?.values);
    let mut missing = BTreeSet::new();
    for (i, kept) in is_kept.iter_mut().enumerate() {
        let cell = grid.source_cell(i);
        if values[cell].is_nan() {
            *kept = false;
            missing.insert(cell);
        }
    }
    if !missing.is_empty() {
        let cells = counted(missing.len(), "cell");
        call.notes.warnings.push(format!("{cells} left out, whose '{name}' is nan"));
    }
    Ok(())
}

/// Most values that a message lists.
const MAX_LISTED: usize = 12;

/// Says which of the listed values no point or cell has, and which there are.
fn note_missing_values(call: &mut RunContext, volume: &Volume, condition: &Condition) -> Result<()> {
    // Other parts may have them.
    let Condition::Values(wanted) = condition else { return Ok(()) };
    if call.part().is_some() {
        return Ok(());
    }
    let (p, grid) = (call.parameters, &volume.grid);
    let mut known: Vec<f64> = match p.text("association")? {
        "cell" => {
            let values = &cell_array(p, grid)?.values;
            (0..grid.tetrahedra.len()).map(|i| values[grid.source_cell(i)]).collect()
        }
        _ => point_values(p, volume)?.to_vec(),
    };
    known.sort_unstable_by(f64::total_cmp);
    known.dedup();
    let missing: Vec<String> =
        wanted.iter().filter(|value| !known.contains(value)).map(|value| format!("{value:?}")).collect();
    if !missing.is_empty() {
        let mut listed: Vec<String> =
            known.iter().take(MAX_LISTED).map(|value| format!("{value:?}")).collect();
        if known.len() > MAX_LISTED {
            listed.push(format!("… ({} values)", known.len()));
        }
        let (name, missing, listed) = (p.text("array")?, missing.join(", "), listed.join(", "));
        call.notes.warnings.push(format!("'{name}' is nowhere {missing}; it is {listed}"));
    }
    Ok(())
}

/// The cells cut at the ends of a range.
fn cut(call: &mut RunContext, volume: &Arc<Volume>, [low, high]: [f64; 2]) -> Result<Arc<Volume>> {
    let p = call.parameters;
    let field = point_values(p, volume)?;
    let turned = |field: &[f64]| field.iter().map(|value| -value).collect::<Vec<_>>();
    let (is_low, is_high) = (field.iter().any(|f| *f < low), field.iter().any(|f| *f > high));
    call.stage("threshold", |progress| {
        if p.flag("invert")? {
            let mut rest = Subset::default();
            if is_low {
                rest.append(cells_above(&volume.grid, &turned(field), -low, progress)?);
            }
            if is_high {
                rest.append(cells_above(&volume.grid, field, high, progress)?);
            }
            return Ok(Arc::new(volume.subset(&rest)));
        }
        let mut kept = volume.clone();
        if is_low {
            kept = Arc::new(kept.subset(&cells_above(&kept.grid, field, low, progress)?));
        }
        if is_high {
            let turned = turned(point_values(p, &kept)?);
            kept = Arc::new(kept.subset(&cells_above(&kept.grid, &turned, -high, progress)?));
        }
        Ok(kept)
    })
}

/// The error where no cell is kept, with the values that there are.
fn nothing_kept(p: &Parameters, volume: &Volume) -> Result<Error> {
    let name = p.text("array")?;
    let (place, found) = match Condition::new(p)? {
        Condition::Space => ("clip", "no cell has its points there".into()),
        Condition::Blocks(_) => ("blocks", "no cell is of these blocks".into()),
        condition => {
            let values: &[f64] = match p.text("association")? {
                "cell" => &cell_array(p, &volume.grid)?.values,
                _ => point_values(p, volume)?,
            };
            let place = if matches!(condition, Condition::Range(_)) { "range" } else { "values" };
            (place, range_message(name, values))
        }
    };
    let error = Error::run("no cell is kept").got(found).expected("a condition that some cells fulfil");
    Ok(p.locate(place, error))
}
