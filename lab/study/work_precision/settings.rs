//! Settings of a study: its options, and what is tried: every integrator that can serve the scene, over its own numbers.

use super::subject::{Subject, is_studied};
use super::variant::{Engines, RendererVariant};
use std::time::Duration;
use voltet_core::camera::Camera;
use voltet_core::parameters::Parameter;
use voltet_core::{Error, Result};
use voltet_graph::{ParameterType, ParameterValue, Registry};
use voltet_integrators::{DEFAULT_OVERSAMPLING, DEFAULT_PIECES, DEFAULT_PLANES};
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::{INTEGRATOR, Integrator, can_serve, kinds};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Ordering, Shading, VisibilityOrder};
use voltet_reference::REFERENCE;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    #[default]
    Maximum,
    RootMeanSquare,
    /// 99.9th percentile of the pixels' errors.
    Percentile,
    Flip,
}

impl Measure {
    /// Every measure with its name on the command line and a description.
    pub const NAMES: [(Measure, &'static str, &'static str); 4] = [
        (Measure::Maximum, "max", "The largest difference of a channel of premultiplied linear RGBA"),
        (Measure::RootMeanSquare, "rms", "The root of the mean square of these differences"),
        (Measure::Percentile, "p99.9", "The 99.9th percentile of these differences"),
        (Measure::Flip, "flip", "The perceptual difference FLIP, mean over the pixels"),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Measure::NAMES[self as usize].1
    }

    /// Its name within a sentence.
    pub fn words(self) -> &'static str {
        ["largest error", "root-mean-square error", "99.9 percentile of the error", "mean of FLIP"]
            [self as usize]
    }

    /// Label of an axis.
    pub fn label(self) -> String {
        let scale = match self {
            Measure::Flip => "(0 = equal, 1 = largest)",
            _ => "of premultiplied linear RGBA (1 = full scale)",
        };
        format!("{} {scale}", self.words())
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    /// Frames that count, at most, ≥ 1. One before them warms up.
    pub count: usize,
    /// No further frame begins once a setting has taken this long. Where the first one already does, it counts.
    pub patience: Duration,
    /// Degrees that the camera turns about its target before each frame, so that nothing of the former one can be used
    /// again; 0: it stands still.
    pub turn: f64,
    /// Frames of a device that are in flight at a time while it is measured how fast they follow each other; below 2 that is not
    /// measured.
    pub in_flight: usize,
}

impl Frames {
    pub(super) fn scene(&self, scene: &Scene, number: usize) -> Scene {
        let mut turned = scene.clone();
        let Camera { eye, target, up, .. } = scene.camera;
        if self.turn != 0.0 {
            let by = glam::DQuat::from_axis_angle(up.normalize(), (self.turn * number as f64).to_radians());
            turned.camera.eye = target + by * (eye - target);
        }
        turned
    }
}

#[derive(Debug, Clone)]
pub struct StudyOptions {
    /// Integrators to look at; none for all.
    pub only: Vec<String>,
    pub engines: Engines,
    /// The adapter, by a part of its name or its kind; none for the file's, or the fastest that is hardware.
    pub adapter: Option<String>,
    /// Number of times each is drawn.
    pub frames: Frames,
    /// Measure of error that decides about the front and the recommendation.
    pub measure: Measure,
    pub max_error: Option<f64>,
    /// Number of times the grid is refined, to tell the integration's error from the data model's; 0: not at all.
    pub refine: u32,
}

impl Default for StudyOptions {
    fn default() -> StudyOptions {
        let frames = Frames { count: 5, patience: Duration::from_secs(10), turn: 0.0, in_flight: 1 };
        StudyOptions {
            only: Vec::new(),
            engines: Engines::All,
            adapter: None,
            frames,
            measure: Measure::Maximum,
            max_error: None,
            refine: 0,
        }
    }
}

impl StudyOptions {
    /// Refuses what cannot be measured. `integrators`: names of those that can be studied; `named`: the option of a name as it was given.
    pub fn check(&self, integrators: &[&str], named: impl Fn(&str) -> String) -> Result<()> {
        if let Some(name) = self.only.iter().find(|name| !integrators.contains(&name.as_str())) {
            let error = Error::usage(format!("{} names no integrator that can be studied", named("only")));
            return Err(error.got(name).not_among(name, integrators.iter().copied()));
        }
        let wrong = |name: &str, found: String, expected: &str| {
            Err(Error::usage(format!("{} is out of range", named(name))).got(found).expected(expected))
        };
        if let Some(bound) = self.max_error.filter(|bound| !(bound.is_finite() && *bound >= 0.0)) {
            return wrong("max_error", bound.to_string(), "a number of at least 0");
        }
        if !self.frames.turn.is_finite() {
            return wrong("turn", self.frames.turn.to_string(), "a number of degrees");
        }
        if self.frames.count == 0 {
            return wrong("frames", "0".into(), "1 or more");
        }
        let no_device = self.engines.each().all(|engine| !engine.on_device);
        match self.adapter.as_ref().filter(|_| no_device) {
            Some(adapter) => {
                let what = format!(
                    "{} names a graphics device, and {} asks for none",
                    named("adapter"),
                    named("engine")
                );
                let without = format!("{} gpu or all, or no {}", named("engine"), named("adapter"));
                Err(Error::usage(what).got(adapter).expected(without))
            }
            None => Ok(()),
        }
    }
}

/// A patience of so many seconds; a year is longer than any, and does not overflow. Errors: a number that is none; `named`: its option.
pub fn patience(seconds: f64, named: &str) -> Result<Duration> {
    match seconds.is_finite() && seconds >= 0.0 {
        true => Ok(Duration::from_secs_f64(seconds.min(3e7))),
        false => {
            let error = Error::usage(format!("{named} is out of range"));
            Err(error.got(seconds).expected("a number of at least 0"))
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderConfig {
    pub variant: RendererVariant,
    pub integrator: Integrator,
    pub overlap: WidgetBlend,
    pub order: VisibilityOrder,
}

/// Sides of the partial pre-integration table beside the standard one, at the standard number of pieces.
const PARTIAL_SIDES: [usize; 3] = [16, 64, 1024];

/// Sides of the three-dimensional tables. 256³ takes 256 MiB in 32 bits; the largest, 512³, 2 GiB, and is left out.
const SIDES: [usize; 5] = [16, 32, 64, 128, 256];

/// The side at which oversampling and planes are tried, with what is tried beside the standard.
const TRIED_SIDE: usize = 64;
const OVERSAMPLINGS: [usize; 2] = [1, 8];
const PLANES_TRIED: [usize; 2] = [2, 4];

/// Every setting for the scene with one variant, each integrator's cheapest first. `only`: names of integrators, none for
/// all.
pub fn settings(subject: &Subject, only: &[String], variant: RendererVariant) -> Vec<RenderConfig> {
    let without = |kind: &Integrator| kind.parameters().is_empty();
    let (exact, numbered): (Vec<_>, Vec<_>) = subject.studied().into_iter().partition(without);
    let integrators = exact.into_iter().chain(numbered.iter().flat_map(sweep));

    let serves = |integrator: &Integrator| can_serve(integrator, &subject.scene.transfer_function).is_ok();
    let wanted = |integrator: &Integrator| only.is_empty() || only.iter().any(|n| n == integrator.name());
    let mut settings = Vec::new();
    for integrator in integrators.filter(|i| serves(i) && wanted(i)) {
        // Both ways with overlaps where the integrator knows them and the scene has several widgets.
        let several = integrator == Integrator::ANALYTIC && subject.scene.transfer_function.widgets.len() > 1;
        let overlaps = [Some(WidgetBlend::Exact), several.then_some(WidgetBlend::Mix)];
        for overlap in overlaps.into_iter().flatten() {
            for order in orders(subject, &integrator, variant) {
                settings.push(RenderConfig { variant, integrator, overlap, order });
            }
        }
    }
    let own = RenderConfig::of_file(subject, variant);
    let makes = variant.makes(own.scene(subject).ordering(false));
    let drawn = makes && own.integrator != REFERENCE && wanted(&own.integrator);
    if drawn && !settings.iter().any(|setting| setting.draws_as(&own)) {
        settings.push(own);
    }
    settings
}

/// Tolerances of the adaptive integrator.
const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

pub fn studied(registry: &Registry) -> Vec<Integrator> {
    kinds(registry.variants(INTEGRATOR)).into_iter().map(Integrator::new).filter(is_studied).collect()
}

/// An integrator over its own numbers.
fn sweep(kind: &Integrator) -> Vec<Integrator> {
    let sides = |kind: Integrator, sides: &[usize]| -> Vec<Integrator> {
        sides.iter().map(|&side| kind.with(TABLE_SIZE, side as f64)).collect()
    };
    let powers = |name: &'static str, most: u32| (0..=most).map(move |k| kind.with(name, f64::from(1 << k)));
    match (Numbers::of(kind), count_name(kind)) {
        (Numbers { tolerance: Some(_), .. }, _) => TOLERANCES.map(|it| kind.with(TOLERANCE, it)).to_vec(),
        (Numbers { table_size: Some(_), .. }, Some(count)) => {
            let usual = kind.with(count, DEFAULT_PIECES as f64);
            powers(count, 6).chain(sides(usual, &PARTIAL_SIDES)).collect()
        }
        (_, Some(count)) => powers(count, 8).collect(),
        (Numbers { table_size: Some(_), oversampling, planes, .. }, None) => {
            let usual = kind.with(TABLE_SIZE, TRIED_SIDE as f64);
            let finer = OVERSAMPLINGS.map(|n| usual.with(OVERSAMPLING, n as f64));
            let more = PLANES_TRIED.map(|n| usual.with(PLANES, n as f64));
            let finer = finer.into_iter().filter(|_| oversampling.is_some());
            let more = more.into_iter().filter(|_| planes.is_some());
            sides(*kind, &SIDES).into_iter().chain(finer).chain(more).collect()
        }
        _ => vec![*kind],
    }
}

/// The centroid order too for the integrators without an error of their own, so that the order's shows, and alone where the
/// variant does not make the exact one.
fn orders(subject: &Subject, integrator: &Integrator, variant: RendererVariant) -> Vec<VisibilityOrder> {
    if !subject.scene.needs_order() {
        return vec![VisibilityOrder::Exact];
    }
    if subject.order_node.is_none() {
        return vec![RenderConfig::of_file(subject, variant).order];
    }
    match variant.makes(Ordering::PerPixel) {
        true if *integrator == Integrator::ANALYTIC => {
            vec![VisibilityOrder::Exact, VisibilityOrder::Centroid]
        }
        true => vec![VisibilityOrder::Exact],
        false => vec![VisibilityOrder::Centroid],
    }
}

impl RenderConfig {
    /// Configuration of the native engine in exact order.
    pub const fn native(integrator: Integrator) -> RenderConfig {
        RenderConfig {
            variant: RendererVariant::NATIVE,
            integrator,
            overlap: WidgetBlend::Exact,
            order: VisibilityOrder::Exact,
        }
    }

    /// Configuration by which the file would draw the scene with this variant.
    pub fn of_file(subject: &Subject, variant: RendererVariant) -> RenderConfig {
        let Scene { shading, order, .. } = subject.scene;
        RenderConfig { variant, integrator: shading.integrator, overlap: shading.overlap, order }
    }

    pub fn scene(&self, subject: &Subject) -> Scene {
        let shading = Shading { integrator: self.integrator, overlap: self.overlap, ..subject.scene.shading };
        // Exact is no order where none is needed: the same picture without the work.
        let order = if subject.scene.needs_order() { self.order } else { VisibilityOrder::Exact };
        Scene { shading, order, ..subject.scene.clone() }
    }

    /// True if another setting draws the same picture: overlaps count for the closed forms alone.
    pub fn draws_as(&self, other: &RenderConfig) -> bool {
        let overlap = self.overlap == other.overlap || self.integrator != Integrator::ANALYTIC;
        let same = self.integrator == other.integrator && self.order == other.order && overlap;
        self.variant == other.variant && same
    }

    /// The keys of a pipeline file that state the integrator, with their values.
    pub fn keys(&self) -> Vec<(&'static str, ParameterValue)> {
        let mut keys = vec![("integrator", ParameterValue::Text(self.integrator.name().into()))];
        keys.extend(self.integrator.parameters().iter().map(|parameter| {
            let value = self.integrator.setting(parameter.name).unwrap_or(0.0);
            let value = match parameter.parameter_type {
                ParameterType::Integer(_) => ParameterValue::Integer(value as i64),
                _ => ParameterValue::Number(value),
            };
            (parameter.name, value)
        }));
        keys
    }

    /// The numbers beside the integrator's name, for people: "16 pieces, table 64".
    pub fn numbers(&self) -> String {
        let mut parts = Numbers::of(&self.integrator).labels();
        if self.overlap == WidgetBlend::Mix && self.integrator == Integrator::ANALYTIC {
            parts.push("overlap mix".into());
        }
        if self.order != VisibilityOrder::Exact {
            parts.push(format!("order {}", self.order));
        }
        parts.join(", ")
    }

    /// Integrator, numbers and the device, for people.
    pub fn label(&self) -> String {
        let variant =
            if self.variant == RendererVariant::NATIVE { String::new() } else { self.variant.label() };
        let parts = [self.integrator.name().into(), self.numbers(), variant];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
    }

    /// Label as part of a file's name.
    pub fn file_stem(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let text: String = self.label().chars().map(plain).collect();
        text.split('_').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("_")
    }

    /// A rough relative cost, for estimates of what is left to do.
    pub fn weight(&self) -> f64 {
        let cube = |side: usize| (side as f64 / 64.0).powi(3);
        let native = match Numbers::of(&self.integrator) {
            Numbers { tolerance: Some(_), .. } => 6.0,
            Numbers { count: Some(count), table_size: Some(_), .. } => 3.0 + count as f64,
            Numbers { count: Some(count), .. } => 3.0 + 0.5 * count as f64,
            Numbers { table_size: Some(side), planes, .. } => 4.0 + cube(side) * planes.unwrap_or(1) as f64,
            Numbers { .. } if self.integrator == REFERENCE => 50.0,
            Numbers { .. } => 1.0,
        };
        match self.variant.engine.on_device {
            false => native,
            // Compiling is what most of it takes.
            true => 4.0 + 0.5 * native,
        }
    }
}

/// The word for what is done with overlaps in pipeline files.
pub fn overlap_name(overlap: WidgetBlend) -> &'static str {
    match overlap {
        WidgetBlend::Exact => "exact",
        WidgetBlend::Mix => "mix",
    }
}

/// Settings of an integrator; `None`: the integrator has no such setting.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Numbers {
    /// Largest error of a channel of C and of A.
    pub tolerance: Option<f64>,
    /// Pieces or samples of a segment.
    pub count: Option<usize>,
    /// Entries a side of the table.
    pub table_size: Option<usize>,
    /// Pieces from one entry of a pre-integrated table to the next.
    pub oversampling: Option<usize>,
    /// Tiles of a cylindrical table for each entry of a side.
    pub planes: Option<usize>,
}

const TOLERANCE: &str = "tolerance";
const TABLE_SIZE: &str = "table_size";
const OVERSAMPLING: &str = "oversampling";
const PLANES: &str = "planes";

/// The whole number by which an integrator samples a segment: the first that belongs to no table.
fn count_name(integrator: &Integrator) -> Option<&'static str> {
    let is_count = |parameter: &&Parameter| {
        matches!(parameter.parameter_type, ParameterType::Integer(_))
            && ![TABLE_SIZE, OVERSAMPLING, PLANES].contains(&parameter.name)
    };
    integrator.parameters().iter().find(is_count).map(|parameter| parameter.name)
}

impl Numbers {
    pub fn of(integrator: &Integrator) -> Numbers {
        Numbers {
            tolerance: integrator.setting(TOLERANCE),
            count: count_name(integrator).and_then(|name| integrator.count(name)),
            table_size: integrator.count(TABLE_SIZE),
            oversampling: integrator.count(OVERSAMPLING),
            planes: integrator.count(PLANES),
        }
    }
    /// Each number for people, but what is as usual of a table's: "16 pieces", "table 64".
    pub fn labels(&self) -> Vec<String> {
        // What a table combines are pieces.
        let counted = if self.table_size.is_some() { "pieces" } else { "samples" };
        let oversampling = self.oversampling.filter(|n| *n != DEFAULT_OVERSAMPLING);
        let planes = self.planes.filter(|n| *n != DEFAULT_PLANES);
        let labels = [
            self.tolerance.map(|tolerance| format!("tolerance {tolerance:e}")),
            self.count.map(|count| format!("{count} {counted}")),
            self.table_size.map(|side| format!("table {side}")),
            oversampling.map(|n| format!("oversampling {n}")),
            planes.map(|n| format!("planes {n}")),
        ];
        labels.into_iter().flatten().collect()
    }
}
