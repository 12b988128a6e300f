// Uses: nothing. Fills: nothing. Asks for: numbers.
// Control points of a piecewise-linear widget: colour and extinction linear between them, constant beyond the ends.
// Interval k lies below control point k: interval 0 before the first, interval n beyond the last.
// Twin of `lanes::optics::piecewise_linear::LanePoints`.

// Numbers of a control point: s, extinction, 1/(s − s of the point before) or 0 for a step, red, green, blue.
const POINT_STRIDE = 6u;

// The points of one widget: where its numbers begin, how many points there are.
struct ControlPoints {
    first: u32,
    count: u32,
}

fn point_s(points: ControlPoints, k: u32) -> f32 {
    return number(points.first + POINT_STRIDE * k);
}

// Number of control points at or below s.
fn points_interval(points: ControlPoints, s: f32) -> u32 {
    var k = 0u;
    for (var i = 0u; i < points.count; i++) {
        k += select(0u, 1u, point_s(points, i) <= s);
    }
    return k;
}

// Weights of the control points below and above at s, each from the difference to the other.
fn points_weights(points: ControlPoints, k: u32, s: f32) -> vec2f {
    if k == 0u || k == points.count {
        return vec2f(0.5, 0.5);
    }
    let inverse = number(points.first + POINT_STRIDE * k + 2u);
    return clamp(vec2f(point_s(points, k) - s, s - point_s(points, k - 1u)) * inverse, vec2f(0.0), vec2f(1.0));
}

// First numbers of the control points below and above interval k; beyond the ends they are the same.
fn points_sides(points: ControlPoints, k: u32) -> vec2u {
    let sides = vec2u(max(k, 1u) - 1u, min(k, max(points.count, 1u) - 1u));
    return vec2u(points.first) + POINT_STRIDE * sides;
}

// Extinction at s, which lies in interval k.
fn points_extinction(points: ControlPoints, k: u32, s: f32) -> f32 {
    let side = points_sides(points, k);
    return dot(points_weights(points, k, s), vec2f(number(side.x + 1u), number(side.y + 1u)));
}

// Colour at s, which lies in interval k.
fn points_color(points: ControlPoints, k: u32, s: f32) -> vec3f {
    let side = points_sides(points, k);
    let weights = points_weights(points, k, s);
    return weights.x * vec3f(number(side.x + 3u), number(side.x + 4u), number(side.x + 5u))
        + weights.y * vec3f(number(side.y + 3u), number(side.y + 4u), number(side.y + 5u));
}
