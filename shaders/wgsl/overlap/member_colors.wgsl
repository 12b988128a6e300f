// Uses: overlap/member. Fills: nothing.
// Light and rate of a member whose colour varies along the segment.

fn member_colors_light(member: Member, colors: mat3x4f, at: vec4f, rates: vec4f) -> mat4x4f {
    let present = rates * held_by(member.range, at);
    let strength = member_strength(member, at, present);
    return mat4x4f(strength * colors[0], strength * colors[1], strength * colors[2], present);
}

// The same from red, green, blue and alpha at four places, for a rate of `peak` × alpha.
fn member_texels_light(member: Member, texels: mat4x4f, at: vec4f, peak: f32) -> mat4x4f {
    return member_colors_light(member, mat3x4f(texels[0], texels[1], texels[2]), at, peak * texels[3]);
}
