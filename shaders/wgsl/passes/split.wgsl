// Uses: compositor/corner, compositor/silhouette, passes/view. Fills: nothing. Asks for: tetrahedra, seen, bounds.
// Cells into triangles: three or four round the thick vertex (Shirley and Tuchman 1990), for a run of the sorted list.
//
// Between the corners of such a triangle the front of a cell is one plane, and its back another. A point of a plane has
// barycentric weights w and a depth d; w / d is linear on the screen under perspective, and w under parallel rays. So a
// corner holds V = q w for the front and the back, where q = d₀ / d or 1 (d₀: the farthest depth of the cell), and
// Δ = (z_b − z_f) q_f q_b, which is linear, too: d₀ (q_f − q_b), or the thickness. V and Δ are what the hardware
// interpolates; the sum of V is q.

struct Run {
    // The run's first cell in the list, and how many cells a run has.
    first: u32,
    length: u32,
    padding: vec2u,
}

@group(1) @binding(1) var<uniform> split_run: Run;
@group(1) @binding(2) var<storage, read> sorted: array<vec2u>;
// The number of sorted cells stands behind one number a digit.
@group(1) @binding(3) var<storage, read> digit_counts: array<u32>;
@group(1) @binding(4) var<storage, read_write> split: array<SplitCorner>;

const TOTAL = 256u;

// Weights times q, and the place on the screen.
struct ThickVertex {
    front: vec4f,
    back: vec4f,
    at: vec2f,
}

// One corner alone, times its q.
fn only(corner: u32, q: vec4f) -> vec4f {
    return select(vec4f(0.0), q, vec4<bool>(corner == 0u, corner == 1u, corner == 2u, corner == 3u));
}

// Where two edges cross: a share of the first edge's length, or 0 where they have one direction.
fn crossing_share(a: vec2f, b: vec2f, c: vec2f, d: vec2f) -> f32 {
    let along = turn(c, d, a);
    let whole = along - turn(c, d, b);
    return clamp(along / select(whole, 1.0, whole == 0.0), 0.0, 1.0);
}

// The thick vertex, its front and its back not told apart yet.
fn thick_vertex(silhouette: Silhouette, places: array<vec2f, 4>, q: vec4f) -> ThickVertex {
    var corners = places;
    let i = silhouette.corners;
    let a = corners[i.x];
    let b = corners[i.y];
    let c = corners[i.z];
    let d = corners[i.w];
    if silhouette.is_triangle {
        let parts = vec3f(turn(b, c, d), turn(c, a, d), turn(a, b, d)) / select(turn(a, b, c), 1.0, turn(a, b, c) == 0.0);
        var shares = max(parts, vec3f(0.0));
        shares /= max(shares.x + shares.y + shares.z, 1e-30);
        return ThickVertex(
            shares.x * only(i.x, q) + shares.y * only(i.y, q) + shares.z * only(i.z, q),
            only(i.w, q),
            d,
        );
    }
    let t = crossing_share(a, c, b, d);
    let u = crossing_share(b, d, a, c);
    return ThickVertex(
        mix(only(i.x, q), only(i.z, q), t),
        mix(only(i.y, q), only(i.w, q), u),
        mix(a, c, t),
    );
}

fn put_fan(index: u32, cell: u32, middle: SplitCorner, ring: array<vec2f, 4>, corners: vec4u, q: vec4f) {
    var around = ring;
    split[5u * index] = middle;
    for (var k = 0u; k < 4u; k++) {
        let own = only(corners[k], q);
        split[5u * index + 1u + k] = SplitCorner(own, own, around[k], min(middle.thickness, 0.0), cell);
    }
}

// What is to be drawn by its planes: its fan is the box of pixels that it may cover.
fn put_whole(index: u32, cell: u32) {
    let around = box_around(bounds_of(cell));
    let middle = SplitCorner(vec4f(0.0), vec4f(0.0), 0.5 * (around[0] + around[2]), WHOLE, cell);
    put_fan(index, cell, middle, around, vec4u(0u), vec4f(0.0));
}

@compute @workgroup_size(64)
fn split_cells(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = flat_index(id, groups);
    let place = split_run.first + index;
    if split_run.length <= index || digit_counts[TOTAL] <= place {
        return;
    }
    let cell = sorted[place].x;
    let points = tetrahedron(cell);
    let p = array(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
    let z = vec4f(p[0].z, p[1].z, p[2].z, p[3].z);
    if least(z) < max(cut_before(most(z)), view.near) {
        put_whole(index, cell);
        return;
    }
    let places = array(on_screen(p[0]), on_screen(p[1]), on_screen(p[2]), on_screen(p[3]));
    if !are_within_reach(places) {
        put_whole(index, cell);
        return;
    }
    let silhouette = silhouette_of(places[0], places[1], places[2], places[3]);
    let depths = z + view.distance;
    let q = select(vec4f(1.0), most(depths) / depths, vec4<bool>(0.0 < view.perspective));
    var thick = thick_vertex(silhouette, places, q);
    let sums = vec2f(dot(thick.front, vec4f(1.0)), dot(thick.back, vec4f(1.0)));
    let between = dot(thick.back, z) / sums.y - dot(thick.front, z) / sums.x;
    if between < 0.0 {
        thick = ThickVertex(thick.back, thick.front, thick.at);
    }
    let thickness = abs(between) * sums.x * sums.y;
    let middle = SplitCorner(thick.front, thick.back, thick.at, thickness, cell);
    let i = silhouette.corners;
    let last = select(i.w, i.z, silhouette.is_triangle);
    put_fan(index, cell, middle, ring_of(silhouette, places), vec4u(i.xyz, last), q);
}
