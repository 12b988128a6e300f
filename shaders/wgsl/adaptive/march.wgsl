// Uses: adaptive/four_points, elementary/exponential, overlap/panel. Fills: nothing. Asks for: members, stretch_light.
// The ordered integral to a tolerance: from front to back, each panel of 4 points where their error keeps within its part
// of what is left of the tolerance, else of 8, which leave the working precision; to where what is left to see does not
// matter. Colours are without D/U. Twin of `optics::integrators::Adaptive`, whose steps it does not repeat.

// Error of 4 points as a share of a panel's stake: five times the largest found on panels between breaks (a test
// measures it).
const FOUR_POINTS_ERROR = 7e-3;

// The error that a stretch may have of what is left: its part of the light that is.
fn march_allowed(left: f32, rest: f32, behind: f32, dt: f32, held: f32) -> f32 {
    if rest <= dt {
        return left;
    }
    let whole = stretch_light(rest, max(behind, held));
    return left * min(stretch_light(dt, held) / max(whole, 1e-37), 1.0);
}

// `depth` is that of the whole segment, `brightest` the largest channel that a unit of depth or length can give.
fn march(members: Members, depth: f32, tolerance: f32, brightest: f32) -> vec3f {
    var walk = walk_start();
    var color = vec3f(0.0);
    var left = tolerance;
    for (var i = 0u; i < PANELS_MOST && walk_is_open(walk); i++) {
        let seen = brightest * exponential(-walk.depth);
        let rest = 1.0 - walk.t;
        let behind = max(depth - walk.depth, 0.0);
        if seen * stretch_light(rest, behind) <= 1e-3 * left {
            break;
        }
        let next = members_next_break(members, walk.t);
        let dt = walk_panel(walk, next);
        let four = members_light(members, vec4f(walk.t) + dt * FOUR_NODES);
        let held = dt * dot(four[3], FOUR_WEIGHTS);
        if walk_shortens(&walk, dt, held) {
            continue;
        }
        let error = FOUR_POINTS_ERROR * seen * panel_stake(dt, held);
        if error <= march_allowed(left, rest, behind, dt, held) {
            color += four_points_light(four, dt, walk.depth);
            walk_advance(&walk, next, dt, held, four[3].w);
            left -= error;
        } else {
            color += ordered_panel(members, &walk, next, dt);
        }
    }
    return color;
}
