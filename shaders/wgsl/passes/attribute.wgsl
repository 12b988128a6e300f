// Uses: passes/view. Fills: nothing.
// One further value of the points, about the place that the transfer function counts it from.

struct Placement {
    // Where it is counted from, high and low part.
    offset: vec2f,
    // Its place among the attributes of a point, and how many these are.
    slot: u32,
    stride: u32,
}

@group(1) @binding(1) var<uniform> placement: Placement;
// High and low part.
@group(1) @binding(2) var<storage, read> values: array<vec2f>;
@group(1) @binding(3) var<storage, read_write> attributes: array<f32>;

@compute @workgroup_size(64)
fn place_attribute(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let point = flat_index(id, groups);
    if view.point_count <= point {
        return;
    }
    let value = values[point] - placement.offset;
    attributes[point * placement.stride + placement.slot] = value.x + value.y;
}
