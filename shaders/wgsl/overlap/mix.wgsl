// Uses: elementary/mean_transmittance. Fills: nothing.
// Share of a widget's own light that is left when all widgets of a segment absorb on the mean (Kniss et al. 2003,
// Eq. 15). For the density-emitter the light is then c Tᵢ/T (1 − e^(−T)).

fn mix_share(own_depth: f32, depth: f32) -> f32 {
    return mean_transmittance(depth) / mean_transmittance(own_depth);
}
