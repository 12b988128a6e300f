//! Surface files in every form: a square pyramid, whose base is one polygon.

use glam::DVec3;
use voltet_core::progress::NoProgress;
use voltet_core::{Error, Result};
use voltet_io::formats::{SurfaceColors, SurfaceFile, read_surface};
use voltet_testing::files::surfaces::{FACES, PIECES, POINTS, ply, stl_binary, stl_text};

fn open(name: &str, bytes: impl AsRef<[u8]>, array: Option<&str>) -> Result<SurfaceFile> {
    read_otherwise(name, bytes, array.map_or(SurfaceColors::Uniform, SurfaceColors::Array), false)
}

/// The file with its own colours, or with edges in place of triangles.
fn read_otherwise(
    name: &str,
    bytes: impl AsRef<[u8]>,
    colors: SurfaceColors<'_>,
    edges: bool,
) -> Result<SurfaceFile> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_surface(&path, colors, edges, &NoProgress)
}

fn read(name: &str, bytes: impl AsRef<[u8]>, array: Option<&str>) -> SurfaceFile {
    open(name, bytes, array).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn refused(name: &str, bytes: impl AsRef<[u8]>, array: Option<&str>) -> String {
    open(name, bytes, array).map_err(|error: Error| error.to_string()).expect_err(name)
}

/// Volume that the triangles enclose; the pyramid's is 2.
fn volume(surface: &SurfaceFile) -> f64 {
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|p| surface.points[p as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    surface.triangles.iter().map(of).sum()
}

fn is_pyramid(surface: &SurfaceFile, what: &str) {
    assert_eq!((surface.points.len(), surface.triangles.len()), (5, 6), "{what}");
    assert_eq!(volume(surface), 2.0, "{what}");
    assert!(surface.warnings.is_empty(), "{what}: {:?}", surface.warnings);
}

#[test]
fn stl_in_text_and_binary() {
    for text in [
        stl_text(" a pyramid"),
        stl_text(""),
        stl_text(" x").to_uppercase(),
        stl_text("").replace('\n', "\r\n"),
    ] {
        is_pyramid(&read("a.stl", text, None), "text");
    }
    for head in ["", "solid of a program", "made by a program"] {
        is_pyramid(&read("a.stl", stl_binary(head), None), head);
    }
    let two = read("a.stl", stl_text(" one") + &stl_text(" two"), None);
    assert_eq!((two.points.len(), two.triangles.len()), (5, 12));
    let longer = [stl_binary("x"), vec![0; 7]].concat();
    is_pyramid(&read("a.stl", longer, None), "bytes behind the triangles");
    let cut = &stl_binary("x")[..200];
    assert!(refused("a.stl", cut, None).contains("200 bytes; expected 384 bytes"));
    assert!(refused("a.stl", "solid\nfacet\n", None).contains("ends early"));
    let damaged = refused("a.stl", stl_text("").replacen("vertex 2", "vertex two", 1), None);
    assert!(damaged.contains("'two'") && damaged.contains("a.stl:"), "{damaged}");
    assert!(refused("a.stl", stl_text(""), Some("T")).contains("an STL file holds no arrays"));
}

#[test]
fn obj_with_and_without_normals() {
    let points: String = POINTS.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let faces = |corner: &dyn Fn(u32) -> String| -> String {
        let face = |corners: &&[u32]| corners.iter().map(|&p| corner(p)).collect::<Vec<_>>().join(" ");
        FACES.iter().map(|corners| format!("f {}\n", face(corners))).collect()
    };
    let plain =
        format!("# a comment\nmtllib a.mtl\no a\n{points}usemtl b\n{}", faces(&|p| (p + 1).to_string()));
    is_pyramid(&read("a.obj", &plain, None), "from 1");
    is_pyramid(
        &read("a.obj", format!("{points}{}", faces(&|p| (i64::from(p) - 5).to_string())), None),
        "from the end",
    );
    let with = format!("{points}vn 0 0 -1\nvn 0 0 3\n{}", faces(&|p| format!("{}//{}", p + 1, 1 + p / 4)));
    let surface = read("a.obj", with, None);
    is_pyramid(&surface, "normals");
    assert_eq!(surface.normals.iter().filter(|normal| normal.z == 3.0).count(), 1);
    let some = read("a.obj", format!("{points}vn 0 0 1\nf 1//1 2//1 3\n"), None);
    assert!(some.normals.is_empty() && some.triangles.len() == 1);
    for (face, said) in [
        ("f 1 2 6", "found 6; expected 1 to 5"),
        ("f 1 2 0", "found 0"),
        ("f -6 1 2", "found -6"),
        ("f 1//6148914691236517206 2 3", "normal that does not exist"),
        ("f 1//-9223372036854775808 2 3", "normal that does not exist"),
        ("f // 1 2", "no point"),
        ("f a 1 2", "'a'"),
        ("f 1 2 \\", "'\\'"),
        ("v 1 2", "three numbers"),
    ] {
        let error = refused("a.obj", format!("{points}vn 0 0 1\n{face}\n"), None);
        assert!(error.contains(said) && error.contains("a.obj:7"), "{face}: {error}");
    }
    assert!(refused("a.obj", "nothing of the kind\n", None).contains("no points"));
    let lines = read("a.obj", format!("{points}vn 0 0 1\nl 1 2/7 -1\np 3 4\nf 1 2 3\nf 1 2\n"), None);
    assert_eq!(lines.warnings, ["1 polygon of fewer than three points is not drawn"]);
    assert_eq!((&lines.lines[..], &lines.vertices[..]), (&[vec![0, 1, 4]][..], &[2, 3][..]));
    let with = read("a.obj", format!("{points}vn 0 0 1\nl 5 4\nf 1//1 2//1 3//1\n"), None);
    let line: Vec<DVec3> = with.lines[0].iter().map(|&p| with.points[p as usize]).collect();
    assert_eq!(line, [[1.0, 1.0, 1.5], [0.0, 2.0, 0.0]].map(DVec3::from));
    assert_eq!((with.points.len(), with.normals.len(), with.triangles.len()), (5, 5, 1));
    // Points alone stand for themselves.
    assert_eq!(read("a.obj", &points, None).vertices, [0, 1, 2, 3, 4]);
}

#[test]
fn ply_in_three_encodings_with_arrays() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        is_pyramid(&read("a.ply", ply(format), None), format);
        let levels = read("a.ply", ply(format), Some("level"));
        is_pyramid(&levels, format);
        assert_eq!(levels.values.as_deref(), Some(&[0.0, 10.0, 20.0, 30.0, 40.0][..]), "{format}");
        // Of faces: each triangle has its own points.
        let loads = read("a.ply", ply(format), Some("load"));
        assert_eq!((loads.points.len(), volume(&loads)), (18, 2.0), "{format}");
        let values = loads.values.unwrap();
        assert_eq!(values[..9], [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1.5, 1.5, 1.5], "{format}");
        let error = refused("a.ply", ply(format), Some("leval"));
        assert!(error.contains("no array 'leval'") && error.contains("level"), "{error}");
    }
    let normals = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   property float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
                   property list uchar uint vertex_index\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2";
    assert_eq!(read("a.ply", normals, None).normals, [DVec3::Z; 3]);
    let zero = read("a.ply", normals.replace("1 0 0 0 0 1", "1 0 0 0 0 0"), None);
    assert!(zero.normals.is_empty() && zero.warnings[0].contains("no directions"), "{:?}", zero.warnings);
    is_pyramid(&read("a.ply", String::from_utf8(ply("ascii")).unwrap().replace('\n', "\r\n"), None), "CRLF");
    let none = normals.replace("element vertex 3", "element mark 999999999999\nelement vertex 3");
    assert!(refused("a.ply", none, None).contains("'mark' has no properties"));
    let many = normals.replace("element vertex 3", "element vertex 999999999999");
    assert!(refused("a.ply", many, None).contains("damaged"));
    assert!(
        refused("a.ply", normals.replace("3 0 1 2", "3 0 1 7"), None).contains("found 7; expected below 3")
    );
    assert!(refused("a.ply", normals.replace("3 0 1 2", "3 0 1 -2"), None).contains("damaged"));
}

#[test]
fn poly_data_of_pieces_with_arrays() {
    let surface = read("a.vtp", PIECES, Some("T"));
    assert_eq!((surface.points.len(), surface.triangles.len(), volume(&surface)), (9, 6, 2.0));
    assert_eq!(surface.values.as_deref(), Some(&[0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 4.0][..]));
    assert!(surface.warnings.is_empty(), "{:?}", surface.warnings);
    assert_eq!((surface.lines, surface.vertices.len()), (vec![vec![4, 5]], 0));
    let lengths = read("a.vtp", PIECES, Some("v:magnitude")).values.unwrap();
    assert_eq!([lengths[0], lengths[1], lengths[8]], [5.0, 0.0, 10.0]);
    let parts = read("a.vtp", PIECES, Some("part"));
    assert_eq!((parts.points.len(), volume(&parts)), (18 + 2, 2.0));
    let line: Vec<f64> = parts.lines[0].iter().map(|&p| parts.values.as_ref().unwrap()[p as usize]).collect();
    assert_eq!(line, [1.0, 1.0]);
    let of_triangles: Vec<f64> = parts.values.unwrap()[..18].chunks(3).map(|values| values[0]).collect();
    assert_eq!(of_triangles, [7.0, 7.0, 2.0, 3.0, 4.0, 4.0]);
    let hidden = PIECES.replace(
        "<DataArray type=\"Int32\" Name=\"part\" format=\"ascii\">1",
        "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">0 1 0 32</DataArray>\
         <DataArray type=\"Int32\" Name=\"part\" format=\"ascii\">1",
    );
    assert_eq!(read("a.vtp", hidden, None).triangles.len(), 3);
    for (from, to, said) in [
        ("0 3 2 1", "0 3 2 4", "found 4; expected below 4"),
        (">3 6<", ">6 3<", "expected 6 to 6"),
        (">3 6<", ">3 7<", "expected 3 to 6"),
        ("NumberOfPolys=\"2\"", "NumberOfPolys=\"4000000000\"", "found 2; expected 4000000000"),
        ("type=\"PolyData\"", "type=\"ImageData\"", "PolyData; a node of type reader"),
    ] {
        let error = refused("a.vtp", PIECES.replacen(from, to, 1), None);
        assert!(error.contains(said), "{to}: {error}");
    }
    let error = refused("a.vtp", PIECES, Some("v"));
    assert!(error.contains("'v:magnitude'"), "{error}");
    assert!(refused("a.xyz", "1 2 3\n", None).contains("STL (.stl), PLY (.ply)"));
}

#[test]
fn polygons_are_cut_within_themselves() {
    let text = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 3 4 5 6 1 2\nv 0 0 1\nv 1 1 1\nv 1 0 1\nv 0 1 1\nf 7 8 9 10\n";
    let surface = read("a.obj", text, None);
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|p| surface.points[p as usize]);
        (b - a).cross(c - a).z / 2.0
    };
    assert_eq!(surface.triangles[..4].iter().map(area).sum::<f64>(), 4.0);
    assert!(surface.triangles[..4].iter().all(|corners| area(corners) > 0.0));
    assert_eq!(surface.triangles.len(), 6);
    assert_eq!(surface.warnings.len(), 1, "{:?}", surface.warnings);
}

#[test]
fn ply_edges_and_points_alone() {
    let edges = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                 element edge 2\nproperty int vertex1\nproperty int vertex2\nproperty float load\nend_header\n\
                 0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 1 0.5\n3 2 1.5\n";
    let found = read("a.ply", edges, None);
    assert_eq!((found.lines, found.vertices.len()), (vec![vec![0, 1], vec![3, 2]], 0));
    let loads = read("a.ply", edges, Some("load"));
    assert_eq!((loads.points.len(), loads.values.unwrap()), (4, vec![0.5, 0.5, 1.5, 1.5]));
    for (wrong, said) in
        [("3 2 1.5", "found 9; expected below 4"), ("-1 2 1.5", "found -1; expected its number")]
    {
        let end = if wrong.starts_with('3') { "3 9 1.5" } else { wrong };
        let error = refused("a.ply", edges.replace("3 2 1.5", end), None);
        assert!(error.contains(said), "{error}");
    }
    let other = edges.replace("property int vertex2", "property int other");
    for array in [None, Some("load")] {
        let error = refused("a.ply", &other, array);
        assert!(error.contains("found vertex1, other, load; expected properties vertex1"), "{error}");
    }
    let cloud =
        edges.split("element edge").next().unwrap().to_owned() + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    assert_eq!(read("a.ply", cloud, None).vertices, [0, 1, 2, 3]);
}

#[test]
fn the_files_own_colours() {
    let head = |kind: &str, alpha: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property {kind} red\nproperty {kind} green\nproperty {kind} blue\n{alpha}\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let bytes = head("uchar", "property uchar alpha\n")
        + "0 0 0 255 0 118 51\n1 0 0 0 0 0 255\n0 1 0 255 255 255 0\n3 0 1 2\n";
    let found = read_otherwise("a.ply", &bytes, SurfaceColors::Own, false).unwrap();
    let colors = found.colors.unwrap();
    // 118 of 255 is 18 % grey in sRGB.
    assert!((colors[0][2] - 0.18).abs() < 2e-3, "{colors:?}");
    assert_eq!([colors[0][0], colors[0][3], colors[1][3], colors[2][1]], [1.0, 0.2, 1.0, 1.0]);
    assert_eq!(read("a.ply", &bytes, None).colors, None);
    assert_eq!(read("a.ply", &bytes, Some("red")).colors, None);
    let floats = head("float", "") + "0 0 0 1 0 0.5\n1 0 0 0 0 0\n0 1 0 1 1 1\n3 0 1 2\n";
    let colors = read_otherwise("a.ply", &floats, SurfaceColors::Own, false).unwrap().colors.unwrap();
    assert!((colors[0][2] - 0.21404).abs() < 1e-5 && colors[0][3] == 1.0, "{colors:?}");
    let wrong = floats.replace("0 0 0 1 0 0.5", "0 0 0 1 0 1.5");
    let error = read_otherwise("a.ply", &wrong, SurfaceColors::Own, false).unwrap_err().to_string();
    assert!(error.contains("colour of element or point 0") && error.contains("1.5"), "{error}");
    assert!(read_otherwise("a.ply", &wrong, SurfaceColors::Uniform, false).is_ok());
    // Of faces, in a file that has edges, too.
    let faces = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                 element edge 1\nproperty int vertex1\nproperty int vertex2\nelement face 1\n\
                 property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n\
                 property uchar blue\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 1\n3 0 1 2 0 255 0\n";
    let found = read_otherwise("a.ply", faces, SurfaceColors::Own, false).unwrap();
    let colors = found.colors.unwrap();
    assert_eq!((found.triangles, found.lines), (vec![[0, 1, 2]], vec![vec![3, 4]]));
    assert_eq!((colors[0], colors[3]), ([0.0, 1.0, 0.0, 1.0], [0.6, 0.6, 0.6, 1.0]));
    // An array of bytes that a PolyData file marks.
    let marked = PIECES.replacen(
        "<PointData Scalars=\"T\">",
        "<PointData Scalars=\"c\"><DataArray type=\"UInt8\" Name=\"c\" NumberOfComponents=\"3\" format=\"ascii\">\
         255 0 0 255 0 0 0 0 0 0 0 255</DataArray>",
        1,
    );
    let one = format!("{}</PolyData></VTKFile>", marked.split_inclusive("</Piece>").next().unwrap());
    let colors = read_otherwise("a.vtp", one, SurfaceColors::Own, false).unwrap().colors.unwrap();
    assert_eq!((colors.len(), colors[0]), (4, [1.0, 0.0, 0.0, 1.0]));
    assert_eq!(read_otherwise("a.vtp", marked, SurfaceColors::Own, false).unwrap().colors, None);
}

#[test]
fn edges_in_place_of_triangles() {
    for (name, bytes) in [("a.ply", ply("ascii")), ("a.vtp", PIECES.as_bytes().to_vec())] {
        let found = read_otherwise(name, bytes, SurfaceColors::Own, true).unwrap();
        assert!(found.triangles.is_empty(), "{name}");
        let lengths = |found: &SurfaceFile| -> f64 {
            let length =
                |line: &Vec<u32>| found.points[line[0] as usize].distance(found.points[line[1] as usize]);
            found.lines.iter().map(length).sum()
        };
        // The base's four edges without a diagonal, and four to the tip; the pieces share no points, and one has a line, too.
        let (base, slanted) = (8.0, 4.0 * (2.0 + 1.5 * 1.5_f64).sqrt());
        let expected = if name == "a.ply" { base + slanted } else { 2.0 * base + slanted + 2.0 };
        assert!((lengths(&found) - expected).abs() < 1e-12, "{name}: {}", lengths(&found));
    }
    let loads = read_otherwise("a.ply", ply("ascii"), SurfaceColors::Array("load"), true).unwrap();
    assert_eq!((loads.lines.len(), loads.points.len()), (8, 16));
    assert_eq!(loads.values.unwrap()[..8], [0.5; 8]);
}

#[test]
fn tables_of_points() {
    let text =
        "\u{feff}name, X ;\"the; T\";y;z\n".replace(", ", ";") + "a;1;20.5;2;3\n\n\"b;c\"; -1;;0;1e-3\r\n";
    let found = read("a.csv", &text, Some("the; T"));
    assert_eq!(found.points, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.0, 1e-3)]);
    let values = found.values.unwrap();
    assert!(values[0] == 20.5 && values[1].is_nan());
    assert_eq!(found.vertices, [0, 1]);
    let paraview = "\"T\",\"Points:0\",\"Points:1\",\"Points:2\"\n300,1,2,3\n";
    assert_eq!(read("a.csv", paraview, Some("T")).points, [DVec3::new(1.0, 2.0, 3.0)]);
    assert_eq!(read("a.csv", "x\ty\tz\n1\t2\t3", None).points.len(), 1);
    for (text, array, said) in [
        ("\n\n", None, "the table is empty"),
        ("a,b,c\n1,2,3\n", None, "found a, b, c; expected a first line with the names x, y and z"),
        ("x,y,z\n1,2\n", None, "found 2; expected 3 fields"),
        ("x,y,z\n1,2,q\n", None, "'q'"),
        ("x,y,z,T\n1,2,,3\n", None, "''"),
        ("x,y,z,temperature\n1,2,3,4\n", Some("temprature"), "'temperature'"),
    ] {
        let error = refused("a.csv", text, array);
        assert!(error.contains(said) && error.contains("a.csv"), "{text}: {error}");
    }
}
