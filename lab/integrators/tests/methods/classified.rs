//! Classified points serve the pictures that they were made for, and no others.

use crate::found::shading;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_integrators::VERTEX_SAMPLED;
use voltet_optics::engine::{AdapterRequest, PreparedVolume, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::VisibilityOrder;
use voltet_testing::pictures::grids::{cube, smooth};
use voltet_testing::pictures::looks::outside;
use voltet_testing::segments::{MODELS, gaussian, look};

fn ready(volume: &Arc<Volume>) -> Arc<dyn PreparedVolume> {
    let engine = voltet_cpu::ENGINE.open(&AdapterRequest::default()).expect("opens");
    engine.prepare(volume).expect("takes in")
}

fn drawn(
    on: &dyn PreparedVolume,
    volume: &Arc<Volume>,
    look: &TransferFunction,
    camera: Camera,
) -> Vec<[f32; 4]> {
    let scene = Scene::new(
        volume.clone(),
        Arc::new(look.clone()),
        camera,
        shading(VERTEX_SAMPLED),
        VisibilityOrder::Exact,
    );
    on.draw(&scene, &RenderOptions::default(), &NoProgress).expect("draws").picture.rgba
}

#[test]
fn what_is_classified_serves_the_pictures_that_it_is_true_of() {
    let [volume, other] = [0.2, 0.3].map(|jitter| smooth(cube([6, 6, 6], jitter)));
    let looks = [0.4, 0.6].map(|s| look(MODELS[0], vec![gaussian(s, [1.0, 0.5, 0.2], 20.0)]));
    let cameras = [outside([40, 32]), outside([32, 40])];
    let prepared = ready(&volume);
    let mut pictures = Vec::new();
    for (volume, look, camera) in
        [(&volume, 0, 0), (&volume, 0, 1), (&volume, 1, 1), (&other, 1, 1), (&volume, 0, 1)]
    {
        let found = drawn(prepared.as_ref(), volume, &looks[look], cameras[camera]);
        let alone = drawn(ready(volume).as_ref(), volume, &looks[look], cameras[camera]);
        assert!(found.iter().any(|pixel| pixel[3] > 0.1), "nothing to see");
        assert_eq!(found, alone, "another look, volume or camera was drawn");
        pictures.push(found);
    }
    assert!(pictures[1] != pictures[2] && pictures[2] != pictures[3], "they would look alike anyway");
}
