// Uses: passes/faces. Fills: nothing. Asks for: segment, view, finish, tetrahedra, seen, attributes.
// A segment's values, found from its cell.

// A value's four corners each.
alias Corners = array<vec4f, VALUE_COUNT>;

fn corners_of_values(points: vec4u) -> Corners {
    var corners = Corners();
    corners[0] = vec4f(seen_at(points.x).w, seen_at(points.y).w, seen_at(points.z).w, seen_at(points.w).w);
    for (var i = 1u; i < VALUE_COUNT; i++) {
        corners[i] = attribute_corners(points, i - 1u);
    }
    return corners;
}

// Counted from one corner: equal corners give their value, not one beside it by what the sum of the weights is rounded.
fn mean(weights: vec4f, corners: vec4f) -> f32 {
    return corners.x + dot(weights.yzw, corners.yzw - corners.x);
}

fn values_at(corners: Corners, weights: vec4f) -> Values {
    var given = corners;
    var values = Values();
    for (var i = 0u; i < VALUE_COUNT; i++) {
        values[i] = mean(weights, given[i]);
    }
    return values;
}

fn attribute_corners(points: vec4u, slot: u32) -> vec4f {
    return vec4f(
        attribute_of(points.x, slot),
        attribute_of(points.y, slot),
        attribute_of(points.z, slot),
        attribute_of(points.w, slot),
    );
}

fn attribute_at(points: vec4u, weights: vec4f, slot: u32) -> f32 {
    return mean(weights, attribute_corners(points, slot));
}

// What the ray's way through a cell from entry to exit adds.
fn shade_between(faces: Faces, corners: Corners, points: vec4u, range: vec2f, ray: Ray) -> Contribution {
    let front = weights_at(faces, ray, range.x);
    let back = weights_at(faces, ray, range.y);
    return shade((range.y - range.x) * ray.stretch, front, back, corners, points, ray);
}

// The same from the length and the barycentric weights of entry and exit.
fn shade(length: f32, front: vec4f, back: vec4f, corners: Corners, points: vec4u, ray: Ray) -> Contribution {
    let found = segment(length, values_at(corners, front), values_at(corners, back));
    return finish(found, points, 0.5 * (front + back), ray);
}

// Unit direction of the ray, world axes.
fn ray_direction(ray: Ray) -> vec3f {
    return (view.right * ray.slope.x + view.down * ray.slope.y + view.forward) / ray.stretch;
}
