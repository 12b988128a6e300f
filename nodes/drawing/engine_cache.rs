//! Scenes on opened engines: an engine is opened once a session for each adapter, and takes in a volume once a revision.

use super::diagnostics::{note, note_whole};
use super::disk_cache::CacheFolder;
use super::needs::check_engine;
use super::parameters::{AUTO, COMPOSITOR, accumulation, adapter, compositor, order_check};
use super::visible;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_graph::RunContext;
use voltet_optics::engine::{
    AdapterRequest, Compositor, Engine, EngineInfo, KeyValueStore, NoStore, PreparedVolume, RenderOptions,
};
use voltet_optics::scene::Scene;

/// An engine by its name and what was wished for.
type Wished = (&'static str, AdapterRequest);

/// Cache of opened engines by name and adapter. Failures are cached too, since the search for adapters takes a while.
#[derive(Default)]
pub struct OpenEngines(Mutex<HashMap<Wished, Result<Arc<dyn Engine>>>>);

/// An engine, and the volume on it.
type EngineVolume = (Arc<dyn Engine>, Arc<dyn PreparedVolume>);

/// One volume on the engines that hold it, by engine and adapter.
#[derive(Default)]
pub struct PreparedVolumes(Mutex<HashMap<(&'static str, String), EngineVolume>>);

/// Draws on one engine, on the adapter that the node's parameters name, or the fastest. `port`: the input that the scene's volume
/// came by; `hardware`: programs that stand in for devices will not do unless they are named.
pub(super) fn draw_on(
    call: &mut RunContext,
    scene: &Scene,
    port: &str,
    declared: &'static EngineInfo,
    hardware: bool,
) -> Result<Picture> {
    check_engine(declared, call.parameters, &scene.transfer_function, &scene.shading)?;
    let wish = AdapterRequest { name: adapter(call.parameters), hardware };
    let folder = CacheFolder::named("adapters");
    let memory: &dyn KeyValueStore = if call.exhaustive() { &NoStore } else { &folder };
    let opened = call.keep_for_session(|| Ok(OpenEngines::default()))?;
    let engine =
        stage(call, declared, "device", |_| opened.open(declared, &wish, memory)).map_err(|error| {
            if wish.name.is_some() { call.parameters.locate("adapter", error) } else { error }
        })?;
    let (compositing, why) = compositing(call, scene, declared, engine.as_ref())?;
    let volumes = call.keep(call.revision(port)?, || Ok(PreparedVolumes::default()))?;
    let volume = stage(call, declared, "upload", |_| volumes.prepare(declared, &engine, scene))?;
    let accumulation = accumulation(call.parameters)?;
    let order_check = order_check(call.parameters)?;
    let (exhaustive, passing) = (call.exhaustive(), call.allows_preview());
    let manner = RenderOptions { compositing, accumulation, order_check, exhaustive, passing };
    let drawn = stage(call, declared, "draw", |progress| volume.draw(scene, &manner, progress))?;
    if drawn.is_passing {
        call.mark_preview();
    }
    let stages = drawn.stages.iter().map(|part| match declared.on_device {
        true => (format!("device {}", part.name()), part.seconds),
        false => (part.name().to_string(), part.seconds),
    });
    call.notes.stages.extend(stages);
    let (compositing, why) = match drawn.instead {
        Some(instead) => (Some(instead.compositing), Some(instead.why)),
        None => (compositing, why),
    };
    call.notes.compositor = compositing.map(|one| one.name().to_string()).zip(why);
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
    note_whole(call, scene, &drawn.counts)?;
    call.notes.warnings.extend(visible::warnings(scene, &drawn.counts, &drawn.picture));
    Ok(drawn.picture)
}

/// A part of the work that only a device has.
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

/// Compositor for the scene, and the reason, where the engine has several.
fn compositing(
    call: &mut RunContext,
    scene: &Scene,
    declared: &EngineInfo,
    engine: &dyn Engine,
) -> Result<(Option<Compositor>, Option<String>)> {
    if declared.compositing.is_empty() {
        return Ok((None, None));
    }
    if let Some(asked) = compositor(call.parameters)? {
        let why = match call.parameters.text(COMPOSITOR.name)? {
            AUTO => "the pipeline asks for an accumulation that tiles do not have",
            _ => "the pipeline asks for it",
        };
        return Ok((Some(asked), Some(why.into())));
    }
    let memory = CacheFolder::named("compositors");
    let Some(chosen) = engine.choose(scene, &memory, call.progress())? else { return Ok((None, None)) };
    let measured = chosen.measured_secs.map(|seconds| ("measure compositors".to_string(), seconds));
    call.notes.stages.extend(measured);
    Ok((Some(chosen.compositing), Some(chosen.why)))
}

impl OpenEngines {
    /// The engine, opened if it is not there or was lost.
    ///
    /// # Errors
    /// - no such adapter, or none at all.
    pub fn open(
        &self,
        declared: &EngineInfo,
        wish: &AdapterRequest,
        memory: &dyn KeyValueStore,
    ) -> Result<Arc<dyn Engine>> {
        let mut opened = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (declared.name, wish.clone());
        if let Some(known) = opened.get(&key).filter(|known| !matches!(known, Ok(engine) if engine.is_lost()))
        {
            return known.clone();
        }
        let engine = declared.open_remembering(wish, memory);
        opened.insert(key, engine.clone());
        engine
    }

    /// Lets an engine stand for what would be opened.
    #[cfg(test)]
    pub fn insert(&self, name: &'static str, wish: AdapterRequest, engine: Result<Arc<dyn Engine>>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert((name, wish), engine);
    }
}

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
