// Uses: nothing. Fills: nothing. Asks for: glows.
// One slice of the table, from entry `first` on, bilinear. Twin of `optics::integrators::pre_integrated::Bilinear`.

fn glow_bilinear(first: u32, row: f32, column: f32, side: u32) -> vec3f {
    let i = min(u32(row), side - 2u);
    let j = min(u32(column), side - 2u);
    let u = row - f32(i);
    let v = column - f32(j);
    let at = first + i * side + j;
    let low = mix(glow(at), glow(at + 1u), v);
    let high = mix(glow(at + side), glow(at + side + 1u), v);
    return mix(low, high, u).rgb;
}
