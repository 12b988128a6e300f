// Uses: passes/digit_sums, passes/digits. Fills: nothing.
// Each digit's numbers of the blocks into sums of the blocks before, and their whole sum. One workgroup a digit.

@compute @workgroup_size(256)
fn place_digits(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let blocks = block_count();
    var before = 0u;
    for (var first = 0u; first < blocks; first += DIGITS) {
        let block = first + lane;
        var value = 0u;
        if block < blocks {
            value = digit_counts[row_place(group.x, block)];
        }
        let through = sum_through(value, lane);
        if block < blocks {
            digit_counts[row_place(group.x, block)] = before + through - value;
        }
        before += sums[DIGITS - 1u];
        workgroupBarrier();
    }
    if lane == 0u {
        digit_counts[group.x] = before;
    }
}
