// Uses: nothing. Fills: part. Asks for: values.
// A segment on which every widget is present from end to end.

struct Part {
    front: Values,
    back: Values,
    // D, in scene lengths.
    length: f32,
}

fn part_whole(length: f32, front: Values, back: Values) -> Part {
    return Part(front, back, length);
}

// The value at the start of the part of what is `front` and `back` at the segment's ends.
fn part_start(part: Part, front: f32, back: f32) -> f32 {
    return front;
}

fn part_end(part: Part, front: f32, back: f32) -> f32 {
    return back;
}

// The part's share of the segment.
fn part_share(part: Part) -> f32 {
    return 1.0;
}

// [t₀, t₁].
fn part_range(part: Part) -> vec2f {
    return vec2f(0.0, 1.0);
}
