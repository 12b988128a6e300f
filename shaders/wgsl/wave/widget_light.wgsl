// Uses: wave/glow, wave/widget. Fills: nothing.
// Wave alone under the constant-emitter.

fn wave_light(index: u32, part: Part) -> vec3f {
    let peak = widget_peak(index, part);
    let light = wave_glow(widget_bell(index), wave_start(index, part), wave_end(index, part), peak);
    return scene.widgets[index].color * (glow_scale(part) * part_share(part) * light);
}
