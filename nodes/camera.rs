//! `camera`: where the picture is seen from.

use crate::relative::{self, RELATIVE_TO, placed};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::arithmetic::unit_vector;
use voltet_core::camera::{Camera, Projection};
use voltet_core::camera_path::{CameraKey, camera_on_way, points_on_orbit};
use voltet_core::grid::extent::corners;
use voltet_core::transfer::with_placeholders;
use voltet_core::{Error, Result};
use voltet_graph::{
    AxisRef, DefaultValue, Demand, Node, Outputs, Parameter, ParameterType, Parameters, PartWork, Port,
    PortType, Range, RelativeNumberType, RunContext, StatisticKind, Value,
};

/// Largest side of a picture, pixels: what the engine counts.
const LARGEST_SIDE: f64 = 32768.0;

/// Most pixels of a picture: 4 GiB of floats.
const MAX_PIXELS: f64 = (1u64 << 28) as f64;

/// Views by name; the first letters are the sign and the axis on whose side the eye is.
const VIEWS: &[(&str, &str)] = &[
    ("+x", "from the positive side of x; z points up"),
    ("-x", "from the negative side of x; z points up"),
    ("+y", "from the positive side of y; z points up"),
    ("-y", "from the negative side of y; z points up"),
    ("+z", "from the positive side of z; y points up"),
    ("-z", "from the negative side of z; y points up"),
    ("isometric", "from the positive sides of x, y and z alike; z points up"),
];

/// Parameters that state a view in words or turn it. A program that sets `eye`, `target`, `up` and the projection unsets them.
pub const VIEW_PARAMETERS: [&str; 9] =
    ["view", "direction", "fit", "azimuth", "elevation", "roll", "zoom", "orbit", "keys"];

/// An angle, degrees, that turns the camera.
const ANGLE: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Number(Range::ANY),
    unit: "degrees",
    default: DefaultValue::Number(0.0),
    help: "",
};

/// Numbers of a key: its place on the way, the eye, the target.
const KEY_LENGTH: usize = 7;

pub const NODE: Node = Node {
    name: "camera",
    summary: "Says where the picture is seen from, how wide the view is and how many pixels it has.",
    optional_inputs: &[Port {
        name: "volume",
        port_type: PortType::Volume,
        summary: "the data that a view is fitted to, or whose bounds percentages in fit are shares of",
    }],
    outputs: &[Port { name: "camera", port_type: PortType::Camera, summary: "the camera" }],
    parameters: &[
        Parameter {
            name: "view",
            parameter_type: ParameterType::Choice(VIEWS),
            unit: "",
            default: DefaultValue::Unset("eye and target"),
            help: "side of the eye; the camera is moved, after the three angles, to where the data just fit the picture",
        },
        Parameter {
            name: "direction",
            parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
            unit: "world space",
            default: DefaultValue::Unset("a view by its word, or eye and target"),
            help: "direction to the eye, in place of a word for the view; a plane's normal: the eye faces the plane",
        },
        Parameter {
            name: "fit",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Numbers(Some(6), Range::ANY),
                statistic: StatisticKind::Place,
                axis: AxisRef::Places(&["x", "x", "y", "y", "z", "z"]),
            }),
            unit: "world units",
            default: DefaultValue::Unset("the bounds of the data"),
            help: "what a view is fitted to: lowest and highest x, y, z; a percentage: of the bounds",
        },
        Parameter {
            name: "eye",
            parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
            unit: "world units",
            default: DefaultValue::Unset("a view"),
            help: "position of the eye; it may lie inside the grid",
        },
        Parameter {
            name: "target",
            parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
            unit: "world units",
            default: DefaultValue::Unset("a view"),
            help: "the point that appears in the middle of the picture",
        },
        Parameter {
            name: "up",
            parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
            unit: "",
            default: DefaultValue::Numbers(&[0.0, 0.0, 1.0]),
            help: "the direction that points up in the picture, not parallel to the view; a view has its own where this is not set",
        },
        Parameter {
            name: "azimuth",
            help: "turns the eye to the right about the target, round the axis up, as Azimuth of vtkCamera",
            ..ANGLE
        },
        Parameter {
            name: "elevation",
            help: "then turns the eye upwards about the target, and leaves up as it is, as Elevation of vtkCamera",
            ..ANGLE
        },
        Parameter {
            name: "roll",
            help: "then turns up to the right about the view direction, so that the picture turns left, as Roll of vtkCamera",
            ..ANGLE
        },
        Parameter {
            name: "zoom",
            parameter_type: ParameterType::Number(Range::above(0.0)),
            unit: "",
            default: DefaultValue::Number(1.0),
            help: "divides fov_y, or the height, at last, as Zoom of vtkCamera: above 1 all looks larger",
        },
        Parameter {
            name: "fov_y",
            parameter_type: ParameterType::Number(Range::between(0.0, 180.0)),
            unit: "degrees",
            default: DefaultValue::Unset("30 unless height is given"),
            help: "vertical field of view of a perspective camera",
        },
        Parameter {
            name: "height",
            parameter_type: ParameterType::NumberOr(Range::above(0.0), "auto"),
            unit: "world units",
            default: DefaultValue::Unset("a perspective camera"),
            help: "height of the picture of an orthographic camera, in place of fov_y; \"auto\": what a view is fitted by",
        },
        Parameter {
            name: "near",
            parameter_type: ParameterType::Number(Range::at_least(0.0)),
            unit: "world units",
            default: DefaultValue::Number(0.0),
            help: "what is nearer along the view direction is cut off",
        },
        Parameter {
            name: "size",
            parameter_type: ParameterType::Integers(2, Range::within(1.0, LARGEST_SIDE)),
            unit: "pixels",
            default: DefaultValue::Integers(&[1024, 768]),
            help: "width and height of the picture",
        },
        Parameter {
            name: "samples",
            parameter_type: ParameterType::Integer(Range::within(1.0, 256.0)),
            unit: "",
            default: DefaultValue::Integer(1),
            help: "rays a pixel",
        },
        Parameter {
            help: "the data whose bounds a view is fitted to: over a series the picture then does not move with them",
            ..RELATIVE_TO
        },
        Parameter {
            name: "orbit",
            help: "angle that the camera turns about its target, as azimuth does, on its way through several pictures",
            ..ANGLE
        },
        Parameter {
            name: "keys",
            parameter_type: ParameterType::Rows(Some(KEY_LENGTH)),
            unit: "world units",
            default: DefaultValue::Unset("none: the camera stands still, or turns by orbit"),
            help: "the way in place of eye and target, in rows: share of it (0 to 1), x, y, z of the eye, x, y, z of the target",
        },
        Parameter {
            name: "phase",
            parameter_type: ParameterType::Number(Range::within(0.0, 1.0)),
            unit: "share of the way",
            default: DefaultValue::Number(0.0),
            help: "the camera's place on its way by orbit and keys; `voltet run --steps` and `--frames` set it for each picture",
        },
    ],
    example: include_str!("examples/camera.toml"),
    early: true,
    check: &|parameters| camera(&with_placeholders(parameters)?, Some([DVec3::ZERO, DVec3::ONE])).map(drop),
    // Bounds need points alone.
    demand: &|asking| asking.ask("volume", &Demand::default()),
    part_work: PartWork::All,
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    let p = call.parameters;
    let is_relative = !p.relative_numbers().is_empty();
    let view = ["view", "direction"].into_iter().find(|name| p.is_set(name));
    let camera = match view {
        Some(view) if is_relative || p.optional("fit").is_none() => {
            if !call.is_wired("volume")? {
                let what = "the view is relative to data, and no data are wired in";
                let error = p.error(if is_relative { "fit" } else { view }, what);
                return Err(error.needs_input("volume", " at the camera, or numbers in fit"));
            }
            let bounds = relative::bounds(call)?;
            camera(&placed(p, bounds)?, bounds)?
        }
        _ => camera(p, None)?,
    };
    Ok(vec![Value::Camera(Arc::new(camera))])
}

/// The camera that the parameters state; its axes are known to be sound. `bounds`: those of the data, where a view is fitted to them.
fn camera(p: &Parameters, bounds: Option<[DVec3; 2]>) -> Result<Camera> {
    let side = side(p)?;
    let key = key(p)?;
    let is_auto = p.optional("height").is_some_and(|height| height.text().is_some());
    let projection = match (p.optional_number("fov_y"), p.optional_number("height")) {
        (Some(_), height) if height.is_some() || is_auto => {
            return Err(p
                .error("height", "'fov_y' and 'height' exclude each other")
                .expected("fov_y for a perspective camera, height for an orthographic one"));
        }
        (None, None) if is_auto => Projection::Orthographic { height: 1.0 },
        (_, Some(height)) => Projection::Orthographic { height },
        (fov_y, None) => Projection::Perspective { fov_y: fov_y.unwrap_or(30.0) },
    };
    let [width, height]: [f64; 2] = p.vector("size")?;
    if width * height > MAX_PIXELS {
        let error = p.error("size", "the picture has too many pixels").got(width * height);
        return Err(error.expected(format!("width × height of at most {MAX_PIXELS}")));
    }
    refuse_contradictions(p, side.is_some(), key.is_some(), is_auto)?;
    let (eye, target, own_up) = match side {
        Some(side) if side.reject_from(DVec3::Z).length() < ALONG_Z => (side, DVec3::ZERO, DVec3::Y),
        Some(side) => (side, DVec3::ZERO, DVec3::Z),
        None => {
            let [eye, target] = match key {
                Some(places) => places,
                None => [p.vector("eye")?.into(), p.vector("target")?.into()],
            };
            (eye, target, p.vector("up")?.into())
        }
    };
    let camera = Camera {
        eye,
        target,
        up: if p.is_set("up") { p.vector("up")?.into() } else { own_up },
        projection,
        near: p.number("near")?,
        // Within the declared range, so nothing is lost.
        size: [width as u32, height as u32],
        samples: p.integer("samples")? as u32,
    };
    let place = if eye == target { "target" } else { "up" };
    camera.frame().map_err(|error| p.locate(place, error))?;
    let angles = [p.number("azimuth")?, p.number("elevation")?, p.number("roll")?];
    let (orbit, axis, mut middle) = (p.number("orbit")?, camera.up, camera.target);
    let mut camera = camera.turned(angles).map_err(|error| p.locate("elevation", error))?;
    if side.is_some() {
        let ends = ends(p, bounds)?;
        let mut points = corners(ends).to_vec();
        if orbit != 0.0 {
            // The picture holds the data wherever on its orbit the camera is, from one distance.
            middle = ends[0] * 0.5 + ends[1] * 0.5;
            points = points_on_orbit(&points, middle, axis, orbit);
        }
        camera = camera.fitted(&points).map_err(|error| p.locate("fit", error))?;
        // A height that is given stays; the picture is fitted by its middle then.
        camera.projection = if is_auto { camera.projection } else { projection };
    }
    let camera = camera.zoomed(p.number("zoom")?).turned_about(middle, axis, orbit * p.number("phase")?);
    camera.frame().map_err(|error| p.locate("zoom", error))?;
    Ok(camera)
}

/// Eye and target on the way that `keys` state, at `phase`; `None` where there is no way.
fn key(p: &Parameters) -> Result<Option<[DVec3; 2]>> {
    if p.optional("keys").is_none() {
        return Ok(None);
    }
    let rows = p.rows("keys")?;
    let keys: Vec<CameraKey> = rows
        .iter()
        .map(|row| CameraKey {
            place: row[0],
            eye: DVec3::from_slice(&row[1..4]),
            target: DVec3::from_slice(&row[4..7]),
        })
        .collect();
    let [eye, target] = camera_on_way(&keys, p.number("phase")?).map_err(|error| p.locate("keys", error))?;
    Ok(Some([eye, target]))
}

/// Refuses parameters that exclude each other, or that only a view has a use for.
fn refuse_contradictions(p: &Parameters, is_view: bool, has_keys: bool, is_auto: bool) -> Result<()> {
    let places = ["eye", "target"];
    if has_keys {
        let others = ["eye", "target", "view", "direction"];
        let Some(other) = others.into_iter().find(|name| p.optional(name).is_some()) else { return Ok(()) };
        let error = p.error(other, format!("'keys' and '{other}' exclude each other"));
        return Err(error.expected("the places of keys, or one place of the camera"));
    }
    if is_view {
        let Some(place) = places.into_iter().find(|place| p.optional(place).is_some()) else { return Ok(()) };
        let view = if p.is_set("view") { "view" } else { "direction" };
        let error = p.error(place, format!("'{view}' and '{place}' exclude each other"));
        let found = p.get(view)?;
        return Err(error.got(format!("{view} = {}", found.datum)).expected("a view, or eye and target"));
    }
    if let Some(place) = places.into_iter().find(|place| p.optional(place).is_none()) {
        let error = p.error(place, format!("the camera has no '{place}'"));
        return Err(error.expected("eye = [x, y, z] and target = [x, y, z], or view = \"isometric\""));
    }
    let needs_view = |name: &str, what: &str| {
        Err(p.error(name, format!("{what} belongs to a view")).expected("a view in place of eye and target"))
    };
    match (p.optional("fit").is_some(), is_auto) {
        (true, _) => needs_view("fit", "'fit'"),
        (_, true) => needs_view("height", "height = \"auto\""),
        _ => Ok(()),
    }
}

/// Sine of the angle to z below which y points up in a view.
const ALONG_Z: f64 = 1e-6;

/// Direction to the eye of a view; `None`: eye and target are given. Of length 1, or by its word.
fn side(p: &Parameters) -> Result<Option<DVec3>> {
    if !p.is_set("direction") {
        return p.optional("view").map(|_| Ok(direction_of(p.text("view")?))).transpose();
    }
    if p.is_set("view") {
        let error = p.error("direction", "'view' and 'direction' exclude each other");
        return Err(error.expected("one of them"));
    }
    match unit_vector(p.vector("direction")?.into()) {
        DVec3::ZERO => {
            Err(p.error("direction", "the direction has no length").expected("a vector that is not zero"))
        }
        unit => Ok(Some(unit)),
    }
}

/// Direction to the eye of a view of this name.
fn direction_of(view: &str) -> DVec3 {
    let sign = if view.starts_with('-') { -1.0 } else { 1.0 };
    let axis = ["x", "y", "z"].iter().position(|axis| view[1..] == **axis);
    axis.map_or(DVec3::ONE, |axis| sign * DVec3::AXES[axis])
}

/// The box that a view is fitted to.
fn ends(p: &Parameters, bounds: Option<[DVec3; 2]>) -> Result<[DVec3; 2]> {
    if p.optional("fit").is_none() {
        let none = || Error::run("the data have no points, so no view of them can be fitted");
        return bounds.ok_or_else(none);
    }
    let [x0, x1, y0, y1, z0, z1]: [f64; 6] = p.vector("fit")?;
    let ends = [DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)];
    if ends[0].cmpgt(ends[1]).any() {
        let error = p.error("fit", "the box is empty").got(format!("from {} to {}", ends[0], ends[1]));
        return Err(error.expected("lowest x, highest x, lowest y, highest y, lowest z, highest z"));
    }
    Ok(ends)
}
