//! What may change per frame without another shader: the bytes of the `scene` uniform and of the `numbers` buffer.

use bytemuck::{Pod, Zeroable};
use voltet_core::optics::wave::{sine_half_area, sine_half_width};
use voltet_core::shading::{Integrator, Shading, unit_vector};
use voltet_core::transfer::{HalfPlane, Profile, Table, TransferFunction, Wave, Widget};
use voltet_core::{Error, Result};

/// How a value is stored: stored = (value − offset) / scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// In units of the value.
    pub offset: f64,
    /// In units of the value, > 0.
    pub scale: f64,
}

impl Axis {
    /// Values as they are.
    pub const PLAIN: Axis = Axis { offset: 0.0, scale: 1.0 };

    pub(crate) fn stored(&self, value: f64) -> f64 {
        (value - self.offset) / self.scale
    }
}

/// What stands before the widgets in `Scene` of `scene.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SceneHead {
    /// Unit vector, world axes.
    pub light_direction: [f32; 3],
    /// k_a.
    pub light_ambient: f32,
    /// k_d.
    pub light_diffuse: f32,
    /// p.
    pub silhouette_exponent: f32,
    /// −ln cutoff.
    pub level: f32,
    /// Share of the peak above which a widget glows.
    pub cutoff: f32,
    /// 1/U in scene lengths.
    pub per_unit: f32,
    /// Largest error of a channel (adaptive).
    pub tolerance: f32,
    /// The largest channel of any colour.
    pub brightest: f32,
    /// Pieces of a segment (segments, riemann).
    pub piece_count: u32,
}

/// `Widget` of `scene.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct WidgetRecord {
    /// Linear RGB.
    pub color: [f32; 3],
    /// ρ₀ per scene length.
    pub extinction: f32,
    /// Numbers of the profile.
    pub matrix: [f32; 4],
    /// 1/w, reach, half area, half-width of what glows; of a table columns and rows.
    pub bell: [f32; 4],
    /// As values are stored.
    pub centre: [f32; 2],
    /// Where the region's edges begin in `numbers`.
    pub first_edge: u32,
    /// Where the profile's further numbers begin, or a table's texels.
    pub first_number: u32,
    /// Bit 0: a sine wave; bit 1: nothing is cut away.
    pub bell_kind: u32,
    /// Fills up to the alignment of a widget.
    pub padding: [u32; 3],
}

/// The bytes that a composed shader reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Light, model.
    pub head: SceneHead,
    /// One a widget; one of zeros where there is none, since no array is empty.
    pub widgets: Vec<WidgetRecord>,
    /// Edges, control points, matrices; one zero where there is none.
    pub numbers: Vec<f32>,
}

/// Bands over one unit of stored values from which on 32 bits do not tell one from the next.
const BANDS_MOST: f64 = 1e6;

/// Pieces of a segment: all of them are told apart by a 32-bit t.
const PIECES_MOST: u32 = 1 << 20;

impl Parameters {
    /// `axes`: how s, g (also where it is not read) and the further fields by name are stored. `length`: the scene
    /// length in world units, in which D is counted.
    pub fn new(
        transfer_function: &TransferFunction,
        shading: &Shading,
        axes: &[Axis],
        length: f64,
    ) -> Result<Parameters> {
        let fields = transfer_function.fields();
        if axes.len() != 2 + fields.len() {
            return Err(Error::usage("the axes do not fit the values of the transfer function")
                .found(axes.len())
                .accepted(format!("{}: s, g and one a field", 2 + fields.len())));
        }
        let cutoff = transfer_function.model.cutoff();
        let (direction, ambient, diffuse) = shading.light.map_or(([0.0; 3], 1.0, 0.0), |light| {
            (unit_vector(light.direction).to_array(), light.ambient, light.diffuse)
        });
        let per_unit = length / transfer_function.unit_distance;
        let (tolerance, piece_count) = match shading.integrator {
            Integrator::Adaptive { tolerance } => (tolerance as f32, 0),
            Integrator::Segments { count, .. } | Integrator::Riemann { count } => (0.0, pieces(count)?),
            _ => (0.0, 0),
        };
        let head = SceneHead {
            light_direction: direction.map(|x| x as f32),
            light_ambient: ambient as f32,
            light_diffuse: diffuse as f32,
            silhouette_exponent: shading.silhouette.unwrap_or(0.0) as f32,
            // A cutoff of 0 leaves everything lit.
            level: cutoff.map_or(0.0, |cutoff| (-cutoff.ln()).min(1e30)) as f32,
            cutoff: cutoff.unwrap_or(0.0) as f32,
            per_unit: finite("1/unit distance", per_unit)?,
            tolerance,
            brightest: transfer_function.widgets.iter().map(Widget::brightest).fold(0.0, f64::max) as f32,
            piece_count,
        };
        let first_field = 1 + usize::from(transfer_function.uses_gradient_magnitude());
        let mut writer =
            Writer { axes, per_unit, cutoff, fields, first_field, numbers: Vec::new(), texel_count: 0 };
        let mut widgets = Vec::with_capacity(transfer_function.widgets.len().max(1));
        for (i, widget) in transfer_function.widgets.iter().enumerate() {
            widgets.push(writer.widget(widget).map_err(|e| e.at_item(format!("widgets[{i}]")))?);
        }
        if let Some(color) = transfer_function.one_color() {
            // Any of them stands for all; what is not drawn may have another.
            widgets.iter_mut().for_each(|record| record.color = color.map(|c| c as f32));
        }
        if widgets.is_empty() {
            widgets.push(WidgetRecord::zeroed());
        }
        let mut numbers = writer.numbers;
        if numbers.is_empty() {
            numbers.push(0.0);
        }
        Ok(Parameters { head, widgets, numbers })
    }

    /// The bytes of the uniform `scene`.
    pub fn scene_bytes(&self) -> Vec<u8> {
        [bytemuck::bytes_of(&self.head), bytemuck::cast_slice(&self.widgets)].concat()
    }
}

struct Writer<'a> {
    axes: &'a [Axis],
    per_unit: f64,
    cutoff: Option<f64>,
    fields: Vec<&'a str>,
    first_field: usize,
    numbers: Vec<f32>,
    /// Of the tables so far.
    texel_count: u32,
}

impl Writer<'_> {
    fn widget(&mut self, widget: &Widget) -> Result<WidgetRecord> {
        let first_edge = self.numbers.len() as u32;
        self.edges(widget)?;
        let first_number = self.numbers.len() as u32;
        let mut record = WidgetRecord {
            color: widget.color.map(|c| c as f32),
            extinction: finite("the extinction", widget.extinction * self.per_unit)?,
            first_edge,
            first_number,
            ..WidgetRecord::zeroed()
        };
        let [s, g] = [self.axes[0], self.axes[1]];
        match &widget.profile {
            Profile::Uniform => {}
            Profile::Table(table) => self.table(table, &mut record)?,
            Profile::Gaussian { centre, matrix } => {
                let one_row = matrix[0][1] == 0.0 && matrix[1][1] == 0.0;
                let rows = if one_row {
                    [matrix[0][0].hypot(matrix[1][0]) * s.scale, 0.0, 0.0, 0.0]
                } else {
                    let [[a, b], [c, d]] = *matrix;
                    [a * s.scale, b * g.scale, c * s.scale, d * g.scale]
                };
                record.matrix = all_finite("the matrix", rows)?;
                let centre = [s.stored(centre[0]), if one_row { 0.0 } else { g.stored(centre[1]) }];
                record.centre = all_finite("the centre", centre)?;
            }
            Profile::GaussianNd { fields, centre, matrix } => self.gaussian_fields(fields, centre, matrix)?,
            Profile::TriangularGaussian { centre, sigma } => {
                record.matrix[0] = finite("sigma", sigma * g.scale / s.scale)?;
                record.centre = all_finite("the centre", [s.stored(*centre), g.stored(0.0)])?;
            }
            Profile::TriangleWave(wave) => self.wave(wave, false, &mut record)?,
            Profile::SineWave(wave) => self.wave(wave, true, &mut record)?,
            Profile::PiecewiseLinear { points } => {
                record.color = points[0].color.map(|c| c as f32);
                record.extinction = finite("1/unit distance", self.per_unit)?;
                let peak = points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak));
                record.matrix[0] = self.cutoff.map_or(-1.0, |cutoff| finite32(cutoff * peak));
                for (i, point) in points.iter().enumerate() {
                    let span = s.stored(point.s) - s.stored(points[i.saturating_sub(1)].s);
                    let inverse = if span > 0.0 { 1.0 / span } else { 0.0 };
                    let [red, green, blue] = point.color;
                    let row = [s.stored(point.s), point.extinction, inverse, red, green, blue];
                    self.numbers.extend(all_finite("a control point", row)?);
                }
            }
        }
        Ok(record)
    }

    /// Texel coordinates are factor × stored value + place of the stored 0; the texels are those of `Resources`.
    fn table(&mut self, table: &Table, record: &mut WidgetRecord) -> Result<()> {
        let [s, g] = [self.axes[0], self.axes[1]];
        let size = [table.width as f64, table.height as f64];
        let columns = size[0] / (table.s[1] - table.s[0]);
        let rows = size[1] / (table.g[1] - table.g[0]);
        let column = [columns * s.scale, (s.offset - table.s[0]) * columns - 0.5];
        let row = [-rows * g.scale, (table.g[1] - g.offset) * rows - 0.5];
        record.matrix = all_finite("a table's range", [column[0], column[1], row[0], row[1]])?;
        record.bell = [size[0] as f32, size[1] as f32, 0.0, 0.0];
        record.first_number = self.texel_count;
        self.texel_count += table.texels.len() as u32;
        Ok(())
    }

    fn gaussian_fields(&mut self, names: &[String], centre: &[f64], matrix: &[Vec<f64>]) -> Result<()> {
        let of = |name: &String| self.fields.iter().position(|field| field == name).unwrap_or(0);
        let places: Vec<usize> = names.iter().map(of).collect();
        for &place in &places {
            self.numbers.push((self.first_field + place) as f32);
        }
        for (&place, &centre) in places.iter().zip(centre) {
            self.numbers.push(finite("the centre", self.axes[2 + place].stored(centre))?);
        }
        for row in matrix {
            for (&place, k) in places.iter().zip(row) {
                self.numbers.push(finite("the matrix", k * self.axes[2 + place].scale)?);
            }
        }
        Ok(())
    }

    fn wave(&mut self, wave: &Wave, sine: bool, record: &mut WidgetRecord) -> Result<()> {
        let (sin, cos) = wave.angle.sin_cos();
        let per_value = [cos * wave.scale[0] / wave.period, sin * wave.scale[1] / wave.period];
        let (mut start, mut bands) = (0.0, 0.0);
        for (a, per_value) in per_value.into_iter().enumerate() {
            if per_value != 0.0 {
                let phase = per_value * (self.axes[a].offset - wave.origin[a]);
                start += phase - phase.round();
                record.matrix[a] = (per_value * self.axes[a].scale) as f32;
                bands += (per_value * self.axes[a].scale).abs();
            }
        }
        if bands > BANDS_MOST || bands.is_nan() {
            return Err(Error::run("a wave has more bands than 32 bits tell apart")
                .found(format!("{bands:.3e} over the range of the values"))
                .accepted(format!("at most {BANDS_MOST:.0e}")));
        }
        record.matrix[2] = (start - start.round()) as f32;
        let half_width = |width: f64| if sine { sine_half_width(width) } else { 0.5 * width };
        let reach = half_width(wave.band_width);
        let half_area = if sine { sine_half_area(wave.band_width, reach) } else { 0.5 * reach };
        let lit = self.cutoff.map_or(reach, |cutoff| half_width((1.0 - cutoff) * wave.band_width));
        record.bell = [1.0 / wave.band_width, reach, half_area, lit].map(|x| x as f32);
        record.bell_kind = u32::from(sine) | u32::from(wave.band_width == 1.0) << 1;
        Ok(())
    }

    fn edges(&mut self, widget: &Widget) -> Result<()> {
        for HalfPlane { normal, corner } in widget.half_planes() {
            let scaled = [normal[0] * self.axes[0].scale, normal[1] * self.axes[1].scale];
            // Only the ratio of distances matters: a power of two keeps the digits.
            let size = scaled[0].abs().max(scaled[1].abs());
            let unit = size.log2().floor().exp2();
            let stored = [0, 1].map(|a| if normal[a] == 0.0 { 0.0 } else { self.axes[a].stored(corner[a]) });
            let row = [scaled[0] / unit, scaled[1] / unit, stored[0], stored[1]];
            self.numbers.extend(all_finite("a corner of the region", row)?);
        }
        Ok(())
    }
}

fn pieces(count: usize) -> Result<u32> {
    u32::try_from(count).ok().filter(|count| *count <= PIECES_MOST).ok_or_else(|| {
        Error::usage("a segment has more pieces than a shader walks").found(count).accepted(PIECES_MOST)
    })
}

fn finite32(x: f64) -> f32 {
    x.min(f64::from(f32::MAX)) as f32
}

fn finite(what: &str, x: f64) -> Result<f32> {
    let stored = x as f32;
    if stored.is_finite() {
        return Ok(stored);
    }
    Err(Error::run(format!("{what} leaves the range of 32 bits"))
        .found(x)
        .accepted(format!("at most {:.1e} in the units of the scene", f32::MAX)))
}

fn all_finite<const N: usize>(what: &str, numbers: [f64; N]) -> Result<[f32; N]> {
    let mut stored = [0.0; N];
    for (stored, x) in stored.iter_mut().zip(numbers) {
        *stored = finite(what, x)?;
    }
    Ok(stored)
}
