// Uses: overlap/member, track. Fills: nothing. Asks for: members.
// Several widgets on one segment: the ordered integral ∫ Σ cᵢ ρᵢ e^(−T) dl. A panel ends at the breaks of every widget
// and holds a depth of at most PANEL_DEPTH. Twin of `optics::lanes::overlap::ordered`.

fn ordered(members: Members) -> vec3f {
    var walk = walk_start();
    var color = vec3f(0.0);
    for (var i = 0u; i < PANELS_MOST && walk_is_open(walk); i++) {
        let next = members_next_break(members, walk.t);
        let dt = walk_panel(walk, next);
        let low = members_light(members, vec4f(walk.t) + dt * NODES_LOW);
        let high = members_light(members, vec4f(walk.t) + dt * NODES_HIGH);
        let seen = walk_take(&walk, next, dt, Points(low[3], high[3]));
        color += vec3f(
            dot(seen.low, low[0]) + dot(seen.high, high[0]),
            dot(seen.low, low[1]) + dot(seen.high, high[1]),
            dot(seen.low, low[2]) + dot(seen.high, high[2]),
        );
    }
    return color;
}
