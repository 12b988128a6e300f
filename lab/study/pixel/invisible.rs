//! Reasons for a ray that shows nothing.

use voltet_optics::scene::Scene;
use voltet_optics::trace::{Ray, Tracer, Walk};

/// Smallest value that shows in 8 bits.
const HALF_STEP: f64 = 0.5 / 255.0;

/// A sentence for a ray without opacity and colour that show; `None` for others.
pub(super) fn why(tracer: &Tracer, ray: &Ray, walk: &Walk, scene: &Scene) -> Option<String> {
    let most = walk.seen.color.iter().copied().fold(walk.seen.opacity, f64::max);
    if most >= HALF_STEP {
        return None;
    }
    if walk.steps.is_empty() {
        let cut = tracer.cut_away(ray);
        return Some(match cut {
            0 => "the ray meets no cell of the grid".into(),
            1 => "the one cell on the ray lies before the near plane".into(),
            cut => format!("all {cut} cells on the ray lie before the near plane"),
        });
    }
    let range = |q: usize| {
        let values = walk.steps.iter().flat_map(|step| [step.front[q], step.back[q]]);
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        format!("{low:.6} to {high:.6}")
    };
    let met = format!("the ray crosses {} cells with s from {}", walk.steps.len(), range(0));
    let met = match scene.transfer_function.uses_gradient_magnitude() {
        true => format!("{met} and g from {}", range(1)),
        false => met,
    };
    let depth: f64 = walk.steps.iter().map(|step| step.part.optical_depth).sum();
    Some(match () {
        () if scene.transfer_function.widgets.is_empty() => {
            format!("{met}; the transfer function has no widgets")
        }
        () if depth < HALF_STEP && most > 0.0 => {
            format!("{met}, where the widgets hardly absorb: an optical depth of {depth:.3e} in all")
        }
        () if depth > 0.0 => format!("{met}; silhouettes take most of its optical depth of {depth:.3e}"),
        () => format!("{met}; no widget takes any of these values"),
    })
}
