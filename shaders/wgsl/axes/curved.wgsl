// Uses: elementary/exponential, elementary/one_minus_exp. Fills: segment. Asks for: straight_segment, axes, values, numbers.
// Segments along logarithmic axes, cut into pairs of straight pieces; twin of `optics::curved_axes`, which derives them.
//
// Values are linear along a segment and counted from 0; widgets stand at positions. A segment is walked from front to back, by shares
// that are counted from the end where the first curved axis is smaller, since only there small shares matter. A pair of pieces ends
// after an even step of positions, and where a profile jumps.
//
// Numbers of an axis, from scene.first_entry on: positions by binary logarithm; the binary logarithm that positions are counted from,
// whole and rest; the longest step of positions; where its jumps begin, and how many there are (ascending: value, position); 1/c of a
// symmetric logarithm; the least and the greatest value of which anything is drawn; the positions between which profiles change.
const AXIS_NUMBERS = 11u;

// Ratio of the smallest value that counts to the largest: 10⁻³⁰ (`transfer::axis::DECADES`).
const SMALLEST = 1e-30;
// Optical depth behind which nothing is seen, nor changes an opacity of 32 bits.
const BEHIND_ALL = 100.0;
// Share of a step over which one straight piece is as good.
const STRAIGHT = 0.03;
// In place of an axis.
const NO_AXIS = 2u;

// A walk along one axis.
struct AxisWalk {
    // Values at the shares 0 and 1.
    near: f32,
    far: f32,
    // Positions where the walk begins.
    from_position: f32,
    // Position of the first step, and the way of all of them.
    first_step: f32,
    way: f32,
    step: f32,
    step_count: f32,
    jump: i32,
    jump_count: i32,
}

fn axis_number(axis: u32) -> u32 {
    return scene.first_entry + axis * AXIS_NUMBERS;
}

fn jump_place(axis: u32, jump: i32) -> u32 {
    return scene.first_entry + u32(number(axis_number(axis) + 4u)) + 2u * u32(jump);
}

// The smallest value that counts beside the largest one.
fn smallest_value(axis: u32, largest: f32) -> f32 {
    let drawn = number(axis_number(axis) + 7u);
    return select(drawn, max(max(drawn, SMALLEST * largest), 1e-37), IS_LOG[axis]);
}

// Narrows shares to those at which the axis has positions and anything is drawn.
fn shares_drawn(axis: u32, near: f32, far: f32, shares: vec2f) -> vec2f {
    if !IS_CURVED[axis] {
        return shares;
    }
    let low = smallest_value(axis, max(near, far));
    let high = number(axis_number(axis) + 8u);
    if !(low <= max(near, far) && min(near, far) <= high) {
        return vec2f(1.0, 0.0);
    }
    var narrowed = shares;
    if near < low || high < near {
        let bound = select(high, low, near < low);
        narrowed.x = max(narrowed.x, (bound - near) / (far - near));
    }
    if far < low || high < far {
        let bound = select(high, low, far < low);
        narrowed.y = min(narrowed.y, (near - bound) / (near - far));
    }
    return narrowed;
}

fn value_at_share(near: f32, far: f32, share: f32) -> f32 {
    return select(near + share * (far - near), far, share == 1.0);
}

fn position_at_share(axis: u32, walk: AxisWalk, share: f32) -> f32 {
    let value = value_at_share(walk.near, walk.far, share);
    if !IS_CURVED[axis] {
        return value;
    }
    return axis_position(axis, max(value, smallest_value(axis, max(walk.near, walk.far))));
}

fn axis_walk(axis: u32, near: f32, far: f32, from_share: f32, to_share: f32) -> AxisWalk {
    // Straight axes have no cuts.
    var walk = AxisWalk(near, far, 0.0, 0.0, 0.0, 1.0, 0.0, 0, 0);
    walk.from_position = position_at_share(axis, walk, from_share);
    if IS_CURVED[axis] {
        let at = axis_number(axis);
        let changing = vec2f(number(at + 9u), number(at + 10u));
        if changing.x <= changing.y && near != far {
            walk.first_step = clamp(walk.from_position, changing.x, changing.y);
            walk.way = clamp(position_at_share(axis, walk, to_share), changing.x, changing.y) - walk.first_step;
            walk.step_count = max(ceil(abs(walk.way) / number(at + 3u)), 1.0);
            walk.step = 0.0;
        }
        // The first jump beyond where the walk begins.
        let value = value_at_share(near, far, from_share);
        walk.jump_count = i32(number(at + 5u));
        let is_rising = (near < far) == (from_share < to_share);
        var low = 0;
        var high = walk.jump_count;
        while low < high {
            let middle = (low + high) / 2;
            let jump = number(jump_place(axis, middle));
            if jump < value || is_rising && jump == value {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        walk.jump = select(low - 1, low, is_rising);
    }
    return walk;
}

// A segment: its length, and its values at both ends.
struct Ends {
    length: f32,
    front: Values,
    back: Values,
}

// A place where a pair of pieces may end.
struct AxisCut {
    share: f32,
    position: f32,
    axis: u32,
    is_jump: bool,
}

// The nearer of a cut and the next ones of an axis.
fn nearest_cut(axis: u32, walk: AxisWalk, nearest: AxisCut, turn: f32) -> AxisCut {
    var cut = nearest;
    if walk.step <= walk.step_count {
        let value = axis_value(axis, walk.first_step + walk.way * (walk.step / walk.step_count));
        let share = (value - walk.near) / (walk.far - walk.near);
        if turn * share < turn * cut.share {
            cut = AxisCut(share, 0.0, axis, false);
        }
    }
    if 0 <= walk.jump && walk.jump < walk.jump_count && walk.near != walk.far {
        let at = jump_place(axis, walk.jump);
        let share = (number(at) - walk.near) / (walk.far - walk.near);
        if turn * share < turn * cut.share {
            cut = AxisCut(share, number(at + 1u), axis, true);
        }
    }
    return cut;
}

// Goes behind a cut if it is of this axis.
fn behind_cut(axis: u32, walk: AxisWalk, cut: AxisCut, turn: f32) -> AxisWalk {
    var next = walk;
    if cut.axis == axis {
        next.step += select(1.0, 0.0, cut.is_jump);
        next.jump += select(0, select(-1, 1, (walk.near < walk.far) == (0.0 < turn)), cut.is_jump);
    }
    return next;
}

// Values at a share of the segment, with positions in place of s and g.
fn values_between(front: Values, back: Values, share: f32, positions: vec2f) -> Values {
    var ends = array<Values, 2>(front, back);
    var values = with_positions(front, positions);
    for (var i = FIRST_FIELD; i < VALUE_COUNT; i++) {
        values[i] = ends[0][i] + share * (ends[1][i] - ends[0][i]);
    }
    return values;
}

// A sum with what a straight piece between two shares adds.
fn with_piece(
    sum: Contribution,
    segment: Ends,
    shares: vec2f,
    first: vec2f,
    last: vec2f,
) -> Contribution {
    let part = straight_segment(
        segment.length * abs(shares.y - shares.x),
        values_between(segment.front, segment.back, shares.x, first),
        values_between(segment.front, segment.back, shares.y, last),
    );
    let color = sum.color + exponential(-sum.optical_depth) * part.color;
    return Contribution(color, 0.0, sum.optical_depth + part.optical_depth);
}

fn segment(length: f32, front: Values, back: Values) -> Contribution {
    let front_plane = plane(front);
    let back_plane = plane(back);
    let is_turned = select(back_plane.y < front_plane.y, back_plane.x < front_plane.x, IS_CURVED[0]);
    let near = select(front_plane, back_plane, is_turned);
    let far = select(back_plane, front_plane, is_turned);
    var shares = shares_drawn(0u, near.x, far.x, vec2f(0.0, 1.0));
    shares = shares_drawn(1u, near.y, far.y, shares);
    var sum = Contribution(vec3f(0.0), 0.0, 0.0);
    if !(shares.x < shares.y) {
        return sum;
    }
    let ends = Ends(length, front, back);
    let turn = select(1.0, -1.0, is_turned);
    let end = select(shares.y, shares.x, is_turned);
    var begin = select(shares.x, shares.y, is_turned);
    var along_s = axis_walk(0u, near.x, far.x, begin, end);
    var along_g = axis_walk(1u, near.y, far.y, begin, end);
    let steps = vec2f(number(axis_number(0u) + 3u), number(axis_number(1u) + 3u));
    var first = vec2f(along_s.from_position, along_g.from_position);
    loop {
        var cut = nearest_cut(0u, along_s, AxisCut(end, 0.0, NO_AXIS, false), turn);
        cut = nearest_cut(1u, along_g, cut, turn);
        along_s = behind_cut(0u, along_s, cut, turn);
        along_g = behind_cut(1u, along_g, cut, turn);
        if turn * begin < turn * cut.share {
            var last = vec2f(position_at_share(0u, along_s, cut.share), position_at_share(1u, along_g, cut.share));
            if cut.is_jump {
                last = select(vec2f(last.x, cut.position), vec2f(cut.position, last.y), cut.axis == 0u);
            }
            let middle = 0.5 * (begin + cut.share);
            let at = vec2f(position_at_share(0u, along_s, middle), position_at_share(1u, along_g, middle));
            // Simpson's mean; of a straight axis the middle. Over many decades, where nothing changes, not beyond the ends.
            let mean = at + (2.0 * at - first - last) / 6.0;
            let between = clamp(mean, min(first, last), max(first, last));
            // From the front, as values are given.
            let shares = abs(vec3f(f32(is_turned)) - vec3f(begin, middle, cut.share));
            if all(abs(last - first) <= STRAIGHT * steps) {
                sum = with_piece(sum, ends, shares.xz, first, last);
            } else {
                sum = with_piece(sum, ends, shares.xy, first, between);
                sum = with_piece(sum, ends, shares.yz, between, last);
            }
            begin = cut.share;
            first = last;
        }
        if cut.axis == NO_AXIS || BEHIND_ALL < sum.optical_depth {
            break;
        }
    }
    sum.opacity = one_minus_exp(sum.optical_depth);
    return sum;
}
