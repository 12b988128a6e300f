// Uses: widgets/widget. Fills: nothing.
// A uniform widget along a segment, as the quadrature sees it.

struct UniformTrack {
    rate: f32,
}

fn uniform_track(index: u32, part: Part) -> UniformTrack {
    return UniformTrack(widget_rate(index, part));
}

fn uniform_rates(track: UniformTrack, at: vec4f) -> vec4f {
    return vec4f(track.rate);
}

fn uniform_next_break(track: UniformTrack, t: f32) -> f32 {
    return 2.0;
}
