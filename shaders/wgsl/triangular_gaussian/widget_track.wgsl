// Uses: triangular_gaussian/track, triangular_gaussian/widget. Fills: nothing.
// A triangular Gaussian over the whole segment.

fn triangular_track(index: u32, part: Part) -> TriangularTrack {
    let ends = triangular_ends(index, part);
    return TriangularTrack(ends.xy, ends.zw, widget_rate(index, part));
}
