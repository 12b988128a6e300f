//! What 32 bits on a device cannot hold, asked before anything is drawn.

use crate::choices::{Choices, Combine};
use crate::kinds;
use crate::stretch::{Spans, Stretch};
use voltet_core::transfer::{TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_lanes::limits::{DEPTH_IN_ORDER_MOST, LENGTHS};

/// Checks that a composed shader holds what the segments of a data set may ask of it; the error names the widget and the
/// limit.
pub fn check_32_bits(choices: &Choices, transfer_function: &TransferFunction, spans: &Spans) -> Result<()> {
    if choices.method.is_table_of_lengths() {
        return Ok(());
    }
    let is_in_order = choices.combine == Combine::Ordered;
    let stretch = Stretch { transfer_function, spans, is_in_order };
    for (i, widget) in transfer_function.widgets.iter().enumerate() {
        check(choices, widget, &stretch).map_err(|e| e.at_item(format!("widgets[{i}]")))?;
    }
    Ok(())
}

fn check(choices: &Choices, widget: &Widget, stretch: &Stretch) -> Result<()> {
    for rate in [stretch.length(), stretch.length().max(stretch.depth(widget))] {
        if !LENGTHS.contains(&rate) {
            return Err(Error::run("lengths or extinctions leave the range of 32 bits")
                .found(format!("{rate:e} as the length or depth of a segment in unit distances"))
                .accepted(format!("{:.1e} to {:.1e}", LENGTHS.start, LENGTHS.end)));
        }
    }
    // Samples are taken where they fall, whatever lies between them.
    if choices.method.samples() {
        return Ok(());
    }
    let depth = stretch.depth(widget);
    if stretch.is_in_order && depth > DEPTH_IN_ORDER_MOST {
        return Err(Error::run("widgets that overlap are too dense for 32 bits to tell which is in front")
            .found(format!("{depth:e} as the optical depth of a segment"))
            .accepted(format!("at most {DEPTH_IN_ORDER_MOST:e}, or an engine of 64 bits")));
    }
    kinds::check_32_bits(widget, stretch)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Compositor;
    use voltet_core::optics::Overlap;
    use voltet_core::shading::{Integrator, Shading};
    use voltet_core::transfer::{OpticalModel, Profile, Wave};

    fn answer(integrator: Integrator, widgets: Vec<Widget>, values: &[f64]) -> Result<()> {
        let model = OpticalModel::ConstantEmitter { cutoff: 1e-3 };
        let transfer_function = TransferFunction { model, unit_distance: 1.0, widgets };
        let shading = Shading { integrator, overlap: Overlap::Exact, silhouette: None, light: None };
        let choices = Choices::new(&transfer_function, &shading, Compositor::None).expect("has pieces");
        check_32_bits(&choices, &transfer_function, &Spans { values, longest: 2.0 })
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
        let analytic = Integrator::Analytic;
        assert!(answer(analytic, vec![gaussian(9e4)], &[1.0, 1.0]).is_ok());
        let error =
            answer(analytic, vec![wave(1.0, 1.0), gaussian(2e5)], &[1.0, 1.0]).expect_err("too narrow");
        let message = error.to_string();
        assert!(message.contains("200000 widths") || message.contains("2e5 widths"), "{message}");
        assert!(message.contains("widgets[1]"), "{message}");
        // Samples, and a table made in 64 bits, do not resolve it either, and are not asked to.
        for integrator in [Integrator::Riemann { count: 4 }, Integrator::PreIntegrated { table_size: 4 }] {
            assert!(answer(integrator, vec![gaussian(2e5)], &[1.0, 1.0]).is_ok());
        }
        assert!(answer(analytic, vec![gaussian(1.0)], &[1e6, 1.0]).is_err());
    }

    #[test]
    fn waves_of_many_bands_are_refused_among_others_first() {
        let analytic = Integrator::Analytic;
        let among = |wave| vec![wave, gaussian(1.0)];
        assert!(answer(analytic, vec![wave(1e-4, 1.0)], &[1.0, 1.0]).is_ok());
        assert!(answer(analytic, among(wave(1e-4, 1.0)), &[1.0, 1.0]).is_err());
        assert!(answer(analytic, vec![wave(1e-7, 1.0)], &[1.0, 1.0]).is_err());
        // 40 bands by band width are more than 2e4 × 1e-3; they matter where they are opaque.
        assert!(answer(analytic, among(wave(0.05, 1.0)), &[1.0, 1.0]).is_ok());
        assert!(answer(analytic, among(wave(0.05, 100.0)), &[1.0, 1.0]).is_err());
        assert!(answer(analytic, among(wave(1.0, 1e38)), &[1.0, 1.0]).is_err());
    }
}
