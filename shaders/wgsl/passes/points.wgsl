// Uses: passes/view. Fills: nothing. Asks for: positions, quantity, seen.
// Points: positions about the view's base, and the stored scalar.

@compute @workgroup_size(64)
fn see_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let point = flat_index(id, groups);
    if view.point_count <= point {
        return;
    }
    // High parts, then low parts.
    let position = position_of(point);
    let high = vec3f(position[0], position[1], position[2]) - view.base_high;
    let low = vec3f(position[3], position[4], position[5]) - view.base_low;
    let p = high + low;
    let scalar = quantity_of(point) - view.scalar_offset;
    put_seen(point, vec4f(dot(p, view.right), dot(p, view.down), dot(p, view.forward), scalar.x + scalar.y));
}
