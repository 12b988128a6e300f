// Uses: compositor/blended, compositor/outline, compositor/shade, passes/faces. Fills: nothing. Asks for: segment, view, finish, tetrahedra, seen, attributes, bounds.
// Raster: each cell's silhouette is drawn, farthest first, and the hardware blends what its pixels find. A pixel finds
// its ray's entry and exit from the cell's four planes by the same sums as the tiles do, so that cells meet without
// gap or overlap whatever the hardware made of their outlines; what it drew beyond the cell is thrown away.

// Number of the cell, and its key.
@group(1) @binding(1) var<storage, read> sorted: array<vec2u>;

// A corner of the outline with the cell's planes, found once for all its pixels.
struct Corner {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) points: vec4u,
    // Nearest corner and nearest depth, next corner and farthest depth, normals, the first with six times the volume, the second with the
    // nearest corner's number.
    @location(1) @interpolate(flat) nearest: vec4f,
    @location(2) @interpolate(flat) next: vec4f,
    @location(3) @interpolate(flat) normal_0: vec4f,
    @location(4) @interpolate(flat) normal_1: vec4f,
    @location(5) @interpolate(flat) normal_2: vec3f,
    @location(6) @interpolate(flat) normal_3: vec3f,
}

// Four vertices a cell, around its outline.
@vertex
fn outline_cell(@builtin(vertex_index) index: u32) -> Corner {
    let cell = sorted[index / 4u].x;
    let points = tetrahedron(cell);
    let corners =
        array(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
    var outline = outline_of(corners, bounds_of(cell));
    let faces = faces_of(corners[0], corners[1], corners[2], corners[3]);
    return Corner(
        place_in_window(outline[index % 4u]),
        points,
        vec4f(faces.nearest, faces.depths.x),
        vec4f(faces.next, faces.depths.y),
        vec4f(faces.normals[0], faces.determinant),
        vec4f(faces.normals[1], f32(faces.nearest_number)),
        faces.normals[2],
        faces.normals[3],
    );
}

fn faces_behind(corner: Corner) -> Faces {
    return Faces(
        corner.nearest.xyz,
        corner.next.xyz,
        u32(corner.normal_1.w),
        array(corner.normal_0.xyz, corner.normal_1.xyz, corner.normal_2, corner.normal_3),
        corner.normal_0.w,
        vec2f(corner.nearest.w, corner.next.w),
    );
}

@fragment
fn blend_cell(corner: Corner) -> @location(0) vec4f {
    let ray = ray_through(vec2u(corner.position.xy) + view.window.xy * TILE);
    let faces = faces_behind(corner);
    let range = cross_faces(faces, ray);
    if !(range.x < range.y) {
        discard;
    }
    let corners = corners_of_values(corner.points);
    return blended_of(shade_between(faces, corners, corner.points, range, ray));
}
