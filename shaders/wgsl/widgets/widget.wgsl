// Uses: nothing. Fills: nothing. Asks for: scene, part.
// What every widget has. `index` counts the scene's widgets.

// ρ₀ D of the whole segment.
fn widget_rate(index: u32, part: Part) -> f32 {
    return scene.widgets[index].extinction * part.length;
}

// ρ₀ D of the widget's part of the segment.
fn widget_peak(index: u32, part: Part) -> f32 {
    return widget_rate(index, part) * part_share(part);
}

// D/U of the whole segment: what turns ∫ e^(−T) dt into the light of the constant-emitter.
fn glow_scale(part: Part) -> f32 {
    return scene.per_unit * part.length;
}
