//! What 32 bits on a device cannot hold, asked before anything is drawn.

use crate::choices::{Choices, Combine};
use voltet_core::transfer::{Profile, TransferFunction, Wave, Widget};
use voltet_core::{Error, Result};
use voltet_lanes::optics::wave::BANDS_MOST;

/// What one segment of a data set spans at most; the ranges of the values bound it, closer numbers refuse less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spans<'a> {
    /// |v_b − v_f| of s, g (also where it is not read) and the further fields by name.
    pub values: &'a [f64],
    /// D, world units.
    pub longest: f64,
}

/// Widths of a Gaussian that a segment may span: the rounding of the ends (6e-8 of the span) moves the path by a share
/// of a width, which enters h² squared: 1e-5 at this limit.
const WIDTHS_MOST: f64 = 1e5;

/// Bands of a wave within which 32 bits tell one from the next.
const WAVE_BANDS_MOST: f64 = 1e6;

/// Depth from which on all that is seen of a wave of the constant-emitter is where its band begins to glow.
const OPAQUE: f64 = 30.0;

/// That place is then within rounding of where the band begins if the segment crosses more than this times the cutoff of
/// bands, by band width: the rate there, `cutoff` of its peak, has few digits. Under the limit the colour errs by less
/// than 1e-4.
const SUDDEN_BANDS: f64 = 2e4;

/// Checks that a composed shader holds what the segments of a data set may ask of it; the error names the widget and the
/// limit.
pub fn check_32_bits(choices: &Choices, transfer_function: &TransferFunction, spans: &Spans) -> Result<()> {
    if choices.method.is_table_of_lengths() {
        return Ok(());
    }
    let per_unit = spans.longest / transfer_function.unit_distance;
    for (i, widget) in transfer_function.widgets.iter().enumerate() {
        let scene = Scene { choices, transfer_function, spans, per_unit };
        scene.check(widget).map_err(|e| e.at_item(format!("widgets[{i}]")))?;
    }
    Ok(())
}

struct Scene<'a> {
    choices: &'a Choices,
    transfer_function: &'a TransferFunction,
    spans: &'a Spans<'a>,
    /// D/U.
    per_unit: f64,
}

impl Scene<'_> {
    fn check(&self, widget: &Widget) -> Result<()> {
        for rate in [self.per_unit, self.per_unit * widget.extinction.max(1.0)] {
            if !(f64::from(f32::MIN_POSITIVE)..f64::from(f32::MAX) / 4.0).contains(&rate) {
                return Err(Error::run("lengths or extinctions leave the range of 32 bits")
                    .found(format!("{rate:e} as the length or depth of a segment in unit distances"))
                    .accepted("1.2e-38 to 8.5e37"));
            }
        }
        // Samples are taken where they fall, whatever lies between them.
        if self.choices.method.samples() {
            return Ok(());
        }
        match &widget.profile {
            Profile::TriangleWave(wave) | Profile::SineWave(wave) => self.wave(widget, wave),
            profile => {
                let widths = self.widths(profile);
                if widths <= WIDTHS_MOST {
                    return Ok(());
                }
                Err(Error::run("a Gaussian is narrower than 32 bits resolve along a segment")
                    .found(format!("{widths:e} widths over one segment"))
                    .accepted(format!("at most {WIDTHS_MOST:e}, or an engine of 64 bits")))
            }
        }
    }

    /// The most of |K (v_b − v_f)|; 0 for other widgets.
    fn widths(&self, profile: &Profile) -> f64 {
        let along = |row: &[f64], spans: &dyn Fn(usize) -> f64| {
            row.iter().enumerate().map(|(j, k)| (k * spans(j)).abs()).sum::<f64>()
        };
        let norm = |rows: &mut dyn Iterator<Item = f64>| rows.map(|x| x * x).sum::<f64>().sqrt();
        match profile {
            Profile::Gaussian { matrix, .. } => {
                norm(&mut matrix.iter().map(|row| along(row, &|j| self.spans.values[j])))
            }
            Profile::GaussianNd { fields, matrix, .. } => {
                let all = self.transfer_function.fields();
                let span = |j: usize| {
                    let place = all.iter().position(|name| *name == fields[j]);
                    place.map_or(0.0, |place| self.spans.values[2 + place])
                };
                norm(&mut matrix.iter().map(|row| along(row, &span)))
            }
            _ => 0.0,
        }
    }

    fn wave(&self, widget: &Widget, wave: &Wave) -> Result<()> {
        let (sin, cos) = wave.angle.sin_cos();
        let per_value = [cos * wave.scale[0] / wave.period, sin * wave.scale[1] / wave.period];
        let bands: f64 = per_value.iter().zip(self.spans.values).map(|(a, span)| (a * span).abs()).sum();
        let by_width = bands / wave.band_width;
        let refuse = |why: &str, found: f64, most: f64| {
            Err(Error::run(why)
                .found(format!("{found:e} bands over one segment"))
                .accepted(format!("at most {most:e}, or an engine of 64 bits")))
        };
        if bands > WAVE_BANDS_MOST {
            return refuse("a wave has more bands than 32 bits tell apart", bands, WAVE_BANDS_MOST);
        }
        if self.choices.combine != Combine::Ordered {
            return Ok(());
        }
        if by_width > BANDS_MOST {
            let why = "a wave among other widgets has more bands, by band width, than are walked one by one";
            return refuse(why, by_width, BANDS_MOST);
        }
        // On a part of one band the place has all its digits.
        let whole = bands.round() / wave.band_width;
        let depth = self.per_unit * widget.extinction;
        let cutoff = self.transfer_function.model.cutoff();
        if let Some(most) = cutoff.map(|cutoff| SUDDEN_BANDS * cutoff)
            && depth > OPAQUE
            && whole > most
        {
            let why = "a wave among other widgets is opaque within the rounding of its band";
            return refuse(why, whole, most);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Compositor;
    use voltet_core::optics::Overlap;
    use voltet_core::shading::{Integrator, Shading};
    use voltet_core::transfer::OpticalModel;

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
