// Uses: clip. Fills: part. Asks for: values, numbers.
// The part of a segment inside a widget's region, a convex polygon in the (s, g) plane (Song et al. 2009, Figure 4).

struct Part {
    front: Values,
    back: Values,
    // D of the whole segment, in scene lengths.
    length: f32,
    stretch: Stretch,
}

// Numbers of an edge: a normal that points inwards, a corner on the edge.
const EDGE_STRIDE = 4u;

fn part_whole(length: f32, front: Values, back: Values) -> Part {
    return Part(front, back, length, stretch_whole());
}

fn part_inside(first: u32, count: u32, length: f32, front: Values, back: Values) -> Part {
    var stretch = stretch_whole();
    let v_f = plane(front);
    let v_b = plane(back);
    for (var i = 0u; i < count; i++) {
        let at = first + EDGE_STRIDE * i;
        let normal = vec2f(number(at), number(at + 1u));
        let corner = vec2f(number(at + 2u), number(at + 3u));
        stretch = stretch_cut(stretch, dot(normal, v_f - corner), dot(normal, v_b - corner));
    }
    return Part(front, back, length, stretch);
}

fn part_start(part: Part, front: f32, back: f32) -> f32 {
    return stretch_at_start(part.stretch, front, back);
}

fn part_end(part: Part, front: f32, back: f32) -> f32 {
    return stretch_at_end(part.stretch, front, back);
}

fn part_share(part: Part) -> f32 {
    return max(part.stretch.length, 0.0);
}

fn part_range(part: Part) -> vec2f {
    return vec2f(part.stretch.start, part.stretch.end);
}
