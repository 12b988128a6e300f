//! Engines, which draw scenes. Each is an [`EngineInfo`], a constant with its name and limits, and
//! a function that opens it; an [`Engine`] takes in a volume ([`Engine::prepare`]) and draws it ([`PreparedVolume::draw`]).
//!
//! The nodes that draw use engines through these types alone, from one list.

use crate::depth_image::VolumetricDepthImage;
use crate::scene::Scene;
use crate::scene_parts::{PartTally, SceneChoices, SceneExtent};
use crate::shading::{Ordering, Shading};
use std::any::Any;
use std::sync::Arc;
use voltet_core::diagnostics::Diagnostics;
use voltet_core::picture::Picture;
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
    /// True if it draws parts of a grid, each by itself ([`Engine::prepare_part`]).
    pub draws_parts: bool,
    /// The ways in which it composites; none where it has one only, of every order.
    pub compositing: &'static [Compositor],
    /// Refuses a scene that no device of it can draw, before data are read. Limits that depend on the data are checked when it is
    /// drawn.
    pub can_serve: fn(&TransferFunction, &Shading) -> Result<()>,
    /// The adapters that it finds here, in words.
    pub adapters: fn() -> Vec<String>,
    /// Opens it. Errors: no such adapter, or none at all.
    pub open: fn(&AdapterRequest) -> Result<Arc<dyn Engine>>,
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
            draws_parts: false,
            compositing: &[],
            can_serve: |_, _| Ok(()),
            adapters: Vec::new,
            open: |_| Err(Error::run("this build is without the engine")),
        }
    }

    /// Refuses a scene that the engine cannot draw on any device, and a build without it.
    pub fn can_serve(&self, transfer_function: &TransferFunction, shading: &Shading) -> Result<()> {
        self.check()?;
        (self.can_serve)(transfer_function, shading)
    }

    /// Opens it. Errors: no such adapter, or none at all; a build without it.
    pub fn open(&self, wish: &AdapterRequest) -> Result<Arc<dyn Engine>> {
        self.check()?;
        (self.open)(wish)
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

/// Execution options of one render: compositor, exhaustive and interactive mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RenderOptions {
    /// Compositor of a device; `None`, and where it does not make the scene's order: the one that supports every order.
    pub compositing: Option<Compositor>,
    /// True to do all work, needed or not, for comparison; the picture is the same.
    pub exhaustive: bool,
    /// True if other pictures of the same view follow at once, with other widgets: the engine may cache the view's segments, and the picture
    /// may differ by rounding, some 1e-5, from one that is drawn by itself ([`RenderOutput::is_preview`]).
    pub preview: bool,
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

    /// Takes in a part of a volume, to be drawn by itself as a part of the grid that has this extent. Errors: those of
    /// [`Engine::prepare`]; an engine without [`EngineInfo::draws_parts`].
    fn prepare_part(&self, _volume: &Arc<Volume>, _whole: &SceneExtent) -> Result<Arc<dyn PreparedPart>> {
        Err(Error::run("the engine draws whole grids").got("a part of a grid").expected("another engine"))
    }

    /// The choices for a whole grid of this extent, whose parts have this tally together, with the boundary counted
    /// ([`PartTally::count_boundary`]). Errors: an extent beyond 64-bit floats.
    fn choices(
        &self,
        _whole: &SceneExtent,
        _transfer_function: &TransferFunction,
        _tally: &PartTally,
    ) -> Result<SceneChoices> {
        Ok(SceneChoices::default())
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

/// A part of a grid on an engine, whose other parts are drawn by themselves.
pub trait PreparedPart: Send + Sync {
    /// Selects the cells of a scene by these choices, to be tallied and drawn. Errors: those of [`PreparedVolume::draw`].
    fn select(
        self: Arc<Self>,
        scene: &Scene,
        choices: &SceneChoices,
        manner: &RenderOptions,
        progress: &dyn Progress,
    ) -> Result<Box<dyn SelectedPart>>;
}

/// A part of a grid with the cells that a scene selects.
pub trait SelectedPart: Send + Sync {
    /// Figures of the cells. `finds_boundary`: false to leave out a boundary that only the other parts may need
    /// ([`PartTally::lacks_boundary`]).
    fn tally(&self, finds_boundary: bool) -> PartTally;

    /// Draws the volumetric depth image of the scene ([`RenderOutput::part`]). Errors: those of [`PreparedVolume::draw`].
    fn draw(self: Box<Self>, progress: &dyn Progress) -> Result<RenderOutput>;
}

/// Way from a device's cells to the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Compositor {
    /// Compute passes over tiles of pixels.
    Tiles,
    /// The cells' silhouettes, drawn farthest first and blended by the hardware: one order of whole cells for all pixels.
    Raster,
    /// Each cell as three or four triangles round its thick vertex (Shirley and Tuchman 1990), drawn and blended likewise:
    /// what the hardware interpolates between corners is a little off.
    Triangles,
}

impl Compositor {
    /// Each of them with its meaning, what serves every order first.
    pub const NAMES: &[(&str, &str)] = &[
        (
            "tiles",
            "compute passes over tiles of 8 × 8 pixels: every order, and pixels in disorder are counted",
        ),
        (
            "raster",
            "cells in order, drawn and blended by the hardware: for scenes that need no order and for order = \"centroid\" or \
             \"none\", whose errors it does not count; where each pixel needs its exact order, tiles draw",
        ),
        #[cfg(feature = "triangles")]
        (
            "triangles",
            "cells as triangles round their thick vertex (Shirley and Tuchman 1990), in perspective, else as raster: \
             to see what the classic method costs and how far it is off; auto never takes it",
        ),
    ];

    /// Compositors of [`Compositor::NAMES`], in their order.
    pub const ALL: &[Compositor] = &[
        Compositor::Tiles,
        Compositor::Raster,
        #[cfg(feature = "triangles")]
        Compositor::Triangles,
    ];

    /// The name in pipeline files.
    pub fn name(self) -> &'static str {
        match self {
            Compositor::Tiles => "tiles",
            Compositor::Raster => "raster",
            Compositor::Triangles => "triangles",
        }
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Compositor> {
        Compositor::ALL.iter().copied().find(|one| one.name() == name)
    }

    /// True if it makes such an order: what blends whole cells has none of its own for each pixel.
    pub fn makes(self, ordering: Ordering) -> bool {
        self == Compositor::Tiles || ordering != Ordering::PerPixel
    }
}

/// A picture and what it took.
#[derive(Debug, Clone)]
pub struct RenderOutput {
    /// The picture; of a part it is transparent, see `part`.
    pub picture: Picture,
    /// Counts.
    pub counts: RenderStats,
    /// Times of the stages, in the order of work; empty if they are not measured.
    pub stages: Vec<StageTiming>,
    /// True if it was drawn from cached segments of the view ([`crate::engine::RenderOptions::preview`]): by itself it would differ by
    /// rounding.
    pub is_preview: bool,
    /// Further diagnostics: counts of this engine alone, skipped work, warnings.
    pub notes: Diagnostics,
    /// The volumetric depth image of a part ([`SelectedPart::draw`]).
    pub part: Option<VolumetricDepthImage>,
}

impl RenderOutput {
    /// A picture of which nothing is counted or noted yet.
    pub fn new(picture: Picture, stages: Vec<StageTiming>) -> RenderOutput {
        RenderOutput {
            picture,
            counts: RenderStats::default(),
            stages,
            is_preview: false,
            notes: Diagnostics::default(),
            part: None,
        }
    }
}

/// Counts that mean the same on every engine; `None`: not counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Cells left out because no widget touches their values.
    pub culled_by_transfer_function: Option<u64>,
    /// Cells left out because they are outside the view.
    pub culled_by_frustum: Option<u64>,
    /// Cells left out because they cover no pixel's middle.
    pub under_a_pixel: Option<u64>,
    /// Cells that were projected: kept, and such that may cover a pixel's middle.
    pub cells_projected: Option<u64>,
    /// Ray segments integrated.
    pub segments: Option<u64>,
    /// Segments of these that were integrated in 64 bits because 32 do not hold them.
    pub segments_exact: Option<u64>,
    /// Number of evaluations of the transfer function: places at which samples or points of a quadrature were taken, closed forms of
    /// segments, entries between those of a table. Widgets that a place has together count once, segments that meet none not at
    /// all, and a segment in 64 bits as one.
    pub evaluations: Option<u64>,
    /// Pixels (samples, where a pixel has several) whose segments were composited in an order that was not exact.
    pub pixels_disordered: Option<u64>,
    /// Tiles that were opaque before all their cells had been looked at.
    pub tiles_stopped: Option<u64>,
    /// Cells that such tiles did not look at any more, where that is known; a cell counts in each of them.
    pub cells_hidden: Option<u64>,
    /// Tables that the integrator built for this picture.
    pub tables_built: Option<u64>,
}

/// A stage of drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Selection of the cells that can contribute.
    Cull,
    /// The cells' order; sharing them out among tiles.
    Sort,
    /// Points and cells to the screen.
    Project,
    /// Work for a frame that further ones can use: tables, compiled widgets.
    SetUp,
    /// Integrating and compositing the segments.
    Composite,
}

/// A part of the work with its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageTiming {
    /// The stage that it is part of.
    pub stage: Stage,
    /// Its own name, where the stage has several parts.
    pub pass: Option<&'static str>,
    /// Seconds.
    pub seconds: f64,
}

impl Stage {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Cull => "cull",
            Stage::Sort => "sort",
            Stage::Project => "project",
            Stage::SetUp => "set-up",
            Stage::Composite => "composite",
        }
    }
}

impl StageTiming {
    /// A whole stage.
    pub fn whole(stage: Stage, seconds: f64) -> StageTiming {
        StageTiming { stage, pass: None, seconds }
    }

    /// Its name in reports.
    pub fn name(&self) -> &'static str {
        self.pass.unwrap_or(self.stage.name())
    }
}
