// Uses: passes/view. Fills: nothing.
// The pixels of a window, row by row: colour and opacity as bits. What uses this binds `picture`.

fn is_in_picture(pixel: vec2u) -> bool {
    return all(pixel < view.size);
}

// The pixel's place in the window.
fn place_of(pixel: vec2u) -> u32 {
    let at = pixel - view.window.xy * TILE;
    return at.y * view.window.z * TILE + at.x;
}

// Adds a sample to its pixel.
fn put(pixel: vec2u, color: vec3f, opacity: f32) {
    let place = place_of(pixel);
    let sample = view.weight * vec4f(color, opacity);
    let before = select(bitcast<vec4f>(picture[place]), vec4f(0.0), view.is_first == 1u);
    picture[place] = bitcast<vec4u>(before + sample);
}
