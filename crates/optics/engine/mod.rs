//! Engines, which draw scenes. Each is an [`EngineInfo`], a constant with its name and limits, and
//! a function that opens it; an [`Engine`] takes in a volume ([`Engine::prepare`]) and draws it ([`PreparedVolume::draw`]).
//!
//! The nodes that draw use engines through these types alone, from one list.
//!
//! | file | what |
//! | --- | --- |
//! | `compositing` | the ways in which a device composites |
//! | `drawn` | a picture and what it took: counts, stages with their times |

mod compositing;
mod drawn;

pub use compositing::{Accumulation, Compositor, CompositorChoice, KeyValueStore, NoStore, OrderCheck};
pub use drawn::{RenderOutput, RenderStats, Stage, StageTiming};

use crate::scene::Scene;
use crate::shading::Shading;
use std::any::Any;
use std::sync::Arc;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

/// Description of an engine before it is opened.
#[derive(Debug, Clone, Copy)]
pub struct EngineInfo {
    /// Its name in pipeline files and reports.
    pub name: &'static str,
    /// Summary in a few words: the meaning of its name as a value of the parameter `engine`.
    pub summary: &'static str,
    /// Text for `auto` taking this engine, after "the run takes"; `None` for an engine that is taken only by name.
    pub taken: Option<&'static str>,
    /// Why this build does not have it.
    pub unavailable_reason: Option<&'static str>,
    /// True if it runs on a device, which `adapter` names: it may be missing, has limits of its own, and keeps from frame to
    /// frame what was set up on it. Other engines draw every scene and set up each frame anew ([`Stage::SetUp`]).
    pub on_device: bool,
    /// The ways in which it composites; none where it has one only, of every order.
    pub compositing: &'static [Compositor],
    /// Refuses a scene that no device of it can draw, before data are read. Limits that depend on the data are checked when it is
    /// drawn.
    pub can_serve: fn(&TransferFunction, &Shading) -> Result<()>,
    /// The adapters that it finds here, in words.
    pub adapters: fn() -> Vec<String>,
    /// Opens it; what is looked for may be kept in the memory. Errors: no such adapter, or none at all.
    pub open: fn(&AdapterRequest, &dyn KeyValueStore) -> Result<Arc<dyn Engine>>,
}

/// The adapter that an engine shall be opened on.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct AdapterRequest {
    /// Its kind or a part of its name; none for the fastest.
    pub name: Option<String>,
    /// Passes over programs on the CPU that stand in for devices, unless they are named.
    pub hardware: bool,
}

/// Engines are told apart by their names.
impl PartialEq for EngineInfo {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl EngineInfo {
    /// An engine that this build does not have, and why.
    pub const fn absent(name: &'static str, summary: &'static str, why: &'static str) -> EngineInfo {
        EngineInfo {
            name,
            summary,
            taken: Some(name),
            unavailable_reason: Some(why),
            on_device: true,
            compositing: &[],
            can_serve: |_, _| Ok(()),
            adapters: Vec::new,
            open: |_, _| Err(Error::run("this build is without the engine")),
        }
    }

    /// Refuses a scene that the engine cannot draw on any device, and a build without it.
    pub fn can_serve(&self, transfer_function: &TransferFunction, shading: &Shading) -> Result<()> {
        self.check()?;
        (self.can_serve)(transfer_function, shading)
    }

    /// Opens it. Errors: no such adapter, or none at all; a build without it.
    pub fn open(&self, wish: &AdapterRequest) -> Result<Arc<dyn Engine>> {
        self.open_remembering(wish, &NoStore)
    }

    /// Opens it; the absence of a hardware adapter is cached while that can be checked to hold still. Errors: those of
    /// [`EngineInfo::open`].
    pub fn open_remembering(
        &self,
        wish: &AdapterRequest,
        memory: &dyn KeyValueStore,
    ) -> Result<Arc<dyn Engine>> {
        self.check()?;
        (self.open)(wish, memory)
    }

    fn check(&self) -> Result<()> {
        self.unavailable_reason.map_or(Ok(()), |why| Err(Error::run(why)))
    }
}

impl AdapterRequest {
    /// The adapter of that name, or the fastest that is hardware.
    pub fn hardware(name: Option<&str>) -> AdapterRequest {
        AdapterRequest { name: name.map(str::to_string), hardware: true }
    }
}

/// Execution options of one render: compositor, accumulation, check of the order, exhaustive and interactive mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RenderOptions {
    /// Compositor of a device; `None` for the one that supports every order.
    pub compositing: Option<Compositor>,
    /// Number format in which blending hardware accumulates.
    pub accumulation: Accumulation,
    /// Check of the exact order of cells that hardware blends.
    pub order_check: OrderCheck,
    /// True to do all work, needed or not, for comparison; the picture is the same.
    pub exhaustive: bool,
    /// True if other pictures of the same view follow at once, with other widgets: the engine may cache the view's segments, and the picture
    /// may differ by rounding, some 1e-5, from one that is drawn by itself ([`RenderOutput::is_passing`]).
    pub passing: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        RenderOptions {
            compositing: None,
            accumulation: Accumulation::Float,
            order_check: OrderCheck::None,
            exhaustive: false,
            passing: false,
        }
    }
}

impl RenderOptions {
    /// Options with a compositor.
    pub fn with_compositor(compositing: Compositor) -> RenderOptions {
        RenderOptions { compositing: Some(compositing), ..RenderOptions::default() }
    }

    /// One of many pictures of a view that follow each other.
    pub fn passing() -> RenderOptions {
        RenderOptions { passing: true, ..RenderOptions::default() }
    }
}

/// An engine that is open: what it runs on is there. `Any`: a crate that knows an engine's own type finds it again.
pub trait Engine: Any + Send + Sync {
    /// Name of its device, or of its vector units and threads.
    fn adapter(&self) -> String;

    /// Name on pages that compare engines.
    fn label(&self) -> String {
        self.adapter()
    }

    /// Why it runs on that, where there was a choice.
    fn reason(&self) -> Option<&str> {
        None
    }

    /// True if it runs on a program on the CPU that stands in for a device.
    fn is_software(&self) -> bool {
        false
    }

    /// True if the device has been lost: the engine cannot be used any more.
    fn is_lost(&self) -> bool {
        false
    }

    /// Takes in a volume: what frames of it share is made once. Errors: what the device cannot hold.
    fn prepare(&self, volume: &Arc<Volume>) -> Result<Arc<dyn PreparedVolume>>;

    /// Best compositor for the scene on this device, if the engine has several. It may measure; the result is
    /// kept in `memory`. Errors: a stopped run.
    fn choose(
        &self,
        _scene: &Scene,
        _memory: &dyn KeyValueStore,
        _progress: &dyn Progress,
    ) -> Result<Option<CompositorChoice>> {
        Ok(None)
    }
}

/// A picture under way: others can be begun before it is taken.
pub trait Pending: Send {
    /// The picture, once it is there. Errors: those of [`PreparedVolume::draw`].
    fn collect(self: Box<Self>, progress: &dyn Progress) -> Result<RenderOutput>;
}

/// A picture that is there.
impl Pending for RenderOutput {
    fn collect(self: Box<Self>, _progress: &dyn Progress) -> Result<RenderOutput> {
        Ok(*self)
    }
}

/// A volume on an engine.
pub trait PreparedVolume: Any + Send + Sync {
    /// Draws a scene of this volume.
    ///
    /// Errors: what the engine does not serve or its device does not hold; a lost device; a stopped run.
    fn draw(&self, scene: &Scene, manner: &RenderOptions, progress: &dyn Progress) -> Result<RenderOutput>;

    /// Begins a picture. A device works on it while the caller does something else, and on several one after the other, so that it
    /// need not wait for their way back; what it sends back is bounded, and a picture beyond that is drawn at once. Its passes are
    /// not timed. Other engines draw at once. Errors: those of [`PreparedVolume::draw`], here or when the picture is taken.
    fn begin(
        &self,
        scene: &Scene,
        manner: &RenderOptions,
        progress: &dyn Progress,
    ) -> Result<Box<dyn Pending>> {
        Ok(Box::new(self.draw(scene, manner, progress)?))
    }
}
