//! The scale of a transfer function's colours: a bar along s, or the plane of s and g over the distribution of the data.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::grid::{Grid, extent};
use voltet_core::probing::{Axis, Histogram, histogram};
use voltet_core::transfer::{AxisScale, TransferFunction};
use voltet_core::volume::Volume;
use voltet_figure::canvas::{Canvas, Theme};
use voltet_figure::scale::{Border, NamedAxis, Shade, Side, color_bar, level_color_bar, plane};
use voltet_graph::{Parameters, RunContext};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};

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

/// The colours along a scalar, as its bar shows them.
#[derive(Debug, Clone)]
pub struct ScalarColors {
    /// Scale of the axis.
    pub axis: AxisScale,
    /// Values at the ends of the colours.
    pub range: [f64; 2],
    /// Linear RGB of pieces of the range, each as long as another on the axis; black where nothing is seen.
    pub colors: Vec<[f32; 3]>,
}

/// The colours of so many pieces along the scalar: between the ends of colour maps, else over the range of the data. `None` where they
/// depend on more than the scalar, or nothing has a colour.
///
/// Errors: a transfer function that cannot be compiled.
pub fn scalar_colors(
    function: &TransferFunction,
    volume: &Volume,
    count: usize,
) -> Result<Option<ScalarColors>> {
    let peak =
        function.widgets.iter().map(|widget| widget.peak()).fold(0.0, f64::max) / function.unit_distance;
    if function.uses_gradient_magnitude() || !function.fields().is_empty() || peak <= 0.0 {
        return Ok(None);
    }
    let axis = function.axes[0];
    let of_data = || extent::range(&volume.scalar).map(|range| axis.positions(range));
    let Some([low, high]) = drawn_range(function, true).or_else(of_data) else { return Ok(None) };
    let s = NamedAxis { name: String::new(), scale: axis, range: [low, high] };
    let scale = ColorScale { function: CompiledTransferFunction::new(function)?, peak, s, plane: None };
    let place = |step: usize| [low + (high - low) * step as f64 / count as f64, 0.0];
    let color = |step| scale.shade(place(step), place(step + 1)).color.unwrap_or_default();
    let range = [axis.value(low), axis.value(high)];
    Ok(Some(ScalarColors { axis, range, colors: (0..count).map(color).collect() }))
}

pub(crate) fn limits(p: &Parameters) -> Result<Option<[f64; 2]>> {
    let Some(_) = p.optional("bar_range") else { return Ok(None) };
    let [low, high] = p.vector("bar_range")?;
    if low < high {
        return Ok(Some([low, high]));
    }
    let error = p.error("bar_range", "the range of the bar is empty").got(format!("[{low}, {high}]"));
    Err(error.expected("the smaller number first"))
}

/// The scale of a transfer function's colours: along s, or over s and g.
pub(crate) struct ColorScale {
    function: CompiledTransferFunction,
    /// Largest extinction of a widget, per world unit; above 0.
    peak: f64,
    s: NamedAxis,
    /// The axis of g, where the function looks at it, with the data.
    plane: Option<(NamedAxis, Arc<Histogram>)>,
}

/// The last distribution of data with one revision, with the scales of its axes; kept between runs.
#[derive(Default)]
struct Distribution(Mutex<Option<([AxisScale; 2], Arc<Histogram>)>>);

impl ColorScale {
    /// The scale of the transfer function that is wired in. `title`: the name along s; `units`: of the scalar and of length.
    pub fn new(
        call: &RunContext,
        volume: Option<&Volume>,
        title: Option<String>,
        [unit, length]: [&str; 2],
    ) -> Result<ColorScale> {
        let p = call.parameters;
        // Extinctions are compared with each other alone, whatever length they are stated for.
        let function = call.look("transfer_function")?.for_diagonal(100.0);
        refuse_fields(p, &function)?;
        let axes = function.axes;
        let scalar = volume.map_or("s", |volume| volume.grid.scalar_name.as_str());
        let bracketed = |unit: &str| if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let ends = |axis: Axis| [axis.low, axis.high];
        let plane = if function.uses_gradient_magnitude() {
            let found = distribution(call, volume, axes)?;
            let per_length = if length.is_empty() { String::new() } else { format!("{unit}/{length}") };
            let per_length = if unit.is_empty() { "" } else { per_length.as_str() };
            let name = format!("|∇{scalar}|{}", bracketed(per_length));
            Some((NamedAxis { name, scale: axes[1], range: ends(found.axes[1]) }, found))
        } else {
            None
        };
        let limits = limits(p)?.map(|range| axes[0].positions(range));
        let range = match (limits, drawn_range(&function, true).filter(|_| plane.is_none()), volume) {
            (Some(range), ..) | (None, Some(range), _) => range,
            (None, None, Some(volume)) => axes[0].positions(ends(Axis::over(&volume.scalar, 1))),
            (None, None, None) => drawn_range(&function, false).ok_or_else(|| {
                let what = "the transfer function has no ends, so the range of the bar is not known";
                p.error("bar", what).needs_input("volume", ", or bar_range = [low, high]")
            })?,
        };
        let s = title.unwrap_or_else(|| format!("{scalar}{}", bracketed(unit)));
        let s = NamedAxis { name: s, scale: axes[0], range };
        let peak = function.widgets.iter().map(|widget| widget.peak()).fold(f64::MIN_POSITIVE, f64::max);
        let peak = peak / function.unit_distance;
        Ok(ColorScale { function: CompiledTransferFunction::new(&function)?, peak, s, plane })
    }

    /// Draws it; false where there is no room. `border`: that of a level bar, which has no side.
    pub fn draw(&self, canvas: &mut Canvas, side: Side, border: Option<Border>, top: f32) -> bool {
        let Some((g_axis, found)) = &self.plane else {
            let shade = |[low, high]: [f64; 2]| self.shade([low, 0.0], [high, 0.0]);
            return match border {
                Some(border) => level_color_bar(canvas, border, top, &self.s, shade).is_some(),
                None => color_bar(canvas, side, top, &self.s, shade).is_some(),
            };
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

/// Errors: a transfer function that looks at further fields, whose colours no bar and no plane has.
pub(crate) fn refuse_fields(p: &Parameters, function: &TransferFunction) -> Result<()> {
    function.fields().first().map_or(Ok(()), |field| {
        let error = p.error("bar", "no bar and no plane can show the colours of further fields");
        Err(error.got(format!("a widget over '{field}'")).expected("bar = \"none\""))
    })
}

/// Values of s between which all widgets are drawn, or those that have colours of their own, such as colour maps.
fn drawn_range(function: &TransferFunction, of_own_colors: bool) -> Option<[f64; 2]> {
    let widgets = function.widgets.iter().filter(|widget| !of_own_colors || widget.has_colors_of_its_own());
    let ranges = widgets.map(|widget| widget.scalar_range());
    let [low, high] = ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    (low < high && low.is_finite() && high.is_finite()).then_some([low, high])
}

/// The distribution of the data over s and g, up to where nearly all of them are.
fn distribution(call: &RunContext, volume: Option<&Volume>, axes: [AxisScale; 2]) -> Result<Arc<Histogram>> {
    let without = |found: &str| {
        let what = "the transfer function looks at the gradient, so its colours lie in a plane";
        let or = ", a node of type \"gradient-magnitude\"; or bar = \"none\"";
        call.parameters.error("bar", what).got(found).needs_input("volume", or)
    };
    let volume = volume.ok_or_else(|| without("no volume"))?;
    let g = volume.gradient_magnitude.as_ref().ok_or_else(|| without("a volume without gradient"))?;
    let find = || {
        let (s, g) = (on_axis(axes[0], &volume.scalar), on_axis(axes[1], g));
        let s_axis = Axis::over(&s, BINS[0]);
        let whole = Axis::over(&g, 16 * BINS[1]);
        let whole = if axes[1].is_curved() { whole } else { Axis { low: 0.0, ..whole } };
        // All cells where there are few: the exact distribution of many takes as long as the picture.
        let stride = volume.grid.tetrahedra.len().div_ceil(MAX_CELLS).max(1);
        let tetrahedra = volume.grid.tetrahedra.iter().step_by(stride).copied().collect();
        let some = Grid { points: volume.grid.points.clone(), tetrahedra, ..Grid::default() };
        let found = |axes| histogram(&some, [&s, &g], axes, call.progress());
        let high = found([Axis { bins: 1, ..s_axis }, whole])?.nearly_all();
        found([s_axis, Axis { low: whole.low, high, bins: BINS[1] }])
    };
    let kept = call.keep(call.revision("volume")?, || Ok(Distribution::default()))?;
    let mut last = kept.0.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, found)) = last.as_ref().filter(|(of_axes, _)| *of_axes == axes) {
        return Ok(found.clone());
    }
    let found = Arc::new(find()?);
    *last = Some((axes, found.clone()));
    Ok(found)
}

/// Positions of values; of those without one the least of the axis.
fn on_axis(scale: AxisScale, values: &[f64]) -> Cow<'_, [f64]> {
    if !scale.is_curved() {
        return values.into();
    }
    let least = scale.positions(extent::range(values).unwrap_or_default())[0];
    values.iter().map(|value| scale.position(*value).max(least)).collect()
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
