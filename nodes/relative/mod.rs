//! Numbers relative to data: the widgets of a transfer function before and after the data are known, what the numbers became in words
//! and figures, and the statistics that they refer to: ranges and percentiles of one volume, or of steps of a time series.
//!
//! Of a series each step's own percentile is exact, and that of all steps together lies between the least and the largest of these. In
//! that interval the volumes below [`EDGES`] values are summed over all steps (which reads them a second time), and the percentile
//! is found between two of them by a straight line: off by a 4,096th of the interval at most.

use glam::DVec3;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};
use voltet_core::probing::{Volumes, value_range};
use voltet_core::progress::Progress;
use voltet_core::transfer::{
    AxisScale, DataStatistics, StatisticsRequest, on_axes, resolved, statistics_request, with_placeholders,
};
use voltet_core::volume::Volume;
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
        if let Some([low, high]) = volume.grid.bounds() {
            let [a, b] = bounds.unwrap_or([low, high]);
            bounds = Some([a.min(low), b.max(high)]);
        }
        Ok(())
    })?;
    kept.push(SeriesBounds(steps, bounds));
    Ok(bounds)
}

/// Bounds of a grid in parts.
fn bounds_of_parts(call: &mut RunContext) -> Result<Option<[DVec3; 2]>> {
    let mut bounds: Option<[DVec3; 2]> = None;
    call.each_part(&mut |call| {
        if let Some([low, high]) = call.volume("volume")?.grid.bounds() {
            let [a, b] = bounds.unwrap_or([low, high]);
            bounds = Some([a.min(low), b.max(high)]);
        }
        Ok(())
    })?;
    let own = bounds.map_or(Vec::new(), |bounds| bounds.map(|place| place.to_array()).concat());
    let of_all = call.gather(&own)?;
    let of_all = of_all.iter().filter_map(|own| Some([own.get(..3)?, own.get(3..)?].map(DVec3::from_slice)));
    Ok(of_all.reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]))
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
    let error = error.expected("inputs = { volume = \"NODE\" } at the transfer-function, or a number");
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

/// The volume whose points have the values that are measured, in place of one that is read; `None`: that itself.
pub(crate) type VolumeView<'a> = dyn Fn(&Volume) -> Result<Option<Volume>> + 'a;

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
    refuse_part(call)?;
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

/// Refuses numbers that a node would find from a part of a grid in place of the whole.
///
/// # Errors
/// - a node that runs for a part.
pub(crate) fn refuse_part(call: &RunContext) -> Result<()> {
    if call.part().is_none() {
        return Ok(());
    }
    let error = Error::usage(
        "the node runs for each part of a grid (--memory), and its numbers are relative to the whole",
    );
    Err(error.expected("numbers that are not relative, or a larger --memory"))
}

/// Statistics found in the data.
#[derive(Debug, Clone, Default)]
struct FoundStatistics {
    ranges: BTreeMap<ArrayRef, [f64; 2]>,
    /// Each percentile, by the bits of its percentage.
    percentiles: BTreeMap<(ArrayRef, u64), f64>,
    /// Scales of s and g.
    axes: [AxisScale; 2],
}

impl DataStatistics for FoundStatistics {
    fn scale(&self, quantity: &ArrayRef) -> AxisScale {
        match quantity {
            ArrayRef::Named("s") => self.axes[0],
            ArrayRef::Named("g") => self.axes[1],
            _ => AxisScale::Linear,
        }
    }

    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        self.ranges.get(quantity).copied().ok_or_else(|| not_found(quantity))
    }

    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64> {
        let found = self.percentiles.get(&(quantity.clone(), percent.to_bits()));
        found.copied().ok_or_else(|| not_found(quantity))
    }
}

fn not_found(quantity: &ArrayRef) -> Error {
    Error::run(format!("nothing is known of the values of {quantity}"))
}

impl FoundStatistics {
    /// Part of `wanted` that is missing here.
    fn missing(&self, wanted: &StatisticsRequest) -> StatisticsRequest {
        let mut missing = wanted.clone();
        missing.ranges.retain(|quantity| !self.ranges.contains_key(quantity));
        missing.percentiles.retain(|quantity, percents| {
            percents.retain(|&bits| !self.percentiles.contains_key(&(quantity.clone(), bits)));
            !percents.is_empty()
        });
        missing
    }

    /// Notes the ranges and percentiles that relative numbers were found from.
    fn note(&self, notes: &mut Diagnostics, over: &str) {
        let mut said = Vec::new();
        let mut ranges = Map::new();
        for (quantity, [low, high]) in &self.ranges {
            said.push(format!("{quantity} from {low:?} to {high:?}"));
            ranges.insert(quantity.to_string(), json!([low, high]));
        }
        let mut percentiles = Vec::new();
        for ((quantity, bits), value) in &self.percentiles {
            let percent = f64::from_bits(*bits);
            said.push(format!("p{percent} of {quantity} = {value:?}"));
            percentiles.push(json!([quantity.to_string(), percent, value]));
        }
        let figures = json!({ "relative_to": { "over": over, "ranges": ranges, "percentiles": percentiles }});
        notes.find(format!("{} ({over})", said.join(", ")), figures);
    }
}

/// Demand on a volume for these statistics.
fn demand(wanted: &StatisticsRequest) -> Demand {
    demand_for(wanted.quantities())
}

/// Demand on a volume for these quantities.
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

/// The values of a quantity, one a point. Errors: there is no such array, or no gradient magnitude.
pub fn values<'a>(volume: &'a Volume, quantity: &ArrayRef) -> Result<&'a [f64]> {
    match quantity {
        ArrayRef::Array(name) => Ok(&volume.grid.point_array(name, 1)?.values),
        ArrayRef::Named("g") => volume.gradient_magnitude.as_ref().map(|g| g.as_slice()).ok_or_else(|| {
            Error::usage("the gradient magnitude is looked at, and the volume has none")
                .expected("a node of type \"gradient-magnitude\" before the input 'volume'")
        }),
        ArrayRef::Named(_) | ArrayRef::Per(..) => Ok(&volume.scalar),
    }
}

/// The volume below each value of a quantity.
pub(crate) fn volumes(volume: &Volume, quantity: &ArrayRef, progress: &dyn Progress) -> Result<Volumes> {
    Volumes::new(&volume.grid, values(volume, quantity)?, progress)
        .map_err(|error| with_array_name(quantity, error))
}

/// An error with the name of the quantity that it is about.
fn with_array_name(quantity: &ArrayRef, error: Error) -> Error {
    let what = format!("{}, of {quantity}", error.what);
    Error { what, ..error }
}

/// Statistics of one volume: only what is requested is computed.
fn measure(volume: &Volume, wanted: &StatisticsRequest, progress: &dyn Progress) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    for quantity in &wanted.ranges {
        // At points of ghosts alone the gradient is not that of the grid.
        let values = values(volume, quantity)?;
        let drawn = &values[..volume.grid.drawn_points().min(values.len())];
        let range = value_range(drawn).map_err(|error| with_array_name(quantity, error))?;
        found.ranges.insert(quantity.clone(), range);
    }
    for (quantity, percents) in &wanted.percentiles {
        let volumes = volumes(volume, quantity, progress)?;
        for &bits in percents {
            let value = volumes.percentile(f64::from_bits(bits), progress)?;
            found.percentiles.insert((quantity.clone(), bits), value);
        }
    }
    Ok(found)
}

/// Pieces that the interval of a percentile is cut into.
const EDGES: usize = 4096;

/// Rounds in which the percentiles of a series are narrowed down: to a 4,096th of what its steps differ by.
const SERIES_ROUNDS: usize = 1;

/// Rounds in which the percentiles of a grid in parts are narrowed down: to 6e-8 of what its parts differ by.
const PART_ROUNDS: usize = 2;

/// The volume below the edges of an interval, over all steps.
struct Sums {
    /// From the least percentile of a step to the largest.
    interval: [f64; 2],
    below: Vec<f64>,
    total: f64,
}

impl Sums {
    fn edge(&self, i: usize) -> f64 {
        let share = i as f64 / EDGES as f64;
        self.interval[0] * (1.0 - share) + self.interval[1] * share
    }

    /// Before any volume is looked at.
    fn new(interval: [f64; 2]) -> Sums {
        Sums { interval, below: vec![0.0; EDGES + 1], total: 0.0 }
    }

    /// The edges between which a percentile lies.
    fn narrowed(&self, percent: f64) -> [f64; 2] {
        let wanted = percent / 100.0 * self.total;
        match self.below.partition_point(|&volume| volume < wanted) {
            0 => [self.interval[0]; 2],
            above if above > EDGES => [self.interval[1]; 2],
            above => [self.edge(above - 1), self.edge(above)],
        }
    }

    /// Value below which so many percent of the volume lie.
    fn percentile(&self, percent: f64) -> f64 {
        let wanted = percent / 100.0 * self.total;
        let above = self.below.partition_point(|&volume| volume < wanted);
        if above == 0 || above > EDGES {
            return self.interval[usize::from(above > 0)];
        }
        let [low, high] = [self.below[above - 1], self.below[above]];
        let share = (wanted - low) / (high - low);
        let [a, b] = [self.edge(above - 1), self.edge(above)];
        (a * (1.0 - share) + b * share).clamp(a, b)
    }
}

/// Work on one of several volumes.
type VolumeCallback<'a> = dyn FnMut(&Volume, &dyn Progress) -> Result<()> + 'a;

/// Volumes that are measured together.
trait SeveralVolumes {
    /// Hands on all of them, one after the other.
    fn each(&mut self, of_volume: &mut VolumeCallback) -> Result<()>;

    /// Numbers that each process found in its volumes.
    fn gather(&self, own: Vec<f64>) -> Result<Vec<Vec<f64>>> {
        Ok(vec![own])
    }
}

/// Steps of a series.
struct SeriesSteps<'a, 'c> {
    call: &'a RunContext<'c>,
    demand: &'a Demand,
    steps: &'a [usize],
    view: &'a VolumeView<'a>,
    /// Number of steps that were read.
    read: u64,
}

impl SeveralVolumes for SeriesSteps<'_, '_> {
    fn each(&mut self, of_volume: &mut VolumeCallback) -> Result<()> {
        let SeriesSteps { call, demand, steps, view, read } = self;
        call.each_step("volume", demand, Some(steps), &mut |_, value: voltet_graph::Value| {
            *read += 1;
            let Some(volume) = value.volume().transpose()? else { return Ok(()) };
            match view(&volume)? {
                Some(other) => of_volume(&other, call.progress()),
                None => of_volume(&volume, call.progress()),
            }
        })
    }
}

/// Parts of a grid, of this process and of others.
struct GridParts<'a, 'c>(&'a mut RunContext<'c>);

impl SeveralVolumes for GridParts<'_, '_> {
    fn each(&mut self, of_volume: &mut VolumeCallback) -> Result<()> {
        self.0.each_part(&mut |call| of_volume(&*call.volume("volume")?, call.progress()))
    }

    fn gather(&self, own: Vec<f64>) -> Result<Vec<Vec<f64>>> {
        self.0.gather(&own)
    }
}

/// The least and the largest of several intervals; NaN of none.
fn widest(intervals: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    // The minimum with NaN is the other number.
    intervals.fold([f64::NAN; 2], |[low, high], [a, b]| [low.min(a), high.max(b)])
}

/// Statistics that a volume has: those of quantities with finite values.
fn wanted_of_finite(volume: &Volume, wanted: &StatisticsRequest) -> Result<StatisticsRequest> {
    let mut own = wanted.clone();
    for quantity in wanted.quantities() {
        if values(volume, quantity)?.iter().all(|value| !value.is_finite()) {
            own.ranges.retain(|other| other != quantity);
            own.percentiles.retain(|other, _| other != quantity);
        }
    }
    Ok(own)
}

/// Statistics of several volumes together. They are looked at again for each round in which percentiles are narrowed down.
fn measure_several(
    wanted: &StatisticsRequest,
    rounds: usize,
    volumes_of: &mut dyn SeveralVolumes,
) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    if wanted.is_empty() {
        return Ok(found);
    }
    let percents =
        wanted.percentiles.iter().flat_map(|(array, all)| all.iter().map(move |bits| (array.clone(), *bits)));
    let percents: Vec<(ArrayRef, u64)> = percents.collect();
    // Of each range and percentile the interval over all volumes.
    let mut intervals = vec![[f64::NAN; 2]; wanted.ranges.len() + percents.len()];
    volumes_of.each(&mut |volume, progress| {
        let own = measure(volume, &wanted_of_finite(volume, wanted)?, progress)?;
        let ranges = wanted.ranges.iter().map(|quantity| own.ranges.get(quantity).copied());
        let values = percents.iter().map(|key| own.percentiles.get(key).map(|value| [*value; 2]));
        for (known, own) in intervals.iter_mut().zip(ranges.chain(values)) {
            *known = widest([*known].into_iter().chain(own));
        }
        Ok(())
    })?;
    let of_all = volumes_of.gather(intervals.concat())?;
    let interval =
        |k: usize| widest(of_all.iter().filter_map(|own| Some([*own.get(2 * k)?, *own.get(2 * k + 1)?])));
    let quantities = wanted.ranges.iter().chain(percents.iter().map(|(quantity, _)| quantity));
    if let Some((_, quantity)) = quantities.enumerate().find(|(k, _)| interval(*k)[0].is_nan()) {
        let error = Error::run("a field has no finite values, so nothing can be relative to them");
        return Err(with_array_name(quantity, error));
    }
    for (k, quantity) in wanted.ranges.iter().enumerate() {
        found.ranges.insert(quantity.clone(), interval(k));
    }
    let mut sums: BTreeMap<(ArrayRef, u64), Sums> = BTreeMap::new();
    for (k, key) in percents.into_iter().enumerate() {
        let interval = interval(wanted.ranges.len() + k);
        let percent = f64::from_bits(key.1);
        if interval[0] == interval[1] || percent <= 0.0 || percent >= 100.0 {
            // Of 0 % the least of all, of 100 % the largest.
            found.percentiles.insert(key, interval[usize::from(percent > 0.0)]);
        } else {
            sums.insert(key, Sums::new(interval));
        }
    }
    for _ in 0..if sums.is_empty() { 0 } else { rounds } {
        for ((_, bits), own) in &mut sums {
            if own.total > 0.0 {
                *own = Sums::new(own.narrowed(f64::from_bits(*bits)));
            }
        }
        volumes_of.each(&mut |volume, progress| {
            for quantity in wanted.percentiles.keys() {
                let mut own = sums.iter_mut().filter(|((array, _), _)| array == quantity).peekable();
                if own.peek().is_none() {
                    continue;
                }
                if values(volume, quantity)?.iter().all(|value| !value.is_finite()) {
                    continue;
                }
                let volumes = volumes(volume, quantity, progress)?;
                for (_, sums) in own {
                    let edges: Vec<f64> = (0..=EDGES).map(|i| sums.edge(i)).collect();
                    sums.below.iter_mut().zip(volumes.below_each(&edges)).for_each(|(sum, own)| *sum += own);
                    sums.total += volumes.total();
                }
            }
            Ok(())
        })?;
        let own: Vec<f64> =
            sums.values().flat_map(|own| own.below.iter().copied().chain([own.total])).collect();
        let of_all = volumes_of.gather(own)?;
        for (own, first) in sums.values_mut().zip((0..).step_by(EDGES + 2)) {
            let sum = |at: usize| of_all.iter().filter_map(|numbers| numbers.get(first + at)).sum::<f64>();
            own.below = (0..=EDGES).map(sum).collect();
            own.total = sum(EDGES + 1);
        }
    }
    for (key, sums) in sums {
        let value = sums.percentile(f64::from_bits(key.1));
        found.percentiles.insert(key, value);
    }
    Ok(found)
}
