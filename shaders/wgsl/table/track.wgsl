// Uses: track. Fills: nothing. Asks for: texels.
// An image along a segment, bilinear between texel centres, which lie at the integers (Song et al. 2009, section 3.3.2).
// Between the lines through them alpha is a quadratic in t. Twin of `optics::table::TablePath`.

struct TableTrack {
    // Where its texels begin.
    first: u32,
    // Columns and rows, less 1.
    last: vec2f,
    // Texel coordinates at front and back.
    front: vec2f,
    back: vec2f,
    // ρ₀ D.
    peak: f32,
    // Alpha above which it glows; negative where none is told apart.
    cutoff: f32,
}

fn table_place(track: TableTrack, t: f32) -> vec2f {
    // From the nearer end.
    let near_back = 0.5 < t;
    return select(track.front, track.back, near_back) + (track.back - track.front) * select(t, t - 1.0, near_back);
}

fn table_texel(track: TableTrack, t: f32) -> vec4f {
    let place = clamp(table_place(track, t), vec2f(0.0), track.last);
    let low = min(floor(place), max(track.last - vec2f(1.0), vec2f(0.0)));
    let high = min(low + vec2f(1.0), track.last);
    let share = place - low;
    let columns = u32(track.last.x) + 1u;
    let above = track.first + u32(low.y) * columns;
    let below = track.first + u32(high.y) * columns;
    return mix(
        mix(texel(above + u32(low.x)), texel(above + u32(high.x)), share.x),
        mix(texel(below + u32(low.x)), texel(below + u32(high.x)), share.x),
        share.y,
    );
}

// Red, green, blue and alpha at four places.
fn table_texels(track: TableTrack, at: vec4f) -> mat4x4f {
    return transpose(mat4x4f(
        table_texel(track, at.x),
        table_texel(track, at.y),
        table_texel(track, at.z),
        table_texel(track, at.w),
    ));
}

// The next t on a line through texel centres, along one axis.
fn table_next_line(front: f32, back: f32, last: f32, t: f32) -> f32 {
    let span = back - front;
    if abs(span) < 1e-30 {
        return 2.0;
    }
    let place = select(front + span * t, back + span * (t - 1.0), 0.5 < t);
    // What the rounding of t and of the place stands for.
    let margin = 4.8e-7 * (1.0 + abs(place) + abs(span));
    let rising = max(floor(place + margin) + 1.0, 0.0);
    let falling = min(ceil(place - margin) - 1.0, last);
    let line = select(falling, rising, 0.0 < span);
    return select(2.0, (line - front) / span, 0.0 <= line && line <= last);
}

// Where alpha passes the cutoff between t and `end`, if it does.
fn table_next_crossing(track: TableTrack, t: f32, end: f32) -> f32 {
    let length = min(end, 1.0) - t;
    // α(t + length u) − cutoff = a u² + b u + c through three values.
    let start = table_texel(track, t).a - track.cutoff;
    let middle = table_texel(track, t + 0.5 * length).a - track.cutoff;
    let back = table_texel(track, t + length).a - track.cutoff;
    let a = 2.0 * (start - 2.0 * middle + back);
    let b = 4.0 * middle - 3.0 * start - back;
    let square = b * b - 4.0 * a * start;
    if square < 0.0 {
        return 2.0;
    }
    let q = -0.5 * (b + select(sqrt(square), -sqrt(square), b < 0.0));
    let one = q / select(a, 1e-37, abs(a) < 1e-37);
    let other = start / select(q, 1e-37, abs(q) < 1e-37);
    let past = 2.0 * PASSED / max(length, PASSED);
    var next = 2.0;
    next = select(next, one, past < one && one < 1.0 && one < next);
    next = select(next, other, past < other && other < 1.0 && other < next);
    return select(2.0, t + length * next, next < 1.0);
}

fn table_next_break(track: TableTrack, t: f32) -> f32 {
    var line = table_next_line(track.front.x, track.back.x, track.last.x, t);
    line = min(line, table_next_line(track.front.y, track.back.y, track.last.y, t));
    if 0.0 <= track.cutoff {
        line = min(line, table_next_crossing(track, t, line));
    }
    return max(line, t + PASSED);
}
