//! `triangle-wave` and `sine-wave` in WGSL.

use super::snippets::{CUTOFF_RATE, Light, Mixing, Snippet, WidgetSnippets, light_of_rates};
use crate::segment_extent::SegmentExtent;
use crate::writer::{WidgetRecord, Writer};
use voltet_core::transfer::{Wave, Widget};
use voltet_core::{Error, Result};
use voltet_optics::kinds::wave::{sine_half_area, sine_half_width};
use voltet_simd::limits::{MAX_BANDS, MAX_WALKED_BANDS, OPAQUE, SUDDEN_BANDS};

pub(super) fn snippets(constant_emitter: bool) -> WidgetSnippets {
    WidgetSnippets {
        depth: Snippet::new(&["wave/widget"], "wave_depth(#u, part_#)"),
        light: match constant_emitter {
            false => Light::of_density(),
            true => Light::Closed(Snippet::new(&["wave/widget_light"], "wave_light(#u, part_#)")),
        },
        track: Snippet::new(&["wave/widget_track"], "wave_widget_track(#u, part_#)"),
        track_type: "WaveTrack",
        next_break: "wave_next_break(members.track_#, t)".into(),
        member_light: light_of_rates("wave/track", "wave_rates"),
        window: None,
        threshold: CUTOFF_RATE,
        mixing: Mixing::DensityOnly,
    }
}

/// matrix.xy: phase per stored s and g, matrix.z: phase at 0 without whole bands.
pub(super) fn write(wave: &Wave, sine: bool, writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
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

pub(super) fn check_32_bits(widget: &Widget, wave: &Wave, extent: &SegmentExtent) -> Result<()> {
    let bands: f64 = wave.step().iter().enumerate().map(|(a, step)| (step * extent.span(a)).abs()).sum();
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
    if let Some(most) = extent.cutoff().map(|cutoff| SUDDEN_BANDS * cutoff)
        && extent.depth(widget) > OPAQUE
        && whole > most
    {
        let why = "a wave among other widgets is opaque within the rounding of its band";
        return refuse(why, whole, most);
    }
    Ok(())
}
