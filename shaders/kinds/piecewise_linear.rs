//! `piecewise-linear` in WGSL.

use super::snippets::{Light, Mixing, Snippet, WidgetSnippets};
use crate::segment_extent::SegmentExtent;
use crate::writer::{WidgetRecord, Writer, all_finite, finite};
use voltet_core::transfer::ControlPoint;
use voltet_core::{Error, Result};
use voltet_simd::limits::MAX_RAMP_RATE;

pub(super) fn snippets(count: usize, constant_emitter: bool) -> WidgetSnippets {
    let call = |piece, function: &str| Snippet::new(&[piece], format!("{function}(#u, {count}u, part_#)"));
    WidgetSnippets {
        depth: call("piecewise_linear/widget_depth", "piecewise_depth"),
        light: Light::Closed(match constant_emitter {
            false => call("piecewise_linear/widget_density_light", "piecewise_density_light"),
            true => call("piecewise_linear/widget_light", "piecewise_light"),
        }),
        track: call("piecewise_linear/widget_track", "piecewise_track"),
        track_type: "PiecewiseTrack",
        next_break: "piecewise_next_break(members.track_#, t)".into(),
        member_light: Snippet::new(
            &["overlap/member_colors", "piecewise_linear/track"],
            "member_colors_light(members.member_#, piecewise_colors(members.track_#, at), at, \
             piecewise_rates(members.track_#, at))",
        ),
        window: None,
        threshold: "widget_rate(#u, part_#) * scene.widgets[#].matrix.x",
        mixing: Mixing::Unbounded,
    }
}

/// Numbers of a control point.
pub(super) const NUMBERS: usize = 6;

/// matrix.x: the extinction above which it glows; numbers: six a point.
pub(super) fn write(points: &[ControlPoint], writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    let [s, _] = writer.plane();
    record.color = points[0].color.map(|c| c as f32);
    record.extinction = finite("1/unit distance", writer.per_unit)?;
    let peak = points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak));
    record.matrix[0] = writer.cutoff.map_or(-1.0, |cutoff| (cutoff * peak).min(f64::from(f32::MAX)) as f32);
    for (i, point) in points.iter().enumerate() {
        let span = s.stored(point.s) - s.stored(points[i.saturating_sub(1)].s);
        let inverse = if span > 0.0 { 1.0 / span } else { 0.0 };
        let [red, green, blue] = point.color;
        let row: [f64; NUMBERS] = [s.stored(point.s), point.extinction, inverse, red, green, blue];
        writer.numbers.extend(all_finite("a control point", row)?);
    }
    Ok(())
}

/// A ramp of depth P over the share w of the segment has the depth P t²/2w at t, so at most the rate √(2P/w) where that is 1.
pub(super) fn check_32_bits(points: &[ControlPoint], extent: &SegmentExtent) -> Result<()> {
    for (low, high) in points.iter().zip(points.iter().skip(1)) {
        let share = ((high.s - low.s) / extent.span(0)).min(1.0);
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
