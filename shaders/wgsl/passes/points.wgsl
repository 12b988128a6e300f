// Uses: passes/view. Fills: nothing.
// Points: positions about the view's base, and the stored scalar.

// Six numbers a point: the position from the middle of the grid in scene lengths, high parts, then low parts.
@group(1) @binding(1) var<storage, read> positions: array<f32>;
// High and low part of the scalar.
@group(1) @binding(2) var<storage, read> scalars: array<vec2f>;
@group(1) @binding(3) var<storage, read_write> seen: array<vec4f>;

@compute @workgroup_size(64)
fn see_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let point = flat_index(id, groups);
    if view.point_count <= point {
        return;
    }
    let at = 6u * point;
    let high = vec3f(positions[at], positions[at + 1u], positions[at + 2u]) - view.base_high;
    let low = vec3f(positions[at + 3u], positions[at + 4u], positions[at + 5u]) - view.base_low;
    let p = high + low;
    let scalar = scalars[point] - view.scalar_offset;
    seen[point] = vec4f(dot(p, view.right), dot(p, view.down), dot(p, view.forward), scalar.x + scalar.y);
}
