//! `transfer-function`: widgets over the scalar and its gradient magnitude, and the optical model.

use crate::relative;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::colormap::ColorCurve;
use voltet_core::transfer::{
    AxisScale, LoadFiles, OpticalModel, TransferFunction, UnreadFiles, WIDGET_KINDS, read,
};
use voltet_core::{Error, Result};
use voltet_graph::{
    DefaultValue, NamedStub, Node, Outputs, Parameter, ParameterType, Parameters, PartWork, Port, PortType,
    Range, RunContext, TransferFunctionSpec, Value,
};

pub const NODE: Node = Node {
    name: "transfer-function",
    summary: "Turns the scalar and its gradient magnitude into colour and extinction, by a list of widgets.",
    optional_inputs: &[
        Port {
            name: "widgets",
            port_type: PortType::TransferFunction,
            summary: "further widgets, such as those of probes; model and unit_distance are this node's",
        },
        Port {
            name: "volume",
            port_type: PortType::Volume,
            summary: "the data that numbers such as \"25 %\" and \"p90\" are relative to; not read where there are none",
        },
    ],
    outputs: &[Port {
        name: "transfer_function",
        port_type: PortType::TransferFunction,
        summary: "the transfer function",
    }],
    parameters: &[
        Parameter {
            name: "model",
            parameter_type: ParameterType::Choice(&[
                ("density-emitter", "what absorbs glows: a dense medium of its colour"),
                ("constant-emitter", "a widget glows evenly wherever it is above the cutoff"),
            ]),
            unit: "",
            default: DefaultValue::Text("density-emitter"),
            help: "how absorption and glow are related",
        },
        Parameter {
            name: "cutoff",
            parameter_type: ParameterType::Number(Range { below_max: true, ..Range::within(0.0, 1.0) }),
            unit: "share of the peak",
            default: DefaultValue::Number(1.0 / 255.0),
            help: "constant-emitter: where a widget's extinction is below this share of its peak, it does not glow",
        },
        Parameter {
            name: "unit_distance",
            parameter_type: ParameterType::NumberOr(Range::above(0.0), "auto"),
            unit: "world units",
            default: DefaultValue::Text("auto"),
            help: "the length over which extinction is stated; \"auto\": a hundredth of the diagonal of the data, or of the series",
        },
        relative::RELATIVE_TO,
        Parameter {
            name: "widgets",
            parameter_type: ParameterType::Kinds(WIDGET_KINDS),
            unit: "",
            default: DefaultValue::Unset("no widgets: an empty picture"),
            help: "the widgets, whose extinctions add up",
        },
        Parameter {
            name: "s_scale",
            help: "scale of the scalar: widgets have values as positions, and decades as widths",
            ..SCALE
        },
        Parameter {
            name: "s_linear_below",
            help: "\"symlog\" of the scalar: about linear up to this value",
            ..LINEAR_BELOW
        },
        Parameter { name: "g_scale", help: "scale of the gradient magnitude", ..SCALE },
        Parameter { name: "g_linear_below", help: "\"symlog\" of the gradient magnitude", ..LINEAR_BELOW },
    ],
    example: include_str!("examples/stages.toml"),
    early: true,
    check: &|parameters| stood_in(parameters).map(drop),
    outline: &outline,
    demand: &|asking| {
        let asked = asking.asked.clone();
        asking.ask("widgets", &asked)?;
        if asking.parameters.optional_number("unit_distance").is_none() {
            relative::ask_for_series(asking)?;
        }
        relative::ask(asking)
    },
    part_work: PartWork::All,
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

const SCALE: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Choice(&[
        ("linear", "the value itself"),
        ("log", "log10 of the value; what is 0 or less is not drawn"),
        ("symlog", "sign(x) log10(1 + |x|/linear_below), for values of both signs"),
    ]),
    unit: "",
    default: DefaultValue::Text("linear"),
    help: "",
};

const LINEAR_BELOW: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Number(Range::above(0.0)),
    unit: "units of the axis",
    default: DefaultValue::Unset("needed by \"symlog\" alone"),
    help: "",
};

pub(crate) fn axes(p: &Parameters) -> Result<[AxisScale; 2]> {
    let axis = |scale: &str, linear_below: &str| match (p.text(scale)?, p.optional_number(linear_below)) {
        ("symlog", Some(linear_below)) => Ok(AxisScale::SymLog { linear_below }),
        ("symlog", None) => Err(p
            .error(scale, format!("\"symlog\" needs '{linear_below}'"))
            .expected(format!("{linear_below} = a value of the axis, from which on decades count"))),
        (_, Some(found)) => Err(p
            .error(linear_below, format!("'{linear_below}' belongs to \"symlog\" alone"))
            .got(found)
            .expected(format!("{scale} = \"symlog\", or no '{linear_below}'"))),
        ("log", None) => Ok(AxisScale::Log),
        _ => Ok(AxisScale::Linear),
    };
    Ok([axis("s_scale", "s_linear_below")?, axis("g_scale", "g_linear_below")?])
}

/// Files of widgets, found by a function; only the run touches them.
pub(crate) struct FilesFrom<'a>(pub &'a dyn Fn(&str) -> PathBuf);

impl LoadFiles for FilesFrom<'_> {
    fn image(&self, path: &str) -> Result<(usize, usize, Vec<[f32; 4]>)> {
        load_image(&self.0(path))
    }

    fn colors(&self, path: &str) -> Result<ColorCurve> {
        voltet_io::colormaps::read(&self.0(path))
    }
}

/// The transfer function before any data are known.
fn stood_in(p: &Parameters) -> Result<TransferFunctionSpec> {
    look(p, &relative::stood_in(p, &axes(p)?)?, &UnreadFiles)
}

/// Stub of the output while planning, from the stubs of its inputs.
fn outline(parameters: &Parameters, inputs: &[NamedStub]) -> Result<Outputs> {
    let mut look = stood_in(parameters)?;
    for (_, input) in inputs.iter().filter(|(port, _)| *port == "widgets") {
        let Some(Value::TransferFunction(other)) = input else { return Ok(Vec::new()) };
        add(parameters, &mut look, other)?;
    }
    Ok(vec![Value::TransferFunction(Arc::new(look))])
}

/// Adds another's widgets. Extinctions without a length of their own are taken as this node's.
fn add(p: &Parameters, look: &mut TransferFunctionSpec, other: &TransferFunctionSpec) -> Result<()> {
    let factor = match (look.auto_unit_distance, other.auto_unit_distance) {
        (_, true) => 1.0,
        (false, false) => look.transfer_function.unit_distance / other.transfer_function.unit_distance,
        (true, false) => {
            let error =
                p.error("unit_distance", "widgets are wired in whose extinctions have a unit of length");
            let found = format!("unit_distance = {} there", other.transfer_function.unit_distance);
            return Err(error.got(found).expected("a number here too, so that they can be converted"));
        }
    };
    let [own, others] = [&look.transfer_function, &other.transfer_function].map(|function| function.axes);
    if own != others {
        let error = Error::usage("widgets are wired in that stand on axes of other scales than these");
        return Err(error
            .got(format!("{others:?} there, {own:?} here"))
            .expected("the same scales of s and g"));
    }
    let widgets = other.transfer_function.widgets.iter();
    look.transfer_function.widgets.extend(widgets.map(|widget| widget.with_extinction_times(factor)));
    Ok(())
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let widgets = relative::known(call, &axes(call.parameters)?)?;
    let mut look = look(call.parameters, &widgets, &FilesFrom(&|path| call.resolve(path)))?;
    if look.auto_unit_distance {
        look.series_diagonal = relative::series_diagonal(call)?;
    }
    for other in call.looks("widgets")? {
        add(call.parameters, &mut look, &other)?;
    }
    if look.transfer_function.widgets.is_empty() {
        call.notes
            .warnings
            .push("the transfer function has no widgets, so nothing of the volume is drawn".into());
    }
    for (i, (kind, widget)) in call.parameters.kinds("widgets")?.iter().enumerate() {
        if *kind == "table" && widget.is_set("color") {
            let what =
                format!("widget {} is a table, which has its own colours: its color is not used", i + 1);
            call.notes.warnings.push(what);
        }
    }
    Ok(vec![Value::TransferFunction(Arc::new(look))])
}

fn look(p: &Parameters, widgets: &relative::Widgets, files: &dyn LoadFiles) -> Result<TransferFunctionSpec> {
    let model = match p.text("model")? {
        "constant-emitter" => OpticalModel::ConstantEmitter { cutoff: p.number("cutoff")? },
        _ => OpticalModel::DensityEmitter,
    };
    let unit = p.optional_number("unit_distance");
    let axes = axes(p)?;
    let widgets = widgets.iter().map(|(kind, keys)| read(kind, keys, files)).collect::<Result<_>>()?;
    let transfer_function = TransferFunction { model, unit_distance: unit.unwrap_or(1.0), widgets, axes };
    transfer_function.check_axes().map_err(|error| p.locate("widgets", error))?;
    Ok(TransferFunctionSpec::new(transfer_function, unit.is_none()))
}

/// Largest side of a table's picture: far finer than any data, and a gigabyte of texels at most.
const LARGEST_SIDE: u32 = 8192;

/// The picture of a table widget: straight linear RGBA, decoded from 8 or 16-bit sRGB.
pub fn load_image(path: &Path) -> Result<(usize, usize, Vec<[f32; 4]>)> {
    let failed = |error: &dyn std::fmt::Display| {
        Error::run("the picture of a table widget cannot be read")
            .got(error)
            .expected("a PNG file")
            .in_file(path)
    };
    let image = voltet_io::encode::read_image(path, LARGEST_SIDE).map_err(|e| failed(&e))?;
    let rgba = image.into_rgba16();
    let linear = |v: u16| voltet_io::encode::linear_from_srgb(f32::from(v) / 65535.0);
    let texel = |p: &image::Rgba<u16>| [linear(p[0]), linear(p[1]), linear(p[2]), f32::from(p[3]) / 65535.0];
    Ok((rgba.width() as usize, rgba.height() as usize, rgba.pixels().map(texel).collect()))
}
