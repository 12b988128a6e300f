// Uses: compositing, compositor/pixels, compositor/shade, passes/faces, passes/loops. Fills: nothing. Asks for: segment, view, finish, tetrahedra, seen, attributes, bounds.
// Tiles: what every order of compositing shares. One workgroup a tile, one invocation a pixel; the tile's list is taken
// a chunk at a time, and a segment's values are found from its cell when it is its turn.

@group(1) @binding(1) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(2) var<storage, read> entries: array<vec2u>;
// Behind the pixels, where they stopped, two a pixel, as bits: colour and opacity; transparency, and three numbers of the
// order's own.
@group(1) @binding(3) var<storage, read_write> picture: array<vec4u>;

// Of each cell of a chunk: nearest corner and nearest depth, next corner and farthest depth, inward normals, the first with six
// times the volume, the second with the nearest corner's number. Cells side by side: invocations that look at different ones mostly find them in different banks.
const CHUNK = 64u;
var<workgroup> chunk_planes: array<array<vec4f, CHUNK>, 6>;
// Which cells of the chunk may cover pixels of each row and of each column of the tile: a bit a cell, two words a line.
var<workgroup> chunk_rows: array<atomic<u32>, LINE_WORDS>;
var<workgroup> chunk_columns: array<atomic<u32>, LINE_WORDS>;
const LINE_WORDS = 2u * TILE;
var<workgroup> vote: atomic<u32>;
var<workgroup> verdict: u32;

// Share of what lies behind that is given up; negative where nothing is.
override OPAQUE: f32 = 1e-6;

fn corners_of(cell: u32) -> array<vec3f, 4> {
    let points = tetrahedron(cell);
    return array(seen_at(points.x).xyz, seen_at(points.y).xyz, seen_at(points.z).xyz, seen_at(points.w).xyz);
}

// Forgets the chunk before. All invocations must ask, then load their cells, then wait.
fn clear_chunk(lane: u32) {
    workgroupBarrier();
    if lane < LINE_WORDS {
        atomicStore(&chunk_rows[lane], 0u);
        atomicStore(&chunk_columns[lane], 0u);
    }
    workgroupBarrier();
}

// `origin`: the tile's first pixel.
fn load_chunk(place: u32, cell: u32, origin: vec2u) {
    let p = corners_of(cell);
    let faces = faces_of(p[0], p[1], p[2], p[3]);
    chunk_planes[0][place] = vec4f(faces.nearest, faces.depths.x);
    chunk_planes[1][place] = vec4f(faces.next, faces.depths.y);
    chunk_planes[2][place] = vec4f(faces.normals[0], faces.determinant);
    chunk_planes[3][place] = vec4f(faces.normals[1], f32(faces.nearest_number));
    chunk_planes[4][place] = vec4f(faces.normals[2], 0.0);
    chunk_planes[5][place] = vec4f(faces.normals[3], 0.0);
    let box = bounds_of(cell);
    let start = max(vec2u(box.x & 0xffffu, box.x >> 16u), origin) - origin;
    let end = clamp(vec2u(box.y & 0xffffu, box.y >> 16u), origin, origin + TILE) - origin;
    let bit = 1u << (place % 32u);
    for (var row = start.y; row < end.y; row++) {
        atomicOr(&chunk_rows[2u * row + place / 32u], bit);
    }
    for (var column = start.x; column < end.x; column++) {
        atomicOr(&chunk_columns[2u * column + place / 32u], bit);
    }
}

// The chunk's cells that may cover a pixel of the tile.
fn cells_at(within: vec2u) -> vec2u {
    return vec2u(
        atomicLoad(&chunk_rows[2u * within.y]) & atomicLoad(&chunk_columns[2u * within.x]),
        atomicLoad(&chunk_rows[2u * within.y + 1u]) & atomicLoad(&chunk_columns[2u * within.x + 1u]),
    );
}

// Place of the first of some cells of a chunk; there must be one.
fn first_of(cells: vec2u) -> u32 {
    return select(32u + firstTrailingBit(cells.y), firstTrailingBit(cells.x), cells.x != 0u);
}

fn without_first(cells: vec2u) -> vec2u {
    let rest = cells & (cells - 1u);
    return select(vec2u(0u, rest.y), vec2u(rest.x, cells.y), cells.x != 0u);
}

fn faces_in_chunk(place: u32) -> Faces {
    let nearest = chunk_planes[0][place];
    let next = chunk_planes[1][place];
    let first = chunk_planes[2][place];
    let second = chunk_planes[3][place];
    let normals = array(first.xyz, second.xyz, chunk_planes[4][place].xyz, chunk_planes[5][place].xyz);
    return Faces(nearest.xyz, next.xyz, u32(second.w), normals, first.w, vec2f(nearest.w, next.w));
}

// Every bit that any pixel of the tile gives. All invocations must ask.
fn bits_of_pixels(bits: u32, lane: u32) -> u32 {
    if lane == 0u {
        atomicStore(&vote, 0u);
    }
    workgroupBarrier();
    if bits != 0u {
        atomicOr(&vote, bits);
    }
    workgroupBarrier();
    if lane == 0u {
        verdict = atomicLoad(&vote);
    }
    return workgroupUniformLoad(&verdict);
}

// The least number that any pixel of the tile gives. All invocations must ask.
fn least_of_tile(number: u32, lane: u32) -> u32 {
    if lane == 0u {
        atomicStore(&vote, 0xffffffffu);
    }
    workgroupBarrier();
    atomicMin(&vote, number);
    workgroupBarrier();
    if lane == 0u {
        verdict = atomicLoad(&vote);
    }
    return workgroupUniformLoad(&verdict);
}

// Whether any pixel of the tile says so. All invocations must ask.
fn any_pixel(says: bool, lane: u32) -> bool {
    return bits_of_pixels(u32(says), lane) != 0u;
}

// The tile's part of the entries.
fn list_of(tile: vec2u) -> vec2u {
    let index = tile.y * view.window.z + tile.x;
    var start = 0u;
    if index != 0u {
        start = atomicLoad(&counts[COUNTED + index - 1u]);
    }
    return min(vec2u(start, atomicLoad(&counts[COUNTED + index])), vec2u(view.capacity));
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

// Where a pixel's state stands in `picture`.
fn state_place(pixel: vec2u) -> u32 {
    return view.window.z * view.window.w * TILE * TILE + STATE_VECTORS * place_of(pixel);
}

// The state that a dispatch begins with; `fresh` where none came before.
fn state_of(pixel: vec2u, fresh: State) -> State {
    if view.goes_on == 0u || !is_in_picture(pixel) {
        return fresh;
    }
    let a = bitcast<vec4f>(picture[state_place(pixel)]);
    let raw = picture[state_place(pixel) + 1u];
    let b = bitcast<vec4f>(raw);
    return State(Composite(a.rgb, a.a, b.x), b.yz, raw.w, raw.w != CLOSED);
}

// Ends a dispatch: `open` pixels go on in the next one.
fn keep_state(pixel: vec2u, state: State) {
    let at = state_place(pixel);
    if !is_in_picture(pixel) || arrayLength(&picture) <= at + 1u {
        return;
    }
    picture[at] = bitcast<vec4u>(vec4f(state.sum.color, state.sum.opacity));
    let number = select(CLOSED, state.number, state.open);
    picture[at + 1u] = vec4u(bitcast<vec3u>(vec3f(state.sum.transparency, state.kept)), number);
}

var<workgroup> tally: atomic<u32>;

// Ends a dispatch for the whole tile: counts its segments, whether it is to go on, and the cells that it did not look at
// because every pixel was opaque. All invocations must ask; what all tiles add to is added to once a tile.
fn count_tile(segment_count: u32, stops: bool, hidden: u32, lane: u32) {
    if !do_loops_run() {
        atomicAdd(&counts[13], 1u);
    }
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
