// Uses: piecewise_linear/emission, piecewise_linear/widget. Fills: nothing.
// Piecewise-linear widget alone under the density-emitter.

fn piecewise_density_light(index: u32, count: u32, part: Part) -> vec3f {
    let s = piecewise_ends(part);
    return points_emission(widget_points(index, count), s.x, s.y, widget_peak(index, part)).rgb;
}
