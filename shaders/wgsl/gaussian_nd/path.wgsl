// Uses: fields, gaussian/path. Fills: nothing.
// The path of a Gaussian over up to 8 fields; unused components are 0 (Kniss et al. 2003, Eq. 11).

fn gaussian_fields_path(front: Fields, back: Fields) -> GaussianPath {
    var squared = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let step = back[i] - front[i];
        squared += step * step;
    }
    let inverse = gaussian_inverse_length(squared);
    var a = 0.0;
    var b = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let direction = (back[i] - front[i]) * inverse;
        a += front[i] * direction;
        b += back[i] * direction;
    }
    // h from the end nearer to the foot, as a vector: never |q|² − a².
    let nearer = abs(a) < abs(b);
    let foot = select(b, a, nearer);
    var offset = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let across = select(back[i], front[i], nearer) - foot * ((back[i] - front[i]) * inverse);
        offset += across * across;
    }
    return GaussianPath(a, b, squared * inverse, inverse, offset);
}
