//! `annotation`: a title, texts, the scale of the colours, axes and a scale bar over a picture.

use crate::color_scale::{ColorScale, limits, refuse_fields};
use std::sync::Arc;
use voltet_core::arithmetic::decimal;
use voltet_core::camera::Projection;
use voltet_core::parameters::VariantSchema;
use voltet_core::picture::Picture;
use voltet_core::picture_parts::{Annotation, PictureParts};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_figure::canvas::{Align, Canvas, Theme};
use voltet_figure::font_size;
use voltet_figure::note::{Anchor, note};
use voltet_figure::scale::{Border, Side};
use voltet_figure::space::{View, box_axes, directions, scale_bar};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType,
    Range, RunContext, Value,
};

pub const NODE: Node = Node {
    name: "annotation",
    summary: "Writes a title, texts, the scale of the colours, axes and a scale bar over a picture.",
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
            name: "texts",
            parameter_type: ParameterType::Kinds(TEXT_KINDS),
            default: DefaultValue::Unset("no texts"),
            help: "texts of one's own; {time}, {file} and {scalar} as in the title",
            ..TEXT
        },
        Parameter {
            name: "bar",
            parameter_type: ParameterType::Choice(&[
                ("right", "at the right border"),
                ("left", "at the left border"),
                ("bottom", "level at the lower border; a plane in the lower right corner"),
                ("top", "level at the upper border, below the title; a plane in the lower right corner"),
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
        Parameter {
            name: "unit",
            help: "unit of the scalar, as readers shall see it",
            default: DefaultValue::Unset("that of the file, or none"),
            ..UNIT
        },
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
        TEMPLATES.into_iter().filter(|name| p.is_set(name)).try_for_each(|name| pieces(p, name).map(drop))?;
        p.kinds("texts")?.iter().try_for_each(|(_, own)| pieces(own, "text").map(drop))
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

/// Places of texts of one's own.
const TEXT_KINDS: &[VariantSchema] = &[
    VariantSchema {
        name: "border",
        summary: "a text in a corner or at the middle of a border; it gives way to what stands there",
        parameters: &[
            OWN_TEXT,
            Parameter {
                name: "at",
                parameter_type: ParameterType::Choice(&[
                    ("top-left", "upper left corner"),
                    ("top", "upper border, below the title"),
                    ("top-right", "upper right corner"),
                    ("left", "left border"),
                    ("right", "right border"),
                    ("bottom-left", "lower left corner"),
                    ("bottom", "lower border"),
                    ("bottom-right", "lower right corner"),
                ]),
                default: DefaultValue::Text("bottom-left"),
                help: "where it stands",
                ..TEXT
            },
            Parameter {
                name: "margin",
                parameter_type: ParameterType::Number(Range::within(0.3, 100.0)),
                unit: "heights of letters",
                default: DefaultValue::Number(0.8),
                help: "least distance from the border",
            },
        ],
    },
    VariantSchema {
        name: "point",
        summary: "a text at a point of the picture, which stands there or is left out",
        parameters: &[
            OWN_TEXT,
            Parameter {
                name: "at",
                parameter_type: ParameterType::Numbers(Some(2), Range::within(0.0, 1.0)),
                unit: "shares of width and height",
                default: DefaultValue::Required,
                help: "the point, from the upper left corner: [0.5, 0.5] is the middle",
            },
            Parameter {
                name: "align",
                parameter_type: ParameterType::Choice(&[
                    ("start", "the text begins there"),
                    ("middle", "its middle is there"),
                    ("end", "it ends there"),
                ]),
                default: DefaultValue::Text("start"),
                help: "the part of the text that is at the point",
                ..TEXT
            },
        ],
    },
];

const OWN_TEXT: Parameter =
    Parameter { name: "text", default: DefaultValue::Required, help: "the text; \\n begins a line", ..TEXT };

/// Least height of letters of scale 1, pixels.
const MIN_FONT: f32 = 10.0;

/// The parameters in which names in braces stand for what is known of the data.
const TEMPLATES: [&str; 3] = ["title", "text", "bar_title"];

fn demand(asking: &mut DemandContext) -> Result<()> {
    let (p, asked) = (asking.parameters, asking.asked.clone());
    let (axes, is_shown) = (p.text("axes")?, p.text("bar")? != "none");
    let mut needs = vec![
        ("bar", "transfer_function", p.is_set("bar") && is_shown),
        ("bar_title", "transfer_function", p.is_set("bar_title")),
        ("bar_range", "transfer_function", p.is_set("bar_range")),
        ("axes", "volume", axes == "box"),
        ("axes", "camera", axes != "none"),
        ("scale_bar", "camera", p.flag("scale_bar")?),
    ];
    for name in TEMPLATES.into_iter().filter(|name| p.is_set(name)) {
        needs.push((name, "volume", pieces(p, name)?.len() > 1));
    }
    for (_, own) in p.kinds("texts")? {
        needs.push(("texts", "volume", pieces(&own, "text")?.len() > 1));
    }
    for (name, port, _) in needs.into_iter().filter(|(.., is_needed)| *is_needed) {
        if asking.fed_by(port)?.is_none() {
            let error =
                p.error(name, format!("'{name}' needs the input '{port}', and nothing is wired to it"));
            return Err(error.expected(format!("inputs = {{ {port} = \"NODE\" }} beside the image")));
        }
    }
    let has_scale = is_shown && asking.fed_by("transfer_function")?.is_some();
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
    let parts = call.picture_parts("image")?;
    // An annotation under this one goes on.
    let begun = call.demand.shapes.then(|| match &parts.annotation {
        Some(annotation) => Annotation::clone(annotation),
        None => Annotation { ground: Picture::clone(&parts.picture), shapes: Vec::new() },
    });
    let mut picture = Picture::clone(&parts.picture);
    let size = [picture.width, picture.height];
    let theme = if p.text("theme")? == "light" { Theme::LIGHT } else { Theme::DARK };
    let mut font = font_size(size);
    match call.allows_preview() && font < MIN_FONT {
        // Of a coarse picture that is shown larger.
        true => call.mark_preview(),
        false => font = font.max(MIN_FONT),
    }
    font *= p.number("scale")? as f32;
    let mut canvas = Canvas::new(&mut picture, theme, font);
    if let Some(begun) = begun {
        canvas = canvas.recording(begun);
    }
    let missing = write(call, &mut canvas)?;
    let lacking = canvas.lacking();
    if !lacking.is_empty() {
        call.notes.warnings.push(format!("the font has no letters '{lacking}': a box stands for each"));
    }
    if !missing.is_empty() {
        let what = format!("a picture of {} × {} has no room for {}", size[0], size[1], missing.join(", "));
        call.notes.warnings.push(what + ": a smaller scale or a larger picture has");
    }
    let annotation = canvas.into_record().map(Arc::new);
    let picture = Arc::new(picture);
    Ok(vec![match (&annotation, parts.layers) {
        (None, None) => Value::Image(picture),
        (_, layers) => Value::PictureParts(Arc::new(PictureParts { picture, layers, annotation })),
    }])
}

/// Writes what the parameters state; gives names of what has no room.
fn write(call: &RunContext, canvas: &mut Canvas) -> Result<Vec<String>> {
    let p = call.parameters;
    let volume = call.is_wired("volume")?.then(|| call.volume("volume")).transpose()?;
    let [title, text, bar_title] = TEMPLATES.map(|name| filled(call, p, name, volume.as_deref()));
    let mut missing: Vec<String> = Vec::new();
    let heading = canvas.heading(&title?.unwrap_or_default(), &text?.unwrap_or_default());
    if heading.is_none() {
        missing.push("the title".into());
    }
    let bar = p.text("bar")?;
    let side = if bar == "left" { Side::Left } else { Side::Right };
    if bar != "none" && call.is_wired("transfer_function")? {
        let grid = volume.as_ref().map(|volume| &volume.grid);
        let of_file =
            grid.and_then(|grid| grid.origin.units.get(&grid.scalar_name)).map_or("", String::as_str);
        let of_scalar = if p.is_set("unit") { unit(p, "unit") } else { of_file };
        let units = [of_scalar, unit(p, "length_unit")];
        let scale = ColorScale::new(call, volume.as_deref(), bar_title?, units)?;
        let border = match bar {
            "top" => Some(Border::Top),
            "bottom" => Some(Border::Bottom),
            _ => None,
        };
        if !scale.draw(canvas, side, border, heading.unwrap_or(0.0)) {
            missing.push("the scale of the colours".into());
        }
    }
    let axes = p.text("axes")?;
    let view = match axes != "none" || p.flag("scale_bar")? {
        true => Some(view(call, canvas.size())?),
        false => None,
    };
    let length_unit = unit(p, "length_unit");
    if let Some(view) = &view {
        if axes == "directions" && !directions(canvas, view, side.opposite()) {
            missing.push("the directions".into());
        }
        if p.flag("scale_bar")? && scale_bar(canvas, view, length_unit).is_none() {
            missing.push("the scale bar".into());
        }
    }
    for (kind, own) in p.kinds("texts")? {
        let text = filled(call, &own, "text", volume.as_deref())?.unwrap_or_default();
        if !note(canvas, &text, anchor(kind, &own)?) {
            missing.push(format!("the text '{text}'"));
        }
    }
    let bounds = volume.as_ref().filter(|_| axes == "box").and_then(|volume| volume.grid.bounds());
    if let Some((view, bounds)) = view.zip(bounds) {
        let unlabelled = box_axes(canvas, &view, bounds, length_unit);
        missing.extend(unlabelled.into_iter().map(|axis| format!("the labels of {axis}")));
    }
    Ok(missing)
}

/// The view of the picture. Errors: a camera of another picture; a scale bar in perspective.
fn view(call: &RunContext, size: [f32; 2]) -> Result<View> {
    let p = call.parameters;
    let camera = *call.camera("camera")?;
    if camera.size.map(|side| side as f32) != size {
        let error = Error::usage("the camera is that of a picture of another size");
        let found = format!("{} × {}", camera.size[0], camera.size[1]);
        return Err(error.got(found).expected(format!("that of the image, {} × {}", size[0], size[1])));
    }
    if let (true, Projection::Perspective { .. }) = (p.flag("scale_bar")?, camera.projection) {
        let error = p.error("scale_bar", "in perspective no length is the same everywhere");
        return Err(error.expected("height in place of fov_y at the camera, or axes = \"box\""));
    }
    View::new(camera)
}

/// Position of a text of one's own.
fn anchor(kind: &str, p: &Parameters) -> Result<Anchor> {
    if kind == "point" {
        let share = p.vector::<2>("at")?.map(|share| share as f32);
        let align = match p.text("align")? {
            "start" => Align::Start,
            "middle" => Align::Middle,
            _ => Align::End,
        };
        return Ok(Anchor::Point { share, align });
    }
    let at = p.text("at")?;
    let end = |low: &str, high: &str| match at {
        _ if at.contains(low) => Align::Start,
        _ if at.contains(high) => Align::End,
        _ => Align::Middle,
    };
    let margin = p.number("margin")? as f32;
    Ok(Anchor::Border { across: end("left", "right"), down: end("top", "bottom"), margin })
}

fn unit<'a>(p: &'a Parameters, name: &str) -> &'a str {
    p.optional(name).and_then(|unit| unit.text()).unwrap_or("")
}

/// A text of a parameter in pieces, each after the name of what is to be put in before it.
fn pieces<'a>(p: &'a Parameters, name: &str) -> Result<Vec<(Option<&'a str>, &'a str)>> {
    let known = |part: &'a str| {
        let known = part.split_once('}').filter(|(field, _)| ["time", "file", "scalar"].contains(field));
        let unknown = || {
            let error = p.error(name, format!("'{name}' has a name in braces that stands for nothing"));
            error.got(format!("{{{part}")).expected("{time}, {file} or {scalar}")
        };
        known.map(|(field, rest)| (Some(field), rest)).ok_or_else(unknown)
    };
    let parts = p.text(name)?.split('{').enumerate();
    parts.map(|(k, part)| if k == 0 { Ok((None, part)) } else { known(part) }).collect()
}

/// A text of a parameter with what its names in braces stand for; `None` where the parameter is not set.
fn filled(call: &RunContext, p: &Parameters, name: &str, volume: Option<&Volume>) -> Result<Option<String>> {
    if !p.is_set(name) {
        return Ok(None);
    }
    let mut text = String::new();
    for (field, rest) in pieces(p, name)? {
        let (known, wanted) = match field {
            None => (Some(String::new()), ""),
            Some("time") => {
                let time = volume.and_then(|volume| volume.grid.origin.time);
                (time.map(|time| decimal(time, 1e-6 * time.abs()).to_string()), "a file that says its time")
            }
            Some("scalar") => (volume.map(|volume| volume.grid.scalar_name.clone()), "a volume"),
            Some(_) => {
                let files = call.origins().files;
                let data = files.iter().find(|file| file.named.parameter == "path");
                let file = data.and_then(|file| file.path.file_name());
                (file.map(|name| name.to_string_lossy().into_owned()), "data from a file")
            }
        };
        text += &known.ok_or_else(|| {
            let field = field.unwrap_or_default();
            p.error(name, format!("the {field} of the data is not known"))
                .got(format!("{{{field}}}"))
                .expected(wanted)
        })?;
        text += rest;
    }
    Ok(Some(text))
}
