//! The settings that are tried: every integrator that can serve the scene, over its own numbers.

use super::subject::is_studied;
use super::{RendererVariant, Subject};
use crate::numbers::Numbers;
use voltet_graph::{ParameterType, Registry};
use voltet_integrators::{DEFAULT_OVERSAMPLING, DEFAULT_PIECES, DEFAULT_PLANES, DEFAULT_SIDE};
use voltet_optics::WidgetBlend;
use voltet_optics::engine::{Accumulation, Compositor};
use voltet_optics::integrators::{INTEGRATOR, Integrator, can_serve, kinds};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_reference::REFERENCE;

/// One way to draw the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderConfig {
    /// Engine and compositor.
    pub variant: RendererVariant,
    /// The integrator with its numbers.
    pub integrator: Integrator,
    /// Blending of widgets that overlap, for closed forms.
    pub overlap: WidgetBlend,
    /// The order of a pixel's segments.
    pub order: VisibilityOrder,
    /// Accumulation of a variant that blends, as the file has it.
    pub accumulation: Accumulation,
}

/// Sides of the partial pre-integration table beside the standard one, at the standard number of pieces.
const PARTIAL_SIDES: [usize; 3] = [16, 64, 1024];

/// Sides of the three-dimensional tables. 256³ takes 256 MiB in 32 bits; the largest, 512³, 2 GiB, and is left out.
const SIDES: [usize; 5] = [16, 32, 64, 128, 256];

/// The side at which oversampling and planes are tried, with what is tried beside the standard.
const TRIED_SIDE: usize = 64;
const OVERSAMPLINGS: [usize; 2] = [1, 8];
const PLANES: [usize; 2] = [2, 4];

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
        for overlap in overlaps(subject, &integrator) {
            for order in orders(subject, &integrator, variant) {
                let accumulation = accumulation(subject, variant);
                settings.push(RenderConfig { variant, integrator, overlap, order, accumulation });
            }
        }
    }
    let own = RenderConfig::of_file(subject, variant);
    let drawn = own.integrator != REFERENCE && wanted(&own.integrator);
    if drawn && !settings.iter().any(|setting| setting.draws_as(&own)) {
        settings.push(own);
    }
    settings
}

/// Tolerances of the adaptive integrator.
const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// One integrator of each registered kind that is studied.
pub fn studied(registry: &Registry) -> Vec<Integrator> {
    kinds(registry.variants(INTEGRATOR)).into_iter().map(Integrator::new).filter(is_studied).collect()
}

/// An integrator over its own numbers.
fn sweep(kind: &Integrator) -> Vec<Integrator> {
    let powers = |most: u32| (0..=most).map(|k| 1usize << k);
    let with = |count, table_size| Numbers { count, table_size, ..Numbers::default() }.applied_to(kind);
    match Numbers::of(kind) {
        Numbers { tolerance: Some(_), .. } => {
            let with =
                |&tolerance| Numbers { tolerance: Some(tolerance), ..Numbers::default() }.applied_to(kind);
            TOLERANCES.iter().map(with).collect()
        }
        Numbers { count: Some(_), table_size: Some(_), .. } => {
            let pieces = powers(6).map(|count| with(Some(count), Some(DEFAULT_SIDE)));
            pieces.chain(PARTIAL_SIDES.map(|side| with(Some(DEFAULT_PIECES), Some(side)))).collect()
        }
        Numbers { count: Some(_), .. } => powers(8).map(|count| with(Some(count), None)).collect(),
        Numbers { table_size: Some(_), oversampling, planes, .. } => {
            let usual = Numbers {
                table_size: Some(TRIED_SIDE),
                oversampling: Some(DEFAULT_OVERSAMPLING),
                planes: Some(DEFAULT_PLANES),
                ..Numbers::default()
            };
            let sides = SIDES.map(|side| Numbers { table_size: Some(side), ..usual }.applied_to(kind));
            let finer = OVERSAMPLINGS.map(|n| Numbers { oversampling: Some(n), ..usual }.applied_to(kind));
            let more = PLANES.map(|n| Numbers { planes: Some(n), ..usual }.applied_to(kind));
            let finer = finer.into_iter().filter(|_| oversampling.is_some());
            let more = more.into_iter().filter(|_| planes.is_some());
            sides.into_iter().chain(finer).chain(more).collect()
        }
        Numbers { .. } => vec![*kind],
    }
}

/// Both ways with overlaps where the integrator knows them and the scene has several widgets.
fn overlaps(subject: &Subject, integrator: &Integrator) -> Vec<WidgetBlend> {
    match *integrator == Integrator::ANALYTIC && subject.scene.transfer_function.widgets.len() > 1 {
        true => vec![WidgetBlend::Exact, WidgetBlend::Mix],
        false => vec![WidgetBlend::Exact],
    }
}

/// The centroid order too for the integrators without an error of their own, so that the order's shows.
fn orders(subject: &Subject, integrator: &Integrator, variant: RendererVariant) -> Vec<VisibilityOrder> {
    let exact_integrals = *integrator == Integrator::ANALYTIC;
    match exact_integrals && subject.needs_order && subject.order_node.is_some() {
        true => vec![VisibilityOrder::Exact, VisibilityOrder::Centroid],
        false if subject.needs_order && subject.order_node.is_none() => {
            vec![RenderConfig::of_file(subject, variant).order]
        }
        false => vec![VisibilityOrder::Exact],
    }
}

/// Accumulation of the file, if the variant supports it.
fn accumulation(subject: &Subject, variant: RendererVariant) -> Accumulation {
    let asked = subject.asked.accumulation;
    let serves = |way: &Compositor| asked.check(*way).is_ok();
    variant.compositing.filter(serves).map_or(Accumulation::Float, |_| asked)
}

impl RenderConfig {
    /// Configuration by which the file would draw the scene with this variant.
    pub fn of_file(subject: &Subject, variant: RendererVariant) -> RenderConfig {
        let Scene { shading, order, .. } = subject.scene;
        let accumulation = accumulation(subject, variant);
        RenderConfig {
            variant,
            integrator: shading.integrator,
            overlap: shading.overlap,
            order,
            accumulation,
        }
    }

    /// The scene as this setting draws it.
    pub fn scene(&self, subject: &Subject) -> Scene {
        let shading = Shading { integrator: self.integrator, overlap: self.overlap, ..subject.scene.shading };
        // Exact is no order where none is needed: the same picture without the work.
        let order = if subject.needs_order { self.order } else { VisibilityOrder::Exact };
        Scene { shading, order, ..subject.scene.clone() }
    }

    /// True if another setting draws the same picture: overlaps count for the closed forms alone.
    pub fn draws_as(&self, other: &RenderConfig) -> bool {
        let overlap = self.overlap == other.overlap || self.integrator != Integrator::ANALYTIC;
        let same = self.integrator == other.integrator && self.order == other.order && overlap;
        self.variant == other.variant && same
    }

    /// The keys of a pipeline file that state it, with their values; overlap, order and engine apart.
    pub fn keys(&self) -> Vec<(&'static str, Value<'static>)> {
        let mut keys = vec![("integrator", Value::Text(self.integrator.name()))];
        keys.extend(self.integrator.parameters().iter().map(|parameter| {
            let value = self.integrator.setting(parameter.name).unwrap_or(0.0);
            let value = match parameter.parameter_type {
                ParameterType::Integer(_) => Value::Integer(value as i64),
                _ => Value::Number(value),
            };
            (parameter.name, value)
        }));
        keys
    }

    /// The numbers beside the integrator's name, for people: "16 pieces, table 64".
    pub fn numbers(&self) -> String {
        let Numbers { tolerance, count, table_size, oversampling, planes } = Numbers::of(&self.integrator);
        // What a table combines are pieces.
        let counted = if table_size.is_some() { "pieces" } else { "samples" };
        let mut parts = Vec::new();
        parts.extend(tolerance.map(|tolerance| format!("tolerance {tolerance:e}")));
        parts.extend(count.map(|count| format!("{count} {counted}")));
        parts.extend(table_size.map(|side| format!("table {side}")));
        let oversampling = oversampling.filter(|n| *n != DEFAULT_OVERSAMPLING);
        parts.extend(oversampling.map(|n| format!("oversampling {n}")));
        parts.extend(planes.filter(|n| *n != DEFAULT_PLANES).map(|n| format!("planes {n}")));
        if self.overlap == WidgetBlend::Mix && self.integrator == Integrator::ANALYTIC {
            parts.push("overlap mix".into());
        }
        if self.accumulation != Accumulation::Float {
            parts.push(self.accumulation.name().into());
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

/// A value of a key of a pipeline file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// A word.
    Text(&'a str),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
}

/// The word for what is done with overlaps in pipeline files.
pub fn overlap_name(overlap: WidgetBlend) -> &'static str {
    match overlap {
        WidgetBlend::Exact => "exact",
        WidgetBlend::Mix => "mix",
    }
}
