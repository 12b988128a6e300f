// Uses: nothing. Fills: nothing.
// The part of a segment inside a convex region, from the signed distances of both ends from each edge, positive
// inside; an end on an edge is inside. Twin of `lanes::optics::clip`.

// A part [t₀, t₁], with 1 − t₀ and 1 − t₁ known by themselves; length ≤ 0 where nothing is inside.
struct Stretch {
    start: f32,
    start_to_back: f32,
    end: f32,
    end_to_back: f32,
    length: f32,
}

fn stretch_whole() -> Stretch {
    return Stretch(0.0, 1.0, 1.0, 0.0, 1.0);
}

fn stretch_cut(stretch: Stretch, front: f32, back: f32) -> Stretch {
    var cut = stretch;
    let difference = front - back;
    let inverse = 1.0 / select(difference, 1.0, difference == 0.0);
    // Share of the crossing from the front and to the back.
    let t = front * inverse;
    let u = -(back * inverse);
    if front < 0.0 && back < 0.0 {
        cut.end = -1.0;
        cut.end_to_back = 2.0;
    } else if front < 0.0 && cut.start < t {
        cut.start = t;
        cut.start_to_back = u;
    } else if back < 0.0 && t < cut.end {
        cut.end = t;
        cut.end_to_back = u;
    }
    // The difference of the smaller numbers rounds less.
    cut.length = select(cut.end - cut.start, cut.start_to_back - cut.end_to_back, 0.5 < cut.start);
    return cut;
}

// The value at the start of what is `front` and `back` at the segment's ends.
fn stretch_at_start(stretch: Stretch, front: f32, back: f32) -> f32 {
    return front * stretch.start_to_back + back * stretch.start;
}

fn stretch_at_end(stretch: Stretch, front: f32, back: f32) -> f32 {
    return front * stretch.end_to_back + back * stretch.end;
}
