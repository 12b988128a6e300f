// Uses: nothing. Fills: nothing. Asks for: numbers, scene.
// The partial pre-integration table: what depends on the rates a and b at both ends of a piece of linear extinction
// alone. Axes are √r, r = a/(a + b), and u = √T/(1 + √T), T = (a + b)/2; bilinear.
// Twin of `optics::integrators::PartialTable`.

// Entries a side.
fn partial_side() -> u32 {
    return u32(number(scene.first_entry));
}

// Rows of equal u.
fn partial_entry(index: u32) -> f32 {
    return number(scene.first_entry + 1u + index);
}

// Four entries about a place, and its shares between them.
struct PartialPlace {
    first: u32,
    x: f32,
    y: f32,
}

fn partial_place(a: f32, b: f32) -> PartialPlace {
    let side = partial_side();
    let whole = min(a + b, 3e38);
    let ratio = select(0.5, a / max(whole, 1.2e-38), 1.2e-38 <= whole);
    let root = sqrt(0.5 * whole);
    let last = f32(side - 1u);
    let x = clamp(sqrt(ratio) * last, 0.0, last);
    let y = clamp(root / (1.0 + root) * last, 0.0, last);
    let column = min(u32(x), side - 2u);
    let row = min(u32(y), side - 2u);
    return PartialPlace(row * side + column, x - f32(column), y - f32(row));
}
