// Uses: adaptive/four_points, overlap/member, track. Fills: nothing. Asks for: members, stretch_light.
// The ordered integral to a tolerance, by panels of 4 points: the error of one is of eighth order in its length, so a share
// of the way to the next break, the same on the whole segment, keeps the sum of the errors under the tolerance; and what
// cannot be seen beside it is left out. Colours are without D/U. Twin of `optics::integrators::Adaptive`, whose steps it
// does not repeat: all invocations of a group take the same road.

// Error of 4 points on a whole panel between breaks, as a share of the panel's stake: five times the largest found (a
// test measures it, and how it falls with the length).
const FOUR_POINTS_ERROR = 5e-3;
// (0.35)⁸: shorter panels err by less than 32 bits round.
const SHARE_LEAST = 2e-4;

// The share of the way to a break, for a tolerance and the light of all that is on the segment.
fn march_share(tolerance: f32, brightest: f32, depth: f32) -> f32 {
    let error = FOUR_POINTS_ERROR * brightest * stretch_light(1.0, depth) * stake_of_light(depth);
    let share = clamp(tolerance / max(error, 1e-37), SHARE_LEAST, 1.0);
    return sqrt(sqrt(sqrt(share)));
}

// The panel before: its length, and the break that it went towards.
struct MarchStep {
    length: f32,
    next: f32,
}

// Length of the next panel; towards the same break it is not shorter than the one before, but for the last.
fn march_panel(walk: Walk, next: f32, share: f32, before: MarchStep) -> f32 {
    let whole = walk_panel(walk, next);
    let same = abs(next - before.next) < 4.0 * PASSED;
    return max(share * whole, select(0.0, min(whole, before.length), same));
}

// `depth` is that of the whole segment, `brightest` the largest channel that a unit of depth or length can give.
fn march(members: Members, depth: f32, tolerance: f32, brightest: f32) -> vec3f {
    let share = march_share(tolerance, brightest, depth);
    var walk = walk_start();
    var before = MarchStep(0.0, -1.0);
    var color = vec3f(0.0);
    for (var i = 0u; i < PANELS_MOST && walk_is_open(walk); i++) {
        let behind = max(depth - walk.depth, 0.0);
        if brightest * exponential(-walk.depth) * stretch_light(1.0 - walk.t, behind) <= 1e-3 * tolerance {
            break;
        }
        let next = members_next_break(members, walk.t);
        let dt = march_panel(walk, next, share, before);
        let values = members_light(members, vec4f(walk.t) + dt * FOUR_NODES);
        let held = dt * dot(values[3], FOUR_WEIGHTS);
        before = MarchStep(0.0, -1.0);
        if !walk_shortens(&walk, dt, held, share) {
            color += four_points_light(values, dt, walk.depth);
            walk_advance(&walk, next, dt, held, values[3].w);
            before = MarchStep(dt, next);
        }
    }
    return color;
}
