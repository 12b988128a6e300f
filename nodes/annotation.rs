//! `annotation`: a title, the scale of the colours, axes and a scale bar over a picture.

use std::sync::Arc;
use voltet_core::arithmetic::decimal;
use voltet_core::camera::Projection;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::probing::{Axis, Histogram, histogram};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_figure::canvas::{Canvas, Theme, lacking};
use voltet_figure::font_size;
use voltet_figure::scale::{NamedAxis, Shade, Side, color_bar, plane};
use voltet_figure::space::{View, box_axes, directions, scale_bar};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType,
    Range, RunContext, Value,
};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};

/// The declaration.
pub const NODE: Node = Node {
    name: "annotation",
    summary: "Writes a title, the scale of the colours, axes and a scale bar over a picture.",
    inputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    optional_inputs: &[
        Port {
            name: "transfer_function",
            port_type: PortType::TransferFunction,
            summary: "the one that was drawn: its colours become the bar, or the plane of s and g",
        },
        Port {
            name: "volume",
            port_type: PortType::Volume,
            summary: "the data that were drawn: names, ranges, their distribution behind the plane, the box of the axes",
        },
        Port {
            name: "camera",
            port_type: PortType::Camera,
            summary: "that of the picture, for axes and scale bar",
        },
    ],
    outputs: &[Port {
        name: "image",
        port_type: PortType::Image,
        summary: "the picture with what is written over it",
    }],
    parameters: &[
        Parameter {
            name: "title",
            default: DefaultValue::Unset("no title"),
            help: "at the top; {time}, {file} and {scalar} are those of the volume",
            ..TEXT
        },
        Parameter {
            name: "text",
            default: DefaultValue::Unset("no text"),
            help: "below the title, in smaller letters; {time}, {file} and {scalar} as there",
            ..TEXT
        },
        Parameter {
            name: "bar",
            parameter_type: ParameterType::Choice(&[
                ("right", "at the right border"),
                ("left", "at the left border"),
                ("none", "no bar and no plane"),
            ]),
            default: DefaultValue::Text("right"),
            help: "place of the colour bar, or of the plane of s and g where the transfer function looks at g",
            ..TEXT
        },
        Parameter {
            name: "bar_title",
            default: DefaultValue::Unset("name and unit of the scalar"),
            help: "above the bar, or along s at the plane",
            ..TEXT
        },
        Parameter {
            name: "bar_range",
            parameter_type: ParameterType::Numbers(Some(2), Range::ANY),
            unit: "units of s",
            default: DefaultValue::Unset("the ends of colour maps, or the data's range"),
            help: "values of s at the ends of the bar, or of the plane, [low, high]",
        },
        Parameter { name: "unit", help: "unit of the scalar, as readers shall see it", ..UNIT },
        Parameter {
            name: "axes",
            parameter_type: ParameterType::Choice(&[
                ("none", "no axes"),
                ("box", "ticks at the box of the data, where it meets the background"),
                ("directions", "directions of x, y and z in the corner across from the bar"),
            ]),
            default: DefaultValue::Text("none"),
            help: "axes of space",
            ..TEXT
        },
        Parameter {
            name: "scale_bar",
            parameter_type: ParameterType::Boolean,
            default: DefaultValue::Boolean(false),
            help: "a line of a round length at the lower border; of orthographic cameras alone",
            ..TEXT
        },
        Parameter { name: "length_unit", help: "unit of lengths, at the axes and the scale bar", ..UNIT },
        Parameter {
            name: "theme",
            parameter_type: ParameterType::Choice(&[
                ("dark", "bright letters, for dark backgrounds"),
                ("light", "dark letters, for bright backgrounds"),
            ]),
            default: DefaultValue::Text("dark"),
            help: "colours of letters and lines, by the background of the image-writer",
            ..TEXT
        },
        Parameter {
            name: "scale",
            parameter_type: ParameterType::Number(Range::within(0.25, 8.0)),
            default: DefaultValue::Number(1.0),
            help: "size of the letters; 1: 18 pixels in a picture of 1024 × 768, and more in larger ones",
            ..TEXT
        },
    ],
    example: include_str!("examples/annotation.toml"),
    check: &|p| {
        limits(p)?;
        TEMPLATES.into_iter().filter(|name| p.is_set(name)).try_for_each(|name| pieces(p, name).map(drop))
    },
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

const TEXT: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Text,
    unit: "",
    default: DefaultValue::Text(""),
    help: "",
};

const UNIT: Parameter = Parameter { default: DefaultValue::Unset("no unit"), ..TEXT };

/// The parameters in which names in braces stand for what is known of the data.
const TEMPLATES: [&str; 3] = ["title", "text", "bar_title"];

/// Bins along s and g of the distribution behind the plane.
const BINS: [usize; 2] = [160, 112];

/// Most cells of which the distribution is found, spread evenly over those of the grid.
const MAX_CELLS: usize = 1 << 15;

/// Decades of volume that the plane tells apart.
const DECADES: f64 = 6.0;

/// Optical depth of a segment whose light gives a colour: so little that its front hides nothing of its back.
const THIN: f64 = 1e-4;

/// Extinction under which nothing is seen, as a share of the peak.
const NEGLIGIBLE_EXTINCTION: f64 = 1e-6;

fn demand(asking: &mut DemandContext) -> Result<()> {
    let (p, asked) = (asking.parameters, asking.asked.clone());
    let needs = |name: &str, port: &str| -> Result<()> {
        if asking.fed_by(port)?.is_some() {
            return Ok(());
        }
        let error = p.error(name, format!("'{name}' needs the input '{port}', and nothing is wired to it"));
        Err(error.expected(format!("inputs = {{ {port} = \"NODE\" }} beside the image")))
    };
    let has_scale = p.text("bar")? != "none" && asking.fed_by("transfer_function")?.is_some();
    if p.is_set("bar") && p.text("bar")? != "none" {
        needs("bar", "transfer_function")?;
    }
    for name in ["bar_title", "bar_range"].into_iter().filter(|name| p.is_set(name)) {
        needs(name, "transfer_function")?;
    }
    if p.text("axes")? == "box" {
        needs("axes", "volume")?;
    }
    if p.text("axes")? != "none" {
        needs("axes", "camera")?;
    }
    if p.flag("scale_bar")? {
        needs("scale_bar", "camera")?;
    }
    for name in TEMPLATES.into_iter().filter(|name| p.is_set(name)) {
        if pieces(p, name)?.iter().any(|(_, field)| field.is_some()) {
            needs(name, "volume")?;
        }
    }
    let look = asking.look("transfer_function").filter(|_| has_scale);
    if let Some(look) = &look {
        refuse_fields(p, &look.transfer_function)?;
    }
    let is_plane = has_scale && look.is_none_or(|look| look.transfer_function.uses_gradient_magnitude());
    asking.ask("image", &asked)?;
    asking.ask("volume", &Demand { gradient_magnitude: is_plane, ..Demand::default() })
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let p = call.parameters;
    let mut picture = Picture::clone(&*call.image("image")?);
    let size = [picture.width, picture.height];
    let volume = call.is_wired("volume")?.then(|| call.volume("volume")).transpose()?;
    let texts = TEMPLATES.map(|name| filled(call, name, volume.as_deref()));
    let [title, text, bar_title] = texts;
    let (title, text, bar_title) = (title?, text?, bar_title?);
    let theme = if p.text("theme")? == "light" { Theme::LIGHT } else { Theme::DARK };
    let mut canvas = Canvas::new(&mut picture, theme, font_size(size) * p.number("scale")? as f32);
    let mut missing: Vec<String> = Vec::new();
    let heading = canvas.heading(title.as_deref().unwrap_or(""), text.as_deref().unwrap_or(""));
    if heading.is_none() {
        missing.push("the title".into());
    }
    let side = if p.text("bar")? == "left" { Side::Left } else { Side::Right };
    let mut names = vec![title.clone(), text.clone()];
    if p.text("bar")? != "none" && call.is_wired("transfer_function")? {
        let scale = Scale::new(call, volume.as_deref(), bar_title)?;
        let axes = [Some(&scale.s), scale.plane.as_ref().map(|(axis, _)| axis)];
        names.extend(axes.map(|axis| axis.map(|axis| axis.name.clone())));
        if !scale.draw(&mut canvas, side, heading.unwrap_or(0.0)) {
            missing.push("the scale of the colours".into());
        }
    }
    let axes = p.text("axes")?;
    if axes != "none" || p.flag("scale_bar")? {
        let camera = *call.camera("camera")?;
        if camera.size.map(|side| side as usize) != size {
            let error = Error::usage("the camera is that of a picture of another size");
            let found = format!("{} × {}", camera.size[0], camera.size[1]);
            return Err(error.got(found).expected(format!("that of the image, {} × {}", size[0], size[1])));
        }
        let (view, unit) = (View::new(camera)?, unit(p, "length_unit"));
        names.push(Some(unit.into()));
        if axes == "directions" && !directions(&mut canvas, &view, side.opposite()) {
            missing.push("the directions".into());
        }
        if p.flag("scale_bar")? {
            if let Projection::Perspective { .. } = camera.projection {
                let error = p.error("scale_bar", "in perspective no length is the same everywhere");
                return Err(error.expected("height in place of fov_y at the camera, or axes = \"box\""));
            }
            if scale_bar(&mut canvas, &view, unit).is_none() {
                missing.push("the scale bar".into());
            }
        }
        if let Some(bounds) =
            volume.as_ref().filter(|_| axes == "box").and_then(|volume| volume.grid.bounds())
        {
            let unlabelled = box_axes(&mut canvas, &view, bounds, unit);
            missing.extend(unlabelled.into_iter().map(|axis| format!("the labels of {axis}")));
        }
    }
    if !missing.is_empty() {
        let what = format!("a picture of {} × {} has no room for {}", size[0], size[1], missing.join(", "));
        call.notes.warnings.push(what + ": a smaller scale or a larger picture has");
    }
    let lacking: String = names.iter().flatten().filter_map(|text| lacking(text)).collect();
    if !lacking.is_empty() {
        call.notes.warnings.push(format!("the font has no letters '{lacking}': a box stands for each"));
    }
    Ok(vec![Value::Image(Arc::new(picture))])
}

fn unit<'a>(p: &'a Parameters, name: &str) -> &'a str {
    p.optional(name).and_then(|unit| unit.text()).unwrap_or("")
}

/// A text of a parameter in pieces, each followed by the name of what is to be put in.
fn pieces<'a>(p: &'a Parameters, name: &str) -> Result<Vec<(&'a str, Option<&'a str>)>> {
    let mut parts = p.text(name)?.split('{');
    let mut pieces = vec![(parts.next().unwrap_or(""), None)];
    for part in parts {
        let known = part.split_once('}').filter(|(field, _)| ["time", "file", "scalar"].contains(field));
        let Some((field, rest)) = known else {
            let error = p.error(name, format!("'{name}' has a name in braces that stands for nothing"));
            return Err(error.got(format!("{{{part}")).expected("{time}, {file} or {scalar}"));
        };
        if let Some(last) = pieces.last_mut() {
            last.1 = Some(field);
        }
        pieces.push((rest, None));
    }
    Ok(pieces)
}

/// A text with what its names in braces stand for; `None` where the parameter is not set.
fn filled(call: &RunContext, name: &str, volume: Option<&Volume>) -> Result<Option<String>> {
    let p = call.parameters;
    if !p.is_set(name) {
        return Ok(None);
    }
    let mut text = String::new();
    for (piece, field) in pieces(p, name)? {
        text += piece;
        let known = match field {
            None => continue,
            Some("time") => volume.and_then(|volume| volume.grid.origin.time).map(short),
            Some("scalar") => volume.map(|volume| volume.grid.scalar_name.clone()),
            Some(_) => {
                let files = call.origins().files;
                let data = files.iter().find(|file| file.named.parameter == "path");
                data.and_then(|file| Some(file.path.file_name()?.to_string_lossy().into_owned()))
            }
        };
        let field = field.unwrap_or_default();
        text += &known.ok_or_else(|| {
            let error =
                p.error(name, format!("the {field} of the data is not known")).got(format!("{{{field}}}"));
            error.expected(if field == "time" { "a file that says its time" } else { "data from a file" })
        })?;
    }
    Ok(Some(text))
}

/// Six digits of a number.
fn short(x: f64) -> String {
    if x == 0.0 { "0".into() } else { decimal(x, 1e-6 * x.abs()).to_string() }
}

/// The range that the parameter gives.
fn limits(p: &Parameters) -> Result<Option<[f64; 2]>> {
    let Some(_) = p.optional("bar_range") else { return Ok(None) };
    let [low, high] = p.vector("bar_range")?;
    if low < high {
        return Ok(Some([low, high]));
    }
    let error = p.error("bar_range", "the range of the bar is empty").got(format!("[{low}, {high}]"));
    Err(error.expected("the smaller number first"))
}

/// The scale of a transfer function's colours: along s, or over s and g.
struct Scale {
    function: CompiledTransferFunction,
    /// Largest extinction of a widget, per world unit; above 0.
    peak: f64,
    s: NamedAxis,
    /// The axis of g, where the function looks at it, with the data.
    plane: Option<(NamedAxis, Arc<Distribution>)>,
}

/// The distribution of data with one revision, kept between runs.
struct Distribution(Histogram);

impl Scale {
    fn new(call: &RunContext, volume: Option<&Volume>, title: Option<String>) -> Result<Scale> {
        let p = call.parameters;
        // Extinctions are compared with each other alone, whatever length they are stated for.
        let function = call.look("transfer_function")?.for_diagonal(100.0);
        refuse_fields(p, &function)?;
        let scalar = volume.map_or("s", |volume| volume.grid.scalar_name.as_str());
        let bracketed = |unit: &str| if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let (unit, length) = (unit(p, "unit"), unit(p, "length_unit"));
        let plane = if function.uses_gradient_magnitude() {
            let found = distribution(call, volume)?;
            let per_length = if length.is_empty() { String::new() } else { format!("{unit}/{length}") };
            let per_length = if unit.is_empty() { "" } else { per_length.as_str() };
            let name = format!("|∇{scalar}|{}", bracketed(per_length));
            Some((NamedAxis { name, range: ends(found.0.axes[1]) }, found))
        } else {
            None
        };
        let range = match (limits(p)?, own_range(&function).filter(|_| plane.is_none()), volume) {
            (Some(range), ..) | (None, Some(range), _) => range,
            (None, None, Some(volume)) => ends(Axis::over(&volume.scalar, 1)),
            (None, None, None) => support(&function).ok_or_else(|| {
                let what = "the transfer function has no ends, so the range of the bar is not known";
                p.error("bar", what).expected("inputs = { volume = \"NODE\" }, or bar_range = [low, high]")
            })?,
        };
        let s = NamedAxis { name: title.unwrap_or_else(|| format!("{scalar}{}", bracketed(unit))), range };
        let peak = function.widgets.iter().map(|widget| widget.peak()).fold(f64::MIN_POSITIVE, f64::max);
        let peak = peak / function.unit_distance;
        Ok(Scale { function: CompiledTransferFunction::new(&function)?, peak, s, plane })
    }

    /// Draws it; false where there is no room.
    fn draw(&self, canvas: &mut Canvas, side: Side, top: f32) -> bool {
        let Some((g_axis, Distribution(found))) = self.plane.as_ref().map(|(axis, found)| (axis, &**found))
        else {
            let shade = |[low, high]: [f64; 2]| self.shade([low, 0.0], [high, 0.0]);
            return color_bar(canvas, side, top, &self.s, shade).is_some();
        };
        let most = found.volumes.iter().copied().fold(0.0, f64::max);
        let Theme { ink, rim } = canvas.theme();
        // Thin widgets beside dense ones are seen by the cube root; in linear light a bright ground outshines colours.
        let power = if rim[0] > ink[0] { 1.0 / 6.0 } else { 1.0 / 3.0 };
        let color = |place: [f64; 2]| {
            let volume = volume_at(found, place);
            let level = if volume > 0.0 { (1.0 + (volume / most).log10() / DECADES).max(0.1) } else { 0.0 };
            let ground = [0, 1, 2].map(|k: usize| rim[k] + 0.4 * level as f32 * (ink[k] - rim[k]));
            let Shade { color, extinction } = self.shade(place, place);
            let share = (extinction / self.peak).clamp(0.0, 1.0).powf(power) as f32;
            let over = |k: usize, color: f32| share * color + (1.0 - share) * ground[k];
            let [r, g, b] = color.map_or(ground, |color| [0, 1, 2].map(|k: usize| over(k, color[k])));
            [r, g, b, 1.0]
        };
        plane(canvas, side, [&self.s, g_axis], color).is_some()
    }

    /// The look of a thin segment between two places: C/A, no brighter than a picture shows, and the mean extinction.
    fn shade(&self, front: [f64; 2], back: [f64; 2]) -> Shade {
        // So thin a segment has no order of its widgets.
        let length = THIN / self.peak;
        let segment = Segment { length, front, back, fields_front: &[], fields_back: &[] };
        let Contribution { optical_depth, color, opacity } =
            self.function.integrate(&segment, WidgetBlend::Mix);
        let brightest = color.into_iter().fold(opacity, f64::max);
        let is_seen = optical_depth > NEGLIGIBLE_EXTINCTION * THIN;
        Shade {
            color: is_seen.then(|| color.map(|c| (c / brightest) as f32)),
            extinction: optical_depth / length,
        }
    }
}

fn refuse_fields(p: &Parameters, function: &TransferFunction) -> Result<()> {
    let Some(field) = function.fields().first().map(|field| format!("a widget over '{field}'")) else {
        return Ok(());
    };
    let error = p.error("bar", "no bar and no plane can show the colours of further fields");
    Err(error.got(field).expected("bar = \"none\""))
}

fn ends(axis: Axis) -> [f64; 2] {
    [axis.low, axis.high]
}

/// The ends of all widgets that have colours of their own, such as colour maps.
fn own_range(function: &TransferFunction) -> Option<[f64; 2]> {
    let own = function.widgets.iter().filter(|widget| widget.has_colors_of_its_own());
    union(own.map(|widget| widget.scalar_range()))
}

/// Values between which all widgets are drawn.
fn support(function: &TransferFunction) -> Option<[f64; 2]> {
    union(function.widgets.iter().map(|widget| widget.scalar_range()))
}

fn union(ranges: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let all = ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    (all[0] < all[1] && all[0].is_finite() && all[1].is_finite()).then_some(all)
}

/// The distribution of the data over s and g, up to where nearly all of them are.
fn distribution(call: &RunContext, volume: Option<&Volume>) -> Result<Arc<Distribution>> {
    let without = |what: &str| {
        let error = call
            .parameters
            .error("bar", "the transfer function looks at the gradient, so its colours lie in a plane");
        error.got(what).expected(
            "inputs = { volume = \"NODE\" }, a node of type \"gradient-magnitude\"; or bar = \"none\"",
        )
    };
    let volume = volume.ok_or_else(|| without("no volume"))?;
    let g = volume.gradient_magnitude.as_ref().ok_or_else(|| without("a volume without gradient"))?;
    call.keep(call.revision("volume")?, || {
        let s_axis = Axis::over(&volume.scalar, BINS[0]);
        let whole = Axis { low: 0.0, ..Axis::over(g, 16 * BINS[1]) };
        // All cells where there are few: the exact distribution of many takes as long as the picture.
        let stride = volume.grid.tetrahedra.len().div_ceil(MAX_CELLS).max(1);
        let tetrahedra = volume.grid.tetrahedra.iter().step_by(stride).copied().collect();
        let some = Grid { points: volume.grid.points.clone(), tetrahedra, ..Grid::default() };
        let found = |axes| histogram(&some, [&volume.scalar, g], axes, call.progress());
        let high = found([Axis { bins: 1, ..s_axis }, whole])?.nearly_all();
        Ok(Distribution(found([s_axis, Axis { low: 0.0, high, bins: BINS[1] }])?))
    })
}

/// The volume in the bin of a place; 0 beyond the axes.
fn volume_at(found: &Histogram, place: [f64; 2]) -> f64 {
    let bin = |k: usize| {
        let Axis { low, high, bins } = found.axes[k];
        let share = (place[k] - low) / (high - low);
        (0.0..1.0).contains(&share).then_some((share * bins as f64) as usize)
    };
    let bin = bin(0).zip(bin(1)).map(|(i, j)| j * found.axes[0].bins + i);
    bin.map_or(0.0, |bin| found.volumes[bin])
}
