// Uses: passes/view. Fills: nothing. Asks for: tetrahedra, seen.
// What cells are sorted by.

fn sort_key(cell: u32) -> f32 {
    let corners = tetrahedron(cell);
    let a = seen_at(corners.x).xyz;
    let b = seen_at(corners.y).xyz;
    let c = seen_at(corners.z).xyz;
    let d = seen_at(corners.w).xyz;
    if view.sort_key == 0u {
        return min(min(a.z, b.z), min(c.z, d.z));
    }
    let centroid = 0.25 * ((a + b) + (c + d));
    if view.sort_key == 2u {
        return 0.0;
    }
    return select(centroid.z, length(centroid + vec3f(0.0, 0.0, view.distance)), 0.0 < view.perspective);
}
