// Uses: fields. Fills: nothing.
// A triangular Gaussian over fields, exp(−|q|²/m²) with q and m linear along the segment: q/m moves along a straight line,
// so that the profile is e^(−h²) exp(−(δ/γ)²) with δ = q·e, γ = m, e the unit vector along that line and h its distance
// from 0. Twin of `lanes::optics::triangular_gaussian::LaneTriangularPath`.

struct TriangularPath {
    // δ at front and back.
    offset: vec2f,
    // γ at front and back.
    width: vec2f,
    // h².
    offset_squared: f32,
}

fn triangular_fields_largest(v: Fields) -> f32 {
    var largest = 0.0;
    for (var i = 0u; i < 8u; i++) {
        largest = max(largest, abs(v[i]));
    }
    return largest;
}

fn triangular_fields_path(front: Fields, back: Fields, width: vec2f) -> TriangularPath {
    // The direction of q_b m_f − q_f m_b; a point that stays where it is moves in any direction, so in that of its own.
    var direction = Fields();
    for (var i = 0u; i < 8u; i++) {
        direction[i] = (back[i] - front[i]) * width.x - front[i] * (width.y - width.x);
    }
    var largest = triangular_fields_largest(direction);
    if largest <= 0.0 {
        direction = front;
        if triangular_fields_largest(front) < triangular_fields_largest(back) {
            direction = back;
        }
        largest = triangular_fields_largest(direction);
    }
    var squared = 0.0;
    for (var i = 0u; i < 8u; i++) {
        direction[i] /= max(largest, 1e-37);
        squared += direction[i] * direction[i];
    }
    let inverse = 1.0 / sqrt(max(squared, 1e-37));
    var offset = vec2f(0.0);
    for (var i = 0u; i < 8u; i++) {
        direction[i] *= inverse;
        offset += vec2f(front[i], back[i]) * direction[i];
    }
    // h at the end with the smaller |δ/γ|, of those with a width.
    let at_front = 0.0 < width.x && (width.y <= 0.0 || abs(offset.x * width.y) <= abs(offset.y * width.x));
    let x = select(offset.y, offset.x, at_front);
    let m = max(select(width.y, width.x, at_front), 1e-37);
    var offset_squared = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let across = min(abs(select(back[i], front[i], at_front) - x * direction[i]) / m, 1e9);
        offset_squared += across * across;
    }
    return TriangularPath(offset, width, offset_squared);
}
