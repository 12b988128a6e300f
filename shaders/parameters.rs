//! Parameters that change per frame without another shader: the bytes of the `scene` uniform, and the last ones of the `numbers` buffer;
//! and limits of 32 bits on a device, checked before anything is drawn.

use crate::kinds;
use crate::kinds::{SegmentExtent, Spans};
use crate::resources::Places;
use crate::shader_key::{Combine, ShaderKey, WgslCall, registered};
use crate::writer::{Axis, WidgetRecord, Writer, finite};
use bytemuck::{Pod, Zeroable};
use voltet_core::arithmetic::unit_vector;
use voltet_core::transfer::{TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::shading::Shading;
use voltet_simd::limits::{LENGTHS, MAX_ORDERED_DEPTH, MAX_PIECES};

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
    /// Index of the integrator's first entry in `numbers`, or of the first number of curved axes.
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
    /// Edges, control points, matrices: what [`Places`] has them for.
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

/// Checks that a composed shader holds what the segments of a data set may ask of it; the error names the widget and the
/// limit.
pub fn check_32_bits(
    shader_key: &ShaderKey,
    transfer_function: &TransferFunction,
    spans: &Spans,
) -> Result<()> {
    if shader_key.method.is_table_of_lengths() {
        return Ok(());
    }
    let is_in_order = shader_key.combine == Combine::Ordered;
    let extent = SegmentExtent { transfer_function, spans, is_in_order };
    for (i, widget) in transfer_function.widgets.iter().enumerate() {
        check(shader_key, widget, &extent).map_err(|e| e.at_item(format!("widgets[{i}]")))?;
    }
    Ok(())
}

fn check(shader_key: &ShaderKey, widget: &Widget, extent: &SegmentExtent) -> Result<()> {
    for rate in [extent.length(), extent.length().max(extent.depth(widget))] {
        if !LENGTHS.contains(&rate) {
            return Err(Error::run("lengths or extinctions leave the range of 32 bits")
                .got(format!("{rate:e} as the length or depth of a segment in unit distances"))
                .expected(format!("{:.1e} to {:.1e}", LENGTHS.start, LENGTHS.end)));
        }
    }
    // Samples are taken where they fall, whatever lies between them.
    if shader_key.method.samples() {
        return Ok(());
    }
    let depth = extent.depth(widget);
    if extent.is_in_order && depth > MAX_ORDERED_DEPTH {
        return Err(Error::run("widgets that overlap are too dense for 32 bits to tell which is in front")
            .got(format!("{depth:e} as the optical depth of a segment"))
            .expected(format!("at most {MAX_ORDERED_DEPTH:e}, or an engine of 64 bits")));
    }
    kinds::check_32_bits(widget, extent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CompositorProgram;
    use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Wave};
    use voltet_optics::WidgetBlend;
    use voltet_optics::shading::{Integrator, Shading};

    #[test]
    fn a_million_pieces_are_walked_and_no_more() {
        assert_eq!(pieces(1 << 20).expect("fits"), 1 << 20);
        let message = pieces((1 << 20) + 1).expect_err("too many").to_string();
        assert!(message.contains("found 1048577") && message.contains("1048576"), "{message}");
    }

    fn answer(integrator: Integrator, widgets: Vec<Widget>, values: &[f64]) -> Result<()> {
        let model = OpticalModel::ConstantEmitter { cutoff: 1e-3 };
        let transfer_function =
            TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() };
        let shading = Shading { integrator, overlap: WidgetBlend::Exact, silhouette: None, light: None };
        let shader_key =
            ShaderKey::new(&transfer_function, &shading, CompositorProgram::None).expect("has pieces");
        check_32_bits(&shader_key, &transfer_function, &Spans { values, longest: 2.0 })
    }

    fn widget(profile: Profile, extinction: f64) -> Widget {
        Widget { profile, color: [1.0; 3], extinction, region: None }
    }

    fn gaussian(per_width: f64) -> Widget {
        widget(Profile::Gaussian { centre: [0.0; 2], matrix: [[per_width, 0.0], [0.0, 0.0]] }, 1.0)
    }

    fn wave(period: f64, extinction: f64) -> Widget {
        let wave = Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period, band_width: 0.5 };
        widget(Profile::SineWave(wave), extinction)
    }

    #[test]
    fn what_is_too_narrow_is_refused_and_named() {
        let analytic = Integrator::ANALYTIC;
        assert!(answer(analytic, vec![gaussian(9e4)], &[1.0, 1.0]).is_ok());
        let error =
            answer(analytic, vec![wave(1.0, 1.0), gaussian(2e5)], &[1.0, 1.0]).expect_err("too narrow");
        let message = error.to_string();
        assert!(message.contains("200000 widths") || message.contains("2e5 widths"), "{message}");
        assert!(message.contains("widgets[1]"), "{message}");
        assert!(answer(analytic, vec![gaussian(1.0)], &[1e6, 1.0]).is_err());
    }

    fn ramp(extinction: f64) -> Widget {
        let point = |s, extinction, red| ControlPoint { s, color: [red, 1.0, 1.0], extinction };
        let points = vec![point(0.5, 0.0, 0.0), point(0.5001, extinction, 1.0)];
        widget(Profile::PiecewiseLinear { points }, 0.0)
    }

    /// A tenth inside each limit a scene is served, a tenth beyond it is refused with that limit.
    #[test]
    fn limits_are_where_they_are_stated() {
        let among = |wave| vec![wave, gaussian(1.0)];
        let most = f64::from(f32::MAX) / 4.0;
        // Segments are 2 long; the waves' band width is a half, the cutoff a thousandth.
        type Of<'a> = &'a dyn Fn(f64) -> Vec<Widget>;
        let cases: [(f64, Of, &str); 8] = [
            (1e5, &|widths| vec![gaussian(widths)], "at most 1e5"),
            (1e6, &|bands| vec![wave(1.0 / bands, 1.0)], "at most 1e6"),
            (1e3, &|by_width| among(wave(2.0 / by_width, 1.0)), "at most 1e3"),
            // Opaque ones: 2e4 × 1e-3 bands by band width; and opaque is a depth of 30.
            (20.0, &|by_width| among(wave(2.0 / by_width, 100.0)), "at most 2e1"),
            (30.0, &|depth| among(wave(0.05, 0.5 * depth)), "at most 2e1"),
            (2e7, &|depth| vec![widget(gaussian(1.0).profile, 0.5 * depth), gaussian(1.0)], "at most 2e7"),
            // Over 1e-4 of the segment: P = r² 1e-4 / 2.
            (4e4, &|rate| vec![ramp(0.25e-4 * rate * rate)], "at most 4e4"),
            (most, &|depth| vec![widget(gaussian(1.0).profile, 0.5 * depth)], "to 8.5e37"),
        ];
        for (limit, of, words) in cases {
            let answer = |share: f64| answer(Integrator::ANALYTIC, of(share * limit), &[1.0, 1.0]);
            assert!(answer(0.9).is_ok(), "{words}: {:?}", answer(0.9));
            let message = answer(1.1).expect_err("beyond").to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
