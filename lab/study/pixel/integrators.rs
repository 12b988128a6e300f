//! Pixel by each integrator.

use super::record::{IntegratorPixel, mean};
use crate::numbers::Numbers;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_optics::Segment;
use voltet_optics::compositing::Composite;
use voltet_optics::integrators::{Integrator, SegmentIntegrator};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Shading;
use voltet_optics::trace::{Ray, Tracer};

/// Entries a side of tables of three dimensions, where the pipeline does not say: such a table is built in a second.
const CUBE_SIDE: usize = 64;

/// All of them, in their order. Those that the pipeline does not draw with have the numbers that it would have by default.
pub(super) fn all(
    scene: &Scene,
    integrators: &[Integrator],
    tracer: &Tracer,
    rays: &[Ray],
    progress: &dyn Progress,
) -> Result<Vec<IntegratorPixel>> {
    let own = scene.shading.integrator;
    let segments: Vec<Vec<Traced>> = rays.iter().map(|ray| traced(tracer, ray)).collect();
    let alone = voltet_introspect::SegmentProbe::new(scene, progress)?;
    let mut all = Vec::new();
    for (number, kind) in integrators.iter().enumerate() {
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        progress.report("integrators", number as f64 / integrators.len() as f64);
        let is_own = kind.is_kind_of(&own);
        let integrator = if is_own { own } else { usual(kind) };
        let ready = alone.integrator(&Shading { integrator, ..scene.shading });
        let rgba = ready.and_then(|ready| composite_rays(ready.as_ref(), &segments)).map_err(why);
        all.push(IntegratorPixel {
            name: integrator.name(),
            numbers: numbers(&integrator),
            own: is_own,
            rgba,
        });
    }
    Ok(all)
}

/// Reason why an integrator is not supported, without alternatives.
fn why(error: Error) -> String {
    error.got.unwrap_or(error.what)
}

/// A segment with the factors of its opacity and colour.
struct Traced {
    length: f64,
    ends: [Vec<f64>; 2],
    surface: [f64; 2],
}

fn traced(tracer: &Tracer, ray: &Ray) -> Vec<Traced> {
    let of = |crossing| {
        let (length, ends) = tracer.segment(ray, crossing);
        Traced { length, ends, surface: tracer.surface(ray, crossing) }
    };
    tracer.crossings(ray).iter().map(of).collect()
}

/// The pixel: each ray's segments composited, the mean of all.
fn composite_rays(integrator: &dyn SegmentIntegrator, rays: &[Vec<Traced>]) -> Result<[f64; 4]> {
    let of = |ray: &Vec<Traced>| {
        let mut sum = Composite::default();
        for Traced { length, ends: [front, back], surface: [silhouette, light] } in ray {
            let part = integrator.integrate(&Segment {
                length: *length,
                front: [front[0], front[1]],
                back: [back[0], back[1]],
                fields_front: &front[2..],
                fields_back: &back[2..],
            });
            sum.add(part.color.map(|c| c * silhouette * light), part.opacity * silhouette);
        }
        let [r, g, b] = sum.color;
        [r, g, b, sum.opacity()]
    };
    let pixel = mean(rays.iter().map(of));
    match integrator.failure() {
        Some(error) => Err(error.clone()),
        None => Ok(pixel),
    }
}

/// An integrator with the settings that a pipeline does not state.
fn usual(kind: &Integrator) -> Integrator {
    match kind.has_table_of_lengths() {
        true => kind.with("table_size", CUBE_SIDE as f64),
        false => *kind,
    }
}

fn numbers(integrator: &Integrator) -> String {
    let Numbers { tolerance, count, table_size, oversampling, planes } = Numbers::of(integrator);
    let default = Numbers::of(&Integrator::new(integrator.kind()));
    let mut parts = Vec::new();
    parts.extend(tolerance.map(|tolerance| format!("tolerance {tolerance:e}")));
    parts.extend(count.map(|count| format!("{count} pieces")));
    parts.extend(table_size.map(|side| format!("table {side}")));
    parts.extend(unusual(oversampling, default.oversampling).map(|n| format!("oversampling {n}")));
    parts.extend(unusual(planes, default.planes).map(|n| format!("{n} planes an entry")));
    parts.join(", ")
}

/// A number that is not the usual one.
fn unusual(number: Option<usize>, usual: Option<usize>) -> Option<usize> {
    number.filter(|_| number != usual)
}
