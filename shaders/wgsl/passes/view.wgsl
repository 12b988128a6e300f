// Uses: nothing. Fills: view.
// What changes from frame to frame in the passes over cells and pixels. Its layout is that of `passes.rs`, which a test
// checks.
//
// Positions are taken about a base on the view axis, in camera axes (right, down, forward) and scene lengths, so that
// what is seen stands near 0: the ray through a pixel is x = origin + slope z, and the eye stands at z = −distance.

struct View {
    // Camera axes in world axes, unit vectors.
    right: vec3f,
    // Depth of the base from the eye.
    distance: f32,
    down: vec3f,
    // Slope of a ray one pixel off the axis (perspective), or a pixel's side.
    pixel: f32,
    forward: vec3f,
    // z in front of which nothing is seen.
    near: f32,
    // The base from the middle of the grid, high and low part.
    base_high: vec3f,
    // 1, or 0 for parallel rays.
    perspective: f32,
    base_low: vec3f,
    // What a sample counts in its pixel.
    weight: f32,
    // Pixel coordinates of the view axis.
    axis: vec2f,
    // The picture, in pixels.
    size: vec2u,
    // The window that is drawn, in tiles: first column and row, columns and rows.
    window: vec4u,
    point_count: u32,
    cell_count: u32,
    // Entries that the lists of tiles have room for.
    capacity: u32,
    // What lists are sorted by: 0 nearest depth, 1 distance of the centroid, 2 number of the cell.
    sort_key: u32,
    // Where the stored scalar is counted from, high and low part.
    scalar_offset: vec2f,
    widget_count: u32,
    // 1 for the first sample of a pixel.
    is_first: u32,
    // Work that a tile does before it stops, for the next dispatch to go on.
    budget: u32,
    // 1 where a dispatch goes on.
    goes_on: u32,
    padding: vec2u,
}

// Side of a tile, in pixels.
const TILE = 8u;
// Invocations of a workgroup.
const THREADS = 64u;
// Numbers that the passes count; behind them `counts` holds one a tile: how many cells the tile lists, then where its next
// entry goes, and so at last where its list ends and the next tile's begins.
const COUNTED = 16u;
// Beyond every depth.
const FAR = 3e38;

@group(1) @binding(0) var<uniform> view: View;

// Number of this invocation among those of a dispatch that may be folded into rows.
fn flat_index(id: vec3u, groups: vec3u) -> u32 {
    return id.x + id.y * groups.x * THREADS;
}
