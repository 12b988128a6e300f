//! Values on rays of the picture, weighted by their contribution to it.

use super::query::{Query, QueryRun};
use super::request::VolumeSource;
use super::values;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{Observer, TransferFunctionSpec, Value, diagonal};
use voltet_optics::integrators::Integrator;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_optics::trace::Tracer;
use voltet_optics::{CompiledTransferFunction, WidgetBlend};

/// Places of the picture that are asked about.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProbeQuery {
    pub source: VolumeSource,
    /// The nodes that give the transfer function and the camera.
    pub look: String,
    pub camera: String,
    /// Places, in heights of the picture from its middle, to the right and up.
    pub places: Vec<[f64; 2]>,
}

/// Values on the probed rays.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct PixelProbe {
    /// Rays that were walked; 0 where the values are those of a section.
    pub rays: usize,
    /// Values [s, g] with their shares of what is seen (or of the way, where nothing is).
    pub values: Vec<([f64; 2], f64)>,
    /// The point where the most is seen, world units; `None` where no ray meets a cell.
    pub point: Option<DVec3>,
    /// Opacity of the rays, mean.
    pub opacity: f64,
}

impl ProbeQuery {
    /// Walks the rays.
    fn walk(&self, values: &[Value], observer: &dyn Observer) -> Result<PixelProbe> {
        let mut volume: Option<Arc<Volume>> = None;
        let mut look: Option<Arc<TransferFunctionSpec>> = None;
        let mut camera: Option<Arc<Camera>> = None;
        for value in values {
            match value {
                Value::TransferFunction(of) => look = Some(of.clone()),
                Value::Camera(of) => camera = Some(of.clone()),
                other => volume = other.volume().transpose()?,
            }
        }
        let (Some(volume), Some(look), Some(camera)) = (volume, look, camera) else {
            return Err(Error::run("the picture's volume, transfer function and camera are not all known"));
        };
        let transfer_function = look.for_diagonal(diagonal(&volume.grid.points));
        let camera = Camera { samples: 1, ..*camera };
        let scene = Scene {
            volume,
            transfer_function: Arc::new(transfer_function),
            camera,
            // What is seen, as the values count: light and silhouettes change colours.
            shading: Shading {
                integrator: Integrator::ANALYTIC,
                overlap: WidgetBlend::Exact,
                silhouette: None,
                light: None,
            },
            order: VisibilityOrder::Exact,
        };
        let forms = CompiledTransferFunction::new(&scene.transfer_function)?;
        let tracer = Tracer::new(&scene, Box::new(forms))?;
        let mut probed = PixelProbe { rays: self.places.len(), ..PixelProbe::default() };
        let (mut seen_most, [width, height]) = (0.0, camera.size.map(f64::from));
        for place in &self.places {
            if observer.cancelled() {
                return Err(Error::cancelled());
            }
            let ray = tracer.ray(0.5 * width + place[0] * height, (0.5 - place[1]) * height);
            let walk = tracer.walk(&ray)?;
            probed.opacity += walk.seen.opacity / self.places.len() as f64;
            let all: f64 = walk.steps.iter().map(|step| step.contribution()[3]).sum();
            let way: f64 = walk.steps.iter().map(|step| step.length).sum();
            let [start, direction] = tracer.world(&ray).map(DVec3::from);
            for step in &walk.steps {
                let share = if all > 1e-6 { step.contribution()[3] / all } else { step.length / way };
                let value = |k: usize| {
                    let (front, back) = (step.front.get(k).copied(), step.back.get(k).copied());
                    0.5 * front.unwrap_or(0.0) + 0.5 * back.unwrap_or(0.0)
                };
                probed.values.push(([value(0), value(1)], share / self.places.len() as f64));
                if share > seen_most {
                    seen_most = share;
                    let middle = 0.5 * (step.distance[0] + step.distance[1]);
                    probed.point = Some(start + middle * direction);
                }
            }
        }
        Ok(probed)
    }
}

impl Query for ProbeQuery {
    type Reply = Arc<PixelProbe>;
    // In a newer picture the values lie elsewhere.
    const WAITS: bool = false;

    fn answer(&self, run: &mut QueryRun) -> Result<Arc<PixelProbe>> {
        let others = [("transfer-function", &self.look), ("camera", &self.camera)];
        let others = others.map(|(port, node)| (port.to_string(), node.clone()));
        let nodes = self.source.nodes(&values::NODE, Vec::new(), others.to_vec())?;
        self.walk(&self.source.feed(run, &nodes)?, run.observer).map(Arc::new)
    }
}

impl PixelProbe {
    /// Mean and covariance of the values by their shares; `None` where there are none.
    pub fn moments(&self) -> Option<([f64; 2], [[f64; 2]; 2])> {
        let total: f64 = self.values.iter().map(|(_, share)| share).sum();
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let mean =
            |of: &dyn Fn([f64; 2]) -> f64| self.values.iter().map(|(v, w)| w * of(*v)).sum::<f64>() / total;
        let centre = [mean(&|v| v[0]), mean(&|v| v[1])];
        let covariance = |i: usize, j: usize| mean(&|v| (v[i] - centre[i]) * (v[j] - centre[j]));
        let mixed = covariance(0, 1);
        Some((centre, [[covariance(0, 0).max(0.0), mixed], [mixed, covariance(1, 1).max(0.0)]]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_values_by_their_shares() {
        let values = vec![([1.0, 10.0], 1.0), ([3.0, 30.0], 1.0), ([50.0, 5.0], 0.0)];
        let (centre, covariance) = PixelProbe { values, ..PixelProbe::default() }.moments().unwrap();
        assert_eq!((centre, covariance), ([2.0, 20.0], [[1.0, 10.0], [10.0, 100.0]]));
        let (_, of_one) =
            PixelProbe { values: vec![([7.0, 2.0], 0.3)], ..PixelProbe::default() }.moments().unwrap();
        assert!(of_one.as_flattened().iter().all(|x| x.abs() < 1e-20), "{of_one:?}");
        assert!(PixelProbe::default().moments().is_none());
    }
}
