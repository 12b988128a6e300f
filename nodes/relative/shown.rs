//! Resolved relative numbers, as text that a pipeline file could hold and as figures.

use super::statistics::FoundStatistics;
use serde_json::{Map, Value, json};
use voltet_graph::{Diagnostics, LocatedValue, ParameterValue, Parameters};

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
