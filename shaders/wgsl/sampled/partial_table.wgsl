// Uses: nothing. Fills: nothing.
// The partial pre-integration table: what depends on the rates a and b at both ends of a piece of linear extinction
// alone. Axes are √r, r = a/(a + b), and u = √T/(1 + √T), T = (a + b)/2; bilinear.
// Twin of `optics::integrators::PartialTable`.

struct PartialTable {
    // Entries a side.
    side: u32,
    // Rows of equal u.
    entries: array<f32>,
}

@group(0) @binding(2) var<storage, read> partial_table: PartialTable;

// Four entries about a place, and its shares between them.
struct PartialPlace {
    first: u32,
    x: f32,
    y: f32,
}

fn partial_place(a: f32, b: f32) -> PartialPlace {
    let whole = min(a + b, 3e38);
    let ratio = select(0.5, a / max(whole, 1.2e-38), 1.2e-38 <= whole);
    let root = sqrt(0.5 * whole);
    let last = f32(partial_table.side - 1u);
    let x = clamp(sqrt(ratio) * last, 0.0, last);
    let y = clamp(root / (1.0 + root) * last, 0.0, last);
    let column = min(u32(x), partial_table.side - 2u);
    let row = min(u32(y), partial_table.side - 2u);
    return PartialPlace(row * partial_table.side + column, x - f32(column), y - f32(row));
}
