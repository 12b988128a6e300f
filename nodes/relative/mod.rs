//! Numbers relative to data: the widgets of a transfer function before and after the data are known, what the numbers became in words
//! and figures, and the statistics that they refer to: ranges and percentiles of one volume, or of steps of a time series.

mod places;
mod several;
mod statistics;

pub use places::placed;
pub(crate) use places::{MIDDLE, NORMAL, ORIGIN, POSITION, RADIUS, SpatialRegion};
pub(crate) use several::VolumeView;
pub use statistics::values;
pub(crate) use statistics::volumes;

use several::{GridParts, PART_ROUNDS, SERIES_ROUNDS, SeriesSteps, measure_several};
use statistics::{FoundStatistics, measure};

use glam::DVec3;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};
use voltet_core::grid::extent;
use voltet_core::transfer::{
    AxisScale, DataStatistics, StatisticsRequest, on_axes, resolved, statistics_request, with_placeholders,
};
use voltet_core::{Error, Result, counted};
use voltet_graph::{
    ArrayRef, DefaultValue, Demand, DemandContext, Diagnostics, Parameter, ParameterType, ParameterValue,
    Parameters, RunContext, diagonal,
};

/// Data that relative numbers refer to.
pub const RELATIVE_TO: Parameter = Parameter {
    name: "relative_to",
    parameter_type: ParameterType::Choice(&[
        ("step", "the volume that is wired in"),
        ("sample", "up to 8 steps of its time series together, evenly spread from the first to the last"),
        ("series", "all steps of its time series together, read one after the other"),
    ]),
    unit: "",
    default: DefaultValue::Text("step"),
    help: "what percentages are shares of the range of, and percentiles of the volume of",
};

/// Most steps of a sample of a series.
const SAMPLE_COUNT: usize = 8;

/// Data that relative numbers refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DataScope {
    /// The volume at the input.
    #[default]
    Step,
    /// Some steps of its time series.
    Sample,
    /// All steps of its time series.
    Series,
}

impl DataScope {
    /// The scope that the parameter [`RELATIVE_TO`] names.
    ///
    /// # Errors
    /// - a node without the parameter.
    pub fn from_parameters(p: &Parameters) -> Result<DataScope> {
        p.text(RELATIVE_TO.name).map(DataScope::from_word)
    }

    /// The scope by its name as a value of [`RELATIVE_TO`]; that of one step by any other word.
    pub fn from_word(word: &str) -> DataScope {
        match word {
            "sample" => DataScope::Sample,
            "series" => DataScope::Series,
            _ => DataScope::Step,
        }
    }

    /// Refuses steps of a series, for a grid in parts.
    ///
    /// # Errors
    /// - a scope of several steps.
    pub fn refuse_series(self, p: &Parameters) -> Result<()> {
        if self == DataScope::Step {
            return Ok(());
        }
        let error = p.error(RELATIVE_TO.name, "steps of a series are looked at as whole grids");
        let error = error.got("a grid in parts (--memory)");
        Err(error.expected("relative_to = \"step\", numbers that are not relative, or a larger --memory"))
    }

    /// Numbers of the steps, of a series of so many; `None`: that of the input alone.
    pub fn steps(self, count: usize) -> Option<Vec<usize>> {
        match self {
            DataScope::Step => None,
            DataScope::Sample if count > SAMPLE_COUNT => {
                let last = SAMPLE_COUNT - 1;
                Some((0..=last).map(|i| (i * (count - 1) + last / 2) / last).collect())
            }
            DataScope::Sample | DataScope::Series => Some((0..count).collect()),
        }
    }

    /// "over the volume", or "over 8 of 365 time steps".
    pub(crate) fn phrase(self, call: &RunContext) -> Result<String> {
        if self == DataScope::Step {
            return Ok("over the volume".to_string());
        }
        let count = call.step_count("volume")?;
        let own = self.steps(count).map_or(count, |steps| steps.len());
        Ok(match own == count {
            true => format!("over {}", counted(count, "time step")),
            false => format!("over {own} of {}", counted(count, "time step")),
        })
    }
}

/// Steps that a node with the parameter [`RELATIVE_TO`] looks at beside the one that is read ([`voltet_graph::Node::other_steps`]).
pub(crate) fn other_steps(p: &Parameters, count: usize) -> Vec<usize> {
    DataScope::from_parameters(p).ok().and_then(|scope| scope.steps(count)).unwrap_or_default()
}

/// Bounds of the data at the input `volume`, or of all steps of their series that count.
pub(crate) fn bounds(call: &mut RunContext) -> Result<Option<[DVec3; 2]>> {
    let scope = DataScope::from_parameters(call.parameters)?;
    if call.is_in_parts() {
        scope.refuse_series(call.parameters)?;
        return bounds_of_parts(call);
    }
    let Some(steps) = scope.steps(call.step_count("volume")?) else {
        return Ok(call.volume("volume")?.grid.bounds());
    };
    let demand = Demand::default();
    let kept = call.keep_over_steps("volume", &demand, || Ok(KeptBounds::default()))?;
    let mut kept = kept.0.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(SeriesBounds(_, bounds)) = kept.iter().find(|SeriesBounds(of, _)| *of == steps) {
        return Ok(*bounds);
    }
    let mut bounds: Option<[DVec3; 2]> = None;
    call.each_step("volume", &demand, Some(&steps), &mut |_, value| {
        let Some(volume) = value.volume().transpose()? else { return Ok(()) };
        bounds = extent::joined(bounds, volume.grid.bounds());
        Ok(())
    })?;
    kept.push(SeriesBounds(steps, bounds));
    Ok(bounds)
}

fn bounds_of_parts(call: &mut RunContext) -> Result<Option<[DVec3; 2]>> {
    let swept = call.swept_parts("volume")?;
    let mut bounds = swept.and_then(|swept| swept.bounds);
    if swept.is_none() {
        call.each_part(&mut |call| {
            bounds = extent::joined(bounds, call.volume("volume")?.grid.bounds());
            Ok(())
        })?;
    }
    let own = bounds.map_or(Vec::new(), |bounds| bounds.map(|place| place.to_array()).concat());
    let of_all = call.gather(&own)?;
    let bounds_of = |own: &Vec<f64>| Some([own.get(..3)?, own.get(3..)?].map(DVec3::from_slice));
    Ok(of_all.iter().map(bounds_of).fold(None, extent::joined))
}

/// Bounds of some steps of a series, which a session keeps.
#[derive(Default)]
struct KeptBounds(Mutex<Vec<SeriesBounds>>);

/// Numbers of steps, and the bounds of their data.
struct SeriesBounds(Vec<usize>, Option<[DVec3; 2]>);

/// Diagonal of the bounds of the steps that a node's numbers are relative to, for unit distances: noted, and `None` where they are
/// relative to the volume at its input alone, or nothing is wired in.
pub(crate) fn series_diagonal(call: &mut RunContext) -> Result<Option<f64>> {
    let scope = DataScope::from_parameters(call.parameters)?;
    if scope == DataScope::Step || !call.is_wired("volume")? {
        return Ok(None);
    }
    let diagonal = diagonal(bounds(call)?);
    let (unit, over) = (diagonal / 100.0, scope.phrase(call)?);
    let figures = json!({ "unit_distance": { "over": over, "length": unit } });
    call.notes.find(format!("unit_distance = {unit:?} ({over})"), figures);
    Ok(Some(diagonal))
}

/// Widgets: their kinds and keys.
pub(crate) type Widgets = Vec<(&'static str, Parameters)>;

/// The widgets at their positions on the axes, before any data are known.
pub(crate) fn stood_in(p: &Parameters, axes: &[AxisScale; 2]) -> Result<Widgets> {
    let widget = |(kind, keys): (_, Parameters)| Ok((kind, with_placeholders(&on_axes(keys, axes)?)?));
    p.kinds("widgets")?.into_iter().map(widget).collect()
}

/// Statistics that the widgets' numbers refer to.
fn wanted_of(widgets: &Widgets) -> StatisticsRequest {
    let mut all = StatisticsRequest::default();
    for (_, keys) in widgets {
        let StatisticsRequest { ranges, percentiles } = statistics_request(keys);
        all.ranges.extend(ranges);
        for (quantity, percents) in percentiles {
            all.percentiles.entry(quantity).or_default().extend(percents);
        }
    }
    all
}

/// Demand for the data that the widgets' numbers are relative to.
pub(crate) fn ask(asking: &mut DemandContext) -> Result<()> {
    let widgets = asking.parameters.kinds("widgets")?;
    let request = wanted_of(&widgets);
    if request.is_empty() {
        return Ok(());
    }
    if asking.fed_by("volume")?.is_none() {
        return Err(unwired(&widgets));
    }
    let of_step = DataScope::from_parameters(asking.parameters)? == DataScope::Step;
    asking.ask("volume", &if of_step { demand(&request) } else { Demand::default() })
}

/// Demand for the steps that a node looks at by itself, where its numbers are relative to a series.
pub(crate) fn ask_for_series(asking: &mut DemandContext) -> Result<()> {
    let of_step = DataScope::from_parameters(asking.parameters)? == DataScope::Step;
    if of_step || asking.fed_by("volume")?.is_none() {
        return Ok(());
    }
    asking.ask("volume", &Demand::default())
}

/// The error where nothing is wired in that numbers could be relative to.
fn unwired(widgets: &Widgets) -> Error {
    let error = Error::usage("a number is relative to data, and no data are wired in");
    let error = error.needs_input("volume", " at the transfer-function, or a number");
    match widgets.iter().flat_map(|(_, keys)| keys.relative_numbers()).next() {
        Some(number) => number.locate(error.got(&number.setting.datum)),
        None => error,
    }
}

/// The widgets at their positions on the axes, with numbers for those that were relative to data, each noted.
pub(crate) fn known(call: &mut RunContext, axes: &[AxisScale; 2]) -> Result<Widgets> {
    let placed = |(kind, keys): (_, Parameters)| Ok((kind, on_axes(keys, axes)?));
    known_values(call, axes)?.into_iter().map(placed).collect()
}

/// The widgets with numbers for those that were relative to data.
fn known_values(call: &mut RunContext, axes: &[AxisScale; 2]) -> Result<Widgets> {
    let widgets = call.parameters.kinds("widgets")?;
    let request = wanted_of(&widgets);
    if request.is_empty() {
        return Ok(widgets);
    }
    if !call.is_wired("volume")? {
        return Err(unwired(&widgets));
    }
    let scope = DataScope::from_parameters(call.parameters)?;
    let found = FoundStatistics { axes: *axes, ..found(call, &request, scope)? };
    let over = scope.phrase(call)?;
    found.note(&mut call.notes, &over);
    let mut known = Vec::new();
    for (number, (kind, keys)) in widgets.into_iter().enumerate() {
        let own = resolved(&keys, &found)?;
        if own != keys {
            note_numbers(&mut call.notes, &format!("widget {number} ({kind})"), &over, &keys, &own);
        }
        known.push((kind, own));
    }
    Ok(known)
}

fn json_of(datum: &ParameterValue) -> Value {
    match datum {
        ParameterValue::Boolean(flag) => json!(flag),
        ParameterValue::Integer(number) => json!(number),
        ParameterValue::Number(number) => json!(number),
        ParameterValue::Text(text) => json!(text),
        ParameterValue::List(list) => list.iter().map(|part| json_of(&part.datum)).collect(),
        ParameterValue::Table(fields) => {
            let fields = fields.iter().map(|field| (field.name.clone(), json_of(&field.setting.datum)));
            Value::Object(fields.collect())
        }
    }
}

/// Notes what the relative numbers of a thing ("widget 0 (gaussian)") became, as a file could hold them now:
/// "centre = [60.8, 0.012], sigma = [0.35, 0.025]". `over`: of what.
pub(crate) fn note_numbers(
    notes: &mut Diagnostics,
    thing: &str,
    over: &str,
    before: &Parameters,
    after: &Parameters,
) {
    let changed = before.iter().zip(after.iter()).filter(|((_, old, _), (_, new, _))| old != new);
    let changed: Vec<(&str, &ParameterValue)> =
        changed.filter_map(|(_, (parameter, new, _))| Some((parameter.name, &new?.datum))).collect();
    let shown: Vec<String> = changed.iter().map(|(name, datum)| format!("{name} = {datum}")).collect();
    let numbers = changed.into_iter().map(|(name, datum)| (name.to_string(), json_of(datum)));
    let numbers: Map<String, Value> = numbers.collect();
    let figures = json!({ "relative": { "of": thing, "over": over, "numbers": numbers }});
    notes.find(format!("{thing}: {} ({over})", shown.join(", ")), figures);
}

/// The parameters of a node with numbers for those relative to values of these quantities over the steps of a series, which are noted.
/// `quantity`: that of a name in the parameters; `view`: the volume whose points have its values; places stay relative.
pub(crate) fn known_of_series(
    call: &mut RunContext,
    p: &Parameters,
    scope: DataScope,
    demand: &Demand,
    quantity: &dyn Fn(&ArrayRef) -> Option<ArrayRef>,
    view: &VolumeView,
) -> Result<SeriesStatistics> {
    let StatisticsRequest { ranges, percentiles } = statistics_request(p);
    let mut request = StatisticsRequest::default();
    request.ranges.extend(ranges.iter().filter_map(quantity));
    for (named, percents) in percentiles {
        if let Some(own) = quantity(&named) {
            request.percentiles.entry(own).or_default().extend(percents);
        }
    }
    let found = found_in(call, &request, scope, demand, view)?;
    Ok(SeriesStatistics { found, over: scope.phrase(call)? })
}

/// Statistics over steps of a series, with the words for these.
pub(crate) struct SeriesStatistics {
    found: FoundStatistics,
    pub over: String,
}

impl SeriesStatistics {
    /// The statistics by quantity.
    pub fn statistics(&self) -> &dyn DataStatistics {
        &self.found
    }
}

/// Statistics of the volume at the input `volume`, or of steps of the time series that feeds it, of which one is read at a time.
/// Statistics of former runs are not computed again.
fn found(call: &mut RunContext, wanted: &StatisticsRequest, scope: DataScope) -> Result<FoundStatistics> {
    found_in(call, wanted, scope, &demand(wanted), &|_| Ok(None))
}

/// Statistics over some steps of a series; a type of its own, under which a session keeps them.
#[derive(Default)]
struct SampleStatistics(Mutex<FoundStatistics>);

fn found_in(
    call: &mut RunContext,
    wanted: &StatisticsRequest,
    scope: DataScope,
    demand: &Demand,
    view: &VolumeView,
) -> Result<FoundStatistics> {
    if call.is_in_parts() {
        scope.refuse_series(call.parameters)?;
    }
    let (of_sample, of_all);
    let kept: &Mutex<FoundStatistics> = match scope {
        DataScope::Sample => {
            of_sample = call.keep_over_steps("volume", demand, || Ok(SampleStatistics::default()))?;
            &of_sample.0
        }
        DataScope::Series => {
            of_all = call.keep_over_steps("volume", demand, || Ok(Mutex::default()))?;
            &of_all
        }
        DataScope::Step => {
            of_all = call.keep(call.revision("volume")?, || Ok(Mutex::default()))?;
            &of_all
        }
    };
    let mut known = kept.lock().unwrap_or_else(PoisonError::into_inner);
    let missing = known.missing(wanted);
    let steps = match scope {
        DataScope::Step => None,
        _ => scope.steps(call.step_count("volume")?),
    };
    let new = if call.is_in_parts() {
        measure_several(&missing, PART_ROUNDS, &mut GridParts(call))?
    } else if let Some(steps) = steps {
        let mut series = SeriesSteps { call, demand, steps: &steps, view, read: 0 };
        let new = measure_several(&missing, SERIES_ROUNDS, &mut series)?;
        let read = series.read;
        call.notes.counts.insert("steps_read", read);
        new
    } else {
        let volume = call.volume("volume")?;
        call.stage("range", |progress| measure(&volume, &missing, progress))?
    };
    known.ranges.extend(new.ranges);
    known.percentiles.extend(new.percentiles);
    let computed: usize = missing.percentiles.values().map(BTreeSet::len).sum();
    call.notes.counts.insert("percentiles_computed", computed as u64);
    Ok(known.clone())
}

fn demand(wanted: &StatisticsRequest) -> Demand {
    demand_for(wanted.quantities())
}

pub(crate) fn demand_for<'a>(quantities: impl IntoIterator<Item = &'a ArrayRef>) -> Demand {
    let mut demand = Demand::default();
    for quantity in quantities {
        match quantity {
            ArrayRef::Array(name) => demand.arrays.named.extend([name.clone()]),
            ArrayRef::Named("g") => demand.gradient_magnitude = true,
            ArrayRef::Named(_) | ArrayRef::Per(..) => {}
        }
    }
    demand
}
