// Uses: compositor/outline, compositor/pixels, compositor/shade, passes/faces. Fills: nothing. Asks for: segment, view, finish, tetrahedra, seen, attributes, bounds.
// Raster: each cell's silhouette is drawn, farthest first, and the hardware blends what its pixels find. A pixel finds
// its ray's entry and exit from the cell's four planes by the same sums as the tiles do, so that cells meet without
// gap or overlap whatever the hardware made of their outlines; what it drew beyond the cell is thrown away.

// Number of the cell, and its key.
@group(1) @binding(1) var<storage, read> sorted: array<vec2u>;
// What was blended, one sample a pixel of the window.
@group(1) @binding(2) var blended: texture_2d<f32>;
@group(1) @binding(3) var<storage, read_write> picture: array<vec4f>;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) cell: u32,
}

// Four vertices a cell, around its outline.
@vertex
fn outline_cell(@builtin(vertex_index) index: u32) -> Corner {
    let cell = sorted[index / 4u].x;
    let points = tetrahedron(cell);
    let corners =
        array(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
    var outline = outline_of(corners, bounds_of(cell));
    // The hardware's pixels have their middles at halves.
    let at = outline[index % 4u] + 0.5 - vec2f(view.window.xy * TILE);
    let share = at / vec2f(view.window.zw * TILE);
    return Corner(vec4f(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0), cell);
}

// Entry and exit of the pixel's ray; exit ≤ entry where it misses the cell.
fn cross_cell(cell: u32, ray: Ray) -> vec2f {
    let points = tetrahedron(cell);
    let faces =
        faces_of(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
    var range = vec2f(max(faces.depths.x, view.near), faces.depths.y);
    range = narrowed(range, faces.normals[0], faces.second, ray);
    range = narrowed(range, faces.normals[1], faces.first, ray);
    range = narrowed(range, faces.normals[2], faces.first, ray);
    return narrowed(range, faces.normals[3], faces.first, ray);
}

@fragment
fn blend_cell(corner: Corner) -> @location(0) vec4f {
    let ray = ray_through(vec2u(corner.position.xy) + view.window.xy * TILE);
    let range = cross_cell(corner.cell, ray);
    if !(range.x < range.y) {
        discard;
    }
    return blended_of(shade(corner.cell, range, ray));
}

// Adds what was blended to the picture.
@compute @workgroup_size(8, 8)
fn take_blended(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_id) within: vec3u) {
    let at = tile.xy * TILE + within.xy;
    let pixel = view.window.xy * TILE + at;
    if is_in_picture(pixel) {
        let found = pixel_of(textureLoad(blended, at, 0));
        put(pixel, found.rgb, found.a);
    }
}
