//! Parameters that change per frame without another shader: the bytes of the `scene` uniform, and the last ones of the `numbers` buffer.

use crate::kinds;
use crate::resources::Places;
use crate::shader_key::{WgslCall, registered};
use crate::writer::{Axis, WidgetRecord, Writer, finite};
use bytemuck::{Pod, Zeroable};
use voltet_core::transfer::{TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::shading::{Shading, unit_vector};
use voltet_simd::limits::MAX_PIECES;

/// Head of `Scene` in `scene.wgsl`, before the widgets.
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
    /// Pieces of a segment, for integrators that cut it.
    pub piece_count: u32,
    /// Index of the integrator's first entry in `numbers`.
    pub first_entry: u32,
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
    /// Edges, control points, matrices: what [`Places`](crate::Places) has them for.
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
                .got(axes.len())
                .expected(format!("{}: s, g and one a field", 2 + fields.len())));
        }
        let cutoff = transfer_function.model.cutoff();
        let (direction, ambient, diffuse) = shading.light.map_or(([0.0; 3], 1.0, 0.0), |light| {
            (unit_vector(light.direction).to_array(), light.ambient, light.diffuse)
        });
        let per_unit = length / transfer_function.unit_distance;
        let tolerance = shading.integrator.tolerance().unwrap_or(0.0) as f32;
        let piece_count = registered(&shading.integrator)
            .and_then(|text| text.piece_count(&shading.integrator))
            .map_or(Ok(0), pieces)?;
        let places = Places::new(transfer_function, shading, 0);
        let [first_entry, first_number] = [place(places.first_entry())?, place(places.first_number())?];
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
            brightest: transfer_function.widgets.iter().map(Widget::max_emission).fold(0.0, f64::max) as f32,
            piece_count,
            first_entry,
            padding: [0; 3],
        };
        let first_field = 1 + usize::from(transfer_function.uses_gradient_magnitude());
        let mut writer = Writer {
            axes,
            per_unit,
            cutoff,
            fields,
            first_field,
            first_number,
            numbers: Vec::new(),
            texel_count: 0,
        };
        let mut widgets = Vec::with_capacity(transfer_function.widgets.len().max(1));
        for (i, widget) in transfer_function.widgets.iter().enumerate() {
            widgets.push(record(&mut writer, widget).map_err(|e| e.at_item(format!("widgets[{i}]")))?);
        }
        if let Some(color) = transfer_function.uniform_color() {
            // Any of them stands for all; what is not drawn may have another.
            widgets.iter_mut().for_each(|record| record.color = color.map(|c| c as f32));
        }
        if widgets.is_empty() {
            widgets.push(WidgetRecord::zeroed());
        }
        // A table of lengths stands for all widgets.
        let from_table = registered(&shading.integrator)
            .is_some_and(|text| matches!(text.call(false), WgslCall::Table { .. }));
        let numbers = if from_table { Vec::new() } else { writer.numbers };
        Ok(Parameters { head, widgets, numbers })
    }

    /// The bytes of the uniform `scene`.
    pub fn scene_bytes(&self) -> Vec<u8> {
        [bytemuck::bytes_of(&self.head), bytemuck::cast_slice(&self.widgets)].concat()
    }
}

/// Writes one widget.
fn record(writer: &mut Writer, widget: &Widget) -> Result<WidgetRecord> {
    let first_edge = writer.next_place();
    writer.edges(widget)?;
    let first_number = writer.next_place();
    let mut record = WidgetRecord {
        color: widget.color.map(|c| c as f32),
        extinction: finite("the extinction", widget.extinction * writer.per_unit)?,
        first_edge,
        first_number,
        ..WidgetRecord::zeroed()
    };
    kinds::write(&widget.profile, writer, &mut record)?;
    Ok(record)
}

/// A place in `numbers`.
fn place(at: u64) -> Result<u32> {
    u32::try_from(at)
        .map_err(|_| Error::run("a table has more numbers than a shader counts").got(at).expected(u32::MAX))
}

fn pieces(count: usize) -> Result<u32> {
    u32::try_from(count).ok().filter(|count| *count <= MAX_PIECES).ok_or_else(|| {
        Error::usage("a segment has more pieces than a shader walks").got(count).expected(MAX_PIECES)
    })
}

#[cfg(test)]
mod tests {
    use super::pieces;

    #[test]
    fn a_million_pieces_are_walked_and_no_more() {
        assert_eq!(pieces(1 << 20).expect("fits"), 1 << 20);
        let message = pieces((1 << 20) + 1).expect_err("too many").to_string();
        assert!(message.contains("found 1048577") && message.contains("1048576"), "{message}");
    }
}
