//! Numbers relative to data: the widgets of a transfer function before and after the data are known, what the numbers became in words
//! and figures, and the statistics that they refer to: ranges and percentiles of one volume, or of all steps of a time series.
//!
//! Of a series each step's own percentile is exact, and that of all steps together lies between the least and the largest of these. In
//! that interval the volumes below [`EDGES`] values are summed over all steps (which reads them a second time), and the percentile
//! is found between two of them by a straight line: off by a 4,096th of the interval at most.

use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::probing::{Volumes, value_range};
use voltet_core::progress::Progress;
use voltet_core::transfer::{
    DataStatistics, StatisticsRequest, resolved, statistics_request, with_placeholders,
};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{
    ArrayRef, Demand, DemandContext, Diagnostics, LocatedValue, ParameterValue, Parameters, RunContext,
};

/// Widgets: their kinds and keys.
pub type Widgets = Vec<(&'static str, Parameters)>;

/// The widgets before any data are known.
pub fn stood_in(p: &Parameters) -> Result<Widgets> {
    p.kinds("widgets")?.into_iter().map(|(kind, keys)| Ok((kind, with_placeholders(&keys)?))).collect()
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

/// Asks for what the widgets' numbers are relative to.
pub fn ask(asking: &mut DemandContext) -> Result<()> {
    let widgets = asking.parameters.kinds("widgets")?;
    let request = wanted_of(&widgets);
    if request.is_empty() {
        return Ok(());
    }
    if asking.fed_by("volume")?.is_none() {
        return Err(unwired(&widgets));
    }
    let of_step = asking.parameters.text("relative_to")? == "step";
    asking.ask("volume", &if of_step { demand(&request) } else { Demand::default() })
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

/// The widgets with numbers for those that were relative to data, each noted.
pub fn known(call: &mut RunContext) -> Result<Widgets> {
    let widgets = call.parameters.kinds("widgets")?;
    let request = wanted_of(&widgets);
    if request.is_empty() {
        return Ok(widgets);
    }
    if !call.is_wired("volume")? {
        return Err(unwired(&widgets));
    }
    let (found, over) = match call.parameters.text("relative_to")? {
        "series" => {
            let found = of_series(call, &request)?;
            (found, format!("over {} time steps", call.step_count("volume")?))
        }
        _ => (of_volume(call, &request)?, "over the volume".to_string()),
    };
    note_found(&mut call.notes, &over, &found);
    let mut known = Vec::new();
    for (number, (kind, keys)) in widgets.into_iter().enumerate() {
        let own = resolved(&keys, &found)?;
        if own != keys {
            let thing = format!("widget {number} ({kind})");
            note_numbers(&mut call.notes, &thing, &over, &keys, &own);
        }
        known.push((kind, own));
    }
    Ok(known)
}

/// The parameters that were relative, as a file could hold them now: "centre = [60.8, 0.012], sigma = [0.35, 0.025]".
fn shown(before: &Parameters, after: &Parameters) -> String {
    let changed = changed(before, after);
    changed.iter().map(|(name, setting)| format!("{name} = {}", setting.datum)).collect::<Vec<_>>().join(", ")
}

fn changed<'a>(before: &'a Parameters, after: &'a Parameters) -> Vec<(&'static str, &'a LocatedValue)> {
    let pairs = before.iter().zip(after.iter());
    let changed = pairs.filter(|((_, old, _), (_, new, _))| old != new);
    changed.filter_map(|((parameter, ..), (_, new, _))| Some((parameter.name, new?))).collect()
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

/// Notes what the relative numbers of a thing ("widget 0 (gaussian)") became. `over`: of what.
pub fn note_numbers(
    notes: &mut Diagnostics,
    thing: &str,
    over: &str,
    before: &Parameters,
    after: &Parameters,
) {
    let numbers: Map<String, Value> = changed(before, after)
        .into_iter()
        .map(|(name, setting)| (name.to_string(), json_of(&setting.datum)))
        .collect();
    let figures = json!({ "relative": { "of": thing, "over": over, "numbers": numbers }});
    notes.find(format!("{thing}: {} ({over})", shown(before, after)), figures);
}

/// Notes the ranges and percentiles that relative numbers were found from.
pub fn note_found(notes: &mut Diagnostics, over: &str, found: &FoundStatistics) {
    let ranges: Map<String, Value> =
        found.ranges.iter().map(|(quantity, range)| (quantity.to_string(), json!(range))).collect();
    let percentiles: Vec<Value> = (found.percentiles.iter())
        .map(|((quantity, bits), value)| json!([quantity.to_string(), f64::from_bits(*bits), value]))
        .collect();
    let ends =
        found.ranges.iter().map(|(quantity, [low, high])| format!("{quantity} from {low:?} to {high:?}"));
    let within = found.percentiles.iter();
    let within = within.map(|((q, bits), value)| format!("p{} of {q} = {value:?}", f64::from_bits(*bits)));
    let said: Vec<String> = ends.chain(within).collect();
    let figures = json!({ "relative_to": { "over": over, "ranges": ranges, "percentiles": percentiles }});
    notes.find(format!("{} ({over})", said.join(", ")), figures);
}

/// Statistics found so far, of one volume or one series.
#[derive(Default)]
struct StatisticsCache(Mutex<FoundStatistics>);

impl StatisticsCache {
    /// Statistics requested, computed as far as they are missing. Returns the count of percentiles computed.
    fn with(
        &self,
        wanted: &StatisticsRequest,
        find: impl FnOnce(&StatisticsRequest) -> Result<FoundStatistics>,
    ) -> Result<(FoundStatistics, u64)> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let missing = known.missing(wanted);
        if !missing.is_empty() {
            known.add(find(&missing)?);
        }
        let count = missing.percentiles.values().map(BTreeSet::len).sum::<usize>();
        Ok((known.clone(), count as u64))
    }
}

/// Statistics of the volume at the input `volume`.
pub fn of_volume(call: &mut RunContext, wanted: &StatisticsRequest) -> Result<FoundStatistics> {
    let volume = call.volume("volume")?;
    let kept: Arc<StatisticsCache> =
        call.keep(call.revision("volume")?, || Ok(StatisticsCache::default()))?;
    let (found, computed) =
        call.stage("range", |progress| kept.with(wanted, |missing| measure(&volume, missing, progress)))?;
    call.notes.counts.insert("percentiles_computed", computed);
    Ok(found)
}

/// Statistics of all steps of the time series that feeds the input `volume`; one step is read at a time.
pub fn of_series(call: &mut RunContext, wanted: &StatisticsRequest) -> Result<FoundStatistics> {
    let demand = demand(wanted);
    let kept: Arc<StatisticsCache> =
        call.keep_over_steps("volume", &demand, || Ok(StatisticsCache::default()))?;
    let mut read = 0;
    let (found, computed) = kept.with(wanted, |missing| measure_series(call, missing, &demand, &mut read))?;
    call.notes.counts.insert("percentiles_computed", computed);
    call.notes.counts.insert("steps_read", read);
    Ok(found)
}

/// Statistics found in the data.
#[derive(Debug, Clone, Default)]
pub struct FoundStatistics {
    /// The range of each quantity that was asked for.
    pub ranges: BTreeMap<ArrayRef, [f64; 2]>,
    /// Each percentile, by the bits of its percentage.
    pub percentiles: BTreeMap<(ArrayRef, u64), f64>,
}

impl DataStatistics for FoundStatistics {
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
    pub fn missing(&self, wanted: &StatisticsRequest) -> StatisticsRequest {
        let mut missing = StatisticsRequest::default();
        missing.ranges.extend(wanted.ranges.iter().filter(|q| !self.ranges.contains_key(q)).cloned());
        for (quantity, percents) in &wanted.percentiles {
            let open = percents.iter().filter(|&&p| !self.percentiles.contains_key(&(quantity.clone(), p)));
            let open: BTreeSet<u64> = open.copied().collect();
            if !open.is_empty() {
                missing.percentiles.insert(quantity.clone(), open);
            }
        }
        missing
    }

    /// Adds what else was found.
    pub fn add(&mut self, other: FoundStatistics) {
        self.ranges.extend(other.ranges);
        self.percentiles.extend(other.percentiles);
    }
}

/// Demand on a volume for these statistics.
pub fn demand(wanted: &StatisticsRequest) -> Demand {
    let mut demand = Demand::default();
    for quantity in wanted.quantities() {
        match quantity {
            ArrayRef::Array(name) => demand.arrays.insert(name.clone()),
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
            Error::usage("numbers are relative to the gradient magnitude, and the volume has none")
                .expected("a node of type \"gradient-magnitude\" before the input 'volume'")
        }),
        ArrayRef::Named(_) | ArrayRef::Per(..) => Ok(&volume.scalar),
    }
}

/// An error with the name of the quantity that it is about.
pub fn with_array_name(quantity: &ArrayRef, error: Error) -> Error {
    let what = format!("{}, of {quantity}", error.what);
    Error { what, ..error }
}

/// Statistics of one volume: only what is requested is computed.
pub fn measure(
    volume: &Volume,
    wanted: &StatisticsRequest,
    progress: &dyn Progress,
) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    for quantity in &wanted.ranges {
        let range =
            value_range(values(volume, quantity)?).map_err(|error| with_array_name(quantity, error))?;
        found.ranges.insert(quantity.clone(), range);
    }
    for (quantity, percents) in &wanted.percentiles {
        let volumes = Volumes::new(&volume.grid, values(volume, quantity)?, progress);
        let volumes = volumes.map_err(|error| with_array_name(quantity, error))?;
        for &bits in percents {
            let value = volumes.percentile(f64::from_bits(bits), progress)?;
            found.percentiles.insert((quantity.clone(), bits), value);
        }
    }
    Ok(found)
}

/// Pieces that the interval of a percentile is cut into.
const EDGES: usize = 4096;

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

/// `read` counts the steps that were read.
pub fn measure_series(
    call: &RunContext,
    wanted: &StatisticsRequest,
    demand: &Demand,
    read: &mut u64,
) -> Result<FoundStatistics> {
    let mut found = FoundStatistics::default();
    let mut intervals: BTreeMap<(ArrayRef, u64), [f64; 2]> = BTreeMap::new();
    let wider = |[low, high]: [f64; 2], [a, b]: [f64; 2]| [low.min(a), high.max(b)];
    each(call, demand, read, &mut |volume| {
        let own = measure(volume, wanted, call.progress())?;
        for (quantity, range) in own.ranges {
            let known = found.ranges.entry(quantity).or_insert(range);
            *known = wider(*known, range);
        }
        for (key, value) in own.percentiles {
            let known = intervals.entry(key).or_insert([value; 2]);
            *known = wider(*known, [value; 2]);
        }
        Ok(())
    })?;
    let mut sums: BTreeMap<(ArrayRef, u64), Sums> = BTreeMap::new();
    for (key, interval) in intervals {
        let percent = f64::from_bits(key.1);
        if interval[0] == interval[1] || percent <= 0.0 || percent >= 100.0 {
            // Of 0 % the least of all steps, of 100 % the largest.
            found.percentiles.insert(key, interval[usize::from(percent > 0.0)]);
        } else {
            sums.insert(key, Sums { interval, below: vec![0.0; EDGES + 1], total: 0.0 });
        }
    }
    if !sums.is_empty() {
        each(call, demand, read, &mut |volume| {
            for quantity in wanted.percentiles.keys() {
                let mut own = sums.iter_mut().filter(|((array, _), _)| array == quantity).peekable();
                if own.peek().is_none() {
                    continue;
                }
                let volumes = Volumes::new(&volume.grid, values(volume, quantity)?, call.progress());
                let volumes = volumes.map_err(|error| with_array_name(quantity, error))?;
                for (_, sums) in own {
                    let edges: Vec<f64> = (0..=EDGES).map(|i| sums.edge(i)).collect();
                    sums.below.iter_mut().zip(volumes.below_each(&edges)).for_each(|(sum, own)| *sum += own);
                    sums.total += volumes.total();
                }
            }
            Ok(())
        })?;
    }
    for (key, sums) in sums {
        let value = sums.percentile(f64::from_bits(key.1));
        found.percentiles.insert(key, value);
    }
    Ok(found)
}

fn each(
    call: &RunContext,
    demand: &Demand,
    read: &mut u64,
    of_step: &mut dyn FnMut(&Volume) -> Result<()>,
) -> Result<()> {
    call.each_step("volume", demand, &mut |_, value: voltet_graph::Value| {
        *read += 1;
        match value.volume() {
            Some(volume) => of_step(&*volume?),
            None => Ok(()),
        }
    })
}
