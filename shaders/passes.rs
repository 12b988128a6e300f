//! The passes over points, cells and lists that stand before the tiles: their texts and uniforms, and the arrays of the grid in parts.
//!
//! What does not fit one binding stands in several, each a power of two elements long, and the text reads it by functions that pick
//! the part. An array in one part is read as it is.

use crate::text::{Shader, compose_pieces};
use bytemuck::{Pod, Zeroable};
use std::fmt::Write;

/// Split of an array over bindings. Equal parts give equal text; of whole arrays all do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Parts {
    /// Bindings, at least 1.
    pub count: u32,
    /// Binary logarithm of the elements of each part but the last.
    pub shift: u32,
}

impl Parts {
    /// One binding.
    pub const WHOLE: Parts = Parts { count: 1, shift: 32 };

    /// `count` elements of `bytes` each, in bindings of at most `most` bytes.
    pub fn for_elements(count: u64, bytes: u64, most: u64) -> Parts {
        let fit = (most / bytes.max(1)).max(1);
        if count <= fit {
            return Parts::WHOLE;
        }
        let shift = fit.ilog2();
        Parts { count: count.div_ceil(1 << shift).try_into().unwrap_or(u32::MAX), shift }
    }

    /// Split of another number of elements of equal size.
    pub fn with_count(self, count: u64) -> Parts {
        Parts::for_elements(count, 1, 1 << self.shift)
    }

    /// Elements of part `part` of an array of `count`.
    pub fn length(self, part: u32, count: u64) -> u64 {
        let before = u64::from(part) << self.shift;
        count.saturating_sub(before).min(1 << self.shift)
    }

    /// Name of a part of the array `name` in the text.
    pub fn name(name: &str, part: u32) -> String {
        if part == 0 { name.into() } else { format!("{name}_{part}") }
    }
}

/// Splits of a scene's arrays over bindings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Layout {
    /// The grid's arrays, in the order of [`GridArray::ALL`].
    pub grid: [Parts; 6],
    /// Numbers of the scene beside its uniform, where vectors are among them: images, or the colours of a pre-integrated table.
    pub table: Parts,
}

impl Layout {
    /// Every array in one binding.
    pub const WHOLE: Layout = Layout { grid: [Parts::WHOLE; 6], table: Parts::WHOLE };

    /// The parts of one of the grid's arrays.
    pub fn parts(&self, array: GridArray) -> Parts {
        self.grid[array as usize]
    }
}

/// An array over the points or the cells of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum GridArray {
    /// `position_of`: from the middle of the grid in scene lengths, three high parts, then three low parts.
    Positions,
    /// `quantity_of`: a value, high and low part.
    Quantity,
    /// `seen_at`: position about the view's base, and the stored scalar.
    Seen,
    /// `attribute_of`: further values, by their slot.
    Attributes,
    /// `tetrahedron`: four points.
    Tetrahedra,
    /// `bounds_of`: first column and row, then end column and row of pixels, in 16 bits each.
    Bounds,
}

impl GridArray {
    /// Every array.
    pub const ALL: [GridArray; 6] = [
        GridArray::Positions,
        GridArray::Quantity,
        GridArray::Seen,
        GridArray::Attributes,
        GridArray::Tetrahedra,
        GridArray::Bounds,
    ];

    /// Bytes of a point or cell. `attribute_stride`: attributes of a point.
    pub fn bytes(self, attribute_stride: u64) -> u64 {
        match self {
            GridArray::Positions => 24,
            GridArray::Quantity | GridArray::Bounds => 8,
            GridArray::Seen | GridArray::Tetrahedra => 16,
            GridArray::Attributes => 4 * attribute_stride,
        }
    }

    /// Name in errors.
    pub fn label(self) -> &'static str {
        self.words()[4]
    }

    /// Name, element, the functions that read and write it, and the name in errors.
    fn words(self) -> [&'static str; 5] {
        match self {
            GridArray::Positions => {
                ["positions", "array<f32, 6>", "position_of", "put_position", "the grid's points"]
            }
            GridArray::Quantity => ["quantity", "vec2f", "quantity_of", "put_quantity", "the grid's values"],
            GridArray::Seen => ["seen", "vec4f", "seen_at", "put_seen", "the points on the screen"],
            GridArray::Attributes => {
                ["attributes", "f32", "attribute_of", "put_attribute", "the points' values"]
            }
            GridArray::Tetrahedra => {
                ["tetrahedra", "vec4u", "tetrahedron", "put_tetrahedron", "the grid's cells"]
            }
            GridArray::Bounds => ["bounds", "vec2u", "bounds_of", "put_bounds", "the cells' bounds"],
        }
    }
}

/// Access of a shader to an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Access {
    /// It reads it.
    Read,
    /// It writes it.
    Write,
}

/// The group in which the grid's arrays are bound, at 0, 1, … in their order, each part by itself.
pub const GRID_GROUP: u32 = 2;

/// All of it.
const CELLS_READ: &[(GridArray, Access)] = &[
    (GridArray::Tetrahedra, Access::Read),
    (GridArray::Seen, Access::Read),
    (GridArray::Bounds, Access::Read),
    (GridArray::Attributes, Access::Read),
];

/// Grid arrays that the compositors of pixels read, for points of so many attributes: without any there is no such array.
pub fn cells_read(attribute_stride: usize) -> &'static [(GridArray, Access)] {
    if attribute_stride == 0 { &CELLS_READ[..CELLS_READ.len() - 1] } else { CELLS_READ }
}

/// The declarations of the grid's arrays, and the functions that read or write them.
pub(crate) fn grid_text(arrays: &[(GridArray, Access)], layout: &Layout) -> String {
    let mut text = String::new();
    let mut binding = 0;
    for &(array, access) in arrays {
        let [name, element, reads, writes, _] = array.words();
        let table = PartedArray {
            name,
            element,
            stride: (array == GridArray::Attributes).then_some("ATTRIBUTE_STRIDE"),
            parts: layout.parts(array),
        };
        text += &table.declared(access, GRID_GROUP, |part| binding + part);
        text += &match access {
            Access::Read => table.read_by(reads),
            Access::Write => table.written_by(writes),
        };
        binding += table.parts.count;
    }
    text
}

/// An array of the text.
pub struct PartedArray<'a> {
    /// Its name.
    pub name: &'a str,
    /// The type of its elements.
    pub element: &'a str,
    /// The constant that holds how many elements stand together; `None` for one.
    pub stride: Option<&'a str>,
    /// Its parts.
    pub parts: Parts,
}

impl PartedArray<'_> {
    /// One variable a part.
    pub fn declared(&self, access: Access, group: u32, binding: impl Fn(u32) -> u32) -> String {
        let mode = match access {
            Access::Read => "read",
            Access::Write => "read_write",
        };
        let mut text = String::new();
        for part in 0..self.parts.count {
            let name = Parts::name(self.name, part);
            let (at, element) = (binding(part), self.element);
            let place = format!("@group({group}) @binding({at})");
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{place} var<storage, {mode}> {name}: array<{element}>;");
        }
        text
    }

    /// The function that reads an element.
    pub fn read_by(&self, function: &str) -> String {
        let (element, slot) = (self.element, self.slot());
        let head = format!("fn {function}(index: u32{slot}) -> {element} {{");
        if self.parts.count == 1 {
            return format!("{head} return {}[{}]; }}\n", self.name, self.place("index"));
        }
        self.read_in_parts(&head, element, "index", "[at]")
    }

    /// The function that reads one of four numbers of a vector, all of them counted through.
    pub fn number_read_by(&self, function: &str) -> String {
        let head = format!("fn {function}(index: u32) -> f32 {{");
        if self.parts.count == 1 {
            return format!("{head} return {}[index >> 2u][index & 3u]; }}\n", self.name);
        }
        self.read_in_parts(&head, "f32", "(index >> 2u)", "[at][index & 3u]")
    }

    fn read_in_parts(&self, head: &str, element: &str, index: &str, at: &str) -> String {
        let taken = |part: u32| format!("found = {}{at};", Parts::name(self.name, part));
        format!("{head}\n    var found: {element};\n{}    return found;\n}}\n", self.choose(index, taken))
    }

    /// The function that writes an element.
    pub fn written_by(&self, function: &str) -> String {
        let head = format!("fn {function}(index: u32{}, element: {}) {{", self.slot(), self.element);
        if self.parts.count == 1 {
            return format!("{head} {}[{}] = element; }}\n", self.name, self.place("index"));
        }
        let put = |part: u32| format!("{}[at] = element;", Parts::name(self.name, part));
        format!("{head}\n{}}}\n", self.choose("index", put))
    }

    fn slot(&self) -> &'static str {
        if self.stride.is_some() { ", slot: u32" } else { "" }
    }

    /// Expression of an element's index in its part.
    fn place(&self, index: &str) -> String {
        self.stride.map_or(index.into(), |stride| format!("{index} * {stride} + slot"))
    }

    /// Statement on the part that holds the element of that index, at `at`.
    fn choose(&self, index: &str, of_part: impl Fn(u32) -> String) -> String {
        let Parts { count, shift } = self.parts;
        let mask = (1u64 << shift) - 1;
        let mut text = format!("    let at = {};\n", self.place(&format!("({index} & {mask}u)")));
        let _ = writeln!(text, "    switch {index} >> {shift}u {{");
        for part in 1..count {
            let _ = writeln!(text, "        case {part}u: {{ {} }}", of_part(part));
        }
        let _ = writeln!(text, "        default: {{ {} }}\n    }}", of_part(0));
        text
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_every_element_once() {
        for (count, bytes, most) in
            [(0, 16, 64), (4, 16, 64), (5, 16, 64), (1000, 24, 100), (17, 8, 8), (9, 12, 4)]
        {
            let parts = Parts::for_elements(count, bytes, most);
            let lengths: Vec<u64> = (0..parts.count).map(|part| parts.length(part, count)).collect();
            assert_eq!(lengths.iter().sum::<u64>(), count, "{parts:?}");
            assert!(lengths.iter().all(|length| length * bytes <= most.max(bytes)), "{parts:?} {lengths:?}");
            assert!(count == 0 || lengths.iter().all(|length| *length > 0), "{parts:?} {lengths:?}");
        }
        assert_eq!(Parts::for_elements(4, 16, 64), Parts::WHOLE);
        assert_eq!(Parts::for_elements(5, 16, 64), Parts { count: 2, shift: 2 });
    }

    #[test]
    fn an_array_in_one_part_is_read_as_it_is() {
        let text =
            |parts| PartedArray { name: "seen", element: "vec4f", stride: None, parts }.read_by("seen_at");
        assert_eq!(text(Parts::WHOLE), "fn seen_at(index: u32) -> vec4f { return seen[index]; }\n");
        let three = text(Parts { count: 3, shift: 4 });
        for words in [
            "index & 15u",
            "index >> 4u",
            "case 2u: { found = seen_2[at]; }",
            "default: { found = seen[at]; }",
        ] {
            assert!(three.contains(words), "'{words}' is not in {three}");
        }
    }
}
