//! The settings that are tried: every integrator that can serve the scene, over its own numbers.

use super::subject::is_studied;
use super::{RendererVariant, Subject};
use voltet_core::parameters::Parameter;
use voltet_graph::{ParameterType, ParameterValue, Registry};
use voltet_integrators::{DEFAULT_OVERSAMPLING, DEFAULT_PIECES, DEFAULT_PLANES};
use voltet_optics::WidgetBlend;
use voltet_optics::engine::{Accumulation, Compositor};
use voltet_optics::integrators::{INTEGRATOR, Integrator, can_serve, kinds};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_reference::REFERENCE;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderConfig {
    pub variant: RendererVariant,
    pub integrator: Integrator,
    pub overlap: WidgetBlend,
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
