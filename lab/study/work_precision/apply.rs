//! A setting written into a pipeline file; every other byte stays as it is.

use super::settings::overlap_name;
use super::{RenderConfig, RendererNode, Study, Value as Key};
use voltet_core::Result;
use voltet_document::{Document, Edit};
use voltet_graph::ParameterValue;
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::Integrator;

/// The text of the pipeline file with one of the study's settings in it. Overlap, order, engine, adapter and compositor are
/// written where they differ from what the file says or comes to here; a `gpu-renderer` that is to draw on the native
/// engine becomes a `renderer`.
pub fn apply(text: &str, study: &Study, setting: &RenderConfig) -> Result<String> {
    let subject = &study.subject;
    let mut document = Document::from_text(text.to_string(), None);
    let own = RenderConfig::of_file(subject, setting.variant);
    for (name, key) in setting.keys() {
        set(&mut document, &subject.node, name, key)?;
    }
    if setting.overlap != own.overlap && setting.integrator == Integrator::ANALYTIC {
        set(&mut document, &subject.node, "overlap", Key::Text(overlap_name(setting.overlap)))?;
    } else if own.overlap == WidgetBlend::Mix && setting.integrator != Integrator::ANALYTIC {
        // Of no account for the others, and misleading.
        set(&mut document, &subject.node, "overlap", Key::Text(overlap_name(WidgetBlend::Exact)))?;
    }
    if setting.order != own.order
        && let Some(node) = &subject.order_node
    {
        set(&mut document, node, "order", Key::Text(setting.order.name()))?;
    }
    for (name, value) in engine_keys(study, setting) {
        set(&mut document, &subject.node, name, Key::Text(value))?;
    }
    Ok(document.text().to_string())
}

/// The keys that state the setting's engine, where the file comes to another one.
fn engine_keys<'a>(study: &'a Study, setting: &RenderConfig) -> Vec<(&'static str, &'a str)> {
    let asked = &study.subject.asked;
    let variant = setting.variant;
    let mut keys = Vec::new();
    match asked.form {
        RendererNode::Stages => return keys,
        RendererNode::GpuRenderer if variant.engine.name != asked.engine => {
            keys.extend([("type", "renderer"), ("engine", variant.engine.name)]);
        }
        RendererNode::GpuRenderer => {}
        RendererNode::Renderer => {
            let same = study.own.is_some_and(|own| own.variant.engine == variant.engine);
            keys.extend((!same).then_some(("engine", variant.engine.name)));
        }
    }
    let adapter = study.adapters.iter().find(|adapter| adapter.engine == variant.engine);
    let wish = adapter.and_then(|adapter| adapter.wish.as_deref());
    keys.extend(wish.filter(|wish| asked.adapter.as_deref() != Some(wish)).map(|wish| ("adapter", wish)));
    let only = asked.compositor == "auto" && variant.engine.compositing.len() == 1;
    let compositor = variant.compositor().filter(|name| *name != asked.compositor && !only);
    keys.extend(compositor.map(|name| ("compositor", name)));
    // Tiles refuse what the file asks of those that blend.
    let accumulation = variant.compositing.is_some().then_some(setting.accumulation);
    let other = accumulation.filter(|one| *one != asked.accumulation);
    keys.extend(other.map(|one| ("accumulation", one.name())));
    keys
}

/// Sets a key of a node. One that says so already stays as it is written.
fn set(document: &mut Document, node: &str, name: &str, key: Key) -> Result<()> {
    let value = match key {
        Key::Text(word) => ParameterValue::Text(word.to_string()),
        Key::Integer(n) => ParameterValue::Integer(n),
        Key::Number(x) => ParameterValue::Number(x),
    };
    document.edit(&Edit::set(node, name, value))
}
