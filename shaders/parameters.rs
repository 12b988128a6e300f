//! What may change per frame without another shader: the bytes of the `scene` uniform and of the `numbers` buffer.

use crate::kinds;
use bytemuck::{Pod, Zeroable};
use voltet_core::shading::{Shading, unit_vector};
use voltet_core::transfer::{HalfPlane, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_lanes::limits::PIECES_MOST;

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
        let numbers = shading.integrator.numbers();
        let tolerance = numbers.tolerance.unwrap_or(0.0) as f32;
        let piece_count = numbers.count.map_or(Ok(0), pieces)?;
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

/// Writes the numbers of one widget after the other.
pub(crate) struct Writer<'a> {
    axes: &'a [Axis],
    /// 1/U in scene lengths.
    pub per_unit: f64,
    /// The constant-emitter's.
    pub cutoff: Option<f64>,
    fields: Vec<&'a str>,
    /// Where the further fields begin among a segment's values.
    first_field: usize,
    /// Edges, control points, matrices so far.
    pub numbers: Vec<f32>,
    /// Of the tables so far.
    pub texel_count: u32,
}

impl Writer<'_> {
    /// The axes of s and g.
    pub fn plane(&self) -> [Axis; 2] {
        [self.axes[0], self.axes[1]]
    }

    /// The place of a field among the further ones.
    pub fn field(&self, name: &str) -> usize {
        self.fields.iter().position(|field| *field == name).unwrap_or(0)
    }

    /// The axis of a further field.
    pub fn axis(&self, field: usize) -> Axis {
        self.axes[2 + field]
    }

    /// The place of a further field among a segment's values.
    pub fn value_of_field(&self, field: usize) -> usize {
        self.first_field + field
    }

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
        kinds::write(&widget.profile, self, &mut record)?;
        Ok(record)
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

/// A number in 32 bits, if it has one there.
pub(crate) fn finite(what: &str, x: f64) -> Result<f32> {
    let stored = x as f32;
    if stored.is_finite() {
        return Ok(stored);
    }
    Err(Error::run(format!("{what} leaves the range of 32 bits"))
        .found(x)
        .accepted(format!("at most {:.1e} in the units of the scene", f32::MAX)))
}

/// The same for several.
pub(crate) fn all_finite<const N: usize>(what: &str, numbers: [f64; N]) -> Result<[f32; N]> {
    let mut stored = [0.0; N];
    for (stored, x) in stored.iter_mut().zip(numbers) {
        *stored = finite(what, x)?;
    }
    Ok(stored)
}
