//! `voltet gradient-test`: how right a gradient filter is and what it costs, beside others.

use super::outcome::{DONE, show};
use super::reading::Inspecting;
use crate::arguments;
use crate::collisions::{self, OptionFile};
use crate::core::field::Method;
use crate::core::graph::{Origin, Parameters, Registry};
use crate::core::pipeline::field;
use crate::core::{Error, Result};
use crate::nodes::{encode, files};
use crate::present::{Bar, print, say};
use crate::study::gradient_test::{GradientTest, Hold, Wish, gradient_test as measure, page, plot, text};
use std::path::Path;

/// The filter breaks what it is held to.
const BROKEN: u8 = 1;

pub fn gradient_test(arguments: &arguments::GradientTest, registry: &Registry) -> Result<u8> {
    let wish = wish(arguments)?;
    let methods = methods(arguments, registry)?;
    let outputs: Vec<(&str, &Path)> =
        [("--html", &arguments.html), ("--json", &arguments.json), ("--plot", &arguments.plot)]
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)))
            .collect();
    let written: Vec<OptionFile> =
        outputs.iter().map(|(option, path)| OptionFile::written(option, path)).collect();
    if let Err((error, text)) = collisions::refuse([], false, &written) {
        return Ok(show(&error, text));
    }
    arguments.plot.as_deref().map_or(Ok(false), super::pixel::is_png)?;
    outputs.iter().try_for_each(|(_, path)| files::refuse_unwritable(path))?;
    let bar = Bar::new(arguments.quiet);
    let found = measure(&methods, &wish, &Inspecting(&bar));
    bar.clear();
    let found = found?;
    outputs
        .iter()
        .try_for_each(|(option, path)| files::write_whole(path, &content(&found, option, path)?))?;
    let table = text(&found);
    // What goes to the standard output stands there alone.
    match outputs.iter().any(|(_, path)| files::is_standard_output(path)) {
        _ if arguments.quiet => found.requirements.iter().filter(|one| !one.holds).for_each(|one| {
            let what = format!("the gradient filter '{}' does not hold: {}", arguments.name, one.what);
            show(&Error::run(what).found(&one.found), None);
        }),
        true => say(&table),
        false => drop(print(&table)?),
    }
    Ok(if found.passed() { DONE } else { BROKEN })
}

/// What an option writes.
fn content(found: &GradientTest, option: &str, path: &Path) -> Result<Vec<u8>> {
    Ok(match option {
        "--html" => page(found, &plot(found).svg()).into_bytes(),
        "--json" => {
            let object =
                serde_json::to_string_pretty(found).map_err(|error| Error::run(error.to_string()))?;
            format!("{object}\n").into_bytes()
        }
        _ if super::pixel::is_png(path)? => encode::png(&plot(found).picture(), [1.0; 3], None)?,
        _ => plot(found).svg().into_bytes(),
    })
}

fn wish(arguments: &arguments::GradientTest) -> Result<Wish> {
    let wrong = |what: &str, found: String, accepted: &str| {
        Err(Error::usage(format!("{what} is out of range")).found(found).accepted(accepted))
    };
    let levels = &arguments.levels;
    let rising = levels.windows(2).all(|pair| pair[0] < pair[1]);
    if levels.len() < 2 || !rising || levels.iter().any(|n| !(2..=128).contains(n)) {
        return wrong(
            "--levels",
            format!("{levels:?}"),
            "two or more rising numbers from 2 to 128, such as 4,8,16",
        );
    }
    if !(2..=200).contains(&arguments.timed) {
        return wrong("--timed", arguments.timed.to_string(), "2 to 200 boxes along a side");
    }
    if arguments.rounds == 0 {
        return wrong("--rounds", "0".into(), "1 or more");
    }
    if !arguments.order.is_finite() {
        return wrong("--order", arguments.order.to_string(), "a number");
    }
    if arguments.linear_error.is_nan() || arguments.linear_error < 0.0 {
        return wrong("--linear-error", arguments.linear_error.to_string(), "a number of at least 0");
    }
    Ok(Wish {
        levels: levels.clone(),
        timed: arguments.timed,
        rounds: arguments.rounds,
        hold_to: arguments.hold_to.iter().filter_map(|name| Option::<Hold>::from(*name)).collect(),
        order: arguments.order,
        linear_error: arguments.linear_error,
    })
}

/// The filter with what was set, then those beside it.
fn methods(arguments: &arguments::GradientTest, registry: &Registry) -> Result<Vec<Method>> {
    let filter = registry.find_filter(&arguments.name)?.clone();
    let declared = filter.declaration().parameters;
    let fields = arguments.options.iter().map(|option| field(option)).collect::<Result<Vec<_>>>()?;
    let parameters = Parameters::check(declared, &fields, &Origin::Nowhere, &[])?;
    let method = Method::new(filter, parameters)?;
    if let Some(array) = method.arrays()?.into_iter().next() {
        let error = Error::usage("the filter reads a point array, and manufactured grids carry none");
        return Err(error
            .found(format!("'{array}'"))
            .accepted("a filter that computes gradients")
            .at_item(&arguments.name));
    }
    let mut methods = vec![method];
    let beside: Vec<String> = match &arguments.beside {
        Some(names) => names.clone(),
        None => registry.filters().map(|filter| filter.declaration().name.to_string()).collect(),
    };
    for name in beside.iter().filter(|name| **name != arguments.name && !name.is_empty()) {
        // Those that cannot go without parameters or arrays are left out, unless they were asked for.
        let other = Method::standard(registry.find_filter(name)?.clone());
        match other.and_then(|other| other.arrays().map(|arrays| (other, arrays))) {
            Ok((other, arrays)) if arrays.is_empty() => methods.push(other),
            Ok((_, arrays)) if arguments.beside.is_some() => {
                let error = Error::usage("the filter reads a point array, and manufactured grids carry none");
                return Err(error.found(arrays.join(", ")).at_item(name));
            }
            Err(error) if arguments.beside.is_some() => return Err(error.at_item(name)),
            _ => {}
        }
    }
    Ok(methods)
}

impl From<arguments::HoldName> for Option<Hold> {
    fn from(name: arguments::HoldName) -> Option<Hold> {
        match name {
            arguments::HoldName::Finite => Some(Hold::Finite),
            arguments::HoldName::Linear => Some(Hold::Linear),
            arguments::HoldName::Order => Some(Hold::Order),
            arguments::HoldName::Invariance => Some(Hold::Invariance),
            arguments::HoldName::Nothing => None,
        }
    }
}
