// Uses: passes/view. Fills: nothing.
// A tetrahedron as four half-spaces, and where a ray crosses it.
//
// Corners come in ascending order of their numbers, so that both cells of a face find its plane by the same sums. A ray
// leaves one cell where it enters the next, whatever was rounded, and no edge is looked at: near one, chords shrink to
// nothing before a rounding could tell one cell from the other.

struct Faces {
    // Corner 0, on the faces opposite corners 1, 2, 3; corner 1, on the face opposite corner 0.
    first: vec3f,
    second: vec3f,
    // Inward normals of the faces opposite corners 0 to 3; their length is twice the area.
    normals: array<vec3f, 4>,
    // Six times the volume.
    determinant: f32,
    // Depths of the nearest and the farthest corner.
    depths: vec2f,
}

struct Ray {
    origin: vec2f,
    slope: vec2f,
    // Distance per depth.
    stretch: f32,
}

// Twice the area of a triangle as a vector along its normal. The sum of products tilts the normal of a thin triangle along its longest
// edge, where a small tilt moves the plane far away from the other end: that part is taken off. Tilts about that edge are no
// larger than those by the rounding of the corners.
fn area_of(a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let u = b - a;
    let v = c - a;
    let w = c - b;
    let area = cross(u, v);
    var longest = select(v, u, dot(v, v) < dot(u, u));
    longest = select(w, longest, dot(w, w) < dot(longest, longest));
    return area - longest * (dot(area, longest) / dot(longest, longest));
}

fn faces_of(a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> Faces {
    let n1 = area_of(a, c, d);
    let determinant = dot(b - a, n1);
    let side = select(-1.0, 1.0, 0.0 < determinant);
    let normals = array(-side * area_of(b, c, d), side * n1, -side * area_of(a, b, d), side * area_of(a, b, c));
    let depths = vec2f(min(min(a.z, b.z), min(c.z, d.z)), max(max(a.z, b.z), max(c.z, d.z)));
    return Faces(a, b, normals, abs(determinant), depths);
}

// The ray through the middle (or the sample) of a pixel.
fn ray_through(pixel: vec2u) -> Ray {
    let across = (vec2f(pixel) - view.axis) * view.pixel;
    let slope = across * view.perspective;
    let origin = select(across, across * view.distance, 0.0 < view.perspective);
    return Ray(origin, slope, sqrt(1.0 + dot(slope, slope)));
}

// At z = 0: the plane's distance from the ray's point at the corner's depth, and its change with z; times the area.
fn against(normal: vec3f, corner: vec3f, ray: Ray) -> vec2f {
    let offset = ray.origin + ray.slope * corner.z - corner.xy;
    return vec2f(dot(normal.xy, offset), dot(normal.xy, ray.slope) + normal.z);
}

// The range [enter, leave] of z, narrowed by one half-space; empty where leave ≤ enter.
//
// A ray within the plane goes to the cell that would hold it if it were moved by (ε, ε²): to one of two, and around an
// edge seen as a point to one of all.
fn narrowed(range: vec2f, normal: vec3f, corner: vec3f, ray: Ray) -> vec2f {
    let plane = against(normal, corner, ray);
    if plane.y == 0.0 {
        let tie = select(normal.x, normal.y, normal.x == 0.0);
        let inside = 0.0 < select(plane.x, tie, plane.x == 0.0);
        return select(vec2f(FAR, -FAR), range, inside);
    }
    let z = corner.z - plane.x / plane.y;
    return select(vec2f(range.x, min(range.y, z)), vec2f(max(range.x, z), range.y), 0.0 < plane.y);
}

// Entry and exit of the pixel's ray; exit ≤ entry where it misses the cell.
fn cross_faces(faces: Faces, ray: Ray) -> vec2f {
    var range = vec2f(max(faces.depths.x, view.near), faces.depths.y);
    range = narrowed(range, faces.normals[0], faces.second, ray);
    range = narrowed(range, faces.normals[1], faces.first, ray);
    range = narrowed(range, faces.normals[2], faces.first, ray);
    return narrowed(range, faces.normals[3], faces.first, ray);
}

fn share_at(normal: vec3f, corner: vec3f, ray: Ray, z: f32) -> f32 {
    let plane = against(normal, corner, ray);
    return plane.x + (z - corner.z) * plane.y;
}

// Barycentric coordinates of the ray's point at z; for flat cells whatever rounding leaves, but always a mean.
fn weights_at(faces: Faces, ray: Ray, z: f32) -> vec4f {
    var weights = vec4f(
        share_at(faces.normals[0], faces.second, ray, z),
        share_at(faces.normals[1], faces.first, ray, z),
        share_at(faces.normals[2], faces.first, ray, z),
        share_at(faces.normals[3], faces.first, ray, z),
    );
    weights = clamp(weights / faces.determinant, vec4f(0.0), vec4f(1.0));
    let sum = dot(weights, vec4f(1.0));
    return select(vec4f(0.25), weights / sum, 0.0 < sum);
}
