// Uses: elementary/power, light/direction. Fills: nothing.
// (1 − |ĝ·view|)^p (Song et al. 2009, section 6.2); 1 where the gradient is 0. `view` has unit length.
// 1 − cos = sin²/(1 + cos): the difference would lose the digits of a gradient along the ray.

fn silhouette_factor(gradient: vec3f, view: vec3f, exponent: f32) -> f32 {
    let g = scaled_direction(gradient);
    let size = length(g);
    if size == 0.0 {
        return 1.0;
    }
    let across = cross(g, view);
    let value = dot(across, across) / (size * (size + abs(dot(g, view))));
    return power(min(value, 1.0), exponent);
}
