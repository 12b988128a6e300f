// Uses: passes/view. Fills: nothing. Asks for: quantity, attributes.
// One further value of the points, about the place that the transfer function counts it from.

struct Placement {
    // Where it is counted from, high and low part.
    offset: vec2f,
    // Its place among the attributes of a point.
    slot: u32,
    padding: u32,
}

// Attributes of a point.
override ATTRIBUTE_STRIDE: u32 = 1u;

@group(1) @binding(1) var<uniform> placement: Placement;

@compute @workgroup_size(64)
fn place_attribute(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let point = flat_index(id, groups);
    if view.point_count <= point {
        return;
    }
    let value = quantity_of(point) - placement.offset;
    put_attribute(point, placement.slot, value.x + value.y);
}
