// Uses: passes/view. Fills: nothing. Asks for: tetrahedra, seen, bounds.
// Lists: each cell's number into the lists of its tiles, with what the list is sorted by.

@group(1) @binding(1) var<storage, read_write> listed: array<atomic<u32>>;
// Number of the cell, and the bits of its key.
@group(1) @binding(2) var<storage, read_write> entries: array<vec2u>;

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

@compute @workgroup_size(64)
fn fill_lists(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let cell = flat_index(id, groups);
    if view.cell_count <= cell {
        return;
    }
    let box = bounds_of(cell);
    if box.y == 0u {
        return;
    }
    let start = vec2u(box.x & 0xffffu, box.x >> 16u);
    let end = vec2u(box.y & 0xffffu, box.y >> 16u);
    let first = start / TILE - view.window.xy;
    let last = (end - 1u) / TILE - view.window.xy;
    let entry = vec2u(cell, bitcast<u32>(sort_key(cell)));
    for (var row = first.y; row <= last.y; row++) {
        for (var column = first.x; column <= last.x; column++) {
            let place = atomicAdd(&listed[row * view.window.z + column], 1u);
            if place < view.capacity {
                entries[place] = entry;
            }
        }
    }
}
