// Uses: nothing. Fills: nothing.
// Front-to-back compositing: C += τ C_seg, τ ← τ (1 − A_seg). A is the sum of τ A_seg while below ½, 1 − τ beyond.
// Twin of `optics::compositing`.

struct Composite {
    // C, premultiplied.
    color: vec3f,
    // Σ τ A_seg.
    opacity: f32,
    // τ = Π (1 − A_seg).
    transparency: f32,
}

fn composite_start() -> Composite {
    return Composite(vec3f(0.0), 0.0, 1.0);
}

fn composite_add(behind: Composite, color: vec3f, opacity: f32) -> Composite {
    let seen = behind.transparency;
    return Composite(behind.color + seen * color, behind.opacity + seen * opacity, seen * (1.0 - opacity));
}

fn composite_opacity(composite: Composite) -> f32 {
    return select(1.0 - composite.transparency, composite.opacity, composite.opacity < 0.5);
}
