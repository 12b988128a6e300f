//! Settings of a study: its options, its subject (the scene of the pipeline's node that draws), and what is tried: every integrator
//! that can serve the scene, over its own numbers.

use std::sync::Arc;
use std::time::Duration;
use voltet_core::camera::Camera;
use voltet_core::parameters::Parameter;
use voltet_core::{Error, Result};
use voltet_graph::{
    Demand, Graph, GraphNode, Observer, ParameterType, ParameterValue, Parameters, Registry, Session, Value,
    diagonal, suggest,
};
use voltet_integrators::{DEFAULT_OVERSAMPLING, DEFAULT_PIECES, DEFAULT_PLANES};
use voltet_nodes::drawing;
use voltet_nodes::drawing::{ENGINES, NATIVE};
use voltet_optics::WidgetBlend;
use voltet_optics::engine::{Compositor, EngineInfo};
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
            return Err(error.got(name).expected(suggest(name, integrators.iter().copied())));
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

/// Engine and, if it has several, its compositor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RendererVariant {
    pub engine: &'static EngineInfo,
    /// Its compositor; `None` if it has one only.
    pub compositing: Option<Compositor>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Engines {
    /// This one alone.
    One(&'static EngineInfo),
    #[default]
    All,
}

impl RendererVariant {
    pub const NATIVE: RendererVariant = RendererVariant { engine: NATIVE, compositing: None };

    pub fn all_of_engine(engine: &'static EngineInfo) -> impl Iterator<Item = RendererVariant> {
        let only = engine.compositing.is_empty().then_some(None);
        let ways = only.into_iter().chain(engine.compositing.iter().copied().map(Some));
        ways.map(move |compositing| RendererVariant { engine, compositing })
    }

    pub fn all() -> impl Iterator<Item = RendererVariant> {
        ENGINES.iter().flat_map(RendererVariant::all_of_engine)
    }

    /// True if it makes such an order.
    pub fn makes(self, ordering: Ordering) -> bool {
        self.compositing.is_none_or(|compositor| compositor.makes(ordering))
    }

    /// The compositor's name in pipeline files.
    pub fn compositor(self) -> Option<&'static str> {
        self.compositing.map(Compositor::name)
    }

    /// Both names, for people: "cpu", "gpu tiles".
    pub fn label(self) -> String {
        match self.compositor() {
            None => self.engine.name.into(),
            Some(compositor) => format!("{} {compositor}", self.engine.name),
        }
    }

    /// Its place among all.
    pub fn number(self) -> usize {
        RendererVariant::all().position(|known| known == self).unwrap_or_default()
    }
}

impl Engines {
    pub fn each(self) -> impl Iterator<Item = &'static EngineInfo> {
        ENGINES.iter().filter(move |engine| match self {
            Engines::One(only) => *engine == only,
            Engines::All => true,
        })
    }
}

/// Kind of nodes that draw, which decides where an engine can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RendererNode {
    Renderer,
    GpuRenderer,
    /// The stages one by one, which are the native engine's.
    Stages,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SubjectRequest {
    /// Kind of nodes that draw.
    pub form: RendererNode,
    pub engine: String,
    /// The adapter, where one is named.
    pub adapter: Option<String>,
    /// The compositor of the device, or "auto".
    pub compositor: String,
}

/// Subject of a study: a scene, the node that draws it, and its options.
#[derive(Debug, Clone)]
pub struct Subject {
    pub node: String,
    /// The node whose parameter `order` counts; `None` where the pipeline has none that could be set.
    pub order_node: Option<String>,
    /// The scene; integrator, overlap and order are those of the file.
    pub scene: Scene,
    pub asked: SubjectRequest,
    /// One integrator of each kind that the pipeline may name, with default settings, in the order of registration.
    pub integrators: Vec<Integrator>,
    /// Background of the picture where the pipeline writes it (linear RGB).
    pub background: [f64; 3],
    /// Warnings of the nodes that feed it.
    pub warnings: Vec<String>,
}

impl Subject {
    /// Runs what feeds the node that draws. `name`: which one, where the pipeline has several; `gradient`: whether ∇s shall be
    /// there, by the pipeline's own filter, also where the scene does not look at it.
    pub fn gather(
        graph: &Graph,
        name: Option<&str>,
        gradient: bool,
        session: &mut Session,
        observer: &dyn Observer,
    ) -> Result<Subject> {
        let place = drawing_node(graph, name)?;
        let node = &graph.nodes[place];
        let blame = |error| node.locate(error);
        let (inputs, report) =
            session.feed(graph, place, &Demand { gradient, ..Demand::default() }, observer)?;
        let shading = drawing::shading(&node.parameters).map_err(blame)?;
        let unknown = || node.locate(Error::run("the node that draws is fed by values of unknown types"));
        let (scene, order_node) = match inputs.as_slice() {
            [volume, Value::TransferFunction(look), Value::Camera(camera), surfaces @ ..] => {
                let volume = volume.volume().ok_or_else(unknown)?.map_err(blame)?;
                let diagonal = if look.auto_unit_distance { diagonal(volume.grid.bounds()) } else { 0.0 };
                let transfer_function = Arc::new(look.for_diagonal(diagonal));
                let order = drawing::order(&node.parameters).map_err(blame)?;
                let mut scene = Scene::new(volume, transfer_function, **camera, shading, order);
                scene.clips = drawing::clips(&node.parameters).map_err(blame)?;
                for surface in surfaces {
                    let Value::Surface(surface) = surface else { return Err(unknown()) };
                    scene.surfaces.push(surface.clone());
                }
                (scene, Some(node.name.clone()))
            }
            [Value::Projection(projected), Value::TransferFunction(_)] => {
                let projected = projected.clone().downcast::<drawing::Projected>().map_err(|_| unknown())?;
                let cells = projected.projection.cells();
                let scene = Scene::new(
                    cells.volume.clone(),
                    projected.transfer_function.clone(),
                    *projected.projection.camera(),
                    shading,
                    cells.ordering.requested(),
                );
                (scene, sorting_node(graph, place))
            }
            _ => return Err(unknown()),
        };
        Ok(Subject {
            node: node.name.clone(),
            order_node,
            integrators: kinds(node.parameters.variants(INTEGRATOR))
                .into_iter()
                .map(Integrator::new)
                .collect(),
            scene,
            asked: SubjectRequest::from_node(node.node.name, &node.parameters),
            background: background(graph, place),
            warnings: report.warnings,
        })
    }

    pub fn studied(&self) -> Vec<Integrator> {
        self.integrators.iter().copied().filter(is_studied).collect()
    }

    /// An engine as the file has it. `None`: the compositor is left open, and more than one can serve.
    pub fn painter_on(&self, engine: &'static EngineInfo) -> Option<RendererVariant> {
        let mut all = RendererVariant::all_of_engine(engine);
        let exact = self.scene.ordering(false) == Ordering::PerPixel;
        match self.asked.compositor.as_str() {
            _ if engine.compositing.is_empty() => all.next(),
            // Tiles alone have it, and are the first.
            _ if exact => all.next(),
            "auto" => all.next().filter(|_| all.next().is_none()),
            named => all.find(|variant| variant.compositor() == Some(named)),
        }
    }
}

impl SubjectRequest {
    pub fn is_auto(&self) -> bool {
        self.engine == drawing::AUTO
    }

    fn from_node(node: &str, parameters: &Parameters) -> SubjectRequest {
        let form = match node {
            "renderer" => RendererNode::Renderer,
            "gpu-renderer" => RendererNode::GpuRenderer,
            _ => RendererNode::Stages,
        };
        let text = |name: &str| parameters.optional(name).and_then(|setting| setting.text());
        let engine = match form {
            RendererNode::Renderer => text("engine").unwrap_or(drawing::AUTO),
            RendererNode::GpuRenderer => drawing::DEVICE.name,
            RendererNode::Stages => NATIVE.name,
        };
        SubjectRequest {
            form,
            engine: engine.into(),
            adapter: text("adapter").map(str::to_string),
            compositor: text("compositor").unwrap_or(drawing::AUTO).into(),
        }
    }
}

pub fn drawing_nodes(graph: &Graph) -> Vec<String> {
    let all = graph.order.iter().map(|&i| &graph.nodes[i]);
    all.filter(|node| draws(node)).map(|node| node.name.clone()).collect()
}

fn draws(node: &GraphNode) -> bool {
    matches!(node.node.name, "renderer" | "gpu-renderer" | "composite")
}

/// The node that draws: a renderer or a composite node that something written needs.
fn drawing_node(graph: &Graph, name: Option<&str>) -> Result<usize> {
    let found: Vec<usize> = graph.order.iter().copied().filter(|&i| draws(&graph.nodes[i])).collect();
    let names: Vec<&str> = found.iter().map(|&i| graph.nodes[i].name.as_str()).collect();
    match (name, found.as_slice()) {
        (Some(name), _) => names.iter().position(|known| *known == name).map(|i| found[i]).ok_or_else(|| {
            Error::usage("no node of this name draws what the pipeline writes")
                .got(name)
                .expected(suggest(name, names.iter().copied()))
        }),
        (None, [place]) => Ok(*place),
        (None, []) => Err(Error::usage("the pipeline draws no volume").expected(
            "a node of type \"renderer\", \"gpu-renderer\" or \"composite\" that an image-writer needs",
        )),
        (None, _) => Err(Error::usage("several nodes of the pipeline draw")
            .got(names.join(", "))
            .expected("--node with the name of one of them")),
    }
}

/// The sort node that the cells of a composite node run through.
fn sorting_node(graph: &Graph, place: usize) -> Option<String> {
    let mut node = &graph.nodes[place];
    // Its first input each time: projection, cells, cells.
    while let Some(edge) = node.inputs.first() {
        node = &graph.nodes[edge.node];
        if node.node.name == "sort" {
            return Some(node.name.clone());
        }
    }
    None
}

/// The background of the first PNG that shows the picture; black where there is none.
fn background(graph: &Graph, place: usize) -> [f64; 3] {
    let writers = graph.nodes.iter().filter(|node| node.node.name == "image-writer");
    let given =
        writers.filter(|node| shows(graph, node, place)).find(|node| node.parameters.is_set("background"));
    given.and_then(|node| node.parameters.color("background").ok()).unwrap_or([0.0; 3])
}

/// True if a node takes the picture of another, or what a third made of it.
fn shows(graph: &Graph, node: &GraphNode, place: usize) -> bool {
    let mut pictures = node.inputs.iter().filter(|edge| edge.name == "image");
    pictures.any(|edge| edge.node == place || shows(graph, &graph.nodes[edge.node], place))
}

/// True for all integrators but the reference, with which the others are compared.
pub(super) fn is_studied(integrator: &Integrator) -> bool {
    *integrator != REFERENCE
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
