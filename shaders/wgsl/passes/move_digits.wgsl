// Uses: passes/digit_sums, passes/digits. Fills: nothing.
// Items to their places by digit. Of one digit they keep their order: a lane finds its place among those of a step by
// the bits of the lanes before it that have the same digit.

@group(1) @binding(4) var<storage, read_write> sorted: array<vec2u>;

// Words of 32 lanes.
const WORDS = DIGITS / 32u;

var<workgroup> places: array<u32, DIGITS>;
var<workgroup> lanes: array<atomic<u32>, DIGITS * WORDS>;
var<workgroup> items: u32;

@compute @workgroup_size(256)
fn move_digits(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let block = flat_block(group, groups);
    if lane == 0u {
        items = item_count();
    }
    let count = workgroupUniformLoad(&items);
    if count <= block * ITEMS {
        return;
    }
    // Where the block's items of each digit go: behind all lower digits, and behind the digit's in the blocks before.
    let own = digit_counts[lane];
    let through = sum_through(own, lane);
    let total = sums[DIGITS - 1u];
    places[lane] = through - own + digit_counts[row_place(lane, block)];
    workgroupBarrier();
    for (var part = 0u; part < STEPS; part++) {
        let item = item_at(block * ITEMS + part * DIGITS + lane, count);
        let digit = digit_of(item);
        if item.is_there {
            atomicOr(&lanes[digit * WORDS + lane / 32u], 1u << (lane % 32u));
        }
        workgroupBarrier();
        if item.is_there {
            var place = places[digit];
            for (var word = 0u; word < lane / 32u; word++) {
                place += countOneBits(atomicLoad(&lanes[digit * WORDS + word]));
            }
            let own_word = atomicLoad(&lanes[digit * WORDS + lane / 32u]);
            place += countOneBits(own_word & ((1u << (lane % 32u)) - 1u));
            if place < sort_round.capacity {
                sorted[place] = item.entry;
            }
        }
        workgroupBarrier();
        // Each lane for one digit: what was moved stands before the next step's, and the bits are cleared.
        for (var word = 0u; word < WORDS; word++) {
            let at = lane * WORDS + word;
            places[lane] += countOneBits(atomicExchange(&lanes[at], 0u));
        }
        workgroupBarrier();
    }
    // The first round leaves out cells: from here on there are so many items.
    if sort_round.from_cells == 1u && block == 0u && lane == 0u {
        digit_counts[TOTAL] = total;
    }
}
