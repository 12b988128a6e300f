// Uses: passes/view. Fills: nothing.
// Sort: each tile's list by key, then by number of the cell; in place, one workgroup a tile.
//
// A bitonic sort whose every step puts the lesser entry first (the first step of a merge pairs entries mirrored about
// the middle), so that what stands behind the list's end counts as greatest and needs no place. Steps within a block
// run in workgroup memory.

const BLOCK = 512u;
const SORTERS = 128u;

@group(1) @binding(1) var<storage, read> counts: array<u32>;
@group(1) @binding(2) var<storage, read_write> entries: array<vec2u>;

var<workgroup> block: array<vec2u, BLOCK>;

fn is_before(a: vec2u, b: vec2u) -> bool {
    let x = bitcast<f32>(a.y);
    let y = bitcast<f32>(b.y);
    return x < y || (x == y && a.x < b.x);
}

// The two places of pair `index` in a step: mirrored about the middle of `size` places, or `stride` apart.
fn mirrored(index: u32, size: u32) -> vec2u {
    let half = size / 2u;
    let first = (index / half) * size;
    let within = index % half;
    return vec2u(first + within, first + size - 1u - within);
}

fn apart(index: u32, stride: u32) -> vec2u {
    let first = (index / stride) * 2u * stride + index % stride;
    return vec2u(first, first + stride);
}

fn settle_in_block(pair: vec2u, count: u32) {
    if pair.y < count && is_before(block[pair.y], block[pair.x]) {
        let later = block[pair.x];
        block[pair.x] = block[pair.y];
        block[pair.y] = later;
    }
}

fn settle_in_list(start: u32, pair: vec2u, count: u32) {
    if pair.y < count {
        let a = entries[start + pair.x];
        let b = entries[start + pair.y];
        if is_before(b, a) {
            entries[start + pair.x] = b;
            entries[start + pair.y] = a;
        }
    }
}

// Sorts a block, or with `merge` only takes the last log₂ BLOCK steps of a merge.
fn sort_block(start: u32, length: u32, lane: u32, merge: bool) {
    let count = min(length, BLOCK);
    for (var i = lane; i < count; i += SORTERS) {
        block[i] = entries[start + i];
    }
    workgroupBarrier();
    if !merge {
        for (var size = 2u; size <= BLOCK; size *= 2u) {
            for (var i = lane; i < BLOCK / 2u; i += SORTERS) {
                settle_in_block(mirrored(i, size), count);
            }
            workgroupBarrier();
            for (var stride = size / 4u; 0u < stride; stride /= 2u) {
                for (var i = lane; i < BLOCK / 2u; i += SORTERS) {
                    settle_in_block(apart(i, stride), count);
                }
                workgroupBarrier();
            }
        }
    } else {
        for (var stride = BLOCK / 2u; 0u < stride; stride /= 2u) {
            for (var i = lane; i < BLOCK / 2u; i += SORTERS) {
                settle_in_block(apart(i, stride), count);
            }
            workgroupBarrier();
        }
    }
    for (var i = lane; i < count; i += SORTERS) {
        entries[start + i] = block[i];
    }
    storageBarrier();
    workgroupBarrier();
}

@compute @workgroup_size(128)
fn sort_lists(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile = group.y * view.window.z + group.x;
    let start = min(select(counts[COUNTED + tile - 1u], 0u, tile == 0u), view.capacity);
    let count = min(counts[COUNTED + tile], view.capacity) - start;
    for (var first = 0u; first < count; first += BLOCK) {
        sort_block(start + first, count - first, lane, false);
    }
    for (var size = 2u * BLOCK; size < 2u * count && BLOCK < count; size *= 2u) {
        // Pairs whose second place lies behind the end are passed over.
        let pairs = (count + size - 1u) / size * (size / 2u);
        for (var i = lane; i < pairs; i += SORTERS) {
            settle_in_list(start, mirrored(i, size), count);
        }
        storageBarrier();
        workgroupBarrier();
        for (var stride = size / 4u; BLOCK <= stride; stride /= 2u) {
            for (var i = lane; i < pairs; i += SORTERS) {
                settle_in_list(start, apart(i, stride), count);
            }
            storageBarrier();
            workgroupBarrier();
        }
        for (var first = 0u; first < count; first += BLOCK) {
            sort_block(start + first, count - first, lane, true);
        }
    }
}
