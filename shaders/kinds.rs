//! The kinds of widgets as shaders know them: the calls that the generated block makes for one, the numbers that its pieces
//! read, and what 32 bits do not hold of it. The pieces stand under `wgsl/`, in a folder of the kind's name.

use crate::writer::{WidgetRecord, Writer, all_finite, finite};
use voltet_core::transfer::{ControlPoint, Profile, Table, TransferFunction, Wave, Widget};
use voltet_core::{Error, Result};
use voltet_optics::kinds::wave::{sine_half_area, sine_half_width};
use voltet_simd::limits::{
    MAX_BANDS, MAX_GAUSSIAN_WIDTHS, MAX_RAMP_RATE, MAX_WALKED_BANDS, OPAQUE, SUDDEN_BANDS,
};

/// A widget's profile, as far as it decides the text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 1 inside its region.
    Uniform,
    /// A Gaussian of the scalar alone.
    GaussianLine,
    /// A Gaussian over the (s, g) plane.
    GaussianPlane,
    /// A Gaussian over so many fields.
    GaussianNd(usize),
    /// A triangular Gaussian.
    TriangularGaussian,
    /// A triangular Gaussian over so many fields.
    TriangularGaussianNd(usize),
    /// A triangle wave.
    TriangleWave,
    /// A sine wave.
    SineWave,
    /// Linear between so many control points.
    PiecewiseLinear(usize),
    /// An image over the (s, g) plane.
    Table,
}

/// A call of WGSL: the pieces that it takes, and its text. `#` stands for the widget's number, `part_#` for its part of the
/// segment, `depth_#` for its depth.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Snippet {
    pub pieces: Vec<&'static str>,
    pub text: String,
}

/// Functions that the generated block calls for a widget of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WidgetSnippets {
    /// T of its part.
    pub depth: Snippet,
    /// C where it is alone, under the model that was asked for; `None` where it has no closed form, only the ordered integral.
    pub light: Option<Snippet>,
    /// Makes its track, over the whole segment.
    pub track: Snippet,
    pub track_type: &'static str,
    /// The next break of `members.track_#` behind t.
    pub next_break: String,
    /// Light and rate of `members.member_#` with `members.track_#` at four places.
    pub member_light: Snippet,
    /// The t between which it glows under the constant-emitter; `None` for what breaks there itself.
    pub window: Option<Snippet>,
    /// The rate above which it glows under the constant-emitter.
    pub threshold: &'static str,
    /// True if the error of its mix with others has a bound: its colour does not vary, and it glows in one window.
    pub is_mix_bounded: bool,
}

/// The rate at the cutoff, for a profile of peak 1.
const CUTOFF_RATE: &str = "widget_rate(#u, part_#) * scene.cutoff";
/// Rate of a widget that emits within its window, whatever the rounding of the rate.
const ANY_RATE: &str = "0.0";

fn snippet(pieces: &[&'static str], text: impl Into<String>) -> Snippet {
    Snippet { pieces: pieces.to_vec(), text: text.into() }
}

impl Kind {
    pub(crate) fn from_profile(profile: &Profile) -> Kind {
        match profile {
            Profile::Uniform => Kind::Uniform,
            Profile::Gaussian { matrix, .. } if is_line(matrix) => Kind::GaussianLine,
            Profile::Gaussian { .. } => Kind::GaussianPlane,
            Profile::GaussianNd { fields, .. } => Kind::GaussianNd(fields.len()),
            Profile::TriangularGaussian { .. } => Kind::TriangularGaussian,
            Profile::TriangularGaussianNd { fields, .. } => Kind::TriangularGaussianNd(fields.len()),
            Profile::TriangleWave(_) => Kind::TriangleWave,
            Profile::SineWave(_) => Kind::SineWave,
            Profile::PiecewiseLinear { points } => Kind::PiecewiseLinear(points.len()),
            Profile::Table(_) => Kind::Table,
        }
    }

    /// Functions that the generated block calls for it.
    pub(crate) fn snippets(&self, constant_emitter: bool) -> WidgetSnippets {
        match self {
            Kind::Uniform => {
                let pieces = ["uniform/depth", "uniform/track", "uniform/track"];
                let mut uniform = common_snippets("uniform", "UniformTrack", pieces);
                if constant_emitter {
                    uniform.light = Some(snippet(&["uniform/light"], "uniform_light(#u, part_#, depth_#)"));
                }
                uniform
            }
            Kind::GaussianLine => {
                gaussian_snippets("gaussian/widget_line", "gaussian_line", "", constant_emitter)
            }
            Kind::GaussianPlane => {
                gaussian_snippets("gaussian/widget_plane", "gaussian_plane", "", constant_emitter)
            }
            Kind::GaussianNd(count) => gaussian_snippets(
                "gaussian_nd/widget",
                "gaussian_fields",
                &format!("{count}u, "),
                constant_emitter,
            ),
            Kind::TriangularGaussian => triangular_snippets(constant_emitter),
            Kind::TriangularGaussianNd(count) => {
                let call = |function: &str, further: &str| {
                    let text = format!("triangular_fields_{function}(#u, {count}u, part_#{further})");
                    snippet(&["triangular_gaussian_nd/widget"], text)
                };
                WidgetSnippets {
                    depth: call("depth", ""),
                    track: call("track", ""),
                    window: Some(call("window", ", scene.level")),
                    ..triangular_snippets(constant_emitter)
                }
            }
            Kind::TriangleWave | Kind::SineWave => {
                let pieces = ["wave/widget", "wave/widget_track", "wave/track"];
                let wave = common_snippets("wave", "WaveTrack", pieces);
                let light = match constant_emitter {
                    false => wave.light,
                    true => Some(snippet(&["wave/widget_light"], "wave_light(#u, part_#)")),
                };
                let track = snippet(&["wave/widget_track"], "wave_widget_track(#u, part_#)");
                // Under the constant-emitter it glows in many windows.
                WidgetSnippets { light, track, is_mix_bounded: !constant_emitter, ..wave }
            }
            Kind::PiecewiseLinear(count) => piecewise_snippets(*count, constant_emitter),
            Kind::Table => {
                let cutoff = if constant_emitter { "scene.cutoff" } else { "-1.0" };
                WidgetSnippets {
                    light: None,
                    track: snippet(&["table/widget"], format!("table_track(#u, {cutoff}, part_#)")),
                    member_light: snippet(
                        &["overlap/member_colors", "table/track"],
                        "member_texels_light(members.member_#, table_texels(members.track_#, at), at, \
                         members.track_#.peak)",
                    ),
                    is_mix_bounded: false,
                    ..common_snippets("table", "TableTrack", ["table/widget", "table/widget", "table/track"])
                }
            }
        }
    }

    /// True if its light alone has no closed form under the model.
    pub(crate) fn is_integrated(&self, constant_emitter: bool) -> bool {
        self.snippets(constant_emitter).light.is_none()
    }

    /// Count of its `numbers` beside its region's edges.
    pub(crate) fn number_count(&self) -> usize {
        match self {
            Kind::GaussianNd(count) => (2 + count) * count,
            Kind::TriangularGaussianNd(count) => (2 + count) * count + 2,
            Kind::PiecewiseLinear(count) => POINT_NUMBERS * count,
            _ => 0,
        }
    }

    /// The piece that fills the slot `wave_mean_on_flank`, and its function, of a kind that asks for it.
    pub(crate) fn flank(&self) -> Option<(&'static str, &'static str)> {
        match self {
            Kind::TriangleWave => Some(("wave/triangle", "triangle_mean_on_flank")),
            Kind::SineWave => Some(("wave/sine", "sine_mean_on_flank")),
            _ => None,
        }
    }
}

/// Snippets whose functions bear the name `stem`, of a widget with one colour under the density-emitter: C = c (1 − e^(−T)).
/// `pieces`: those of its depth, its track, and the rates of its track.
fn common_snippets(
    stem: &str,
    track_type: &'static str,
    [depth, track, rates]: [&'static str; 3],
) -> WidgetSnippets {
    let colors = format!("scene.widgets[#].color, at, {stem}_rates(members.track_#, at)");
    WidgetSnippets {
        depth: snippet(&[depth], format!("{stem}_depth(#u, part_#)")),
        light: Some(snippet(&["widgets/density_light"], "density_light(#u, depth_#)")),
        track: snippet(&[track], format!("{stem}_track(#u, part_#)")),
        track_type,
        next_break: format!("{stem}_next_break(members.track_#, t)"),
        member_light: snippet(&[rates], format!("member_light(members.member_#, {colors})")),
        window: None,
        threshold: CUTOFF_RATE,
        is_mix_bounded: true,
    }
}

/// Snippets of a profile with a path through a Gaussian: `piece` holds the functions `stem`_whole and `stem`_inside, whose
/// arguments before the part are the widget's number and `count`.
fn gaussian_snippets(piece: &'static str, stem: &str, count: &str, constant_emitter: bool) -> WidgetSnippets {
    let inside = format!("{stem}_inside(#u, {count}part_#)");
    let whole = format!("{stem}_whole(#u, {count}part_#)");
    let with = |other: &'static str, text: String| snippet(&[piece, other], text);
    let common =
        common_snippets("gaussian", "GaussianTrack", ["gaussian/depth", "gaussian/track", "gaussian/track"]);
    WidgetSnippets {
        depth: with("gaussian/depth", format!("gaussian_depth(#u, part_#, {inside})")),
        light: match constant_emitter {
            false => common.light,
            true => Some(with("gaussian/light", format!("gaussian_light(#u, part_#, {inside})"))),
        },
        track: with("gaussian/track", format!("gaussian_track({whole}, widget_rate(#u, part_#))")),
        window: Some(with("gaussian/path", format!("gaussian_window_ends({whole}, scene.level)"))),
        threshold: ANY_RATE,
        ..common
    }
}

fn triangular_snippets(constant_emitter: bool) -> WidgetSnippets {
    let pieces =
        ["triangular_gaussian/widget", "triangular_gaussian/widget_track", "triangular_gaussian/track"];
    let common = common_snippets("triangular", "TriangularTrack", pieces);
    let window = "triangular_window_ends(members.track_#, scene.level)";
    WidgetSnippets {
        light: common.light.filter(|_| !constant_emitter),
        window: Some(snippet(&["triangular_gaussian/track"], window)),
        threshold: ANY_RATE,
        ..common
    }
}

fn piecewise_snippets(count: usize, constant_emitter: bool) -> WidgetSnippets {
    let call = |piece, function: &str| snippet(&[piece], format!("{function}(#u, {count}u, part_#)"));
    WidgetSnippets {
        depth: call("piecewise_linear/widget_depth", "piecewise_depth"),
        light: Some(match constant_emitter {
            false => call("piecewise_linear/widget_density_light", "piecewise_density_light"),
            true => call("piecewise_linear/widget_light", "piecewise_light"),
        }),
        track: call("piecewise_linear/widget_track", "piecewise_track"),
        track_type: "PiecewiseTrack",
        next_break: "piecewise_next_break(members.track_#, t)".into(),
        member_light: snippet(
            &["overlap/member_colors", "piecewise_linear/track"],
            "member_colors_light(members.member_#, piecewise_colors(members.track_#, at), at, \
             piecewise_rates(members.track_#, at))",
        ),
        window: None,
        threshold: "widget_rate(#u, part_#) * scene.widgets[#].matrix.x",
        is_mix_bounded: false,
    }
}

/// Writes the numbers of a profile, into the record and behind the numbers so far.
pub(crate) fn write(profile: &Profile, writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    match profile {
        Profile::Uniform => Ok(()),
        Profile::Gaussian { centre, matrix } => write_gaussian(centre, matrix, writer, record),
        Profile::GaussianNd { fields, centre, matrix } => write_fields(fields, centre, matrix, 1.0, writer),
        // matrix.x: σ for stored values; centre: s₀ and the stored g of 0.
        Profile::TriangularGaussian { centre, sigma } => {
            let [s, g] = writer.plane();
            record.matrix[0] = finite("sigma", sigma * g.scale / s.scale)?;
            record.centre = all_finite("the centre", [s.stored(*centre), g.stored(0.0)])?;
            Ok(())
        }
        // Numbers: those of a Gaussian over the fields, K for widths of stored m; where m lies among a segment's values, m = 0 as
        // it is stored.
        Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
            let place = writer.field(magnitude);
            let axis = writer.axis(place);
            write_fields(fields, centre, matrix, axis.scale, writer)?;
            writer.numbers.push(writer.value_of_field(place) as f32);
            writer.numbers.push(finite("the magnitude's origin", axis.stored(0.0))?);
            Ok(())
        }
        Profile::TriangleWave(wave) => write_wave(wave, false, writer, record),
        Profile::SineWave(wave) => write_wave(wave, true, writer, record),
        Profile::PiecewiseLinear { points } => write_points(points, writer, record),
        Profile::Table(table) => write_table(table, writer, record),
    }
}

/// True if K looks at s alone.
fn is_line(matrix: &[[f64; 2]; 2]) -> bool {
    matrix[0][1] == 0.0 && matrix[1][1] == 0.0
}

/// matrix: K for stored values; centre as values are stored.
fn write_gaussian(
    centre: &[f64; 2],
    matrix: &[[f64; 2]; 2],
    writer: &mut Writer,
    record: &mut WidgetRecord,
) -> Result<()> {
    let ([s, g], one_row) = (writer.plane(), is_line(matrix));
    let rows = if one_row {
        [matrix[0][0].hypot(matrix[1][0]) * s.scale, 0.0, 0.0, 0.0]
    } else {
        let [[a, b], [c, d]] = *matrix;
        [a * s.scale, b * g.scale, c * s.scale, d * g.scale]
    };
    record.matrix = all_finite("the matrix", rows)?;
    let centre = [s.stored(centre[0]), if one_row { 0.0 } else { g.stored(centre[1]) }];
    record.centre = all_finite("the centre", centre)?;
    Ok(())
}

/// Numbers: where the fields lie among a segment's values, the centre, K / `width` row by row.
fn write_fields(
    fields: &[String],
    centre: &[f64],
    matrix: &[Vec<f64>],
    width: f64,
    writer: &mut Writer,
) -> Result<()> {
    let places: Vec<usize> = fields.iter().map(|name| writer.field(name)).collect();
    for &place in &places {
        writer.numbers.push(writer.value_of_field(place) as f32);
    }
    for (&place, &centre) in places.iter().zip(centre) {
        writer.numbers.push(finite("the centre", writer.axis(place).stored(centre))?);
    }
    for row in matrix {
        for (&place, k) in places.iter().zip(row) {
            writer.numbers.push(finite("the matrix", k / width * writer.axis(place).scale)?);
        }
    }
    Ok(())
}

/// matrix.xy: phase per stored s and g, matrix.z: phase at 0 without whole bands.
fn write_wave(wave: &Wave, sine: bool, writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    let (mut start, mut bands) = (0.0, 0.0);
    for (a, (per_value, axis)) in wave.step().into_iter().zip(writer.plane()).enumerate() {
        if per_value != 0.0 {
            let phase = per_value * (axis.offset - wave.origin[a]);
            start += phase - phase.round();
            record.matrix[a] = (per_value * axis.scale) as f32;
            bands += (per_value * axis.scale).abs();
        }
    }
    if bands > MAX_BANDS || bands.is_nan() {
        return Err(Error::run("a wave has more bands than 32 bits tell apart")
            .got(format!("{bands:.3e} over the range of the values"))
            .expected(format!("at most {MAX_BANDS:.0e}")));
    }
    record.matrix[2] = (start - start.round()) as f32;
    let half_width = |width: f64| if sine { sine_half_width(width) } else { 0.5 * width };
    let reach = half_width(wave.band_width);
    let half_area = if sine { sine_half_area(wave.band_width, reach) } else { 0.5 * reach };
    let lit = writer.cutoff.map_or(reach, |cutoff| half_width((1.0 - cutoff) * wave.band_width));
    record.bell = [1.0 / wave.band_width, reach, half_area, lit].map(|x| x as f32);
    record.bell_kind = u32::from(sine) | u32::from(wave.band_width == 1.0) << 1;
    Ok(())
}

const POINT_NUMBERS: usize = 6;

/// matrix.x: the extinction above which it glows; numbers: six a point.
fn write_points(points: &[ControlPoint], writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    let [s, _] = writer.plane();
    record.color = points[0].color.map(|c| c as f32);
    record.extinction = finite("1/unit distance", writer.per_unit)?;
    let peak = points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak));
    record.matrix[0] = writer.cutoff.map_or(-1.0, |cutoff| (cutoff * peak).min(f64::from(f32::MAX)) as f32);
    for (i, point) in points.iter().enumerate() {
        let span = s.stored(point.s) - s.stored(points[i.saturating_sub(1)].s);
        let inverse = if span > 0.0 { 1.0 / span } else { 0.0 };
        let [red, green, blue] = point.color;
        let row: [f64; POINT_NUMBERS] = [s.stored(point.s), point.extinction, inverse, red, green, blue];
        writer.numbers.extend(all_finite("a control point", row)?);
    }
    Ok(())
}

/// Texel coordinates are factor × stored value + place of the stored 0, columns in matrix.xy, rows in matrix.zw; the texels
/// are those of `Resources`.
fn write_table(table: &Table, writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    let [s, g] = writer.plane();
    let size = [table.width as f64, table.height as f64];
    let columns = size[0] / (table.s[1] - table.s[0]);
    let rows = size[1] / (table.g[1] - table.g[0]);
    let column = [columns * s.scale, (s.offset - table.s[0]) * columns - 0.5];
    let row = [-rows * g.scale, (table.g[1] - g.offset) * rows - 0.5];
    record.matrix = all_finite("a table's range", [column[0], column[1], row[0], row[1]])?;
    record.bell = [size[0] as f32, size[1] as f32, 0.0, 0.0];
    record.first_number = writer.texel_count;
    writer.texel_count += table.texels.len() as u32;
    Ok(())
}

/// Largest spans of one segment of a data set; the ranges of the values bound it, tighter numbers refuse less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spans<'a> {
    /// |v_b − v_f| of s, g (also where it is not read) and the further fields by name.
    pub values: &'a [f64],
    /// D, world units.
    pub longest: f64,
}

/// Largest length and value spans of one segment, in the units of the transfer function.
pub(crate) struct SegmentExtent<'a> {
    pub transfer_function: &'a TransferFunction,
    pub spans: &'a Spans<'a>,
    /// True if widgets are walked together, in their order.
    pub is_in_order: bool,
}

impl SegmentExtent<'_> {
    pub fn span_of(&self, field: &str) -> f64 {
        let place = self.transfer_function.fields().iter().position(|name| *name == field);
        place.map_or(0.0, |place| self.spans.values[2 + place])
    }

    /// D/U.
    pub fn length(&self) -> f64 {
        self.spans.longest / self.transfer_function.unit_distance
    }

    /// Optical depth at the widget's peak along the whole segment.
    pub fn depth(&self, widget: &Widget) -> f64 {
        self.length() * widget.peak()
    }
}

/// Checks that 32 bits hold the widget on every segment of a data set.
pub(crate) fn check_32_bits(widget: &Widget, extent: &SegmentExtent) -> Result<()> {
    match &widget.profile {
        Profile::Gaussian { matrix, .. } => {
            let (s, g) = (extent.spans.values[0], extent.spans.values[1]);
            check_widths(matrix.iter().map(|row| (row[0] * s).abs() + (row[1] * g).abs()))
        }
        Profile::GaussianNd { fields, matrix, .. } => {
            let spans: Vec<f64> = fields.iter().map(|name| extent.span_of(name)).collect();
            let widths = |row: &Vec<f64>| row.iter().zip(&spans).map(|(k, span)| (k * span).abs()).sum();
            check_widths(matrix.iter().map(widths))
        }
        Profile::TriangleWave(wave) | Profile::SineWave(wave) => check_wave(widget, wave, extent),
        Profile::PiecewiseLinear { points } => check_ramps(points, extent),
        // Their ends are formed in the values' own 32 bits, and their panels follow the segment.
        Profile::Uniform
        | Profile::TriangularGaussian { .. }
        | Profile::TriangularGaussianNd { .. }
        | Profile::Table(_) => Ok(()),
    }
}

/// Checks the widths of a Gaussian, one number a row of K.
fn check_widths(rows: impl Iterator<Item = f64>) -> Result<()> {
    let widths = rows.map(|x| x * x).sum::<f64>().sqrt();
    if widths <= MAX_GAUSSIAN_WIDTHS {
        return Ok(());
    }
    Err(Error::run("a Gaussian is narrower than 32 bits resolve along a segment")
        .got(format!("{widths:e} widths over one segment"))
        .expected(format!("at most {MAX_GAUSSIAN_WIDTHS:e}, or an engine of 64 bits")))
}

fn check_wave(widget: &Widget, wave: &Wave, extent: &SegmentExtent) -> Result<()> {
    let bands: f64 =
        wave.step().iter().enumerate().map(|(a, step)| (step * extent.spans.values[a]).abs()).sum();
    let by_width = bands / wave.band_width;
    let refuse = |why: &str, found: f64, most: f64| {
        Err(Error::run(why)
            .got(format!("{found:e} bands over one segment"))
            .expected(format!("at most {most:e}, or an engine of 64 bits")))
    };
    if bands > MAX_BANDS {
        return refuse("a wave has more bands than 32 bits tell apart", bands, MAX_BANDS);
    }
    if !extent.is_in_order {
        return Ok(());
    }
    if by_width > MAX_WALKED_BANDS {
        let why = "a wave among other widgets has more bands, by band width, than are walked one by one";
        return refuse(why, by_width, MAX_WALKED_BANDS);
    }
    // On a part of one band the place has all its digits.
    let whole = bands.round() / wave.band_width;
    if let Some(most) = extent.transfer_function.model.cutoff().map(|cutoff| SUDDEN_BANDS * cutoff)
        && extent.depth(widget) > OPAQUE
        && whole > most
    {
        let why = "a wave among other widgets is opaque within the rounding of its band";
        return refuse(why, whole, most);
    }
    Ok(())
}

/// A ramp of depth P over the share w of the segment has the depth P t²/2w at t, so at most the rate √(2P/w) where that is 1.
fn check_ramps(points: &[ControlPoint], extent: &SegmentExtent) -> Result<()> {
    for (low, high) in points.iter().zip(points.iter().skip(1)) {
        let share = ((high.s - low.s) / extent.spans.values[0]).min(1.0);
        let depth = extent.length() * low.extinction.max(high.extinction);
        let rate = depth.min((2.0 * depth / share).sqrt());
        if low.color != high.color && high.s > low.s && rate > MAX_RAMP_RATE {
            return Err(Error::run(
                "a ramp between two colours is too steep for 32 bits to find what is seen of both",
            )
            .got(format!("{rate:e} as its optical depth per segment where it becomes opaque"))
            .expected(format!("at most {MAX_RAMP_RATE:e}, or an engine of 64 bits")));
        }
    }
    Ok(())
}
