// Uses: widgets/widget. Fills: nothing.
// Uniform widget (Song et al. 2009, section 4.1).

fn uniform_depth(index: u32, part: Part) -> f32 {
    return widget_peak(index, part);
}
