// Uses: compositing, passes/view. Fills: cutting.
// Segments cut at what rays meet beside cells: surfaces, whose colours take their places, and the ends of what clips keep.
//
// Behind the tiles' lists stand, for each pixel of the picture, the numbers of its first event and of the one behind its last; then the
// events, three pairs each: depth and red, green and blue, opacity and nothing. Opacities below 0 are no surfaces.

// Vectors of a pixel's state: the cursor has one of its own.
const STATE_VECTORS = 3u;

const EVENT_PAIRS = 3u;
// In place of an opacity.
const HIDES = -1.0;

// How far the events of a pixel have been taken.
struct Cursor {
    next: u32,
    end: u32,
    hidden: bool,
}

fn cursor_of(pixel: vec2u) -> Cursor {
    if !is_in_picture(pixel) {
        return Cursor(0u, 0u, false);
    }
    let range = entries[view.capacity + pixel.y * view.size.x + pixel.x];
    if view.goes_on == 0u {
        return Cursor(range.x, range.y, false);
    }
    let kept = picture[state_place(pixel) + 2u];
    return Cursor(kept.x, range.y, kept.y == 1u);
}

fn keep_cursor(pixel: vec2u, cursor: Cursor) {
    let at = state_place(pixel) + 2u;
    if is_in_picture(pixel) && at < arrayLength(&picture) {
        picture[at] = vec4u(cursor.next, u32(cursor.hidden), 0u, 0u);
    }
}

fn event_at(number: u32) -> u32 {
    return view.capacity + view.size.x * view.size.y + EVENT_PAIRS * number;
}

fn event_depth(number: u32) -> f32 {
    return bitcast<f32>(entries[event_at(number)].x);
}

fn event_color(number: u32) -> vec4f {
    let at = event_at(number);
    return vec4f(bitcast<f32>(entries[at].y), bitcast<vec2f>(entries[at + 1u]), bitcast<f32>(entries[at + 2u].x));
}

fn composite_cell(sum: Composite, cell: u32, range: vec2f, ray: Ray, cursor: ptr<function, Cursor>) -> Composite {
    var total = sum;
    var entry = range.x;
    var at = *cursor;
    while at.next < at.end {
        let depth = event_depth(at.next);
        if range.y <= depth {
            break;
        }
        if entry < depth {
            if !at.hidden {
                let found = shade_again(cell, vec2f(entry, depth), ray);
                total = composite_add(total, found.color, found.opacity);
            }
            entry = depth;
        }
        let color = event_color(at.next);
        if 0.0 <= color.a {
            total = composite_add(total, color.rgb, color.a);
        } else {
            at.hidden = color.a == HIDES;
        }
        at.next++;
    }
    *cursor = at;
    if !at.hidden {
        let found = shade_again(cell, vec2f(entry, range.y), ray);
        total = composite_add(total, found.color, found.opacity);
    }
    return total;
}

// Surfaces behind the last segment.
fn composite_rest(sum: Composite, cursor: Cursor) -> Composite {
    var total = sum;
    for (var number = cursor.next; number < cursor.end; number++) {
        let color = event_color(number);
        if 0.0 <= color.a {
            total = composite_add(total, color.rgb, color.a);
        }
    }
    return total;
}
