// Uses: nothing. Fills: nothing. Asks for: numbers, scene.
// The mean extinction ρ̄ along a path from s_f to s_b, times the longest segment, by the nodes at both ends; and how
// values and lengths lie in the table.

// Nodes a side.
fn table_side() -> u32 {
    return u32(number(scene.first_entry));
}

// Tiles less 1; 0 without any.
fn last_tile() -> u32 {
    return u32(number(scene.first_entry + 1u));
}

// Longest segments a scene length.
fn longest_per_length() -> f32 {
    return number(scene.first_entry + 4u);
}

// Where s lies, in steps from the first node.
fn node_place(s: f32) -> f32 {
    // Where the first node is stored, and nodes a stored unit.
    let start = number(scene.first_entry + 2u);
    let per_value = number(scene.first_entry + 3u);
    return clamp((s - start) * per_value, 0.0, f32(table_side() - 1u));
}

fn mean_extinction(front: f32, back: f32) -> f32 {
    let side = table_side();
    let i = min(u32(front), side - 2u);
    let j = min(u32(back), side - 2u);
    let u = front - f32(i);
    let v = back - f32(j);
    // Rows of equal s_f.
    let at = scene.first_entry + 5u + i * side + j;
    let low = mix(number(at), number(at + 1u), v);
    let high = mix(number(at + side), number(at + side + 1u), v);
    return mix(low, high, u);
}
