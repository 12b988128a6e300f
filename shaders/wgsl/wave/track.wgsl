// Uses: track, wave/value. Fills: nothing.
// A wave along a segment, as the quadrature sees it: it breaks at feet, peaks and where the profile passes the cutoff.
// Serves a thousand bands by band width. Twin of `lanes::optics::wave::LaneWaveTrack`.

struct WaveTrack {
    bell: Bell,
    // φ at the front, from its nearest foot, and what the segment adds to it.
    phase: f32,
    span: f32,
    // ρ₀ D.
    peak: f32,
}

fn wave_track(bell: Bell, front: Phase, back: Phase, peak: f32) -> WaveTrack {
    let span = (back.nearest - front.nearest) + (back.offset - front.offset);
    return WaveTrack(bell, front.offset, span, peak);
}

fn wave_rates(track: WaveTrack, at: vec4f) -> vec4f {
    let phase = along(track.phase, track.phase + track.span, at);
    return track.peak * wave_values(track.bell, min(abs(phase - round(phase)), vec4f(0.5)));
}

fn wave_next_break(track: WaveTrack, t: f32) -> f32 {
    let sign = select(1.0, -1.0, track.span < 0.0);
    let span = abs(track.span);
    let phase = (track.span * t + track.phase) * sign;
    // What the rounding of t and of the phase stands for.
    let past = phase + (span + 1.0 + abs(phase)) * 2.4e-7;
    let band = floor(past);
    let place = past - band;
    var next = 1.0;
    next = select(next, 0.5 + track.bell.reach, place < 0.5 + track.bell.reach);
    next = select(next, 0.5 + track.bell.lit, place < 0.5 + track.bell.lit);
    next = select(next, 0.5, place < 0.5);
    next = select(next, 0.5 - track.bell.lit, place < 0.5 - track.bell.lit);
    next = select(next, 0.5 - track.bell.reach, place < 0.5 - track.bell.reach);
    return t + ((band - phase) + next) / max(span, 1e-30);
}
