// Uses: gaussian/glow, widgets/widget. Fills: nothing.
// Gaussian alone under the constant-emitter, from the path over the widget's part.

fn gaussian_light(index: u32, part: Part, path: GaussianPath) -> vec3f {
    let light = gaussian_glow(path, widget_peak(index, part), scene.level);
    return scene.widgets[index].color * (glow_scale(part) * part_share(part) * light);
}
