// Uses: piecewise_linear/glow, piecewise_linear/widget. Fills: nothing.
// Piecewise-linear widget alone under the constant-emitter; matrix.x is the extinction above which it glows.

fn piecewise_light(index: u32, count: u32, part: Part) -> vec3f {
    let s = piecewise_ends(part);
    let points = widget_points(index, count);
    let glow = points_glow(points, s.x, s.y, widget_peak(index, part), scene.widgets[index].matrix.x);
    return glow.rgb * (glow_scale(part) * part_share(part));
}
