//! Surface files in every form: a square pyramid, whose base is one polygon.

use glam::DVec3;
use voltet_core::progress::NoProgress;
use voltet_core::{Error, Result};
use voltet_io::formats::{SurfaceFile, read_surface};
use voltet_testing::files::surfaces::{FACES, PIECES, POINTS, ply, stl_binary, stl_text};

fn open(name: &str, bytes: impl AsRef<[u8]>, array: Option<&str>) -> Result<SurfaceFile> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_surface(&path, array, &NoProgress)
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
    let lines = read("a.obj", format!("{points}l 1 2\nf 1 2 3\nf 1 2\n"), None);
    assert_eq!(lines.warnings, ["2 elements of fewer than three points are not drawn"]);
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
    assert_eq!(surface.warnings, ["1 element of fewer than three points is not drawn"]);
    let lengths = read("a.vtp", PIECES, Some("v:magnitude")).values.unwrap();
    assert_eq!([lengths[0], lengths[1], lengths[8]], [5.0, 0.0, 10.0]);
    let parts = read("a.vtp", PIECES, Some("part"));
    assert_eq!((parts.points.len(), volume(&parts)), (18, 2.0));
    let of_triangles: Vec<f64> = parts.values.unwrap().chunks(3).map(|values| values[0]).collect();
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
