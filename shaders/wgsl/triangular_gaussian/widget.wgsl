// Uses: triangular_gaussian/mean_profile, widgets/widget. Fills: nothing.
// Triangular Gaussian: matrix.x is σ, centre.x is s₀.

// δ at front and back, γ at front and back.
fn triangular_ends(index: u32, part: Part) -> vec4f {
    let s = vec2f(value_s(part.front), value_s(part.back));
    let g = vec2f(value_g(part.front), value_g(part.back));
    let sigma = scene.widgets[index].matrix.x;
    return vec4f(s - vec2f(scene.widgets[index].centre.x), sigma * (g - vec2f(scene.widgets[index].centre.y)));
}

fn triangular_depth(index: u32, part: Part) -> f32 {
    let ends = triangular_ends(index, part);
    let offset = vec2f(part_start(part, ends.x, ends.y), part_end(part, ends.x, ends.y));
    let width = vec2f(part_start(part, ends.z, ends.w), part_end(part, ends.z, ends.w));
    return widget_peak(index, part) * triangular_gaussian_mean_profile(offset, width);
}
