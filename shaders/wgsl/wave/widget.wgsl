// Uses: wave/bell, widgets/widget. Fills: nothing.
// Triangle and sine waves: matrix.xy is the phase per unit of s and g, matrix.z the phase at 0 without whole bands.

fn widget_bell(index: u32) -> Bell {
    let bell = scene.widgets[index].bell;
    let kind = scene.widgets[index].bell_kind;
    return Bell(bell.x, bell.y, bell.z, bell.w, kind & 1u, (kind >> 1u) & 1u);
}

fn wave_phase(index: u32, v: vec2f) -> Phase {
    let wave = scene.widgets[index].matrix;
    let nearest = round(dot(wave.xy, v) + wave.z);
    // Once more with the whole bands taken away first, so that they cost no digits.
    return Phase(nearest, wave.x * v.x + (wave.y * v.y + (wave.z - nearest)));
}

// The phase where the widget's part begins or ends.
fn wave_start(index: u32, part: Part) -> Phase {
    let front = plane(part.front);
    let back = plane(part.back);
    return wave_phase(index, vec2f(part_start(part, front.x, back.x), part_start(part, front.y, back.y)));
}

fn wave_end(index: u32, part: Part) -> Phase {
    let front = plane(part.front);
    let back = plane(part.back);
    return wave_phase(index, vec2f(part_end(part, front.x, back.x), part_end(part, front.y, back.y)));
}

fn wave_depth(index: u32, part: Part) -> f32 {
    return widget_peak(index, part)
        * wave_mean(widget_bell(index), wave_start(index, part), wave_end(index, part));
}
