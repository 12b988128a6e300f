//! Surface files: a square pyramid, whose base is one polygon.

/// Its points.
pub const POINTS: [[f32; 3]; 5] =
    [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 1.5]];
/// Its faces, counter-clockwise from outside.
pub const FACES: [&[u32]; 5] = [&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];

fn triangles() -> Vec<[u32; 3]> {
    vec![[0, 3, 2], [0, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
}

/// STL in ASCII; `name`: what follows `solid`, with the space before it.
pub fn stl_text(name: &str) -> String {
    let mut text = format!("solid{name}\n");
    for corners in triangles() {
        text += "facet normal 0 0 0\n outer loop\n";
        for [x, y, z] in corners.map(|p| POINTS[p as usize]) {
            text += &format!("  vertex {x} {y} {z:e}\n");
        }
        text += " endloop\nendfacet\n";
    }
    text + "endsolid" + name + "\n"
}

/// STL in binary with this header.
pub fn stl_binary(head: &str) -> Vec<u8> {
    let mut bytes = head.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend(6_u32.to_le_bytes());
    for corners in triangles() {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flat_map(|&p| POINTS[p as usize]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

/// PLY in one of its encodings, with an array `level` of the points and `load` of the faces.
pub fn ply(format: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment a pyramid\nelement vertex 5\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar level\nelement face 5\nproperty list uchar int vertex_indices\n\
         property double load\nend_header\n"
    )
    .into_bytes();
    let numbers = |value: f32| if format.contains("big") { value.to_be_bytes() } else { value.to_le_bytes() };
    let whole = |value: u32| if format.contains("big") { value.to_be_bytes() } else { value.to_le_bytes() };
    let double = |value: f64| if format.contains("big") { value.to_be_bytes() } else { value.to_le_bytes() };
    for (k, at) in POINTS.iter().enumerate() {
        match format {
            "ascii" => bytes.extend(format!("{} {} {} {}\n", at[0], at[1], at[2], 10 * k).into_bytes()),
            _ => {
                bytes.extend(at.iter().flat_map(|x| numbers(*x)));
                bytes.push(10 * k as u8);
            }
        }
    }
    for (k, face) in FACES.iter().enumerate() {
        let load = k as f64 + 0.5;
        match format {
            "ascii" => {
                let corners: Vec<String> = face.iter().map(u32::to_string).collect();
                bytes.extend(format!("{} {} {load}\n", face.len(), corners.join(" ")).into_bytes());
            }
            _ => {
                bytes.push(face.len() as u8);
                bytes.extend(face.iter().flat_map(|p| whole(*p)));
                bytes.extend(double(load));
            }
        }
    }
    bytes
}

/// PolyData of two pieces: the base, and the sides as triangles and a strip, with a line before them.
pub const PIECES: &str = r#"<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="1">
<PointData Scalars="T"><DataArray type="Float64" Name="T" format="ascii">0 1 2 3</DataArray>
<DataArray type="Float32" Name="v" NumberOfComponents="2" format="ascii">3 4 0 0 0 0 0 0</DataArray></PointData>
<CellData><DataArray type="Int32" Name="part" format="ascii">7</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 2 0 0 2 2 0 0 2 0</DataArray></Points>
<Polys><DataArray type="Int32" Name="connectivity" format="ascii">0 3 2 1</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray></Polys></Piece>
<Piece NumberOfPoints="5" NumberOfVerts="0" NumberOfLines="1" NumberOfStrips="1" NumberOfPolys="2">
<PointData><DataArray type="Float64" Name="T" format="ascii">0 1 2 3 4</DataArray>
<DataArray type="Float32" Name="v" NumberOfComponents="2" format="ascii">0 0 0 0 0 0 0 0 6 8</DataArray></PointData>
<CellData><DataArray type="Int32" Name="part" format="ascii">1 2 3 4</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 2 0 0 2 2 0 0 2 0 1 1 1.5</DataArray></Points>
<Lines><DataArray type="Int32" Name="connectivity" format="ascii">0 1</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">2</DataArray></Lines>
<Strips><DataArray type="Int32" Name="connectivity" format="ascii">3 0 4 1</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray></Strips>
<Polys><DataArray type="Int32" Name="connectivity" format="ascii">1 2 4 2 3 4</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">3 6</DataArray></Polys></Piece></PolyData></VTKFile>"#;
