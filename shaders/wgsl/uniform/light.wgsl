// Uses: elementary/mean_transmittance, widgets/widget. Fills: nothing.
// Uniform widget alone under the constant-emitter.

fn uniform_light(index: u32, part: Part, depth: f32) -> vec3f {
    return scene.widgets[index].color * (glow_scale(part) * part_share(part) * mean_transmittance(depth));
}
