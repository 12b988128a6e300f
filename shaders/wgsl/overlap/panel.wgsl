// Uses: overlap/member, track. Fills: nothing. Asks for: members.
// A panel of 8 points over several widgets. Twin of that of `lanes::optics::overlap::ordered`.

// Light of the next panel, 0 if it was too deep and is shortened.
fn ordered_panel(members: Members, walk: ptr<function, Walk>, next: f32, dt: f32) -> vec3f {
    let t = vec4f((*walk).t);
    let low = members_light(members, t + dt * NODES_LOW);
    let high = members_light(members, t + dt * NODES_HIGH);
    let seen = walk_take(walk, next, dt, Points(low[3], high[3]));
    return vec3f(
        dot(seen.low, low[0]) + dot(seen.high, high[0]),
        dot(seen.low, low[1]) + dot(seen.high, high[1]),
        dot(seen.low, low[2]) + dot(seen.high, high[2]),
    );
}
