//! A setting written into a pipeline file; every other byte stays as it is.

use super::settings::{order_name, overlap_name};
use super::{Form, Setting, Study, Value as Key};
use toml_edit::{DocumentMut, Item, TableLike, Value};
use voltet_core::optics::Overlap;
use voltet_core::optics::integrators::Integrator;
use voltet_core::{Error, Result};

/// The text of the pipeline file with one of the study's settings in it. Overlap, order, engine, adapter and compositor are
/// written where they differ from what the file says or comes to here; a `gpu-renderer` that is to draw on the native
/// engine becomes a `renderer`.
pub fn apply(text: &str, study: &Study, setting: &Setting) -> Result<String> {
    let subject = &study.subject;
    // Line ends of two characters would come out as one.
    let windows = text.contains("\r\n");
    if windows && text.replace("\r\n", "").contains('\n') {
        return Err(Error::usage(
            "the file mixes two kinds of line ends, so that it cannot be changed alone where asked",
        )
        .accepted("one kind of line end throughout"));
    }
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        Error::usage("the pipeline file cannot be read as TOML").found(error.message())
    })?;
    let own = Setting::of_file(subject, setting.painter);
    for (name, key) in setting.keys() {
        set(&mut document, &subject.node, name, key)?;
    }
    if setting.overlap != own.overlap && setting.integrator == Integrator::Analytic {
        set(&mut document, &subject.node, "overlap", Key::Text(overlap_name(setting.overlap)))?;
    } else if own.overlap == Overlap::Mix && setting.integrator != Integrator::Analytic {
        // Of no account for the others, and misleading.
        set(&mut document, &subject.node, "overlap", Key::Text(overlap_name(Overlap::Exact)))?;
    }
    if setting.order != own.order
        && let Some(node) = &subject.order_node
    {
        set(&mut document, node, "order", Key::Text(order_name(setting.order)))?;
    }
    for (name, value) in engine_keys(study, setting) {
        set(&mut document, &subject.node, name, Key::Text(value))?;
    }
    let written = document.to_string();
    Ok(if windows && !written.contains("\r\n") { written.replace('\n', "\r\n") } else { written })
}

/// The keys that state the setting's engine, where the file comes to another one.
fn engine_keys<'a>(study: &'a Study, setting: &Setting) -> Vec<(&'static str, &'a str)> {
    let asked = &study.subject.asked;
    let painter = setting.painter;
    let mut keys = Vec::new();
    match asked.form {
        Form::Stages => return keys,
        Form::GpuRenderer if painter.engine.name != asked.engine => {
            keys.extend([("type", "renderer"), ("engine", painter.engine.name)]);
        }
        Form::GpuRenderer => {}
        Form::Renderer => {
            let same = study.own.is_some_and(|own| own.painter.engine == painter.engine);
            keys.extend((!same).then_some(("engine", painter.engine.name)));
        }
    }
    let adapter = study.adapters.iter().find(|adapter| adapter.engine == painter.engine);
    let wish = adapter.and_then(|adapter| adapter.wish.as_deref());
    keys.extend(wish.filter(|wish| asked.adapter.as_deref() != Some(wish)).map(|wish| ("adapter", wish)));
    let only = asked.compositor == "auto" && painter.engine.compositing.len() == 1;
    let compositor = painter.compositor().filter(|name| *name != asked.compositor && !only);
    keys.extend(compositor.map(|name| ("compositor", name)));
    keys
}

/// Sets a key of a node. The spaces and comments around a value that is there stay.
fn set(document: &mut DocumentMut, node: &str, name: &str, key: Key) -> Result<()> {
    let missing =
        || Error::run("the node is not where the pipeline file should have it").found(node.to_string());
    let table: &mut dyn TableLike = document
        .get_mut("nodes")
        .and_then(Item::as_table_like_mut)
        .and_then(|nodes| nodes.get_mut(node))
        .and_then(Item::as_table_like_mut)
        .ok_or_else(missing)?;
    let mut value = match key {
        Key::Text(word) => Value::from(word),
        Key::Integer(n) => Value::from(n),
        Key::Number(x) => Value::from(x),
    };
    match table.get_mut(name).and_then(Item::as_value_mut) {
        Some(there) if same(there, &value) => {}
        Some(there) => {
            *value.decor_mut() = there.decor().clone();
            *there = value;
        }
        None => {
            table.insert(name, Item::Value(value));
        }
    }
    Ok(())
}

/// Whether both mean the same, so that the way it is written can stay.
fn same(a: &Value, b: &Value) -> bool {
    match (a.as_str(), b.as_str(), a.as_integer(), b.as_integer(), a.as_float(), b.as_float()) {
        (Some(a), Some(b), ..) => a == b,
        (_, _, Some(a), Some(b), ..) => a == b,
        (.., Some(a), Some(b)) => a == b,
        _ => false,
    }
}
