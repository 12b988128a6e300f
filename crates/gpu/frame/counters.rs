//! Indices of the numbers that the passes count in `counts`.

pub const ENTRIES: usize = 0;
pub const BY_FUNCTION: usize = 1;
pub const BY_FRUSTUM: usize = 2;
pub const PROJECTED: usize = 3;
pub const SEGMENTS: usize = 4;
pub const DISORDERED: usize = 5;
pub const SWEEPS: usize = 6;
/// Tiles of the last dispatch that are to go on.
pub const UNFINISHED: usize = 7;
pub const LONGEST: usize = 8;
/// Cells in view that cover no pixel's middle.
pub const UNDER_A_PIXEL: usize = 9;
/// Tiles that were opaque before all their cells had been looked at, and those cells.
pub const TILES_STOPPED: usize = 10;
pub const CELLS_HIDDEN: usize = 11;
/// Cells whose tiles a driver did not go through, since it ended the loops: their lists are wrong.
pub const CELLS_CUT_SHORT: usize = 12;
/// Pixels likewise, whose colours are wrong.
pub const PIXELS_CUT_SHORT: usize = 13;
pub const ALL: usize = 14;
/// Counts that are the same in every window.
pub const OF_CELLS: [usize; 4] = [BY_FUNCTION, BY_FRUSTUM, PROJECTED, UNDER_A_PIXEL];
