//! The native engine, as the shared scenes ask for it.

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_cpu::{self as engine, Cells, Counts, Traversal};
use voltet_optics::engine::{AdapterRequest, RenderOptions};
use voltet_optics::integrators;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, within};

/// The engine; rays go from cell to cell wherever that serves.
pub struct Tested;

/// Engine that projects all cells.
pub struct ByCells;

impl Engine for Tested {
    fn picture(&self, scene: &NamedScene, shading: &Shading) -> Option<Picture> {
        let picture = draw(scene, shading, |cells| cells.traversal = Traversal::RayCast).0;
        let name = format!("{} from segments kept", scene.name);
        within(&name, &kept(scene, shading), &picture, KEPT);
        Some(picture)
    }

    fn serves(&self, integrator: &Integrator, look: &TransferFunction) -> bool {
        integrators::can_serve(integrator, look).is_ok()
    }

    fn rounding(&self) -> f64 {
        1e-6
    }

    /// Crossings keep their digits.
    fn grazing(&self) -> f64 {
        ORDINARY
    }
}

impl Engine for ByCells {
    fn picture(&self, scene: &NamedScene, shading: &Shading) -> Option<Picture> {
        Some(picture(scene, shading))
    }

    fn serves(&self, integrator: &Integrator, look: &TransferFunction) -> bool {
        Tested.serves(integrator, look)
    }

    fn rounding(&self) -> f64 {
        Tested.rounding()
    }

    fn grazing(&self) -> f64 {
        Tested.grazing()
    }
}

fn draw(scene: &NamedScene, shading: &Shading, set: impl Fn(&mut Cells)) -> (Picture, Counts) {
    let draw = || -> Result<(Picture, Counts)> {
        let mut cells = engine::cull(&scene.volume, &scene.look, &scene.camera, &NoProgress)?;
        set(&mut cells);
        engine::draw(&cells, &scene.look, &scene.camera, shading, &NoProgress)
    };
    draw().unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// The picture from projected cells; the same, bit by bit, where each tile's are projected when it is composited.
pub fn picture(scene: &NamedScene, shading: &Shading) -> Picture {
    let by_cells = |most_at_once: Option<usize>| {
        let (picture, counts) = draw(scene, shading, |cells| {
            cells.traversal = Traversal::Project;
            cells.max_resident_cells = most_at_once.unwrap_or(cells.max_resident_cells);
        });
        // Cells without a volume are known when they are projected.
        (picture, Counts { cells_projected: 0, ..counts })
    };
    let [whole, in_windows] = [None, Some(0)].map(by_cells);
    let bits = |picture: &Picture| picture.rgba.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(in_windows.1, whole.1, "{}: in windows", scene.name);
    assert!(bits(&in_windows.0) == bits(&whole.0), "{}: another picture in windows", scene.name);
    whole.0
}

/// Tolerance for culled cells and for the rounding of values that are counted from elsewhere.
const KEPT: f64 = 1e-5;

/// The picture after others of the same view, with other widgets: from segments that were kept, where they serve.
fn kept(scene: &NamedScene, shading: &Shading) -> Picture {
    let NamedScene { volume, look, camera, .. } = scene;
    let native = engine::ENGINE.open(&AdapterRequest::default()).expect("opens");
    let prepared = native.prepare(volume).expect("has an extent");
    let draw = |share: f64| {
        let mut transfer_function = look.clone();
        transfer_function.widgets.iter_mut().for_each(|widget| widget.color[0] *= share);
        let scene = Scene::new(
            volume.clone(),
            Arc::new(transfer_function),
            *camera,
            *shading,
            VisibilityOrder::Exact,
        );
        prepared
            .draw(&scene, &RenderOptions { preview: true, ..RenderOptions::default() }, &NoProgress)
            .expect("draws")
            .picture
    };
    [0.5, 0.75].into_iter().for_each(|share| drop(draw(share)));
    draw(1.0)
}
