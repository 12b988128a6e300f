// Uses: compositing. Fills: cutting.
// Segments as their cells have them: rays meet nothing but cells.

// Vectors of a pixel's state.
const STATE_VECTORS = 2u;

struct Cursor {
    none: u32,
}

fn cursor_of(pixel: vec2u) -> Cursor {
    return Cursor(0u);
}

fn keep_cursor(pixel: vec2u, cursor: Cursor) {
}

fn composite_cell(sum: Composite, cell: u32, range: vec2f, ray: Ray, cursor: ptr<function, Cursor>) -> Composite {
    let found = shade_again(cell, range, ray);
    return composite_add(sum, found.color, found.opacity);
}

fn composite_rest(sum: Composite, cursor: Cursor) -> Composite {
    return sum;
}
