// Uses: passes/loops, passes/screen, passes/view. Fills: nothing. Asks for: tetrahedra, seen, attributes, bounds.
// Cells: which can contribute, the pixels that each may cover, and how many each tile will list.
//
// A widget's support is held in slabs low ≤ a s + b g ≤ high; a cell is left out if for every widget its corners lie
// beyond one side of a slab, so no point of their hull is inside.

struct Slab {
    a: f32,
    b: f32,
    low: f32,
    high: f32,
}

// Numbers of values behind the scalar at each point, and whether g is the first of them.
override ATTRIBUTE_STRIDE: u32 = 0u;
override reads_g: bool = false;
// Whether tiles list their cells.
override lists_tiles: bool = true;

// Where each widget's slabs begin, then where the last one's end; then four numbers a slab.
@group(1) @binding(1) var<storage, read> support: array<u32>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;

fn slab(index: u32) -> Slab {
    let at = view.widget_count + 1u + 4u * index;
    return Slab(bitcast<f32>(support[at]), bitcast<f32>(support[at + 1u]), bitcast<f32>(support[at + 2u]),
        bitcast<f32>(support[at + 3u]));
}

fn is_touched(s: vec4f, g: vec4f) -> bool {
    for (var widget = 0u; widget < view.widget_count; widget++) {
        var touches = true;
        for (var i = support[widget]; i < support[widget + 1u]; i++) {
            let slab = slab(i);
            let values = slab.a * s + slab.b * g;
            touches = touches && slab.low <= most(values) && least(values) <= slab.high;
        }
        if touches {
            return true;
        }
    }
    return false;
}

// Pixels that a cell may cover, as least and greatest coordinates.
struct Box {
    low: vec2f,
    high: vec2f,
}

// A twentieth of a pixel: more than the rounding of coordinates in 15 bits of pixels.
const SLACK = 0.05;

fn box_take(box: Box, p: vec3f) -> Box {
    let at = on_screen(p);
    return Box(min(box.low, at), max(box.high, at));
}

fn box_of(p: array<vec3f, 4>) -> Box {
    var corners = p;
    let z = vec4f(p[0].z, p[1].z, p[2].z, p[3].z);
    var box = Box(vec2f(FAR), vec2f(-FAR));
    let cut = cut_before(most(z));
    for (var i = 0u; i < 4u; i++) {
        let a = corners[i];
        if cut <= a.z {
            box = box_take(box, a);
        }
        for (var j = 0u; j < i; j++) {
            let b = corners[j];
            if (a.z < cut) != (b.z < cut) {
                box = box_take(box, mix(a, b, (a.z - cut) / (a.z - b.z)));
            }
        }
    }
    // What lies in front of the cut is seen within a cone no wider than the picture there.
    if least(z) < cut && view.near < cut {
        let reach = (cut + view.distance) * view.pixel * (max(abs(view.axis), abs(vec2f(view.size) - view.axis)) + 1.0);
        let x = vec4f(p[0].x, p[1].x, p[2].x, p[3].x);
        let y = vec4f(p[0].y, p[1].y, p[2].y, p[3].y);
        if least(x) <= reach.x && -reach.x <= most(x) && least(y) <= reach.y && -reach.y <= most(y) {
            return Box(vec2f(0.0), vec2f(view.size));
        }
    }
    return box;
}

// What becomes of a cell: the places of `counts`, but for the last.
const BY_FUNCTION = 1u;
const BY_FRUSTUM = 2u;
const PROJECTED = 3u;
const UNDER_A_PIXEL = 0u;
// Where cells under a pixel's reach are counted, and where cells whose tiles a driver did not go through.
const UNDER_A_PIXEL_COUNT = 9u;
const CUT_SHORT_COUNT = 12u;

// Gives the pixels that a cell may cover, counts it for the tiles that it falls on, and says what becomes of it.
fn bound(cell: u32) -> u32 {
    // Zeros for a cell that is left out.
    put_bounds(cell, vec2u(0u));
    let corners = tetrahedron(cell);
    let a = seen_at(corners.x);
    let b = seen_at(corners.y);
    let c = seen_at(corners.z);
    let d = seen_at(corners.w);
    var g = vec4f(0.0);
    if reads_g {
        g = vec4f(
            attribute_of(corners.x, 0u),
            attribute_of(corners.y, 0u),
            attribute_of(corners.z, 0u),
            attribute_of(corners.w, 0u),
        );
    }
    if !is_touched(vec4f(a.w, b.w, c.w, d.w), g) {
        return BY_FUNCTION;
    }
    if most(vec4f(a.z, b.z, c.z, d.z)) <= view.near {
        return BY_FRUSTUM;
    }
    // Without any volume that 32 bits can hold.
    let determinant = dot(b.xyz - a.xyz, cross(c.xyz - a.xyz, d.xyz - a.xyz));
    if !(1e-37 < abs(determinant)) {
        return UNDER_A_PIXEL;
    }
    let box = box_of(array(a.xyz, b.xyz, c.xyz, d.xyz));
    let size = vec2f(view.size);
    if any(box.high < vec2f(-SLACK)) || any(size - 1.0 + SLACK < box.low) {
        return BY_FRUSTUM;
    }
    let pixels_start = clamp(ceil(box.low - SLACK), vec2f(0.0), size);
    let pixels_end = clamp(floor(box.high + SLACK) + 1.0, vec2f(0.0), size);
    if any(pixels_end <= pixels_start) {
        return UNDER_A_PIXEL;
    }
    let window = view.window * TILE;
    let start = max(vec2u(pixels_start), window.xy);
    let end = min(vec2u(pixels_end), window.xy + window.zw);
    if any(end <= start) {
        return PROJECTED;
    }
    put_bounds(cell, vec2u(start.x | (start.y << 16u), end.x | (end.y << 16u)));
    if !lists_tiles {
        return PROJECTED;
    }
    let first = start / TILE - view.window.xy;
    let last = (end - 1u) / TILE - view.window.xy;
    for (var row = first.y; row <= last.y; row++) {
        for (var column = first.x; column <= last.x; column++) {
            atomicAdd(&counts[COUNTED + row * view.window.z + column], 1u);
        }
    }
    return PROJECTED;
}

// A group's cells are counted together: one number that all groups add to is waited for.
var<workgroup> tallies: array<atomic<u32>, 4>;

@compute @workgroup_size(64)
fn bound_cells(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) lane: u32,
    @builtin(num_workgroups) groups: vec3u,
) {
    let cell = flat_index(id, groups);
    if lane < 4u {
        atomicStore(&tallies[lane], 0u);
    }
    workgroupBarrier();
    if cell < view.cell_count {
        atomicAdd(&tallies[bound(cell)], 1u);
        if !do_loops_run() {
            atomicAdd(&counts[CUT_SHORT_COUNT], 1u);
        }
    }
    workgroupBarrier();
    if lane < 4u && view.is_first == 1u {
        let tally = atomicLoad(&tallies[lane]);
        if tally != 0u {
            atomicAdd(&counts[select(lane, UNDER_A_PIXEL_COUNT, lane == UNDER_A_PIXEL)], tally);
        }
    }
}
