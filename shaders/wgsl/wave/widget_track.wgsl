// Uses: wave/track, wave/widget. Fills: nothing.
// A wave over the whole segment.

fn wave_widget_track(index: u32, part: Part) -> WaveTrack {
    let front = wave_phase(index, plane(part.front));
    let back = wave_phase(index, plane(part.back));
    return wave_track(widget_bell(index), front, back, widget_rate(index, part));
}
