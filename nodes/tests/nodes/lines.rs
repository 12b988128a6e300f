//! Lines, points and edges as surfaces: what the nodes give, what they say.

use crate::surfaces::{made, mapped, refused, surface};
use voltet_core::surface::{Paint, Surface};

/// A streamline of three points and a sensor, with an array of both and one of the cells.
pub const STREAMLINE: &str = r#"<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="1" NumberOfLines="1" NumberOfStrips="0" NumberOfPolys="0">
<PointData><DataArray type="Float64" Name="speed" format="ascii">1 2 4 8</DataArray></PointData>
<CellData><DataArray type="Float64" Name="id" format="ascii">5 6</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 3 0 0 3 4 0 3 4 12</DataArray></Points>
<Verts><DataArray type="Int32" Name="connectivity" format="ascii">3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">1</DataArray></Verts>
<Lines><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">3</DataArray></Lines></Piece></PolyData></VTKFile>"#;

/// Two coloured points.
pub const CLOUD: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nend_header\n\
                         0 0 0 255 0 0 255\n10 0 0 0 0 255 51\n";

/// A triangle, and lines: one with a repeated point, one without length, one with a point that is not finite.
pub const PART: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 5\nv nan 0 0\nf 1 2 3\nl 4 5 5\nl 4 4\nl 6 4\n";

pub const SENSORS: &str = "name,x,y,z,T\na,0,0,0,20\nb,10,0,0,30\nc,0,10,0,\n";

/// The distance of each point from the nearest one of these.
fn distances(surface: &Surface, from: &[[f64; 3]]) -> Vec<f64> {
    let nearest =
        |at: &glam::DVec3| from.iter().map(|&place| at.distance(place.into())).fold(f64::INFINITY, f64::min);
    surface.points.iter().map(nearest).collect()
}

#[test]
fn streamlines_are_tubes_coloured_by_an_array() {
    let found = surface(
        "type = \"surface-reader\"\npath = \"lines.vtp\"\ncolor_by = \"speed\"\nradius = \"1 %\"\nsides = 6",
    );
    let (values, range) = mapped(&found);
    assert_eq!(range, [1.0, 8.0]);
    // The diagonal is 13. A sharp bend: two tubes of two rings and of one more at each end, and a sphere of three rings.
    assert_eq!(found.points.len(), 2 * (6 * 4 + 2) + (6 * 3 + 2));
    for (at, &value) in found.points.iter().zip(values) {
        let own: [f64; 3] = match value {
            1.0 => [0.0, 0.0, 0.0],
            2.0 => [3.0, 0.0, 0.0],
            4.0 => [3.0, 4.0, 0.0],
            _ => [3.0, 4.0, 12.0],
        };
        assert!((at.distance(own.into()) - 0.13).abs() < 1e-14, "{at} of {value}");
    }
    assert_eq!(found.normals.len(), found.points.len());
    let ids = surface("type = \"surface-reader\"\npath = \"lines.vtp\"\ncolor_by = \"id\"\nradius = 0.5");
    let of_sphere = |(at, &id): (&glam::DVec3, &f64)| (id == 5.0) == (at.z > 11.0);
    assert!(ids.points.iter().zip(mapped(&ids).0).all(of_sphere));
}

#[test]
fn points_have_their_own_colours() {
    let found = surface("type = \"surface-reader\"\npath = \"cloud.ply\"\nradius = 1");
    let Paint::Points(colors) = &found.paint else { panic!("{:?}", found.paint) };
    for (at, color) in found.points.iter().zip(colors) {
        let expected = if at.x < 5.0 { [1.0, 0.0, 0.0, 1.0] } else { [0.0, 0.0, 1.0, 0.2] };
        assert_eq!(*color, expected);
    }
    assert!(distances(&found, &[[0.0; 3], [10.0, 0.0, 0.0]]).iter().all(|d| (d - 1.0).abs() < 1e-14));
    let grey = surface("type = \"surface-reader\"\npath = \"cloud.ply\"\ncolor = [0.1, 0.2, 0.3]");
    assert_eq!(grey.paint, Paint::Uniform([0.1, 0.2, 0.3]));
    let by_red = surface("type = \"surface-reader\"\npath = \"cloud.ply\"\ncolor_by = \"red\"");
    assert_eq!(mapped(&by_red).1, [0.0, 255.0]);
}

#[test]
fn triangles_and_lines_of_one_file_and_what_is_left_out() {
    let (found, report) =
        made("type = \"surface-reader\"\npath = \"part.obj\"\nradius = 0.1\nsides = 4").unwrap();
    // Flat triangles get normals beside those of the tube.
    assert_eq!((found.points.len(), found.normals.len()), (3 + 4 * 2 + 2, 3 + 4 * 2 + 2));
    assert_eq!(found.normals[..3], [glam::DVec3::Z; 3]);
    assert_eq!(
        report.warnings,
        ["made: 1 line is left out: without length", "made: 1 point is left out: not finite"]
    );
    let edges = made(
        "type = \"surface-reader\"\npath = \"part.obj\"\nstyle = \"wireframe\"\nradius = 0.1\nsides = 4",
    )
    .unwrap()
    .0;
    assert_eq!(edges.points.len(), (3 + 1) * (4 * 2 + 2));
    let (_, report) = made("type = \"surface-reader\"\npath = \"a.stl\"").unwrap();
    assert!(report.warnings.is_empty() && report.findings.is_empty(), "{:?}", report.findings);
    let (_, report) = made("type = \"surface-reader\"\npath = \"a.stl\"\nradius = 0.1").unwrap();
    assert_eq!(
        report.warnings,
        ["made: the file has no lines and no points of their own: no 'radius' counts"]
    );
}

#[test]
fn sensors_of_a_table() {
    let (found, report) =
        made("type = \"surface-reader\"\npath = \"sensors.csv\"\ncolor_by = \"T\"\nradius = \"5 %\"")
            .unwrap();
    assert_eq!(mapped(&found).1, [20.0, 30.0]);
    // Diagonal √200; the one without a value is not drawn.
    let drawn: Vec<u32> = found.triangles.concat();
    let all = distances(&found, &[[0.0; 3], [10.0, 0.0, 0.0]]);
    assert!(drawn.iter().all(|&p| (all[p as usize] - 0.05 * 200_f64.sqrt()).abs() < 1e-14));
    assert!(
        report.warnings[0].contains("left out, whose points or values are not finite"),
        "{:?}",
        report.warnings
    );
}

#[test]
fn edges_of_the_box_of_cells_and_of_features() {
    let tube = |sides: usize| sides * 2 + 2 * (sides * (sides.div_ceil(4) - 1) + 1);
    for (keys, count) in [
        ("kind = \"cells\"", 6 * 60 - 60),
        ("kind = \"features\"", 60),
        ("kind = \"features\"\nfeature_angle = 100.0\nsides = 5", 0),
        ("kind = \"outline\"\nradius = 0.1", 12),
    ] {
        let (found, report) = made(&format!("type = \"edges\"\n{keys}")).unwrap();
        let sides = if keys.contains("sides") { 5 } else { 8 };
        assert_eq!(found.points.len(), count * tube(sides), "{keys}");
        match count {
            0 => assert!(report.warnings[0].contains("no such edges"), "{:?}", report.warnings),
            _ => assert!(report.warnings.is_empty(), "{:?}", report.warnings),
        }
    }
    let found = surface("type = \"edges\"\nkind = \"cells\"\ncolor_by = \"s\"\nradius = 0.01");
    let a = |at: glam::DVec3| 2.0 * at.x - 3.0 * at.y + at.z + 20.0;
    // Values are those of the edges' ends: within the radius times the gradient.
    assert!(found.points.iter().zip(mapped(&found).0).all(|(at, value)| (a(*at) - value).abs() <= 0.038));
}

#[test]
fn wrong_lines_are_refused() {
    for (keys, said) in [
        ("type = \"surface-reader\"\npath = \"lines.vtp\"\nradius = 0.0", "'radius' is out of range"),
        (
            "type = \"surface-reader\"\npath = \"lines.vtp\"\nradius = \"p5\"",
            "a percentile is a value of the data",
        ),
        ("type = \"surface-reader\"\npath = \"lines.vtp\"\nsides = 2", "'sides' is out of range"),
        ("type = \"surface-reader\"\npath = \"lines.vtp\"\ncolor_by = \"sped\"", "'speed'"),
        ("type = \"surface-reader\"\npath = \"one.csv\"", "diagonal is the same everywhere"),
        ("type = \"edges\"\nkind = \"outline\"\ncolor_by = \"s\"", "a box has no values"),
        (
            "type = \"edges\"\nkind = \"cells\"\nfeature_angle = 3.0",
            "edges of the kind \"cells\" have no such angle",
        ),
        ("type = \"edges\"\nkind = \"wires\"", "expected one of features, cells, outline"),
    ] {
        let error = refused(keys);
        assert!(error.contains(said), "{keys}: {error}");
    }
}
