// Uses: linear/panels. Fills: nothing.
// ψ = ∫₀¹ e^(−w) for a piece of linear extinction (Moreland & Angel 2004).
// Twin of `lanes::optics::linear::psi`.

fn psi(front: f32, back: f32) -> f32 {
    let a = min(front, LINEAR_RATE_MOST);
    let b = min(back, LINEAR_RATE_MOST);
    var sum = f32();
    var start = 0.0;
    var depth = 0.0;
    for (var i = 0u; i < LINEAR_PANELS_MOST && start < 1.0 && depth < LINEAR_DEPTH_MOST; i++) {
        let panel = linear_panel(a, b, start, depth);
        sum += dot(panel.seen.low + panel.seen.high, vec4f(1.0));
        linear_advance(a, b, panel, &start, &depth);
    }
    return sum;
}
