//! Output of a render: the picture, counts and times.

use super::compositing::CompositorChoice;
use voltet_core::diagnostics::Diagnostics;
use voltet_core::picture::Picture;

/// A picture and what it took.
#[derive(Debug, Clone)]
pub struct RenderOutput {
    /// The picture.
    pub picture: Picture,
    /// Counts.
    pub counts: RenderStats,
    /// Times of the stages, in the order of work; empty if they are not measured.
    pub stages: Vec<StageTiming>,
    /// The way in which it was composited, where it is not the one that was asked for, and why.
    pub instead: Option<CompositorChoice>,
    /// True if it was drawn from cached segments of the view ([`crate::engine::RenderOptions::passing`]): by itself it would differ by
    /// rounding.
    pub is_passing: bool,
    /// Further diagnostics: counts of this engine alone, skipped work, warnings.
    pub notes: Diagnostics,
}

impl RenderOutput {
    /// A picture of which nothing is counted or noted yet.
    pub fn new(picture: Picture, stages: Vec<StageTiming>) -> RenderOutput {
        RenderOutput {
            picture,
            counts: RenderStats::default(),
            stages,
            instead: None,
            is_passing: false,
            notes: Diagnostics::default(),
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
