//! Writes small legacy files, ASCII and binary.

use super::xml::Values;

/// A legacy file in the making.
pub struct LegacyWriter {
    /// Numbers as bytes, most significant first; else as words.
    pub binary: bool,
    /// The file so far.
    pub bytes: Vec<u8>,
}

impl LegacyWriter {
    /// A file that begins with its four lines of header.
    pub fn new(version: &str, binary: bool, kind: &str) -> Self {
        let mode = if binary { "BINARY" } else { "ASCII" };
        let head =
            format!("# vtk DataFile Version {version}\na title: POINTS 3 float\n{mode}\nDATASET {kind}\n");
        LegacyWriter { binary, bytes: head.into_bytes() }
    }

    /// A line of text.
    pub fn line(&mut self, line: &str) {
        self.bytes.extend(line.as_bytes());
        self.bytes.push(b'\n');
    }

    /// The numbers of an array, nine a line.
    pub fn values(&mut self, number_type: &'static str, values: impl IntoIterator<Item = f64>) {
        let values = Values::new(number_type, values);
        if self.binary {
            self.bytes.extend(values.bytes(true));
            self.bytes.push(b'\n');
            return;
        }
        for line in values.values.chunks(9) {
            self.line(&line.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
        }
    }
}

/// The number types by their legacy names.
pub const LEGACY_TYPES: [(&str, &str); 14] = [
    ("char", "Int8"),
    ("unsigned_char", "UInt8"),
    ("short", "Int16"),
    ("unsigned_short", "UInt16"),
    ("int", "Int32"),
    ("unsigned_int", "UInt32"),
    ("long", "Int64"),
    ("unsigned_long", "UInt64"),
    ("vtkIdType", "Int32"),
    ("vtktypeint64", "Int64"),
    ("vtktypeuint64", "UInt64"),
    ("vtktypeint8", "Int8"),
    ("float", "Float32"),
    ("double", "Float64"),
];

/// The value of point `i` in the array of a type.
pub fn value(number_type: &str, i: usize) -> f64 {
    let sign = if number_type.starts_with('U') { 1.0 } else { -1.0 };
    sign * (i % 120) as f64
}

/// Two hexahedra side by side and a tetrahedron between, with arrays of every kind.
pub fn unstructured(version: &str, binary: bool) -> Vec<u8> {
    let offsets = version.starts_with('5');
    let mut out = LegacyWriter::new(version, binary, "UNSTRUCTURED_GRID");
    out.line("FIELD FieldData 2");
    out.line("TIME 1 1 double");
    out.values("Float64", [1.5]);
    out.line("title 1 1 string");
    if binary {
        // A length below 64 and the text.
        out.bytes.extend(b"\xC5POINT\n");
    } else {
        out.line("POINT%20DATA");
    }
    out.line("POINTS 12 float");
    out.values("Float32", points().into_iter().flatten());
    out.line("METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 2.4\n");
    let cells: [&[usize]; 3] = [&[0, 1, 4, 3, 6, 7, 10, 9], &[1, 2, 5, 4, 7, 8, 11, 10], &[0, 2, 4, 9]];
    if offsets {
        out.line("CELLS 4 20\nOFFSETS vtktypeint64");
        out.values("Int64", [0.0, 8.0, 16.0, 20.0]);
        out.line("CONNECTIVITY vtktypeint64");
        out.values("Int64", cells.iter().copied().flatten().map(|&c| c as f64));
    } else {
        out.line("CELLS 3 23");
        let list = cells.iter().flat_map(|cell| std::iter::once(cell.len()).chain(cell.iter().copied()));
        out.values("Int32", list.map(|c| c as f64));
    }
    out.line("CELL_TYPES 3");
    out.values("Int32", [12.0, 12.0, 10.0]);
    out.line("CELL_DATA 3");
    out.line("SCALARS per%20cell double\nLOOKUP_TABLE default");
    out.values("Float64", [1.0, 2.0, 3.0]);
    out.line("POINT_DATA 12");
    for (name, number_type) in LEGACY_TYPES {
        out.line(&format!("SCALARS {name} {name} 1\nLOOKUP_TABLE table"));
        out.values(number_type, (0..12).map(|i| value(number_type, i)));
    }
    out.line("LOOKUP_TABLE table 2");
    out.values(if binary { "UInt8" } else { "Float32" }, [0.0; 8]);
    out.line("COLOR_SCALARS colour 2");
    out.values(if binary { "UInt8" } else { "Float32" }, [1.0; 24]);
    out.line("VECTORS vector double");
    out.values("Float64", (0..36).map(f64::from));
    out.line("NORMALS normal float");
    out.values("Float32", (0..36).map(f64::from));
    // A component without a name has an empty line.
    out.line(
        "METADATA\nCOMPONENT_NAMES\n\nb\n\nINFORMATION 1\nNAME UNITS_LABEL LOCATION vtkDataArray\nDATA m\n",
    );
    out.line("TENSORS tensor float");
    out.values("Float32", (0..108).map(f64::from));
    out.line("TEXTURE_COORDINATES texture 2 float");
    out.values("Float32", (0..24).map(f64::from));
    out.line("FIELD field 3");
    out.line("in%3Dfield 2 12 float");
    out.values("Float32", (0..24).map(f64::from));
    out.line("METADATA\nCOMPONENT_NAMES\nfirst\nsecond\n");
    out.line("names 1 12 string");
    for i in 0..12 {
        if binary {
            out.bytes.extend([0xC0 | (i % 3) as u8]);
            out.bytes.extend(&b"abc"[..i % 3]);
        } else {
            out.line(&"abc"[..i % 3]);
        }
    }
    out.line("bits 1 12 bit");
    if binary {
        out.bytes.extend([0b1010_1010, 0b1010_0000]);
        out.line("");
    } else {
        out.values("UInt8", (0..12).map(|i| f64::from(1 - i % 2)));
    }
    out.bytes
}

/// Twelve points, 3 × 2 × 2.
pub fn points() -> Vec<[f64; 3]> {
    (0..12).map(|i| [f64::from(i % 3), f64::from(i / 3 % 2), f64::from(i / 6)]).collect()
}

/// A structured grid of the twelve points.
pub fn structured(kind: &str, binary: bool) -> Vec<u8> {
    let mut out = LegacyWriter::new("3.0", binary, kind);
    out.line("DIMENSIONS 3 2 2");
    match kind {
        "STRUCTURED_POINTS" => out.line("ASPECT_RATIO 1 1 1\nORIGIN 0 0 0"),
        "RECTILINEAR_GRID" => {
            out.line("X_COORDINATES 3 float");
            out.values("Float32", [0.0, 1.0, 2.0]);
            out.line("Y_COORDINATES 2 double");
            out.values("Float64", [0.0, 1.0]);
            out.line("Z_COORDINATES 2 int");
            out.values("Int32", [0.0, 1.0]);
        }
        _ => {
            out.line("POINTS 12 double");
            out.values("Float64", points().into_iter().flatten());
        }
    }
    out.line("POINT_DATA 12\nSCALARS s float\nLOOKUP_TABLE default");
    out.values("Float32", (0..12).map(f64::from));
    out.bytes
}
