// Uses: compositor/pixels. Fills: nothing. Asks for: blending.
// What the hardware blended, as the picture.

// What was blended, one sample a pixel of the window.
@group(1) @binding(2) var blended: texture_2d<f32>;
@group(1) @binding(3) var<storage, read_write> picture: array<vec4u>;

// Adds what was blended to the picture.
@compute @workgroup_size(8, 8)
fn take_blended(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_id) within: vec3u) {
    let at = tile.xy * TILE + within.xy;
    let pixel = view.window.xy * TILE + at;
    if is_in_picture(pixel) {
        let found = pixel_of(textureLoad(blended, at, 0));
        put(pixel, found.rgb, found.a);
    }
}

// Where the hardware draws a place in pixel coordinates: its pixels have their middles at halves.
fn place_in_window(at: vec2f) -> vec4f {
    let share = (at + 0.5 - vec2f(view.window.xy * TILE)) / vec2f(view.window.zw * TILE);
    return vec4f(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0);
}
