// Uses: nothing. Fills: nothing.
// e^x by the device's own exponential (3 + 2|x| units in the last place); 0 under −87, where numbers end.
// Twin of `lanes::optics::elementary::exp`, whose name WGSL keeps for itself.

fn exponential(x: f32) -> f32 {
    return select(exp(clamp(x, -87.0, 88.0)), 0.0, x < -87.0);
}

// e^(−depth) at four points.
fn transmittances(depth: vec4f) -> vec4f {
    return select(exp(-clamp(depth, vec4f(-88.0), vec4f(87.0))), vec4f(0.0), depth > vec4f(87.0));
}
