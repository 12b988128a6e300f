//! Parameters that choose engine, adapter and compositor.

use super::engines::ENGINES;
use voltet_core::Result;
use voltet_graph::{DefaultValue, Parameter, ParameterType, Parameters};
use voltet_optics::engine::{Accumulation, Compositor, OrderCheck};

/// The word for whatever engine is there.
pub const AUTO: &str = "auto";

/// The engine that a pipeline asks for.
pub const ENGINE: Parameter = Parameter {
    name: "engine",
    parameter_type: ParameterType::Choice(&ENGINE_WORDS),
    unit: "",
    default: DefaultValue::Text(AUTO),
    help: "what draws",
};

/// [`AUTO`] with what it means, then a word with its meaning for each of a list.
macro_rules! words {
    ($auto:literal, $list:expr, |$one:ident| $word:expr) => {{
        let mut words = [(AUTO, $auto); $list.len() + 1];
        let mut k = 0;
        while k < $list.len() {
            let $one = &$list[k];
            words[k + 1] = $word;
            k += 1;
        }
        words
    }};
}

const ENGINE_WORDS: [(&str, &str); ENGINES.len() + 1] = words!(
    "the last of these that this machine has and that holds the scene",
    ENGINES,
    |engine| (engine.name, engine.summary)
);

/// The adapter that a pipeline asks for.
pub const ADAPTER: Parameter = Parameter {
    name: "adapter",
    parameter_type: ParameterType::Text,
    unit: "",
    default: DefaultValue::Unset("the fastest kind"),
    help: "on a device: a part of its name, or discrete, integrated, virtual, software",
};

/// The compositor of the device.
pub const COMPOSITOR: Parameter = Parameter {
    name: "compositor",
    parameter_type: ParameterType::Choice(&COMPOSITOR_WORDS),
    unit: "",
    default: DefaultValue::Text(AUTO),
    help: "on a device: how pixels are composited; other engines have one way",
};

const COMPOSITOR_WORDS: [(&str, &str); Compositor::NAMES.len() + 1] = words!(
    "tiles where each pixel needs its exact order, else what a short measurement finds faster there",
    Compositor::NAMES,
    |word| *word
);

/// Precision of the device's accumulation.
pub const ACCUMULATION: Parameter = Parameter {
    name: "accumulation",
    parameter_type: ParameterType::Choice(&Accumulation::NAMES),
    unit: "",
    default: DefaultValue::Text(Accumulation::NAMES[0].0),
    help: "on a device that blends (raster, triangles): what a pixel accumulates in, to see what few bits cost",
};

/// Check of an exact order that the device blends.
pub const ORDER_CHECK: Parameter = Parameter {
    name: "order_check",
    parameter_type: ParameterType::Choice(&OrderCheck::NAMES),
    unit: "",
    default: DefaultValue::Text(OrderCheck::NAMES[0].0),
    help: "on a device that blends (raster, triangles) in exact order: how the order is checked; where it is wrong, tiles draw",
};

/// Check chosen by the parameters.
pub fn order_check(p: &Parameters) -> Result<OrderCheck> {
    // Other nodes draw by the referee alone.
    let asked = p.optional(ORDER_CHECK.name).and_then(|setting| setting.text());
    Ok(asked.and_then(OrderCheck::named).unwrap_or_default())
}

/// Precision chosen by the parameters.
pub fn accumulation(p: &Parameters) -> Result<Accumulation> {
    Ok(Accumulation::named(p.text(ACCUMULATION.name)?).unwrap_or_default())
}

/// The compositor that the parameters ask for: where they leave it open, one that can do what they ask for besides.
pub fn compositor(p: &Parameters) -> Result<Option<Compositor>> {
    let asked = Compositor::named(p.text(COMPOSITOR.name)?);
    let is_rounded = accumulation(p)? != Accumulation::Float;
    Ok(asked.or(is_rounded.then_some(Compositor::Raster)))
}

/// The adapter that the parameters name.
pub fn adapter(p: &Parameters) -> Option<String> {
    p.optional(ADAPTER.name).and_then(|setting| setting.text()).map(str::to_string)
}
