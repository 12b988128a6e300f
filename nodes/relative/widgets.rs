//! The widgets of a transfer function whose numbers are relative to data.

use super::scales::{of_series, of_volume};
use super::shown::{note_found, note_numbers};
use super::volume::demand;
use voltet_core::transfer::{StatisticsRequest, resolved, statistics_request, with_placeholders};
use voltet_core::{Error, Result};
use voltet_graph::{Demand, DemandContext, Parameters, RunContext};

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
