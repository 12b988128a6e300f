// Uses: overlap/member. Fills: member_strength.
// Light per t of a member where it is not hidden: ρ D (Williams & Max 1992).

fn member_strength(member: Member, at: vec4f, rates: vec4f) -> vec4f {
    return rates;
}
