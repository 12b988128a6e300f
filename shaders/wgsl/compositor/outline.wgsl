// Uses: compositor/silhouette. Fills: nothing.
// The silhouette of a cell as a quadrilateral that holds every pixel it may cover.
//
// The thick vertex of Shirley and Tuchman (1990) is not needed here, since entry and exit come from the planes at every
// pixel; but the hardware moves corners to a raster of a sixteenth to a 256th of a pixel, and the next
// cell's ray must be lost to neither. So the outline is moved outwards by more than that.

// How far the outline is moved outwards, pixels: coordinates are off by a hundredth (rounding), and by half a
// sixteenth (the coarsest raster that Vulkan allows).
const MARGIN = 0.1;
// Least 1 + cos of the turn at a corner whose moved edges meet near it: the corner moves by at most 10 margins.
const SHARPEST = 0.02;

// A corner moved so that both its edges move outwards by the margin. `side`: 1 where the ring turns left.
struct Moved {
    at: vec2f,
    is_near: bool,
}

fn move_corner(before: vec2f, corner: vec2f, after: vec2f, side: f32) -> Moved {
    let u = corner - before;
    let v = after - corner;
    let lengths = vec2f(length(u), length(v));
    let along = u / max(lengths.x, 1e-20);
    let onwards = v / max(lengths.y, 1e-20);
    let opening = 1.0 + dot(along, onwards);
    let normals = side * vec2f(along.y + onwards.y, -(along.x + onwards.x));
    let is_near = SHARPEST < opening && 1e-3 < min(lengths.x, lengths.y);
    return Moved(corner + MARGIN * normals / max(opening, SHARPEST), is_near);
}

// A box along the longest of the edges and diagonals, around all four corners.
fn slanted_box(corners: array<vec2f, 4>) -> array<vec2f, 4> {
    var points = corners;
    var longest = vec2f(1e-3, 0.0);
    for (var i = 0u; i < 4u; i++) {
        for (var j = 0u; j < i; j++) {
            let between = points[i] - points[j];
            if dot(longest, longest) < dot(between, between) {
                longest = between;
            }
        }
    }
    let along = normalize(longest);
    let across = vec2f(-along.y, along.x);
    var low = vec2f(0.0);
    var high = vec2f(0.0);
    for (var i = 1u; i < 4u; i++) {
        let from_first = points[i] - points[0];
        let at = vec2f(dot(from_first, along), dot(from_first, across));
        low = min(low, at);
        high = max(high, at);
    }
    low -= MARGIN;
    high += MARGIN;
    let start = points[0];
    return array(
        start + low.x * along + low.y * across,
        start + high.x * along + low.y * across,
        start + high.x * along + high.y * across,
        start + low.x * along + high.y * across,
    );
}

// `covered`: the pixels that the cell may cover, as `bound_cells` packs them. What cannot be projected is drawn as these.
fn outline_of(p: array<vec3f, 4>, covered: vec2u) -> array<vec2f, 4> {
    let z = vec4f(p[0].z, p[1].z, p[2].z, p[3].z);
    if least(z) < cut_before(most(z)) {
        return box_around(covered);
    }
    let corners = array(on_screen(p[0]), on_screen(p[1]), on_screen(p[2]), on_screen(p[3]));
    if !are_within_reach(corners) {
        return box_around(covered);
    }
    let silhouette = silhouette_of(corners[0], corners[1], corners[2], corners[3]);
    let is_triangle = silhouette.is_triangle;
    let ring = ring_of(silhouette, corners);
    // By the whole area: three corners alone may be in one line.
    let area = turn(ring[0], ring[1], ring[2]) + turn(ring[0], ring[2], ring[3]);
    let side = select(-1.0, 1.0, 0.0 < area);
    let last = select(ring[3], ring[2], is_triangle);
    let a = move_corner(last, ring[0], ring[1], side);
    let b = move_corner(ring[0], ring[1], ring[2], side);
    let after = select(ring[3], ring[0], vec2<bool>(is_triangle));
    let c = move_corner(ring[1], ring[2], after, side);
    if !(a.is_near && b.is_near && c.is_near) {
        return slanted_box(corners);
    }
    if is_triangle {
        return array(a.at, b.at, c.at, c.at);
    }
    let d = move_corner(ring[2], ring[3], ring[0], side);
    if !d.is_near {
        return slanted_box(corners);
    }
    return array(a.at, b.at, c.at, d.at);
}
