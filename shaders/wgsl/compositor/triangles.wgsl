// Uses: compositor/blended, compositor/corner, compositor/shade, passes/faces. Fills: nothing. Asks for: segment, view, finish, tetrahedra, seen, attributes, bounds.
// Triangles: each cell's three or four triangles round its thick vertex, farthest cell first, and the hardware blends what
// their pixels find. Entry, exit and values come from what the hardware interpolates between the corners, in perspective
// (Kraus, Qiao and Ebert 2004). It moves corners to a raster of a sixteenth to a 256th of a pixel, so all of these are a
// little off, the more the steeper a face is: `raster` finds them from the planes.
//
// A cell that reaches before the near plane or the eye has no projection. It is drawn as `raster` draws it, by its planes.

@group(1) @binding(1) var<storage, read> split_corners: array<SplitCorner>;

// Linear on the screen: all have w = 1.
struct Interpolated {
    @builtin(position) position: vec4f,
    @location(0) front: vec4f,
    @location(1) back: vec4f,
    @location(2) thickness: f32,
    @location(3) @interpolate(flat) points: vec4u,
}

// Five vertices a cell: the thick one, then those around the silhouette.
@vertex
fn place_corner(@builtin(vertex_index) index: u32) -> Interpolated {
    let corner = split_corners[index];
    let points = tetrahedron(corner.cell);
    return Interpolated(place_in_window(corner.at), corner.front, corner.back, corner.thickness, points);
}

// Barycentric weights from what was interpolated; rounding leaves none below 0.
fn weights_of(interpolated: vec4f) -> vec4f {
    let positive = max(interpolated, vec4f(0.0));
    return positive / max(dot(positive, vec4f(1.0)), 1e-30);
}

// The way through a cell: its length, and the weights of entry and exit.
struct Way {
    length: f32,
    front: vec4f,
    back: vec4f,
}

fn way_by_planes(points: vec4u, ray: Ray) -> Way {
    let faces = faces_of(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
    let range = cross_faces(faces, ray);
    return Way((range.y - range.x) * ray.stretch, weights_at(faces, ray, range.x), weights_at(faces, ray, range.y));
}

fn way_by_corners(found: Interpolated, ray: Ray) -> Way {
    let q = vec2f(dot(found.front, vec4f(1.0)), dot(found.back, vec4f(1.0)));
    return Way(found.thickness / (q.x * q.y) * ray.stretch, weights_of(found.front), weights_of(found.back));
}

@fragment
fn blend_triangle(found: Interpolated) -> @location(0) vec4f {
    let ray = ray_through(vec2u(found.position.xy) + view.window.xy * TILE);
    let points = found.points;
    var way = Way();
    if found.thickness < 0.0 {
        way = way_by_planes(points, ray);
    } else {
        way = way_by_corners(found, ray);
    }
    if !(0.0 < way.length) {
        discard;
    }
    // In one place: drivers write out a function wherever it is called, and what shades is long.
    return blended_of(shade(way.length, way.front, way.back, corners_of_values(points), points, ray));
}
