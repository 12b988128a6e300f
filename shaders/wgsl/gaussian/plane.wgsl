// Uses: gaussian/path. Fills: nothing.
// The path of a Gaussian over the (s, g) plane.

fn gaussian_plane_path(front: vec2f, back: vec2f) -> GaussianPath {
    let step = back - front;
    let inverse = gaussian_inverse_length(dot(step, step));
    let direction = step * inverse;
    let a = dot(front, direction);
    let b = dot(back, direction);
    // h from the end nearer to the foot, as a vector: never |q|² − a².
    let nearer = abs(a) < abs(b);
    let across = select(back, front, nearer) - select(b, a, nearer) * direction;
    return GaussianPath(a, b, dot(step, step) * inverse, inverse, dot(across, across));
}
