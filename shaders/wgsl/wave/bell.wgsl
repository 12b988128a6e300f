// Uses: nothing. Fills: nothing. Asks for: wave_mean_on_flank.
// Mean of a triangle or sine wave over a segment, any number of bands. Phases come split into the nearest foot and the
// signed distance from it. Twin of `lanes::optics::wave::LaneBell::mean`.

struct Bell {
    // 1/w, w the band width.
    inverse_width: f32,
    // Half-width of what the band width leaves.
    reach: f32,
    // Area of half a band.
    half_area: f32,
    // Half-width of what glows under the constant-emitter.
    lit: f32,
    // 1: a sine wave, 0: a triangle wave.
    is_sine: u32,
    // 1: nothing is cut away, w = 1.
    is_full: u32,
}

struct Phase {
    // ⌊φ + ½⌋.
    nearest: f32,
    // φ − nearest.
    offset: f32,
}

// A place on a flank: distances from its foot and from its peak.
struct Spot {
    foot: f32,
    peak: f32,
}

fn wave_distance(bell: Bell, low: Spot, high: Spot) -> f32 {
    return select(low.peak - high.peak, high.foot - low.foot, bell.is_full == 1u);
}

// Area between two places of one flank, `low` the nearer to the foot.
fn wave_flank(bell: Bell, low: Spot, high: Spot) -> f32 {
    if bell.reach <= high.peak {
        return 0.0;
    }
    let clamped = Spot(low.foot, min(low.peak, bell.reach));
    return wave_distance(bell, clamped, high) * wave_mean_on_flank(bell, clamped, high);
}

fn wave_spot(offset: f32) -> Spot {
    return Spot(abs(offset), 0.5 - abs(offset));
}

fn wave_mean(bell: Bell, front: Phase, back: Phase) -> f32 {
    // From the lower to the higher phase.
    let swapped = back.nearest < front.nearest || (back.nearest == front.nearest && back.offset < front.offset);
    var start = front;
    var end = back;
    if swapped {
        start = back;
        end = front;
    }
    let from_rising = 0.0 <= start.offset;
    let to_rising = 0.0 <= end.offset;
    let start_spot = wave_spot(start.offset);
    let end_spot = wave_spot(end.offset);
    // The band of a falling phase is the one before its nearest foot.
    let bands = (end.nearest - start.nearest) + (select(0.0, 1.0, to_rising) - select(0.0, 1.0, from_rising));
    let same_band = bands < 0.5;
    if same_band && from_rising == to_rising {
        // One flank: the mean itself, so that a flat segment is no 0/0.
        var low = end_spot;
        var high = start_spot;
        if from_rising {
            low = start_spot;
            high = end_spot;
        }
        if low.peak <= bell.reach {
            return wave_mean_on_flank(bell, low, high);
        }
        return wave_flank(bell, low, high) / max(wave_distance(bell, low, high), 1e-37);
    }
    // Otherwise areas: from each end to the nearest peak or foot on the way, and whole half-bands.
    let foot = Spot(0.0, 0.5);
    let peak = Spot(0.5, 0.0);
    var from_low = foot;
    var from_high = start_spot;
    if from_rising {
        from_low = start_spot;
        from_high = peak;
    }
    var to_low = end_spot;
    var to_high = peak;
    if to_rising {
        to_low = foot;
        to_high = end_spot;
    }
    let ends = wave_flank(bell, from_low, from_high) + wave_flank(bell, to_low, to_high);
    let end_length = wave_distance(bell, from_low, from_high) + wave_distance(bell, to_low, to_high);
    // Half-bands between: those behind a rising start and before a falling end.
    var halves = 0.0;
    if !same_band {
        halves = (bands - 1.0) * 2.0 + select(0.0, 1.0, from_rising) + select(1.0, 0.0, to_rising);
    }
    return (halves * bell.half_area + ends) / max(halves * 0.5 + end_length, 1e-37);
}
