// Uses: passes/view. Fills: nothing.
// Runs: what each indirect draw of the sorted list takes.

// Of one indexed draw: indices, instances, first index, base vertex, first instance.
@group(1) @binding(1) var<storage, read_write> draws: array<u32>;
// The number of sorted cells stands behind one number a digit.
@group(1) @binding(2) var<storage, read> digit_counts: array<u32>;

// Cells of a run.
override run_length: u32 = 65536u;
// Indices that a cell draws, and vertices between one cell of the list and the next; 0 where each run has its own.
override cell_indices: u32 = 6u;
override cell_vertices: u32 = 4u;

const TOTAL = 256u;

@compute @workgroup_size(64)
fn aim_runs(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = flat_index(id, groups);
    let at = 5u * run;
    if arrayLength(&draws) < at + 5u {
        return;
    }
    let first = run * run_length;
    let count = digit_counts[TOTAL];
    let cells = select(0u, min(count - first, run_length), first < count);
    draws[at] = cell_indices * cells;
    draws[at + 1u] = 1u;
    draws[at + 2u] = 0u;
    draws[at + 3u] = cell_vertices * first;
    draws[at + 4u] = 0u;
}
