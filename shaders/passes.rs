//! The passes over points, cells and lists that stand before the tiles: their texts and their uniforms.

use crate::parts::{Access, GridArray, Layout, grid_text};
use crate::text::{Shader, compose_pieces};
use bytemuck::{Pod, Zeroable};

/// A pass that is the same for every scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FramePass {
    /// `see_points`: positions as the view sees them, and the scalar.
    Points,
    /// `place_attribute`: one further value of the points.
    Attribute,
    /// `bound_cells`: which cells can contribute, the pixels they may cover, lengths of the tiles' lists.
    Cells,
    /// `start_lists`: where each tile's list begins.
    Starts,
    /// `fill_lists`: the cells' numbers into the lists.
    Lists,
    /// `sort_lists`: each list by its key.
    Sort,
    /// `count_digits`: how often each digit of the key occurs, for the sort of all cells.
    CountDigits,
    /// `place_digits`: where each digit's cells go.
    PlaceDigits,
    /// `move_digits`: the cells to there.
    MoveDigits,
    /// `aim_runs`: the draws of the sorted cells.
    Runs,
    /// `split_cells`: the triangles of a run of them.
    Split,
}

impl FramePass {
    /// Every pass: of all compositors, of the tiles, of what is blended.
    pub const ALL: [FramePass; 11] = [
        FramePass::Points,
        FramePass::Attribute,
        FramePass::Cells,
        FramePass::Starts,
        FramePass::Lists,
        FramePass::Sort,
        FramePass::CountDigits,
        FramePass::PlaceDigits,
        FramePass::MoveDigits,
        FramePass::Runs,
        FramePass::Split,
    ];

    /// The text, with the grid's arrays in the parts of `layout`.
    pub fn shader(self, layout: &Layout) -> Shader {
        compose_pieces(&grid_text(self.grid_arrays(), layout), &[self.names()[0]])
    }

    /// The function that the pass runs.
    pub fn entry_point(self) -> &'static str {
        self.names()[1]
    }

    /// Grid arrays that the pass reads and writes.
    pub fn grid_arrays(self) -> &'static [(GridArray, Access)] {
        use Access::{Read, Write};
        use GridArray::{Attributes, Bounds, Positions, Quantity, Seen, Tetrahedra};
        match self {
            FramePass::Points => &[(Positions, Read), (Quantity, Read), (Seen, Write)],
            FramePass::Attribute => &[(Quantity, Read), (Attributes, Write)],
            FramePass::Cells => &[(Tetrahedra, Read), (Seen, Read), (Attributes, Read), (Bounds, Write)],
            FramePass::Starts | FramePass::Sort | FramePass::Runs => &[],
            _ => &[(Tetrahedra, Read), (Seen, Read), (Bounds, Read)],
        }
    }

    /// Piece and entry point.
    fn names(self) -> [&'static str; 2] {
        match self {
            FramePass::Points => ["passes/points", "see_points"],
            FramePass::Attribute => ["passes/attribute", "place_attribute"],
            FramePass::Cells => ["passes/cells", "bound_cells"],
            FramePass::Starts => ["passes/starts", "start_lists"],
            FramePass::Lists => ["passes/lists", "fill_lists"],
            FramePass::Sort => ["passes/sort", "sort_lists"],
            FramePass::CountDigits => ["passes/count_digits", "count_digits"],
            FramePass::PlaceDigits => ["passes/place_digits", "place_digits"],
            FramePass::MoveDigits => ["passes/move_digits", "move_digits"],
            FramePass::Runs => ["passes/runs", "aim_runs"],
            FramePass::Split => ["passes/split", "split_cells"],
        }
    }
}

/// The pass that measures a device's multiply-adds: its text, and how many each of its workgroups does.
pub fn multiply_adds() -> (Shader, u64) {
    // 64 invocations, 1,024 rounds, 8 chains of 4 lanes.
    (compose_pieces("", &["multiply_adds"]), 64 * 1024 * 8 * 4)
}

/// `View` of `passes/view.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ViewRecord {
    /// Camera axis to the right, world axes, unit length.
    pub right: [f32; 3],
    /// Depth of the base from the eye, scene lengths.
    pub distance: f32,
    /// Camera axis downwards.
    pub down: [f32; 3],
    /// Slope of a ray one pixel off the axis (perspective), or a pixel's side in scene lengths.
    pub pixel: f32,
    /// View direction.
    pub forward: [f32; 3],
    /// Depth from the base in front of which nothing is seen.
    pub near: f32,
    /// The base from the middle of the grid, scene lengths: high part.
    pub base_high: [f32; 3],
    /// 1, or 0 for parallel rays.
    pub perspective: f32,
    /// Low part.
    pub base_low: [f32; 3],
    /// Weight of a sample in its pixel.
    pub weight: f32,
    /// Pixel coordinates of the view axis.
    pub axis: [f32; 2],
    /// The picture, in pixels.
    pub size: [u32; 2],
    /// The window that is drawn, in tiles: first column and row, columns and rows.
    pub window: [u32; 4],
    /// Points of the grid.
    pub point_count: u32,
    /// Tetrahedra.
    pub cell_count: u32,
    /// Entries that the lists have room for.
    pub capacity: u32,
    /// Sort key of lists: 0 nearest depth, 1 distance of the centroid, 2 number of the cell.
    pub sort_key: u32,
    /// Origin of the stored scalar: high and low part.
    pub scalar_offset: [f32; 2],
    /// Widgets of the scene.
    pub widget_count: u32,
    /// 1 for the first sample of a pixel.
    pub is_first: u32,
    /// Work that a tile does before it stops, for the next dispatch to go on.
    pub budget: u32,
    /// 1 where a dispatch goes on.
    pub goes_on: u32,
    /// Fills up to the alignment.
    pub padding: [u32; 2],
}

impl ViewRecord {
    /// Side of a tile in pixels: `TILE` of `passes/view.wgsl`.
    pub const TILE: u32 = 8;
}

/// `Placement` of `passes/attribute.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PlacementRecord {
    /// Origin of the value: high and low part.
    pub offset: [f32; 2],
    /// Its place among the attributes of a point.
    pub slot: u32,
    /// Fills up to the alignment.
    pub padding: u32,
}

/// `Run` of `passes/split.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct RunRecord {
    /// The run's first cell in the sorted list.
    pub first: u32,
    /// Cells of a run.
    pub length: u32,
    /// Fills up to the alignment.
    pub padding: [u32; 2],
}

impl RunRecord {
    /// Bytes of the five corners that a cell is split into: `SplitCorner` of `compositor/corner.wgsl`.
    pub const CELL_BYTES: u64 = 5 * 48;
}

/// `Round` of `passes/digits.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct RoundRecord {
    /// The first bit of the round's digit.
    pub shift: u32,
    /// 1 in the first round, whose items are the cells.
    pub from_cells: u32,
    /// Items that there is room for.
    pub capacity: u32,
    /// Fills up to the alignment.
    pub padding: u32,
}

impl RoundRecord {
    /// Digits: `DIGITS` of `passes/digits.wgsl`.
    pub const DIGITS: u32 = 256;
    /// Items of a block: `ITEMS` there.
    pub const ITEMS: u32 = 4096;
}
