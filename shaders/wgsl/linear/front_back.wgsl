// Uses: linear/panels. Fills: nothing.
// (F, B) = (∫ (1 − x) e^(−w), ∫ x e^(−w)), x ∈ [0, 1]: the weights of the front and back colours in the constant-emitter
// colour of a piece (Song et al. 2009, Eq. 3).
// Twin of `lanes::optics::linear::front_back`.

fn front_back(front: f32, back: f32) -> vec2f {
    let a = min(front, LINEAR_RATE_MOST);
    let b = min(back, LINEAR_RATE_MOST);
    var sum = vec2f();
    var start = 0.0;
    var depth = 0.0;
    for (var i = 0u; i < LINEAR_PANELS_MOST && start < 1.0 && depth < LINEAR_DEPTH_MOST; i++) {
        let panel = linear_panel(a, b, start, depth);
        let x = linear_points(panel);
        sum.x += dot(panel.seen.low, vec4f(1.0) - x.low) + dot(panel.seen.high, vec4f(1.0) - x.high);
        sum.y += dot(panel.seen.low, x.low) + dot(panel.seen.high, x.high);
        linear_advance(a, b, panel, &start, &depth);
    }
    return sum;
}
