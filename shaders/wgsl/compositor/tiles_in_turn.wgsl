// Uses: compositor/tiles. Fills: compositor. Asks for: gathering, chunk_corners.
// Tiles that take their list once, from its start to its end.

// Vectors of a pixel's state.
const STATE_VECTORS = 2u;

// What a pixel has gathered: colours over one another, and two numbers that `gathering` gives their sense.
struct Gathered {
    sum: Composite,
    kept: vec2f,
}

// Those of some cells that a pixel's ray crosses. They are looked for before any is shaded: cells are small, so that a tile's
// pixels cross different ones, and all of them shade at the same time, each its own.
fn crossed_of(cells: vec2u, ray: Ray) -> vec2u {
    var left = cells;
    var crossed = vec2u(0u);
    while any(left != vec2u(0u)) {
        let place = first_of(left);
        left = without_first(left);
        let range = cross_faces(faces_in_chunk(place), ray);
        let bit = u32(range.x < range.y) << (place % 32u);
        crossed |= select(vec2u(bit, 0u), vec2u(0u, bit), 32u <= place);
    }
    return crossed;
}

fn shade_in_chunk(faces: Faces, place: u32, cell: u32, range: vec2f, ray: Ray) -> Contribution {
    return shade_between(faces, corners_in_chunk(place, cell), tetrahedron(cell), range, ray);
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
    let state = state_of(pixel, State(composite_start(), KEPT_AT_FIRST, list.x, is_in_picture(pixel)));
    var gathered = Gathered(state.sum, state.kept);
    let begins_open = state.open;
    var open = begins_open;
    var work = 0u;
    var segment_count = 0u;
    // Where the list goes on, which is the same for all open pixels.
    var first = least_of_tile(select(list.y, state.number, state.open), lane);
    var stops = false;
    // Cells that no pixel looked at.
    var hidden = 0u;
    while first < list.y {
        let count = min(CHUNK, list.y - first);
        clear_chunk(lane);
        if lane < count {
            let cell = entries[first + lane].x;
            load_chunk(lane, cell, pixel - within.xy);
            load_corners(lane, cell);
        }
        workgroupBarrier();
        var crossed = vec2u(0u);
        if open {
            crossed = crossed_of(cells_at(within.xy), ray);
        }
        while open && any(crossed != vec2u(0u)) {
            let place = first_of(crossed);
            crossed = without_first(crossed);
            let faces = faces_in_chunk(place);
            let range = cross_faces(faces, ray);
            let found = shade_in_chunk(faces, place, entries[first + place].x, range, ray);
            gathered = gather(gathered, found, range.x);
            segment_count++;
            work += SEGMENT_WORK;
            open = !is_opaque(gathered);
        }
        work += count;
        first += CHUNK;
        if !any_pixel(open, lane) {
            hidden = list.y - min(first, list.y);
            break;
        }
        if first < list.y && any_pixel(view.budget < work, lane) {
            stops = true;
            break;
        }
    }
    open = open && stops;
    keep_state(pixel, State(gathered.sum, gathered.kept, first, open));
    if begins_open && !open {
        put_gathered(pixel, gathered);
    }
    count_tile(segment_count, stops, hidden, lane);
}
