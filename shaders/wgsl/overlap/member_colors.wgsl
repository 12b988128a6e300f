// Uses: overlap/member. Fills: nothing.
// Light and rate of a member whose colour varies along the segment.

fn member_colors_light(member: Member, colors: mat3x4f, at: vec4f, rates: vec4f) -> mat4x4f {
    let present = rates * held_by(member.range, at);
    let strength = member_strength(member, at, present);
    return mat4x4f(strength * colors[0], strength * colors[1], strength * colors[2], present);
}
