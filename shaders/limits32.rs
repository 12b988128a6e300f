//! Limits of 32 bits on a device, checked before anything is drawn.

use crate::kinds;
use crate::kinds::{SegmentExtent, Spans};
use crate::shader_key::{Combine, ShaderKey};
use voltet_core::transfer::{TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_simd::limits::{LENGTHS, MAX_ORDERED_DEPTH};

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

    fn answer(integrator: Integrator, widgets: Vec<Widget>, values: &[f64]) -> Result<()> {
        let model = OpticalModel::ConstantEmitter { cutoff: 1e-3 };
        let transfer_function = TransferFunction { model, unit_distance: 1.0, widgets };
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
