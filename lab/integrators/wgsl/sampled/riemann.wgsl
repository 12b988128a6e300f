// Uses: elementary/mean_transmittance, track. Fills: nothing. Asks for: members.
// Point samples at (i + ½)/N, each a homogeneous piece with its own absorption (Kniss et al. 2003, Figure 1; Roettger &
// Ertl 2002, Eq. 6, with E₁). Colour, and the optical depth in the fourth component.
// Twin of `optics::integrators::Riemann`.

fn riemann(members: Members, count: u32) -> vec4f {
    let step = 1.0 / f32(count);
    var color = vec3f(0.0);
    var depth = 0.0;
    for (var i = 0u; i < count; i += 4u) {
        let at = (vec4f(f32(i)) + vec4f(0.5, 1.5, 2.5, 3.5)) / f32(count);
        // Places behind the back count for nothing.
        let inside = select(vec4f(0.0), vec4f(step), at < vec4f(1.0));
        var samples = transpose(members_light(members, at));
        for (var k = 0u; k < 4u; k++) {
            let sample = samples[k] * inside[k];
            if depth < OPAQUE_DEPTH {
                color += exponential(-depth) * mean_transmittance(sample.a) * sample.rgb;
            }
            depth += sample.a;
        }
    }
    return vec4f(color, depth);
}
