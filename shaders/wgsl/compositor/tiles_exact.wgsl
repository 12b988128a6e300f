// Uses: compositor/tiles, passes/screen. Fills: compositor. Asks for: cutting.
// Tiles in the exact order: each pixel's segments by entry, then by exit, then by number of the cell.
//
// The list is sorted by nearest depth. A pixel holds the nearest PENDING segments that it has met; those that begin
// before every cell to come are composited. What finds no room is given up for this sweep, and so is all behind it:
// the list is swept again from there. So memory is bounded, nothing is lost, and a sweep is enough where no depth range
// of a few cells holds more than PENDING segments of one pixel. A dispatch that has done its budget of work stops in
// the same way, and the next one sweeps on.

const PENDING = 12u;
// Cells between two looks at what can be composited.
const STEP = 8u;
// Cells that an invocation looks at, one after the other, to find where a sweep begins.
const GLANCE = 16u;

// What pixels say at the end of a chunk.
const IS_OPEN = 1u;
const LOOKS_ON = 2u;
const HAS_WORKED = 4u;

struct Key {
    entry: f32,
    exit: f32,
    cell: u32,
}

// Farthest first, so that the nearest is taken from the end; invocations side by side.
var<workgroup> pending_entry: array<f32, PENDING * THREADS>;
var<workgroup> pending_exit: array<f32, PENDING * THREADS>;
var<workgroup> pending_cell: array<u32, PENDING * THREADS>;

fn is_nearer(a: Key, b: Key) -> bool {
    if a.entry != b.entry {
        return a.entry < b.entry;
    }
    if a.exit != b.exit {
        return a.exit < b.exit;
    }
    return a.cell < b.cell;
}

fn pending_at(place: u32, lane: u32) -> Key {
    let at = place * THREADS + lane;
    return Key(pending_entry[at], pending_exit[at], pending_cell[at]);
}

fn pending_put(place: u32, lane: u32, key: Key) {
    let at = place * THREADS + lane;
    pending_entry[at] = key.entry;
    pending_exit[at] = key.exit;
    pending_cell[at] = key.cell;
}

// The least of a depth of each pixel. All invocations must ask.
fn least_of_pixels(depth: f32, lane: u32) -> f32 {
    // Bits in the order of their floats.
    let bits = bitcast<u32>(depth);
    let found = least_of_tile(select(bits | 0x80000000u, ~bits, (bits >> 31u) == 1u), lane);
    return bitcast<f32>(select(~found, found & 0x7fffffffu, (found >> 31u) == 1u));
}

// Where in the list, from `begin` on, the first cell ends at or behind a depth. All invocations must ask.
fn first_that_reaches(depth: f32, begin: u32, end: u32, lane: u32) -> u32 {
    for (var block = begin; block < end; block += GLANCE * THREADS) {
        var found = end;
        for (var at = block + lane; at < min(block + GLANCE * THREADS, end); at += THREADS) {
            let p = corners_of(entries[at].x);
            if depth <= most(vec4f(p[0].z, p[1].z, p[2].z, p[3].z)) {
                found = at;
                break;
            }
        }
        let first = least_of_tile(found, lane);
        if first < end {
            return first;
        }
    }
    return end;
}

// Takes a segment among those that wait, and gives the limit: the nearest segment that found no room.
fn take(key: Key, waiting: ptr<function, u32>, limit: Key, lane: u32) -> Key {
    var at = *waiting;
    if at < PENDING {
        *waiting = at + 1u;
        while 0u < at && is_nearer(pending_at(at - 1u, lane), key) {
            pending_put(at, lane, pending_at(at - 1u, lane));
            at--;
        }
        pending_put(at, lane, key);
        return limit;
    }
    let farthest = pending_at(0u, lane);
    if !is_nearer(key, farthest) {
        return key;
    }
    at = 0u;
    while at + 1u < PENDING && is_nearer(key, pending_at(at + 1u, lane)) {
        pending_put(at, lane, pending_at(at + 1u, lane));
        at++;
    }
    pending_put(at, lane, key);
    return farthest;
}

// A segment that has waited: its cell's chunk may be gone.
fn shade_again(cell: u32, range: vec2f, ray: Ray) -> Contribution {
    let p = corners_of(cell);
    let points = tetrahedron(cell);
    return shade_between(faces_of(p[0], p[1], p[2], p[3]), corners_of_values(points), points, range, ray);
}

@compute @workgroup_size(8, 8)
fn composite_tiles(
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_id) within: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = (view.window.xy + tile.xy) * TILE + within.xy;
    let list = list_of(tile.xy);
    let ray = ray_through(pixel);
    let nowhere = Key(FAR, FAR, CLOSED);
    let state = state_of(pixel, State(composite_start(), vec2f(-FAR), 0u, is_in_picture(pixel)));
    var sum = state.sum;
    var cursor = cursor_of(pixel);
    // What was composited lies before `low`.
    var low = Key(state.kept.x, state.kept.y, state.number);
    let begins_open = state.open;
    var open = begins_open;
    var work = 0u;
    var segment_count = 0u;
    var stops = false;
    // Cells that no sweep has looked at.
    var hidden = 0u;
    var is_first_sweep = view.goes_on == 0u;
    // All cells before this one end before whatever is still open.
    var begin = list.x;
    loop {
        // What this sweep gave up lies at or behind `limit`.
        var limit = nowhere;
        var waiting = 0u;
        let least_low = least_of_pixels(select(FAR, low.entry, open), lane);
        begin = first_that_reaches(least_low, begin, list.y, lane);
        for (var first = begin; first < list.y; first += CHUNK) {
            let count = min(CHUNK, list.y - first);
            clear_chunk(lane);
            var reaches = false;
            if lane < count {
                load_chunk(lane, entries[first + lane].x, pixel - within.xy);
                reaches = least_low <= chunk_planes[1][lane].w;
            }
            work++;
            if !any_pixel(reaches, lane) {
                continue;
            }
            var cells = cells_at(within.xy);
            for (var batch = 0u; open && batch < count; batch += STEP) {
                let end = min(batch + STEP, count);
                while any(cells != vec2u(0u)) {
                    let place = first_of(cells);
                    if end <= place {
                        break;
                    }
                    cells = without_first(cells);
                    work++;
                    let range = cross_faces(faces_in_chunk(place), ray);
                    if range.x < range.y {
                        let key = Key(range.x, range.y, entries[first + place].x);
                        if !is_nearer(key, low) && is_nearer(key, limit) {
                            limit = take(key, &waiting, limit, lane);
                        }
                    }
                }
                work++;
                // Nearest depth of what is still to come.
                var horizon = FAR;
                if first + end < list.y {
                    horizon = bitcast<f32>(entries[first + end].y);
                }
                while 0u < waiting {
                    let key = pending_at(waiting - 1u, lane);
                    if horizon <= key.entry || !is_nearer(key, limit) {
                        break;
                    }
                    waiting--;
                    sum = composite_cell(sum, key.cell, vec2f(key.entry, key.exit), ray, &cursor);
                    segment_count++;
                    work += SEGMENT_WORK;
                    if sum.transparency < OPAQUE {
                        open = false;
                        break;
                    }
                }
            }
            var horizon = Key(FAR, -FAR, 0u);
            if first + CHUNK < list.y {
                horizon.entry = bitcast<f32>(entries[first + CHUNK].y);
            }
            // A pixel looks on unless all to come lies behind what it gave up.
            let looks_on = open && horizon.entry <= limit.entry;
            let said = bits_of_pixels(
                select(0u, IS_OPEN, open) | select(0u, LOOKS_ON, looks_on) | select(0u, HAS_WORKED, view.budget < work),
                lane,
            );
            if (said & IS_OPEN) == 0u && is_first_sweep {
                hidden = list.y - min(first + CHUNK, list.y);
            }
            if (said & LOOKS_ON) == 0u {
                break;
            }
            // Not before the nearest open pixel has got further.
            if first + CHUNK < list.y && least_low < horizon.entry && (said & HAS_WORKED) != 0u {
                // What waits begins behind the horizon, and is found again.
                if is_nearer(horizon, limit) {
                    limit = horizon;
                }
                if is_nearer(limit, low) {
                    limit = low;
                }
                stops = true;
                break;
            }
        }
        open = open && limit.entry < FAR;
        low = limit;
        if !any_pixel(open, lane) {
            stops = false;
            break;
        }
        stops = stops || any_pixel(view.budget < work, lane);
        if stops {
            break;
        }
        if lane == 0u {
            atomicAdd(&counts[6], 1u);
        }
        is_first_sweep = false;
    }
    keep_state(pixel, State(sum, vec2f(low.entry, low.exit), low.cell, open));
    keep_cursor(pixel, cursor);
    if begins_open && !open {
        let whole = composite_rest(sum, cursor);
        put(pixel, whole.color, composite_opacity(whole));
    }
    count_tile(segment_count, stops, hidden, lane);
}
