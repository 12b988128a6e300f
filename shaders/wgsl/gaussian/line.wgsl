// Uses: gaussian/path. Fills: nothing.
// The path of a Gaussian of one quantity.

fn gaussian_line_path(front: f32, back: f32) -> GaussianPath {
    let step = back - front;
    let inverse = gaussian_inverse_length(step * step);
    let length = step * step * inverse;
    let direction = step * inverse;
    let flat = inverse == 0.0;
    return GaussianPath(front * direction, back * direction, length, inverse, select(0.0, front * front, flat));
}
