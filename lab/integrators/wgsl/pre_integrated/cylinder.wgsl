// Uses: nothing. Fills: nothing.
// The mapping of the table to planes through its diagonal s_f = s_b, D = 0 (Roettger & Ertl 2002, section 4). Ends and
// length each over [0, 1]. Twin of `optics::integrators::pre_integrated_cylindrical`.

// f, Eq. 9: (α, s, t) to (s_f, s_b, l).
fn from_cylinder(angle: f32, s: f32, t: f32) -> vec3f {
    if angle <= 0.25 {
        return vec3f(t + s, t, 4.0 * angle * s);
    }
    if angle <= 0.75 {
        return vec3f(t + (2.0 - 4.0 * angle) * s, t, s);
    }
    return vec3f(t - s, t, 4.0 * (1.0 - angle) * s);
}

// f⁻¹, Eq. 10: (s_f, s_b, l) to (α, s, t). At s_f = s_b, l = 0 every α serves.
fn to_cylinder(front: f32, back: f32, length: f32) -> vec3f {
    let fall = front - back;
    let size = max(abs(fall), length);
    if size <= 0.0 {
        return vec3f(0.5, 0.0, back);
    }
    // Which of the two is the smaller decides the branch; the quotient is then at most 1.
    let long = abs(fall) <= length;
    let quotient = 0.25 * min(abs(fall), length) / size;
    let from_start = select(quotient, 0.5 - quotient, long);
    return vec3f(select(from_start, 1.0 - from_start, fall < 0.0), size, back);
}
