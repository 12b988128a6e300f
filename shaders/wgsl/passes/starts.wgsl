// Uses: passes/view. Fills: nothing.
// Starts: from the number of cells that each tile lists to where its list begins. One workgroup; a block of tiles each.
// The sum of all lists goes to counts[0], the largest number of 32 bits if it leaves them, or stays where an
// earlier sample had more; the longest list likewise to counts[8].

const BLOCKS = 256u;

@group(1) @binding(1) var<storage, read_write> counts: array<u32>;

var<workgroup> sums: array<u32, BLOCKS>;
var<workgroup> wrapped: atomic<u32>;
var<workgroup> longest: atomic<u32>;

@compute @workgroup_size(256)
fn start_lists(@builtin(local_invocation_index) lane: u32) {
    let tiles = view.window.z * view.window.w;
    let length = (tiles + BLOCKS - 1u) / BLOCKS;
    let first = min(lane * length, tiles);
    let last = min(first + length, tiles);
    var sum = 0u;
    for (var tile = first; tile < last; tile++) {
        let next = sum + counts[COUNTED + tile];
        if next < sum {
            atomicStore(&wrapped, 1u);
        }
        atomicMax(&longest, counts[COUNTED + tile]);
        sum = next;
    }
    sums[lane] = sum;
    workgroupBarrier();
    var start = 0u;
    for (var block = 0u; block < lane; block++) {
        let next = start + sums[block];
        if next < start {
            atomicStore(&wrapped, 1u);
        }
        start = next;
    }
    for (var tile = first; tile < last; tile++) {
        let count = counts[COUNTED + tile];
        // From here on: where the next entry of the tile goes.
        counts[COUNTED + tile] = start;
        start += count;
    }
    workgroupBarrier();
    if lane == BLOCKS - 1u {
        counts[8] = max(counts[8], atomicLoad(&longest));
        counts[0] = max(counts[0], select(start, 0xffffffffu, atomicLoad(&wrapped) != 0u));
    }
}
