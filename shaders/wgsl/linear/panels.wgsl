// Uses: elementary/exponential, quadrature. Fills: nothing.
// Panels of optical depth about 2 over a piece of linear extinction: with a = ρ_f D, b = ρ_b D,
// w(x) = a x + (b − a) x²/2. Twin of the panels of `lanes::optics::linear`.

// At most 21 panels at constant or rising rate; a falling rate has fewer.
const LINEAR_PANELS_MOST = 48u;
// Beyond e^(−24) nothing is seen.
const LINEAR_DEPTH_MOST = 24.0;
// Rates are held under this; the first panel is then all that is seen.
const LINEAR_RATE_MOST = 1e15;

struct LinearPanel {
    start: f32,
    // w at the start.
    depth: f32,
    length: f32,
    // weight × e^(−w).
    seen: Points,
}

fn linear_panel(a: f32, b: f32, start: f32, depth: f32) -> LinearPanel {
    let slope = b - a;
    let rest = 1.0 - start;
    let rate = a * rest + b * start;
    let root = sqrt(max(rate * rate + 4.0 * slope, 0.0));
    let length = min(4.0 / max(rate + root, 1e-30), rest);
    let low = length * NODES_LOW;
    let high = length * NODES_HIGH;
    let half_slope = slope * 0.5;
    let seen = Points(
        length * WEIGHTS_LOW * transmittances(vec4f(depth) + low * (vec4f(rate) + half_slope * low)),
        length * WEIGHTS_HIGH * transmittances(vec4f(depth) + high * (vec4f(rate) + half_slope * high)),
    );
    return LinearPanel(start, depth, length, seen);
}

// The panel's points, x.
fn linear_points(panel: LinearPanel) -> Points {
    return Points(
        vec4f(panel.start) + panel.length * NODES_LOW,
        vec4f(panel.start) + panel.length * NODES_HIGH,
    );
}

// Goes behind the panel.
fn linear_advance(a: f32, b: f32, panel: LinearPanel, start: ptr<function, f32>, depth: ptr<function, f32>) {
    let rest = 1.0 - panel.start;
    let rate = a * rest + b * panel.start;
    *depth = panel.depth + panel.length * (rate + 0.5 * (b - a) * panel.length);
    *start = select(panel.start + panel.length, 1.0, rest <= panel.length);
}
