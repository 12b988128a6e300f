// Uses: compositor/tiles_in_turn. Fills: gathering.
// Tiles in the order of their lists: an approximation, whatever the lists are sorted by. Pixels that meet a segment
// that begins before one already composited are counted.

// The farthest entry so far; 1 once a segment began before it.
const KEPT_AT_FIRST = vec2f(-FAR, 0.0);

fn gather(so_far: Gathered, found: Contribution, entry: f32) -> Gathered {
    let disordered = select(so_far.kept.y, 1.0, entry < so_far.kept.x);
    return Gathered(
        composite_add(so_far.sum, found.color, found.opacity),
        vec2f(max(so_far.kept.x, entry), disordered),
    );
}

fn is_opaque(gathered: Gathered) -> bool {
    return gathered.sum.transparency < OPAQUE;
}

fn put_gathered(pixel: vec2u, gathered: Gathered) {
    put(pixel, gathered.sum.color, composite_opacity(gathered.sum));
    atomicAdd(&counts[5], u32(gathered.kept.y));
}
