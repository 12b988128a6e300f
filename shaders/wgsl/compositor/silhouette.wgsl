// Uses: passes/screen. Fills: nothing.
// The silhouette of a cell: two of the six edges cross (the four corners are the silhouette) or one corner lies within the
// triangle of the others. The classes of Shirley and Tuchman (1990); what lies between them, a corner on an edge or on
// another corner, is a triangle here whose fourth corner is on its rim.

// Farthest coordinate of a corner with digits to spare: those of the largest picture.
const REACH = 32768.0;

// Numbers of the corners in their order around the silhouette: corners x and z, and y and w, are the ends of the edges that
// cross. Of a triangle w is the corner within.
struct Silhouette {
    corners: vec4u,
    is_triangle: bool,
}

// Twice the area of a triangle, by its direction.
fn turn(a: vec2f, b: vec2f, c: vec2f) -> f32 {
    let u = b - a;
    let v = c - a;
    return u.x * v.y - u.y * v.x;
}

fn are_crossing(a: vec2f, b: vec2f, c: vec2f, d: vec2f) -> bool {
    let sides = vec2f(turn(a, b, c), turn(a, b, d));
    let others = vec2f(turn(c, d, a), turn(c, d, b));
    return min(sides.x, sides.y) < 0.0 && 0.0 < max(sides.x, sides.y)
        && min(others.x, others.y) < 0.0 && 0.0 < max(others.x, others.y);
}

fn silhouette_of(a: vec2f, b: vec2f, c: vec2f, d: vec2f) -> Silhouette {
    if are_crossing(a, b, c, d) {
        return Silhouette(vec4u(0u, 2u, 1u, 3u), false);
    }
    if are_crossing(a, c, b, d) {
        return Silhouette(vec4u(0u, 1u, 2u, 3u), false);
    }
    if are_crossing(a, d, b, c) {
        return Silhouette(vec4u(0u, 1u, 3u, 2u), false);
    }
    let areas = abs(vec4f(turn(b, c, d), turn(a, c, d), turn(a, b, d), turn(a, b, c)));
    let largest = most(areas);
    if areas.x == largest {
        return Silhouette(vec4u(1u, 2u, 3u, 0u), true);
    }
    if areas.y == largest {
        return Silhouette(vec4u(0u, 2u, 3u, 1u), true);
    }
    if areas.z == largest {
        return Silhouette(vec4u(0u, 1u, 3u, 2u), true);
    }
    return Silhouette(vec4u(0u, 1u, 2u, 3u), true);
}

// Places of the corners around the silhouette; the last two are one where it is a triangle.
fn ring_of(silhouette: Silhouette, corners: array<vec2f, 4>) -> array<vec2f, 4> {
    var places = corners;
    let around = silhouette.corners;
    let last = select(around.w, around.z, silhouette.is_triangle);
    return array(places[around.x], places[around.y], places[around.z], places[last]);
}

fn are_within_reach(corners: array<vec2f, 4>) -> bool {
    let far = max(max(abs(corners[0]), abs(corners[1])), max(abs(corners[2]), abs(corners[3])));
    return max(far.x, far.y) < REACH;
}

// The corners of a box of pixels. `covered`: as `bound_cells` packs it. What cannot be projected is drawn as this.
fn box_around(covered: vec2u) -> array<vec2f, 4> {
    let start = vec2f(vec2u(covered.x & 0xffffu, covered.x >> 16u)) - 0.5;
    let end = vec2f(vec2u(covered.y & 0xffffu, covered.y >> 16u)) - 0.5;
    return array(start, vec2f(end.x, start.y), end, vec2f(start.x, end.y));
}
