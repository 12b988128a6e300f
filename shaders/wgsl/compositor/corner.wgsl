// Uses: nothing. Fills: nothing.
// A corner of the triangles that a cell is split into, as `split_cells` writes it and the hardware interpolates it.

struct SplitCorner {
    // Barycentric weights of the point on the cell's front, and on its back, each times q.
    front: vec4f,
    back: vec4f,
    // On the screen.
    at: vec2f,
    // Depth between the two, times both q; below 0 for what is drawn by its planes.
    thickness: f32,
    cell: u32,
}

// The thickness of what is drawn by its planes.
const WHOLE = -1.0;
