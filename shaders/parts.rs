//! Arrays in parts: what does not fit one binding stands in several, each a power of two elements long, and the text
//! reads it by functions that pick the part. An array in one part is read as it is.

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

    /// Name, element, and the functions that read and write it.
    fn words(self) -> [&'static str; 4] {
        match self {
            GridArray::Positions => ["positions", "array<f32, 6>", "position_of", "put_position"],
            GridArray::Quantity => ["quantity", "vec2f", "quantity_of", "put_quantity"],
            GridArray::Seen => ["seen", "vec4f", "seen_at", "put_seen"],
            GridArray::Attributes => ["attributes", "f32", "attribute_of", "put_attribute"],
            GridArray::Tetrahedra => ["tetrahedra", "vec4u", "tetrahedron", "put_tetrahedron"],
            GridArray::Bounds => ["bounds", "vec2u", "bounds_of", "put_bounds"],
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
        let [name, element, reads, writes] = array.words();
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
        let element = self.element;
        let slot = if self.stride.is_some() { ", slot: u32" } else { "" };
        let head = format!("fn {function}(index: u32{slot}) -> {element} {{");
        if self.parts.count == 1 {
            return format!("{head} return {}[{}]; }}\n", self.name, self.place("index"));
        }
        let taken = |part: u32| format!("found = {}[at];", Parts::name(self.name, part));
        format!("{head}\n    var found: {element};\n{}    return found;\n}}\n", self.choose("index", taken))
    }

    /// The function that reads one of four numbers of a vector, all of them counted through.
    pub fn number_read_by(&self, function: &str) -> String {
        let head = format!("fn {function}(index: u32) -> f32 {{");
        if self.parts.count == 1 {
            return format!("{head} return {}[index >> 2u][index & 3u]; }}\n", self.name);
        }
        let taken = |part: u32| format!("found = {}[at][index & 3u];", Parts::name(self.name, part));
        let chosen = self.choose("(index >> 2u)", taken);
        format!("{head}\n    var found: f32;\n{chosen}    return found;\n}}\n")
    }

    /// The function that writes an element.
    pub fn written_by(&self, function: &str) -> String {
        let element = self.element;
        let slot = if self.stride.is_some() { ", slot: u32" } else { "" };
        let head = format!("fn {function}(index: u32{slot}, element: {element}) {{");
        if self.parts.count == 1 {
            return format!("{head} {}[{}] = element; }}\n", self.name, self.place("index"));
        }
        let put = |part: u32| format!("{}[at] = element;", Parts::name(self.name, part));
        format!("{head}\n{}}}\n", self.choose("index", put))
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
