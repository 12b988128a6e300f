// Uses: overlap/member. Fills: member_strength.
// Light per t of a member where it is not hidden, without D/U: 1 where the profile exceeds the cutoff (Song et al. 2009).

fn member_strength(member: Member, at: vec4f, rates: vec4f) -> vec4f {
    let lit = select(vec4f(0.0), vec4f(1.0), vec4f(member.threshold) < rates);
    return lit * held_by(member.window, at) * held_by(member.range, at);
}
