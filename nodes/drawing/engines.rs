//! The engines that there are: parameters that choose one, its choice with the reason in the report, and scenes on opened engines: an
//! engine is opened once a session for each adapter, and takes in a volume once a revision.

use super::diagnostics::{self, note, note_unsorted, record_unsorted};
use super::scene::{ask, check_engine, shading};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_graph::{DefaultValue, DemandContext, Parameter, ParameterType, RunContext};
use voltet_optics::engine::{AdapterRequest, Compositor, Engine, EngineInfo, PreparedVolume, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Ordering, Shading};

#[cfg(feature = "gpu")]
const GPU: EngineInfo = voltet_gpu::ENGINE;
#[cfg(not(feature = "gpu"))]
const GPU: EngineInfo = EngineInfo::absent(
    "gpu",
    "the graphics device, which this build has no engine for",
    "this build has no GPU engine",
);

/// The engines. The first draws every scene; `auto` tries them from the last to the first, but for those that are taken by name only.
pub const ENGINES: &[EngineInfo] = &[voltet_cpu::ENGINE, GPU];

/// The engine that draws every scene, whatever machine this is.
pub const NATIVE: &EngineInfo = &ENGINES[0];

/// The engine on a device, which the node `gpu-renderer` always takes.
pub const DEVICE: &EngineInfo = &GPU;

#[cfg(all(test, feature = "gpu"))]
mod device_tests;

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

const COMPOSITOR_WORDS: [(&str, &str); Compositor::NAMES.len() + 1] =
    words!("tiles", Compositor::NAMES, |word| *word);

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
    let shading = shading(asking.parameters)?;
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
    let needed = ask(asking, "volume", "transfer_function")?;
    if !needed.order {
        record_unsorted(asking.notes, None);
    }
    Ok(())
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

/// Draws on one engine, on the adapter that the node's parameters name, or the fastest. `port`: the input that the scene's volume
/// came by; `hardware`: refuses devices that are programs on the CPU, unless they are named.
pub(crate) fn draw_on(
    call: &mut RunContext,
    scene: &Scene,
    port: &str,
    declared: &'static EngineInfo,
    hardware: bool,
) -> Result<Picture> {
    check_engine(declared, call.parameters, &scene.transfer_function, &scene.shading)?;
    let parameters = call.parameters;
    let word = |name: &str| parameters.optional(name).and_then(|setting| setting.text());
    let wish = AdapterRequest { name: word(ADAPTER.name).map(str::to_string), hardware };
    let opened = call.keep_for_session(|| Ok(OpenEngines::default()))?;
    let engine = stage(call, declared, "device", |_| opened.open(declared, &wish)).map_err(|error| {
        if wish.name.is_some() { call.parameters.locate("adapter", error) } else { error }
    })?;
    let volumes = call.keep(call.revision(port)?, || Ok(PreparedVolumes::default()))?;
    let volume = stage(call, declared, "upload", |_| volumes.prepare(declared, &engine, scene))?;
    let (exhaustive, preview) = (call.exhaustive(), call.allows_preview());
    let asked = word(COMPOSITOR.name).and_then(Compositor::named);
    let compositing = asked.filter(|asked| declared.compositing.contains(asked));
    let manner = RenderOptions { compositing, exhaustive, preview };
    let drawn = stage(call, declared, "draw", |progress| volume.draw(scene, &manner, progress))?;
    if drawn.is_preview {
        call.mark_preview();
    }
    let stages = drawn.stages.iter().map(|part| match declared.on_device {
        true => (format!("device {}", part.name()), part.seconds),
        false => (part.name().to_string(), part.seconds),
    });
    call.notes.stages.extend(stages);
    let has_several = !declared.compositing.is_empty();
    call.notes.compositor = has_several.then(|| compositor(compositing, scene, exhaustive));
    call.notes.adapter = Some(engine.adapter());
    if let Some(reason) = engine.reason() {
        call.notes.engine = Some((declared.name.into(), reason.into()));
    }
    if engine.is_software() {
        let slow = "is a program on the CPU, slower than engine = \"cpu\"";
        call.notes.warnings.push(format!("{} {slow}", engine.adapter()));
    }
    call.notes.counts.insert("cells_total", scene.volume.grid.tetrahedra.len() as u64);
    call.notes.add(drawn.notes);
    note(call, &drawn.counts);
    note_unsorted(call, scene, &drawn.counts);
    call.notes.warnings.extend(diagnostics::warnings(scene, &drawn.counts, &drawn.picture));
    Ok(drawn.picture)
}

/// A part of the work, which is a stage of its own, with its time, where a device draws.
fn stage<T>(
    call: &mut RunContext,
    declared: &EngineInfo,
    name: &str,
    work: impl FnOnce(&dyn Progress) -> Result<T>,
) -> Result<T> {
    match declared.on_device {
        true => call.stage(name, work),
        false => work(call.progress()),
    }
}

/// Compositor that draws the scene, and the reason. `asked`: the one that the pipeline asks for.
fn compositor(asked: Option<Compositor>, scene: &Scene, exhaustive: bool) -> (String, String) {
    let served = asked.filter(|asked| asked.makes(scene.ordering(false)));
    let why = match served {
        Some(_) => "the pipeline asks for it",
        None if scene.ordering(exhaustive) == Ordering::PerPixel => "each pixel needs its exact order",
        None => "it is the standard one",
    };
    (served.unwrap_or(Compositor::Tiles).name().into(), why.into())
}

/// Cache of opened engines by name and adapter. Failures are cached too, since the search for adapters takes a while.
#[derive(Default)]
pub struct OpenEngines(Mutex<HashMap<EngineKey, Result<Arc<dyn Engine>>>>);

type EngineKey = (&'static str, AdapterRequest);

impl OpenEngines {
    /// The engine, opened if it is not there or was lost.
    ///
    /// # Errors
    /// - no such adapter, or none at all.
    pub fn open(&self, declared: &EngineInfo, wish: &AdapterRequest) -> Result<Arc<dyn Engine>> {
        let mut opened = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (declared.name, wish.clone());
        if let Some(known) = opened.get(&key).filter(|known| !matches!(known, Ok(engine) if engine.is_lost()))
        {
            return known.clone();
        }
        let engine = declared.open(wish);
        opened.insert(key, engine.clone());
        engine
    }
}

/// One volume on the engines that hold it, by engine and adapter.
#[derive(Default)]
pub struct PreparedVolumes(Mutex<HashMap<(&'static str, String), EngineVolume>>);

type EngineVolume = (Arc<dyn Engine>, Arc<dyn PreparedVolume>);

impl PreparedVolumes {
    /// The scene's volume on the engine, uploaded if it is not there.
    ///
    /// # Errors
    /// - a volume that the device cannot hold.
    pub fn prepare(
        &self,
        declared: &EngineInfo,
        engine: &Arc<dyn Engine>,
        scene: &Scene,
    ) -> Result<Arc<dyn PreparedVolume>> {
        let mut volumes = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (declared.name, engine.adapter());
        if let Some((_, volume)) = volumes.get(&key).filter(|(known, _)| Arc::ptr_eq(known, engine)) {
            return Ok(volume.clone());
        }
        let volume = engine.prepare(&scene.volume)?;
        volumes.insert(key, (engine.clone(), volume.clone()));
        Ok(volume)
    }
}
