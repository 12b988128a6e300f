// Uses: wave/bell. Fills: wave_mean_on_flank.
// Mean of max(0, 1 − (1 − tri(φ))/w) between two places of one flank (Song et al. 2009, section 4.3).

fn triangle_mean_on_flank(bell: Bell, low: Spot, high: Spot) -> f32 {
    let cut = max((bell.reach - low.peak) + (bell.reach - high.peak), 0.0) * bell.inverse_width;
    return select(cut, low.foot + high.foot, bell.is_full == 1u);
}
