// Uses: track. Fills: nothing. Asks for: member_strength.
// A widget that takes part in the ordered integral. Twin of `lanes::optics::overlap::LaneMember`.

struct Member {
    // The part of the segment inside its region, [t₀, t₁]; t₁ ≤ t₀ where there is none.
    range: vec2f,
    // The part where it glows (constant-emitter); [−1, 2] for what breaks there itself.
    window: vec2f,
    // The rate above which it glows (constant-emitter).
    threshold: f32,
}

// The first place behind t at which something of the member changes; `next` is that of its track.
fn member_next_break(member: Member, t: f32, of_track: f32) -> f32 {
    let past = t + PASSED;
    var next = of_track;
    next = select(next, member.window.x, past < member.window.x && member.window.x < next);
    next = select(next, member.window.y, past < member.window.y && member.window.y < next);
    next = select(next, member.range.y, past < member.range.y && member.range.y < next);
    // Before its range only the start matters, after it nothing.
    next = select(next, member.range.x, past < member.range.x);
    return select(next, 2.0, member.range.y <= past || member.range.y <= member.range.x);
}

// 1 at the places that a range holds, else 0.
fn held_by(range: vec2f, at: vec4f) -> vec4f {
    let inside = (vec4f(range.x) <= at) & (at <= vec4f(range.y));
    return select(vec4f(0.0), vec4f(1.0), inside & vec4<bool>(range.x < range.y));
}

// Light and rate of a member of constant colour at four places: red, green, blue and rate in the columns.
fn member_light(member: Member, color: vec3f, at: vec4f, rates: vec4f) -> mat4x4f {
    let present = rates * held_by(member.range, at);
    let strength = member_strength(member, at, present);
    return mat4x4f(strength * color.r, strength * color.g, strength * color.b, present);
}
