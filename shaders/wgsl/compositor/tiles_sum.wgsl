// Uses: compositor/tiles, elementary/one_minus_exp. Fills: compositor.
// Tiles of one colour: C = c A whatever the order. Optical depths are added; where silhouettes give every segment a
// factor of its own, opacities are composited.

// −ln OPAQUE.
const OPAQUE_SUM = 13.8;

@compute @workgroup_size(8, 8)
fn composite_tiles(
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_id) within: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = (view.window.xy + tile.xy) * TILE + within.xy;
    let list = list_of(tile.xy);
    let ray = ray_through(pixel);
    let state = state_of(pixel, State(composite_start(), vec2f(0.0), list.x, is_in_picture(pixel)));
    var sum = state.sum;
    var depth = state.kept.x;
    let begins_open = state.open;
    var open = begins_open;
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
                if DEPTHS_ADD_UP {
                    depth += found.optical_depth;
                } else {
                    sum = composite_add(sum, found.color, found.opacity);
                }
                segment_count++;
                work += SEGMENT_WORK;
            }
        }
        work += count;
        first += CHUNK;
        open = open && select(OPAQUE <= sum.transparency, depth < OPAQUE_SUM, DEPTHS_ADD_UP);
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
    keep_state(pixel, State(sum, vec2f(depth, 0.0), first, open));
    if begins_open && !open {
        if DEPTHS_ADD_UP {
            let opacity = one_minus_exp(depth);
            put(pixel, scene.widgets[0].color * opacity, opacity);
        } else {
            put(pixel, sum.color, composite_opacity(sum));
        }
    }
    count_tile(segment_count, stops, hidden, lane);
}
