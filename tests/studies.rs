//! A study that is stopped keeps what is done.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;
use voltet::core::progress::Progress;
use voltet::study::{Frames, Measure, Scene, Wish, reference, study};

/// Stops once this many settings have begun.
struct After(usize, Mutex<Vec<String>>);

impl Progress for After {
    fn report(&self, stage: &str, _fraction: f64) {
        let mut begun = self.1.lock().unwrap();
        if !matches!(stage, "cull" | "project" | "composite" | "reference")
            && begun.last().is_none_or(|last| last != stage)
        {
            begun.push(stage.into());
        }
    }

    fn cancelled(&self) -> bool {
        self.1.lock().unwrap().len() > self.0
    }
}

#[test]
fn a_stopped_study_keeps_the_finished_settings_and_the_reference() {
    let registry = voltet::nodes::registry().unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines/isotherms.toml");
    let document = voltet::Document::open(&file, &["view.size=[24,18]".into()], &registry).unwrap();
    let mut session = voltet::nodes::session();
    let scene = Scene::gather(&document.graph, None, &mut session, &voltet::core::graph::Unobserved).unwrap();
    let cache = tempfile::tempdir().unwrap();
    let stop = After(3, Mutex::default());
    let drawn = reference(&scene, cache.path(), &stop).unwrap();
    let wish = Wish {
        only: Vec::new(),
        frames: Frames { count: 1, patience: Duration::ZERO },
        measure: Measure::Maximum,
        max_error: Some(0.1),
    };
    let found = study(scene.clone(), wish, drawn, &stop).unwrap();
    assert!(found.stopped());
    assert_eq!(found.rows.len(), 3);
    assert!(found.recommended.is_some() && found.rows.iter().any(|row| row.on_front));
    let begun = stop.1.lock().unwrap();
    assert_eq!(begun[..3], found.rows.iter().map(|row| row.setting.label()).collect::<Vec<_>>());
    drop(begun);
    assert!(reference(&scene, cache.path(), &stop).unwrap().cached);
}
