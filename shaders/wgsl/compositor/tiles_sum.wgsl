// Uses: compositor/tiles_in_turn, elementary/one_minus_exp. Fills: gathering.
// Tiles of one colour: C = c A whatever the order. Optical depths are added; where silhouettes give every segment a
// factor of its own, opacities are composited.

// Sum of optical depths.
const KEPT_AT_FIRST = vec2f(0.0);
// −ln OPAQUE.
const OPAQUE_SUM = 13.8;

fn gather(so_far: Gathered, found: Contribution, entry: f32) -> Gathered {
    if DEPTHS_ADD_UP {
        return Gathered(so_far.sum, vec2f(so_far.kept.x + found.optical_depth, 0.0));
    }
    return Gathered(composite_add(so_far.sum, found.color, found.opacity), so_far.kept);
}

fn is_opaque(gathered: Gathered) -> bool {
    return select(gathered.sum.transparency < OPAQUE, OPAQUE_SUM <= gathered.kept.x, DEPTHS_ADD_UP);
}

fn put_gathered(pixel: vec2u, gathered: Gathered) {
    if DEPTHS_ADD_UP {
        let opacity = one_minus_exp(gathered.kept.x);
        put(pixel, scene.widgets[0].color * opacity, opacity);
    } else {
        put(pixel, gathered.sum.color, composite_opacity(gathered.sum));
    }
}
