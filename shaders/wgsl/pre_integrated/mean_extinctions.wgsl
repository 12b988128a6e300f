// Uses: nothing. Fills: nothing.
// The mean extinction ρ̄ along a path from s_f to s_b, times the longest segment, by the nodes at both ends; and how
// values and lengths lie in the table.

struct MeanExtinctions {
    // Nodes a side.
    side: u32,
    // Tiles less 1; 0 without any.
    last_tile: u32,
    // Where the first node is stored.
    start: f32,
    // Nodes a stored unit.
    per_value: f32,
    // Longest segments a scene length.
    per_length: f32,
    // Rows of equal s_f.
    entries: array<f32>,
}

@group(0) @binding(3) var<storage, read> mean_extinctions: MeanExtinctions;

// Where s lies, in steps from the first node.
fn node_place(s: f32) -> f32 {
    return clamp((s - mean_extinctions.start) * mean_extinctions.per_value, 0.0, f32(mean_extinctions.side - 1u));
}

fn mean_extinction(front: f32, back: f32) -> f32 {
    let side = mean_extinctions.side;
    let i = min(u32(front), side - 2u);
    let j = min(u32(back), side - 2u);
    let u = front - f32(i);
    let v = back - f32(j);
    let at = i * side + j;
    let low = mix(mean_extinctions.entries[at], mean_extinctions.entries[at + 1u], v);
    let high = mix(mean_extinctions.entries[at + side], mean_extinctions.entries[at + side + 1u], v);
    return mix(low, high, u);
}
