// Uses: elementary/exponential, quadrature. Fills: nothing.
// A walk along one segment by panels of at most PANEL_DEPTH, which end at the breaks of what is walked along. The
// depth within a panel comes from the rates at its 8 points, so that it fits them however t rounds.
// Twin of `lanes::optics::track`.

// Where the depth in front exceeds this, nothing behind is seen (e^(−25) = 1e-11).
const OPAQUE_DEPTH = 25.0;
// 8 points then leave 1e-7 of e^(−T).
const PANEL_DEPTH = 2.5;
// Panels before a walk is given up: a thousand bands of six breaks.
const PANELS_MOST = 8192u;
// Distance in t within which a break counts as passed.
const PASSED = 5e-7;

struct Walk {
    t: f32,
    // T up to t.
    depth: f32,
    limit: f32,
}

fn walk_start() -> Walk {
    return Walk(0.0, 0.0, 1.0);
}

fn walk_is_open(walk: Walk) -> bool {
    return walk.t < 1.0 && walk.depth < OPAQUE_DEPTH;
}

// Length of the next panel, which ends at `next` or before.
fn walk_panel(walk: Walk, next: f32) -> f32 {
    return min(max(min(next, 1.0) - walk.t, 0.0), walk.limit);
}

// Whether a panel holds too much depth; the next one is then shortened, though not further than t can resolve. `share`: of
// the limit, for panels that are such a share of what the walk would take.
fn walk_shortens(walk: ptr<function, Walk>, dt: f32, held: f32, share: f32) -> bool {
    let shortens = share * (PANEL_DEPTH + 0.5) < held && 2.0 * PASSED < dt;
    if shortens {
        (*walk).limit = dt * clamp(PANEL_DEPTH / max(held, 1e-30), 0.01, 0.5 / share);
    }
    return shortens;
}

// Goes behind the panel; `rate` is that near its end.
fn walk_advance(walk: ptr<function, Walk>, next: f32, dt: f32, held: f32, rate: f32) {
    (*walk).depth += held;
    let end = min(next, 1.0);
    (*walk).t = select((*walk).t + dt, end, end - (*walk).t <= dt);
    (*walk).limit = PANEL_DEPTH / max(rate, PANEL_DEPTH);
}

// Takes the panel whose rates are these if its depth is small enough, else shortens it. Returns e^(−T) × weight × dt
// at the points, 0 if it was not taken.
fn walk_take(walk: ptr<function, Walk>, next: f32, dt: f32, rates: Points) -> Points {
    let held = over_panel(rates) * dt;
    if walk_shortens(walk, dt, held, 1.0) {
        return Points(vec4f(0.0), vec4f(0.0));
    }
    let within = to_nodes(rates);
    let depth = (*walk).depth;
    let seen = Points(
        transmittances(vec4f(depth) + dt * within.low) * (dt * WEIGHTS_LOW),
        transmittances(vec4f(depth) + dt * within.high) * (dt * WEIGHTS_HIGH),
    );
    walk_advance(walk, next, dt, held, rates.high.w);
    return seen;
}

// Linear along t, taken from the nearer end.
fn along(front: f32, back: f32, at: vec4f) -> vec4f {
    let near_back = vec4f(0.5) < at;
    return select(vec4f(front), vec4f(back), near_back)
        + (back - front) * select(at, at - vec4f(1.0), near_back);
}
