//! A study that is stopped keeps what is done; refining the grid tells two errors apart.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

use glam::DVec3;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use voltet::core::SharedSlice;
use voltet::core::camera::{Camera, Projection};
use voltet::core::field::{CellAverage, Method};
use voltet::core::grid::generate::box_of_tetrahedra;
use voltet::core::progress::{NoProgress, Progress};
use voltet::core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet::core::volume::Volume;
use voltet::optics::WidgetBlend;
use voltet::optics::scene::Scene;
use voltet::optics::shading::{Integrator, Shading, VisibilityOrder};
use voltet_study::work_precision::{
    Benches, Engines, Frames, Measure, RendererNode, Source, StudyOptions, Subject, SubjectRequest,
    reference, refinement, study,
};

/// Stops once this many settings have begun.
struct After(usize, Mutex<Vec<String>>);

impl Progress for After {
    fn report(&self, stage: &str, _fraction: f64) {
        let mut begun = self.1.lock().unwrap();
        // The reference is drawn before the settings.
        if stage != "reference" && begun.last().is_none_or(|last| last != stage) {
            begun.push(stage.into());
        }
    }

    fn cancelled(&self) -> bool {
        self.1.lock().unwrap().len() > self.0
    }
}

#[test]
fn a_stopped_study_keeps_the_finished_settings_and_the_reference() {
    let registry = voltet::registry().unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines/isotherms.toml");
    let document = voltet::Document::open(&file, &["view.size=[24,18]".into()], &registry).unwrap();
    let mut session = voltet::nodes::session();
    let unobserved = voltet::graph::NoObserver;
    let subject = Subject::gather(&document.graph, None, false, &mut session, &unobserved).unwrap();
    let cache = tempfile::tempdir().unwrap();
    let stop = After(3, Mutex::default());
    let drawn = reference(&subject, cache.path(), &stop).unwrap();
    let wish = StudyOptions {
        only: Vec::new(),
        engines: Engines::One(voltet::nodes::drawing::NATIVE),
        adapter: None,
        refine: 0,
        frames: Frames { count: 1, patience: Duration::ZERO, turn: 0.0, in_flight: 1 },
        measure: Measure::Maximum,
        max_error: Some(0.1),
    };
    let benches = Benches::open(&subject, &wish).unwrap();
    let found = study(subject.clone(), wish, benches, drawn, &stop).unwrap();
    assert!(found.stopped());
    assert_eq!(found.rows.len(), 3);
    assert!(found.recommended.is_some() && found.rows.iter().any(|row| row.on_front));
    let begun = stop.1.lock().unwrap();
    assert_eq!(begun[..3], found.rows.iter().map(|row| row.setting.label()).collect::<Vec<_>>());
    drop(begun);
    assert!(reference(&subject, cache.path(), &stop).unwrap().cached);
}

/// ∇s of the scene by the filter that the file names, which the scene itself does not look at.
#[test]
fn refinement_goes_by_the_filter_of_the_pipeline() {
    let registry = voltet::registry().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    let gradient_of = |drawn: &str, method: &str, wanted: bool| {
        std::fs::write(&file, FILTERED.replace("DRAWN", drawn).replace("METHOD", method)).unwrap();
        let document = voltet::Document::open(&file, &[], &registry).unwrap();
        let unobserved = voltet::graph::NoObserver;
        let mut session = voltet::nodes::session();
        Subject::gather(&document.graph, None, wanted, &mut session, &unobserved).unwrap().scene.volume
    };
    for drawn in [RENDERED, STAGES] {
        assert!(gradient_of(drawn, "cell-average", false).gradient.is_none());
        let volume = gradient_of(drawn, "cell-average", true);
        let method = Method::with_defaults(Arc::new(CellAverage)).unwrap();
        let of_file = method.gradient(&volume.grid, &volume.scalar, &NoProgress).unwrap().vectors;
        assert_eq!(volume.gradient.as_deref(), Some(&of_file[..]));
        assert_ne!(gradient_of(drawn, "least-squares", true).gradient.as_deref(), Some(&of_file[..]));
    }
}

const FILTERED: &str = r#"
pipeline = { format = 1 }
nodes.grid = { type = "wavelet", resolution = [4, 4, 4] }
nodes.gradient = { type = "gradient-magnitude", method = "METHOD", inputs = { grid = "grid" } }
nodes.view = { type = "camera", eye = [0, -60, 9], target = [0, 0, 0], size = [4, 4] }
nodes.file = { type = "image-writer", path = "picture.png", inputs = { image = "picture" } }
DRAWN
[nodes.look]
type = "transfer-function"
unit_distance = 1.0
[[nodes.look.widgets]]
kind = "uniform"
region = { s = [-1e3, 1e3] }
color = [1, 1, 1]
extinction = 0.1
"#;

const RENDERED: &str = r#"
nodes.picture = { type = "renderer", inputs = { volume = "gradient", transfer_function = "look", camera = "view" } }
"#;

const STAGES: &str = r#"
nodes.cells = { type = "cull", inputs = { volume = "gradient", transfer_function = "look", camera = "view" } }
nodes.cover = { type = "project", inputs = { cells = "cells", camera = "view" } }
nodes.picture = { type = "composite", inputs = { projection = "cover", transfer_function = "look" } }
"#;

/// Stops once a tenth of the reference picture is drawn; counts what is reported.
struct Early(Mutex<Vec<f64>>);

impl Progress for Early {
    fn report(&self, _stage: &str, fraction: f64) {
        self.0.lock().unwrap().push(fraction);
    }

    fn cancelled(&self) -> bool {
        self.0.lock().unwrap().last().is_some_and(|last| *last >= 0.1)
    }
}

#[test]
fn a_stopped_reference_picture_goes_on_where_it_was() {
    let mut subject = smooth_subject();
    subject.scene.camera.size = [160, 160];
    let [cache, other] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let whole = reference(&subject, other.path(), &NoProgress).unwrap();
    let stop = Early(Mutex::default());
    assert!(reference(&subject, cache.path(), &stop).is_err());
    let drawn = stop.0.lock().unwrap().len();
    assert!(drawn >= 10, "{drawn} of 100 tiles");
    let rest = After(usize::MAX, Mutex::default());
    let counted = Early(Mutex::new(Vec::new()));
    assert!(reference(&subject, cache.path(), &counted).is_err(), "a tenth is there already");
    assert!(counted.0.lock().unwrap()[0] > 0.1, "it began anew");
    let resumed = reference(&subject, cache.path(), &rest).unwrap();
    assert!(!resumed.cached);
    assert_eq!(resumed.picture, whole.picture);
    assert!(reference(&subject, cache.path(), &rest).unwrap().cached);
    let left: Vec<_> = std::fs::read_dir(cache.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "one file a picture: {left:?}");
}

/// A smooth field on a box of tetrahedra, with its gradient, drawn as one soft Gaussian over s.
fn smooth_subject() -> Subject {
    let grid = box_of_tetrahedra([6, 6, 6], [DVec3::ZERO, DVec3::ONE], 0.15);
    let of = |f: &dyn Fn(DVec3) -> f64| grid.points.iter().map(|&p| f(p)).collect::<Vec<f64>>();
    let scalar = of(&|p| field(p).0).into();
    let gradient = Some(SharedSlice::from(grid.points.iter().map(|&p| field(p).1).collect::<Vec<DVec3>>()));
    let gradient_magnitude = Some(SharedSlice::from(of(&|p| field(p).1.length())));
    let volume = Arc::new(Volume { grid: Arc::new(grid), scalar, gradient, gradient_magnitude });
    let profile = Profile::Gaussian { centre: [0.5, 0.0], matrix: [[3.0, 0.0], [0.0, 0.0]] };
    let widget = Widget { profile, color: [0.4, 0.7, 1.0], extinction: 3.0, region: None };
    let model = OpticalModel::DensityEmitter;
    let (integrator, overlap) = (Integrator::ANALYTIC, WidgetBlend::Exact);
    let scene = Scene::new(
        volume,
        Arc::new(TransferFunction {
            model,
            unit_distance: 1.0,
            widgets: vec![widget],
            axes: Default::default(),
        }),
        Camera {
            eye: DVec3::new(-0.9, -1.1, 1.4),
            target: DVec3::splat(0.5),
            up: DVec3::Z,
            projection: Projection::Perspective { fov_y: 45.0 },
            near: 0.0,
            size: [32, 24],
            samples: 1,
        },
        Shading { integrator, overlap, silhouette: None, light: None },
        VisibilityOrder::Exact,
    );
    Subject {
        node: "picture".into(),
        order_node: None,
        scene,
        integrators: vec![Integrator::ANALYTIC],
        asked: SubjectRequest {
            form: RendererNode::Renderer,
            engine: "cpu".into(),
            adapter: None,
            compositor: "auto".into(),
        },
        background: [0.0; 3],
        warnings: Vec::new(),
    }
}

fn field(p: DVec3) -> (f64, DVec3) {
    let (a, b) = (2.0 * p.x + p.y, 3.0 * p.z - p.y);
    let gradient = DVec3::new(0.6 * a.cos(), 0.3 * a.cos() + 0.2 * b.sin(), -0.6 * b.sin());
    (0.5 + 0.3 * a.sin() + 0.2 * b.cos(), gradient)
}

#[test]
fn refining_the_grid_tells_integration_from_the_data_model() {
    let subject = smooth_subject();
    let cache = tempfile::tempdir().unwrap();
    let drawn = reference(&subject, cache.path(), &NoProgress).unwrap();
    let known = refinement(&subject, &drawn, 2, &Source::Function(&field), &NoProgress).unwrap();
    let count = subject.scene.volume.grid.tetrahedra.len() as u64;
    assert_eq!(known.cells, [count, 8 * count, 64 * count]);
    for found in known.integration.iter().chain([&known.model]) {
        let observed = found.observed.unwrap_or_else(|| panic!("{known:#?}"));
        // Second order, in cells that are not small yet.
        assert!((observed - found.expected).abs() < 0.4, "{found:#?}");
    }
    // The field is the same on every grid: the closed forms stay at the rounding of 32 bits.
    assert!(known.integration_error < 1e-6, "{known:#?}");
    assert!(known.model_error > 100.0 * known.integration_error, "{known:#?}");
    // What the gradients say of the field between the points is nearly what the field is.
    let guessed = refinement(&subject, &drawn, 2, &Source::Gradients, &NoProgress).unwrap();
    assert!((guessed.model_error / known.model_error - 1.0).abs() < 0.1, "{guessed:#?}\n{known:#?}");
    assert!((guessed.model.observed.unwrap() - 2.0).abs() < 0.4, "{guessed:#?}");
    let many = refinement(&subject, &drawn, 9, &Source::Gradients, &NoProgress).unwrap_err().to_string();
    assert!(many.contains("too large to be refined"), "{many}");
}
