// Uses: passes/faces. Fills: nothing. Asks for: segment, view, finish, tetrahedra, seen, attributes.
// A segment's values, found from its cell.

fn values_at(points: vec4u, weights: vec4f) -> Values {
    var values = Values();
    let scalars = vec4f(seen_at(points.x).w, seen_at(points.y).w, seen_at(points.z).w, seen_at(points.w).w);
    values[0] = dot(weights, scalars);
    for (var i = 1u; i < VALUE_COUNT; i++) {
        values[i] = attribute_at(points, weights, i - 1u);
    }
    return values;
}

fn attribute_at(points: vec4u, weights: vec4f, slot: u32) -> f32 {
    let values = vec4f(
        attribute_of(points.x, slot),
        attribute_of(points.y, slot),
        attribute_of(points.z, slot),
        attribute_of(points.w, slot),
    );
    return dot(weights, values);
}

// What the ray's way through a cell from entry to exit adds.
fn shade(cell: u32, range: vec2f, ray: Ray) -> Contribution {
    let points = tetrahedron(cell);
    let faces =
        faces_of(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
    return shade_between(faces, points, range, ray);
}

// The same for a cell whose planes are known.
fn shade_between(faces: Faces, points: vec4u, range: vec2f, ray: Ray) -> Contribution {
    let front = weights_at(faces, ray, range.x);
    let back = weights_at(faces, ray, range.y);
    let length = (range.y - range.x) * ray.stretch;
    let found = segment(length, values_at(points, front), values_at(points, back));
    return finish(found, points, 0.5 * (front + back), ray);
}

// Unit direction of the ray, world axes.
fn ray_direction(ray: Ray) -> vec3f {
    return (view.right * ray.slope.x + view.down * ray.slope.y + view.forward) / ray.stretch;
}
