// Uses: linear/panels. Fills: nothing.
// (1 − ψ, ψ − ζ), the weights of the front and back colours of a density-emitter piece (Moreland & Angel 2004), as
// integrals of ρ e^(−w).
// Twin of `lanes::optics::linear::emission_weights`.

fn emission_weights(front: f32, back: f32) -> vec2f {
    let a = min(front, LINEAR_RATE_MOST);
    let b = min(back, LINEAR_RATE_MOST);
    var sum = vec2f();
    var start = 0.0;
    var depth = 0.0;
    for (var i = 0u; i < LINEAR_PANELS_MOST && start < 1.0 && depth < LINEAR_DEPTH_MOST; i++) {
        let panel = linear_panel(a, b, start, depth);
        let x = linear_points(panel);
        let low = panel.seen.low * (vec4f(a) + (b - a) * x.low);
        let high = panel.seen.high * (vec4f(a) + (b - a) * x.high);
        sum.x += dot(low, vec4f(1.0) - x.low) + dot(high, vec4f(1.0) - x.high);
        sum.y += dot(low, x.low) + dot(high, x.high);
        linear_advance(a, b, panel, &start, &depth);
    }
    return sum;
}
