//! `histogram`: the distribution of the data over the plane of s and g, weighted by volume, as figures and a picture.

use serde_json::json;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::probing::{Axis, Histogram, histogram};
use voltet_core::{Error, Result};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType,
    Range, RunContext, Value,
};
use voltet_io::encode::viridis;

pub const NODE: Node = Node {
    name: "histogram",
    summary: "Gives the volume in each bin of the scalar and its gradient magnitude, exact within every cell.",
    inputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the cells with their gradient" }],
    outputs: &[
        Port { name: "report", port_type: PortType::Report, summary: "ranges, and the volume of each bin" },
        Port { name: "image", port_type: PortType::Image, summary: "s to the right, g upward, over nothing" },
    ],
    parameters: &[
        Parameter {
            name: "bins",
            parameter_type: ParameterType::Integers(2, Range::within(1.0, 2048.0)),
            unit: "",
            default: DefaultValue::Integers(&[256, 256]),
            help: "number of bins along s and g",
        },
        AXIS,
        Parameter {
            name: "g",
            unit: "units of g",
            help: "range of the gradient magnitude, [low, high]",
            ..AXIS
        },
        Parameter {
            name: "scale",
            parameter_type: ParameterType::Choice(&[
                ("log", "colour by the logarithm of the volume"),
                ("linear", "colour by the volume"),
            ]),
            unit: "",
            default: DefaultValue::Text("log"),
            help: "how volume becomes colour, from dark violet to yellow; empty bins are transparent",
        },
        Parameter {
            name: "decades",
            parameter_type: ParameterType::Number(Range { above_min: true, ..Range::within(0.0, 20.0) }),
            unit: "powers of ten",
            default: DefaultValue::Number(8.0),
            help: "log: how far below the fullest bin the colours reach; less is shown as the darkest",
        },
        Parameter {
            name: "magnify",
            parameter_type: ParameterType::Integer(Range::within(1.0, 16.0)),
            unit: "pixels a bin",
            default: DefaultValue::Integer(2),
            help: "side of a bin in the picture",
        },
    ],
    example: include_str!("examples/histogram.toml"),
    check: &|parameters| ["s", "g"].iter().try_for_each(|name| limits(parameters, name).map(drop)),
    demand: &|asking: &mut DemandContext| {
        asking.ask("volume", &Demand { gradient_magnitude: true, ..Demand::default() })
    },
    run: &run,
    ..Node::BLANK
};

const AXIS: Parameter = Parameter {
    name: "s",
    parameter_type: ParameterType::Numbers(Some(2), Range::ANY),
    unit: "units of s",
    default: DefaultValue::Unset("the data's range"),
    help: "range of the scalar, [low, high]; volume beyond it is counted as outside",
};

fn limits(p: &Parameters, name: &str) -> Result<Option<[f64; 2]>> {
    let Some(_) = p.optional(name) else { return Ok(None) };
    match p.vector(name)? {
        [low, high] if low < high => Ok(Some([low, high])),
        [low, high] => {
            let error = p.error(name, format!("the range '{name}' is empty")).got(format!("[{low}, {high}]"));
            Err(error.expected("the smaller number first"))
        }
    }
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let volume = call.volume("volume")?;
    let Some(g) = volume.gradient_magnitude.clone() else {
        let error = Error::usage("the histogram looks at the gradient magnitude, and the volume has none");
        return Err(error.expected("a node of type \"gradient-magnitude\" before this one"));
    };
    let bins: [f64; 2] = call.parameters.vector("bins")?;
    let axis = |name: &str, values: &[f64], bins: f64| -> Result<Axis> {
        let axis = Axis::over(values, bins as usize);
        let limits = limits(call.parameters, name)?;
        Ok(limits.map_or(axis, |[low, high]| Axis { low, high, ..axis }))
    };
    let axes = [axis("s", &volume.scalar, bins[0])?, axis("g", &g, bins[1])?];
    let found =
        call.stage("histogram", |progress| histogram(&volume.grid, [&volume.scalar, &g], axes, progress))?;
    let decades = (call.parameters.text("scale")? == "log").then(|| call.parameters.number("decades"));
    let picture = picture(&found, decades.transpose()?, call.parameters.integer("magnify")? as usize);
    let summary = summary(&found, &volume.grid.scalar_name);
    call.notes.find(sentence(&found), summary.clone());
    let report = report(&found, summary).to_string();
    Ok(vec![Value::Report(report.into()), Value::Image(Arc::new(picture))])
}

fn sentence(found: &Histogram) -> String {
    let [s, g] = found.axes;
    let mut text = format!(
        "volume {:.6e} over s from {:?} to {:?} and g from {:?} to {:?}, {} × {} bins",
        found.total, s.low, s.high, g.low, g.high, s.bins, g.bins
    );
    if let Some(g) = most_below(found, 0.99) {
        text += &format!("; 99 % of the volume within has g below {g:?}");
    }
    for (volume, what) in [(found.outside, "beyond these ranges"), (found.not_finite, "not finite")] {
        if volume > 0.0 {
            text += &format!("; {:.3} % {what}", 100.0 * volume / found.total);
        }
    }
    text
}

/// The upper edge of the row of bins up to which this share of the volume within the axes lies.
fn most_below(found: &Histogram, share: f64) -> Option<f64> {
    let rows = found.volumes.chunks(found.axes[0].bins).map(|row| row.iter().sum::<f64>());
    let within: f64 = found.volumes.iter().sum();
    let mut below = 0.0;
    let reaches = |volume: f64| {
        below += volume;
        below >= share * within
    };
    rows.map(reaches).position(|reached| reached && within > 0.0).map(|row| found.axes[1].edge(row + 1))
}

/// All but the bins.
fn summary(found: &Histogram, scalar: &str) -> serde_json::Value {
    let axis = |axis: &Axis| json!({ "low": axis.low, "high": axis.high, "bins": axis.bins });
    json!({
        "scalar": scalar,
        "s": axis(&found.axes[0]),
        "g": axis(&found.axes[1]),
        "volume": found.total,
        "volume_outside": found.outside,
        "volume_not_finite": found.not_finite,
    })
}

/// The summary and a row for each bin that is not empty.
fn report(found: &Histogram, mut summary: serde_json::Value) -> serde_json::Value {
    let [s, g] = found.axes;
    let row = |(bin, &volume): (usize, &f64)| {
        let (i, j) = (bin % s.bins, bin / s.bins);
        json!([s.edge(i), s.edge(i + 1), g.edge(j), g.edge(j + 1), volume])
    };
    let filled = found.volumes.iter().enumerate().filter(|(_, volume)| **volume > 0.0);
    summary["columns"] = json!(["s_low", "s_high", "g_low", "g_high", "volume"]);
    summary["rows"] = filled.map(row).collect();
    summary
}

/// The bins as squares, largest g at the top.
fn picture(found: &Histogram, decades: Option<f64>, magnify: usize) -> Picture {
    let [width, height] = found.axes.map(|axis| axis.bins);
    let most = found.volumes.iter().copied().fold(0.0, f64::max);
    let mut picture = Picture::transparent(width * magnify, height * magnify);
    let side = width * magnify;
    for (place, pixel) in picture.rgba.iter_mut().enumerate() {
        let (i, j) = (place % side / magnify, height - 1 - place / side / magnify);
        let volume = found.volumes[j * width + i];
        if volume > 0.0 {
            let share = volume / most;
            let level = decades.map_or(share, |decades| 1.0 + share.log10() / decades);
            *pixel = viridis(level.clamp(0.0, 1.0) as f32);
        }
    }
    picture
}
