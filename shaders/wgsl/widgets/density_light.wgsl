// Uses: elementary/one_minus_exp, widgets/widget. Fills: nothing.
// A widget of constant colour alone under the density-emitter: C = c (1 − e^(−T)), exactly.

fn density_light(index: u32, depth: f32) -> vec3f {
    return scene.widgets[index].color * one_minus_exp(depth);
}
