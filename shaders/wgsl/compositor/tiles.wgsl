// Uses: compositing, compositor/pixels, compositor/shade, passes/faces. Fills: nothing. Asks for: segment, view, finish, tetrahedra, seen, attributes, bounds.
// Tiles: what every order of compositing shares. One workgroup a tile, one invocation a pixel; the tile's list is taken
// a chunk at a time, and a segment's values are found from its cell when it is its turn.

@group(1) @binding(1) var<storage, read> starts: array<u32>;
@group(1) @binding(2) var<storage, read> entries: array<vec2u>;
@group(1) @binding(3) var<storage, read_write> picture: array<vec4f>;
@group(1) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;
// Where a pixel stopped, two a pixel, as bits: colour and opacity; transparency, and three numbers of the order's own.
@group(1) @binding(5) var<storage, read_write> states: array<vec4u>;

// Cells of a chunk: corner 0 and nearest depth, corner 1 and farthest depth, inward normals.
const CHUNK = 64u;
var<workgroup> chunk_planes: array<array<vec4f, 6>, CHUNK>;
var<workgroup> chunk_bounds: array<vec2u, CHUNK>;
var<workgroup> vote: atomic<u32>;
var<workgroup> verdict: u32;

// Share of what lies behind that is given up.
const OPAQUE = 1e-6;

fn corners_of(cell: u32) -> array<vec3f, 4> {
    let points = tetrahedron(cell);
    return array(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
}

fn load_chunk(place: u32, cell: u32) {
    let p = corners_of(cell);
    let faces = faces_of(p[0], p[1], p[2], p[3]);
    chunk_planes[place] = array(
        vec4f(faces.first, faces.depths.x),
        vec4f(faces.second, faces.depths.y),
        vec4f(faces.normals[0], 0.0),
        vec4f(faces.normals[1], 0.0),
        vec4f(faces.normals[2], 0.0),
        vec4f(faces.normals[3], 0.0),
    );
    chunk_bounds[place] = bounds_of(cell);
}

// Entry and exit of the pixel's ray; exit ≤ entry where it misses the cell.
fn cross_in_chunk(place: u32, pixel: vec2u, ray: Ray) -> vec2f {
    let box = chunk_bounds[place];
    let start = vec2u(box.x & 0xffffu, box.x >> 16u);
    let end = vec2u(box.y & 0xffffu, box.y >> 16u);
    if any(pixel < start) || any(end <= pixel) {
        return vec2f(0.0);
    }
    let first = chunk_planes[place][0];
    let second = chunk_planes[place][1];
    var range = vec2f(max(first.w, view.near), second.w);
    range = narrowed(range, chunk_planes[place][2].xyz, second.xyz, ray);
    range = narrowed(range, chunk_planes[place][3].xyz, first.xyz, ray);
    range = narrowed(range, chunk_planes[place][4].xyz, first.xyz, ray);
    return narrowed(range, chunk_planes[place][5].xyz, first.xyz, ray);
}

// Whether any pixel of the tile says so. All invocations must ask.
fn any_pixel(says: bool, lane: u32) -> bool {
    if lane == 0u {
        atomicStore(&vote, 0u);
    }
    workgroupBarrier();
    if says {
        atomicStore(&vote, 1u);
    }
    workgroupBarrier();
    if lane == 0u {
        verdict = atomicLoad(&vote);
    }
    return workgroupUniformLoad(&verdict) != 0u;
}

// The tile's part of the entries.
fn list_of(tile: vec2u) -> vec2u {
    let index = tile.y * view.window.z + tile.x;
    return min(vec2u(starts[index], starts[index + 1u]), vec2u(view.capacity));
}

// Work of one segment, in cells tested.
const SEGMENT_WORK = 32u;

// A pixel between two dispatches: what it has seen, what the order keeps, whether it is to go on.
struct State {
    sum: Composite,
    kept: vec2f,
    number: u32,
    open: bool,
}

// CLOSED stands where the number would, in a pixel that is done.
const CLOSED = 0xffffffffu;

// The state that a dispatch begins with; `fresh` where none came before.
fn state_of(pixel: vec2u, fresh: State) -> State {
    if view.goes_on == 0u || !is_in_picture(pixel) {
        return fresh;
    }
    let a = bitcast<vec4f>(states[2u * place_of(pixel)]);
    let raw = states[2u * place_of(pixel) + 1u];
    let b = bitcast<vec4f>(raw);
    return State(Composite(a.rgb, a.a, b.x), b.yz, raw.w, raw.w != CLOSED);
}

// Ends a dispatch: `open` pixels go on in the next one.
fn keep_state(pixel: vec2u, state: State) {
    let at = 2u * place_of(pixel);
    if !is_in_picture(pixel) || arrayLength(&states) <= at + 1u {
        return;
    }
    states[at] = bitcast<vec4u>(vec4f(state.sum.color, state.sum.opacity));
    let number = select(CLOSED, state.number, state.open);
    states[at + 1u] = vec4u(bitcast<vec3u>(vec3f(state.sum.transparency, state.kept)), number);
}

var<workgroup> tally: atomic<u32>;

// Ends a dispatch for the whole tile: counts its segments, whether it is to go on, and the cells that it did not look at
// because every pixel was opaque. All invocations must ask; what all tiles add to is added to once a tile.
fn count_tile(segment_count: u32, stops: bool, hidden: u32, lane: u32) {
    if lane == 0u {
        atomicStore(&tally, 0u);
    }
    workgroupBarrier();
    atomicAdd(&tally, segment_count);
    workgroupBarrier();
    if lane != 0u {
        return;
    }
    atomicAdd(&counts[4], atomicLoad(&tally));
    if stops {
        atomicAdd(&counts[7], 1u);
    }
    if hidden != 0u {
        atomicAdd(&counts[10], 1u);
        atomicAdd(&counts[11], hidden);
    }
}

// Where a tile's list goes on for the orders that take it once: the open pixels' number, the same for all of them.
fn first_of_tile(state: State, list: vec2u, lane: u32) -> u32 {
    if lane == 0u {
        atomicStore(&vote, list.y);
    }
    workgroupBarrier();
    if state.open {
        atomicMin(&vote, state.number);
    }
    workgroupBarrier();
    if lane == 0u {
        verdict = atomicLoad(&vote);
    }
    return workgroupUniformLoad(&verdict);
}
