// Uses: passes/digits. Fills: nothing.
// How often each digit occurs in each block.

var<workgroup> found: array<atomic<u32>, DIGITS>;
var<workgroup> items: u32;

@compute @workgroup_size(256)
fn count_digits(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let block = flat_block(group, groups);
    if lane == 0u {
        items = item_count();
    }
    let count = workgroupUniformLoad(&items);
    // Blocks behind the list's end, of which there are many where most cells are left out, only write zeros.
    let parts = select(0u, STEPS, block * ITEMS < count);
    for (var part = 0u; part < parts; part++) {
        let item = item_at(block * ITEMS + part * DIGITS + lane, count);
        if item.is_there {
            atomicAdd(&found[digit_of(item)], 1u);
        }
    }
    workgroupBarrier();
    if block < block_count() {
        digit_counts[row_place(lane, block)] = atomicLoad(&found[lane]);
    }
}
