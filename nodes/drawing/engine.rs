//! Choice of the engine: parameters, candidates, and the reason in the report.

use super::engine_cache::draw_on;
use super::engines::{ENGINES, NATIVE};
use super::needs::check_engine;
use super::order::record_unsorted;
use super::parameters::{ACCUMULATION, ADAPTER, AUTO, ENGINE, accumulation, compositor};
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::{DemandContext, Parameters, RunContext};
use voltet_optics::engine::{Compositor, EngineInfo};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Shading;

/// True if an engine is asked where a pipeline says this.
pub fn is_asked_by(engine: &EngineInfo, wanted: &str) -> bool {
    match wanted {
        AUTO => engine.taken.is_some(),
        named => engine.name == named,
    }
}

/// Engines that may draw a scene, in order of preference: for `auto` those of the list that it takes, the last first; else the named
/// one. An integrator with an engine of its own runs on no device: that engine draws whatever the name.
pub fn candidate_engines(wanted: &str, shading: &Shading) -> Vec<&'static EngineInfo> {
    let own = shading.integrator.extension();
    let drawing = |engine: &'static EngineInfo| own.filter(|_| !engine.on_device).unwrap_or(engine);
    let is_asked = |engine: &&EngineInfo| match wanted {
        AUTO => is_asked_by(engine, AUTO) && !(engine.on_device && own.is_some()),
        named => is_asked_by(engine, named),
    };
    ENGINES.iter().rev().filter(is_asked).map(drawing).collect()
}

/// Notes the engine, as far as it is known before the run, and asks for what the scene needs.
pub fn ask_engine(asking: &mut DemandContext, wanted: &str) -> Result<()> {
    let shading = super::shading(asking.parameters)?;
    let engines = candidate_engines(wanted, &shading);
    if let [EngineInfo { unavailable_reason: Some(why), .. }] = engines.as_slice() {
        let item = if asking.parameters.is_set(ENGINE.name) { ENGINE.name } else { ADAPTER.name };
        return Err(asking
            .parameters
            .error(item, *why)
            .got(wanted)
            .expected(format!("\"{}\", or \"{AUTO}\", which takes what is there", NATIVE.name)));
    }
    asking.notes.engine = Some(planned(asking, wanted, &engines, &shading)?);
    let needed = super::ask(asking, "volume", "transfer_function")?;
    check_accumulation(asking.parameters, &engines)?;
    if !needed.order {
        record_unsorted(asking.notes, None);
    }
    Ok(())
}

/// Refuses, before anything is read, an accumulation that the compositor does not have, where an engine that may draw has that.
fn check_accumulation(p: &Parameters, engines: &[&EngineInfo]) -> Result<()> {
    let has = |one: &Compositor| engines.iter().any(|engine| engine.compositing.contains(one));
    let Some(asked) = compositor(p)?.filter(has) else { return Ok(()) };
    accumulation(p)?.check(asked).map_err(|error| p.locate(ACCUMULATION.name, error))
}

/// The engine that will draw, and why, as far as it can be said before a device is opened. Errors: one that was named does not
/// serve the scene on any device.
fn planned(
    asking: &DemandContext,
    wanted: &str,
    engines: &[&'static EngineInfo],
    shading: &Shading,
) -> Result<(String, String)> {
    let look = asking.look("transfer_function");
    let serves = |engine: &EngineInfo| match &look {
        Some(look) => check_engine(engine, asking.parameters, &look.transfer_function, shading),
        None => engine.unavailable_reason.map_or(Ok(()), |why| Err(Error::run(why))),
    };
    let mut why = "the pipeline asks for it".to_string();
    for (k, engine) in engines.iter().enumerate() {
        let named = (engine.name.to_string(), why);
        match serves(engine) {
            _ if engine.taken.is_none() => return Ok((named.0, registered_reason(engine))),
            // The first of the list, asked last, draws every scene that can be drawn: what it says is wrong is wrong.
            Err(error) if k + 1 < engines.len() => why = error.to_string(),
            Err(error) => return Err(error),
            Ok(()) if wanted == AUTO && engine.on_device => {
                let taken: Vec<&str> = engines[k..].iter().filter_map(|engine| engine.taken).collect();
                return Ok((AUTO.into(), format!("the run takes {}", taken.join(", else "))));
            }
            Ok(()) => return Ok(named),
        }
    }
    Err(Error::run("no engine draws the scene").got(wanted))
}

/// Reason that an engine draws which is registered for an integrator.
pub fn registered_reason(engine: &EngineInfo) -> String {
    format!("the integrator {} has an engine of its own", engine.name)
}

/// Draws on the engine that is wanted.
pub fn draw(call: &mut RunContext, scene: &Scene, wanted: &str) -> Result<Picture> {
    let engines = candidate_engines(wanted, &scene.shading);
    check_accumulation(call.parameters, &engines)?;
    let mut refused: Option<String> = None;
    for engine in &engines {
        if wanted != AUTO {
            return draw_on(call, scene, "volume", engine, false);
        }
        call.notes.engine = refused.take().map(|why| (engine.name.into(), why));
        match draw_on(call, scene, "volume", engine, true) {
            Err(error) if engine.on_device && error.kind != ErrorKind::Cancelled => {
                refused = Some(error.to_string());
            }
            done => return done,
        }
    }
    Err(Error::run("no engine draws the scene").got(wanted))
}
