//! Surfaces: paint with its parameters, declared once for the nodes that make surfaces, and the quantities of a volume that they
//! look at.

pub mod tubing;

use crate::relative::{self, DataScope, ORIGIN, RADIUS, SpatialRegion, note_numbers};
use crate::transfer_function::FilesFrom;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::grid::{GridSurface, point_normals, sharp_triangles};
use voltet_core::parameters::RelativeNumber;
use voltet_core::probing::value_range;
use voltet_core::progress::Progress;
use voltet_core::surface::{EyeLight, Paint, Surface};
use voltet_core::transfer::{CURVE_PARAMETERS, DataStatistics, color_curve, resolved, with_placeholders};
use voltet_core::volume::Volume;
use voltet_core::{Result, counted};
use voltet_graph::{
    ArrayRef, AxisRef, DefaultValue, DemandContext, Outputs, Parameter, ParameterType, Parameters, Port,
    PortType, Range, RelativeNumberType, RunContext, StatisticKind, Value,
};

/// The output of the nodes that make surfaces.
pub const OUTPUTS: &[Port] =
    &[Port { name: "surface", port_type: PortType::Surface, summary: "triangles with their colours" }];

/// The input of those that make them of a volume.
pub const INPUTS: &[Port] =
    &[Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" }];

const PAINT_COUNT: usize = 8;

/// A node's own parameters and those of paint. `color_by`, `opacity` and `ambient`: what they are where the file sets none.
pub const fn with_paint<const OWN: usize, const ALL: usize>(
    own: [Parameter; OWN],
    color_by: &'static str,
    opacity: f64,
    ambient: f64,
) -> [Parameter; ALL] {
    let paint = paint_parameters(color_by, opacity, ambient);
    assert!(ALL == OWN + PAINT_COUNT);
    let mut all = [paint[0]; ALL];
    let mut place = 0;
    while place < ALL {
        all[place] = if place < OWN { own[place] } else { paint[place - OWN] };
        place += 1;
    }
    all
}

/// The parameters of colours by values: `color_by`, those of the map, and `range`. `color_by`: what it is where the file sets none.
pub const fn map_parameters(color_by: &'static str) -> [Parameter; 5] {
    let [colormap, reversed, steps] = CURVE_PARAMETERS;
    [
        Parameter {
            name: "color_by",
            default: DefaultValue::Unset(color_by),
            help: "colours by values: \"s\", the scalar; \"g\", its gradient magnitude; or a point array",
            ..QUANTITY
        },
        colormap,
        reversed,
        steps,
        Parameter {
            name: "range",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Numbers(Some(2), Range::ANY),
                statistic: StatisticKind::Value,
                axis: AxisRef::Every("color_by"),
            }),
            unit: "units of color_by",
            default: DefaultValue::Texts(&["0 %", "100 %"]),
            help: "values at the map's first and last colour, which hold beyond it; default: all of the data",
        },
    ]
}

/// Names of [`map_parameters`].
pub(crate) const OF_MAP: [&str; 5] = ["color_by", "colormap", "reversed", "steps", "range"];

const fn paint_parameters(color_by: &'static str, opacity: f64, ambient: f64) -> [Parameter; PAINT_COUNT] {
    let [color_by, colormap, reversed, steps, range] = map_parameters(color_by);
    [
        Parameter {
            name: "color",
            parameter_type: ParameterType::Color(Range::at_least(0.0)),
            unit: "linear RGB",
            default: DefaultValue::Unset("colours by value, or else a light grey"),
            help: "one colour for all",
        },
        color_by,
        colormap,
        reversed,
        steps,
        range,
        Parameter {
            name: "opacity",
            parameter_type: ParameterType::Number(Range::within(0.0, 1.0)),
            unit: "",
            default: DefaultValue::Number(opacity),
            help: "opacity of one crossing",
        },
        Parameter {
            name: "ambient",
            parameter_type: ParameterType::Number(Range::within(0.0, 1.0)),
            unit: "",
            default: DefaultValue::Number(ambient),
            help: "share of the colour that needs no light; the rest faces the eye, and 1 leaves the colour as it is",
        },
    ]
}

/// A quantity at the points of a volume.
pub const QUANTITY: Parameter = Parameter {
    name: "array",
    parameter_type: ParameterType::ArrayName,
    unit: "",
    default: DefaultValue::Text("s"),
    help: "\"s\", the scalar; \"g\", its gradient magnitude; or a point array",
};

/// Normals of points in place of each triangle's own.
pub const SMOOTH: Parameter = Parameter {
    name: "smooth",
    parameter_type: ParameterType::Boolean,
    unit: "",
    default: DefaultValue::Boolean(true),
    help: "true: light by normals at the points, averaged over triangles; false: by each triangle's own",
};

/// Mistakes in the paint that no declaration tells.
pub fn check(p: &Parameters) -> Result<()> {
    if let Some(name) = OF_MAP.into_iter().find(|name| p.is_set("color") && p.is_set(name)) {
        let error = p.error(name, format!("'color' and '{name}' exclude each other"));
        return Err(error.expected("one colour, or the colours of a map"));
    }
    range(&with_placeholders(p)?).map(drop)
}

/// The range of values over which a map's colours go. Errors: it is empty.
pub(crate) fn range(p: &Parameters) -> Result<[f64; 2]> {
    match p.vector("range")? {
        [low, high] if low <= high => Ok([low, high]),
        [low, high] => {
            let error = p.error("range", "the range is empty").got(format!("[{low}, {high}]"));
            Err(error.expected("the smaller number first; reversed = true turns the colours round"))
        }
    }
}

/// The quantity that gives the colours; `None`: one colour. `otherwise`: where the file names neither.
pub fn color_by<'a>(p: &'a Parameters, otherwise: Option<&'a str>) -> Option<&'a str> {
    match p.optional("color_by").and_then(|setting| setting.text()) {
        _ if p.is_set("color") => None,
        None => otherwise,
        named => named,
    }
}

pub(crate) fn quantity(name: &str) -> ArrayRef {
    match name {
        "s" => ArrayRef::Named("s"),
        "g" => ArrayRef::Named("g"),
        _ => ArrayRef::Array(name.into()),
    }
}

/// Asks at the input `volume` for these quantities.
pub fn ask(asking: &mut DemandContext, names: [Option<&str>; 2]) -> Result<()> {
    let quantities: Vec<ArrayRef> = names.into_iter().flatten().map(quantity).collect();
    asking.ask("volume", &relative::demand_for(&quantities))
}

/// Values of a quantity, one a point; an error is at the parameter of this name.
pub fn values<'a>(p: &Parameters, parameter: &str, volume: &'a Volume, name: &str) -> Result<&'a [f64]> {
    relative::values(volume, &quantity(name)).map_err(|error| p.locate(parameter, error))
}

/// Statistics of a volume, and of the quantities that the parameters `array` and `color_by` name.
pub(crate) struct VolumeStatistics<'a> {
    pub volume: &'a Volume,
    pub array: &'a str,
    pub color_by: Option<&'a str>,
    pub progress: &'a dyn Progress,
    /// Statistics of the quantities over steps of a series, in place of those of the volume.
    pub series: Option<&'a dyn DataStatistics>,
    /// Bounds of the volume, for places.
    pub bounds: Option<[DVec3; 2]>,
}

impl VolumeStatistics<'_> {
    fn named(&self, quantity: &ArrayRef) -> Option<ArrayRef> {
        named_quantity(quantity, self.array, self.color_by)
    }
}

impl DataStatistics for VolumeStatistics<'_> {
    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        match (self.named(quantity), self.series) {
            (Some(named), Some(series)) => series.range(&named),
            (Some(named), None) => value_range(relative::values(self.volume, &named)?),
            (None, _) => SpatialRegion::from_known(self.bounds)?.range(quantity),
        }
    }

    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64> {
        match (self.named(quantity), self.series) {
            (Some(named), Some(series)) => series.percentile(&named, percent),
            (Some(named), None) => {
                let volumes = relative::volumes(self.volume, &named, self.progress)?;
                volumes.percentile(percent, self.progress)
            }
            (None, _) => SpatialRegion::from_known(self.bounds)?.percentile(quantity, percent),
        }
    }
}

/// The parameters of a node that cuts a volume, with numbers for those relative to it.
pub fn known_of_volume(
    call: &mut RunContext,
    volume: &Volume,
    array: &str,
    color_by: Option<&str>,
) -> Result<Parameters> {
    let unused: &[&str] = if color_by.is_some() { &[] } else { &["range"] };
    let mut p = unused.iter().fold(call.parameters.clone(), |p, name| p.with(name, None));
    let numbers = p.relative_numbers();
    let is_place = |number: &RelativeNumber| named_quantity(&number.quantity, array, color_by).is_none();
    let bounds = if numbers.iter().any(is_place) { volume.grid.bounds() } else { None };
    if bounds.is_none() && p.optional(ORIGIN.name).is_some() && !p.is_set(ORIGIN.name) {
        // Nothing is cut of a volume without points, wherever the plane is.
        p = p.with(ORIGIN.name, Some([0.0; 3].into_iter().collect()));
    }
    let scope = DataScope::from_parameters(&p)?;
    if scope == DataScope::Step || numbers.iter().all(is_place) {
        let over = if scope == DataScope::Step { "over the data" } else { "over the bounds" };
        return noted(call, p, over, |p, progress| {
            resolved(p, &VolumeStatistics { volume, array, color_by, progress, series: None, bounds })
        });
    }
    let quantities: Vec<ArrayRef> = [Some(array), color_by].into_iter().flatten().map(quantity).collect();
    let demand = relative::demand_for(&quantities);
    let of_name = |named: &ArrayRef| named_quantity(named, array, color_by);
    let series = relative::known_of_series(call, &p, scope, &demand, &of_name, &|_| Ok(None))?;
    let own = {
        let (progress, series) = (call.progress(), Some(series.statistics()));
        resolved(&p, &VolumeStatistics { volume, array, color_by, progress, series, bounds })?
    };
    // Places are shares of the step that is drawn.
    let of_step =
        |p: Parameters, name: &str| p.with(name, own.optional(name).map(|known| known.datum.clone()));
    let placed = [ORIGIN.name, RADIUS.name].into_iter().fold(p.clone(), of_step);
    for (before, after, over) in [(&p, &placed, "over the bounds"), (&placed, &own, &*series.over)] {
        if before != after {
            note_numbers(&mut call.notes, "surface", over, before, after);
        }
    }
    Ok(own)
}

/// The quantity that a parameter names which the numbers are relative to; `None` for a place.
fn named_quantity(named: &ArrayRef, array: &str, color_by: Option<&str>) -> Option<ArrayRef> {
    match named {
        ArrayRef::Named("array") => Some(quantity(array)),
        ArrayRef::Named("color_by") => color_by.map(quantity),
        _ => None,
    }
}

/// The node's parameters with numbers for those relative to data, which are noted; without those that are unused here, such as a range
/// where nothing is coloured by values.
pub fn known(
    call: &mut RunContext,
    unused: &[&str],
    resolve: impl FnOnce(&Parameters, &dyn Progress) -> Result<Parameters>,
) -> Result<Parameters> {
    let p = unused.iter().fold(call.parameters.clone(), |p, name| p.with(name, None));
    noted(call, p, "over the data", resolve)
}

/// Parameters with numbers for those relative to data, which are noted. `over`: in words, the data.
fn noted(
    call: &mut RunContext,
    p: Parameters,
    over: &str,
    resolve: impl FnOnce(&Parameters, &dyn Progress) -> Result<Parameters>,
) -> Result<Parameters> {
    let own = call.stage("range", |progress| resolve(&p, progress))?;
    if own != p {
        note_numbers(&mut call.notes, "surface", over, &p, &own);
    }
    Ok(own)
}

/// A surface before it is painted.
#[derive(Default)]
pub struct Shape {
    /// Positions.
    pub points: Vec<DVec3>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
    /// Normals of the points; none: each triangle's own.
    pub normals: Vec<DVec3>,
    /// Values that give the colours, one a point.
    pub values: Option<Vec<f64>>,
    /// Colours in place of them, linear RGB and opacity, one a point.
    pub colors: Option<Vec<[f64; 4]>>,
    /// Linear RGB of triangles with a value that is not finite; none: they are left out.
    pub bad: Option<[f64; 3]>,
}

impl Shape {
    /// The triangles of a grid.
    pub fn of_grid(surface: GridSurface, points: &[DVec3], values: Option<Vec<f64>>) -> Shape {
        let points = surface.positions(points);
        Shape { points, triangles: surface.triangles, values, ..Shape::default() }
    }

    /// The shape with averaged normals where they are asked for and count.
    pub fn smoothed(mut self, p: &Parameters) -> Result<Shape> {
        if p.flag("smooth")? && p.number("ambient")? < 1.0 {
            self.normals = point_normals(&self.points, &self.triangles);
        }
        Ok(self)
    }

    /// The shape with normals that are averaged between edges where they turn by more than this angle, degrees.
    pub fn sharp(self, angle: f64) -> Shape {
        let sharp = sharp_triangles(&self.points, &self.triangles, angle);
        Shape {
            points: gathered(&self.points, &sharp.origins),
            values: self.values.as_deref().map(|values| gathered(values, &sharp.origins)),
            colors: self.colors.as_deref().map(|colors| gathered(colors, &sharp.origins)),
            triangles: sharp.triangles,
            normals: sharp.normals,
            bad: self.bad,
        }
    }

    /// The node's outputs, painted as these parameters say. `empty`: why there may be nothing.
    pub fn painted(mut self, call: &mut RunContext, p: &Parameters, empty: &str) -> Result<Outputs> {
        let count = self.triangles.len();
        let is_finite = |corners: &[u32; 3]| {
            corners.iter().all(|&p| {
                let value = self.values.as_ref().map_or(0.0, |values| values[p as usize]);
                let value = if self.bad.is_some() { 0.0 } else { value };
                self.points[p as usize].is_finite() && value.is_finite()
            })
        };
        self.triangles.retain(is_finite);
        match (count, count - self.triangles.len()) {
            (0, _) => call.notes.warnings.push(format!("the surface is empty: {empty}")),
            (_, 0) => {}
            (_, left_out) => call.notes.warnings.push(format!(
                "{} left out, whose points or values are not finite",
                counted(left_out, "triangle")
            )),
        }
        call.notes.counts.insert("triangles", self.triangles.len() as u64);
        let paint = match (self.values, self.colors) {
            (None, Some(colors)) => Paint::Points(colors),
            (Some(values), _) => {
                let curve = color_curve(p, &FilesFrom(&|path| call.resolve(path)))?;
                Paint::Mapped { values, range: range(p)?, curve, bad: self.bad }
            }
            (None, None) => Paint::Uniform(p.optional_color("color")?.unwrap_or(LIGHT_GREY)),
        };
        let ambient = p.number("ambient")?;
        let light = (ambient < 1.0).then_some(EyeLight { ambient, diffuse: 1.0 - ambient });
        let Shape { points, triangles, normals, .. } = self;
        let surface = Surface { points, triangles, paint, opacity: p.number("opacity")?, light, normals };
        surface.check()?;
        Ok(vec![Value::Surface(Arc::new(surface))])
    }
}

fn gathered<T: Copy>(all: &[T], places: &[u32]) -> Vec<T> {
    places.iter().map(|&p| all[p as usize]).collect()
}

/// Linear RGB of a surface of no other colour.
const LIGHT_GREY: [f64; 3] = [0.6; 3];

/// The range of values in words: "'p' goes from 0.0 to 1.0".
pub fn range_message(name: &str, values: &[f64]) -> String {
    let name = if matches!(name, "s" | "g") { name.into() } else { format!("'{name}'") };
    match voltet_core::grid::extent::range(values) {
        Some([low, high]) => format!("{name} goes from {low:?} to {high:?}"),
        None => format!("{name} is finite nowhere"),
    }
}
