// Uses: track. Fills: nothing. Asks for: members, piece_light.
// N equal pieces whose ends are classified, colour and extinction linear in each (Song et al. 2009, sections 3.3.2 and
// 5; Moreland & Angel 2004). Colour, and the optical depth in the fourth component.
// Twin of `optics::integrators::Segments`.

fn linear_pieces(members: Members, count: u32) -> vec4f {
    let step = 1.0 / f32(count);
    var color = vec3f(0.0);
    var depth = 0.0;
    var ahead = transpose(members_light(members, vec4f(0.0)));
    var front = ahead[0];
    for (var i = 0u; i < count; i += 4u) {
        // A quotient may pass 1, where regions end.
        let at = min((vec4f(f32(i)) + vec4f(1.0, 2.0, 3.0, 4.0)) / f32(count), vec4f(1.0));
        var samples = transpose(members_light(members, at));
        for (var k = 0u; k < min(4u, count - i); k++) {
            let back = samples[k];
            if depth < OPAQUE_DEPTH {
                color += exponential(-depth) * piece_light(front, back, step);
            }
            depth += 0.5 * step * (front.a + back.a);
            front = back;
        }
    }
    return vec4f(color, depth);
}
