// Uses: compositor/tiles. Fills: compositor.
// Tiles in the order of their lists: an approximation, whatever the lists are sorted by. Pixels that meet a segment
// that begins before one already composited are counted.

@compute @workgroup_size(8, 8)
fn composite_tiles(
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_id) within: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = (view.window.xy + tile.xy) * TILE + within.xy;
    let list = list_of(tile.xy);
    let ray = ray_through(pixel);
    let state = state_of(pixel, State(composite_start(), vec2f(-FAR, 0.0), list.x, is_in_picture(pixel)));
    var sum = state.sum;
    let begins_open = state.open;
    var open = begins_open;
    var last = state.kept.x;
    var disordered = state.kept.y;
    var work = 0u;
    var segment_count = 0u;
    var first = first_of_tile(state, list, lane);
    var stops = false;
    var hidden = 0u;
    while first < list.y {
        let count = min(CHUNK, list.y - first);
        workgroupBarrier();
        if lane < count {
            load_chunk(lane, entries[first + lane].x);
        }
        workgroupBarrier();
        for (var place = 0u; open && place < count; place++) {
            let range = cross_in_chunk(place, pixel, ray);
            if range.x < range.y {
                let found = shade(entries[first + place].x, range, ray);
                sum = composite_add(sum, found.color, found.opacity);
                segment_count++;
                work += SEGMENT_WORK;
                disordered = select(disordered, 1.0, range.x < last);
                last = max(last, range.x);
                open = OPAQUE <= sum.transparency;
            }
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
    keep_state(pixel, State(sum, vec2f(last, disordered), first, open));
    if begins_open && !open {
        put(pixel, sum.color, composite_opacity(sum));
        atomicAdd(&counts[5], u32(disordered));
    }
    count_tile(segment_count, stops, hidden, lane);
}
