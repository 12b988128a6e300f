// Uses: passes/key, passes/view. Fills: nothing. Asks for: tetrahedra, seen, bounds.
// Lists: each cell's number into the lists of its tiles, with what the list is sorted by.

@group(1) @binding(1) var<storage, read_write> counts: array<atomic<u32>>;
// Number of the cell, and the bits of its key.
@group(1) @binding(2) var<storage, read_write> entries: array<vec2u>;

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
            let place = atomicAdd(&counts[COUNTED + row * view.window.z + column], 1u);
            if place < view.capacity {
                entries[place] = entry;
            }
        }
    }
}
