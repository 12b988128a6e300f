// Uses: wave/bell. Fills: nothing.
// The profile at a distance of `foot` from the nearest foot, in [0, ½].

fn wave_value(bell: Bell, foot: f32) -> f32 {
    let spot = Spot(foot, 0.5 - foot);
    return max(wave_mean_on_flank(bell, spot, spot), 0.0);
}

fn wave_values(bell: Bell, foot: vec4f) -> vec4f {
    return vec4f(
        wave_value(bell, foot.x),
        wave_value(bell, foot.y),
        wave_value(bell, foot.z),
        wave_value(bell, foot.w),
    );
}
