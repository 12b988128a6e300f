//! Units that files state: in the summary, and with the grid.

use super::packed::{grid, path, request};
use std::collections::BTreeMap;
use std::path::Path;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, inspect, read};
use voltet_testing::files::samples::file;

/// Units by the names of arrays.
fn units(path: &Path) -> BTreeMap<String, String> {
    let summary = inspect(path, &Request::default(), &NoProgress).unwrap();
    summary.arrays.into_iter().filter_map(|array| Some((array.head.name, array.unit?))).collect()
}

fn expected(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(name, unit)| (name.to_string(), unit.to_string())).collect()
}

#[test]
fn cgns_has_exponents_of_the_units_that_are_nearest() {
    assert_eq!(units(&path("cgns_units.cgns")), expected(&[("Pressure", "Pa"), ("Velocity", "cm/s")]));
    let further = Request { point_arrays: vec!["Velocity".into(), "Mach".into()], ..request("Pressure") };
    let own = grid("cgns_units.cgns", &further);
    assert_eq!(own.origin.units, expected(&[("Pressure", "Pa"), ("Velocity", "cm/s")]));
    let component = grid("cgns_units.cgns", &request("Velocity:Y"));
    assert_eq!(component.origin.units, expected(&[("Velocity:Y", "cm/s")]));
}

#[test]
fn openfoam_has_dimensions() {
    let folder = tempfile::tempdir().unwrap();
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/openfoam/text");
    let to = folder.path();
    for part in ["constant/polyMesh", "10"] {
        std::fs::create_dir_all(to.join(part)).unwrap();
        for entry in case.join(part).read_dir().unwrap() {
            let entry = entry.unwrap();
            std::fs::copy(entry.path(), to.join(part).join(entry.file_name())).unwrap();
        }
    }
    std::fs::create_dir(to.join("system")).unwrap();
    std::fs::write(to.join("system/controlDict"), "").unwrap();
    let set = |name: &str, exponents: &str| {
        let path = to.join("10").join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        let begin = text.find("dimensions").unwrap();
        let end = begin + text[begin..].find(';').unwrap();
        std::fs::write(path, format!("{}dimensions [{exponents}]{}", &text[..begin], &text[end..])).unwrap();
    };
    set("T", "0 0 0 1 0 0 0");
    set("S", "0 2 -2 0 0");
    set("C", "m s^-1");
    assert_eq!(units(to), expected(&[("T", "K"), ("S", "m²/s²")]));
    let own = read(to, &Request { point_arrays: vec!["S:XX".into()], ..request("T") }, &NoProgress).unwrap();
    assert_eq!(own.origin.units, expected(&[("T", "K"), ("S:XX", "m²/s²")]));
}

#[test]
fn vtk_has_labels_ucd_and_netcdf_have_texts() {
    let folder = tempfile::tempdir().unwrap();
    let array = |name: &str, key: &str| {
        format!(
            "<DataArray type=\"Float64\" Name=\"{name}\" format=\"ascii\">1 2 3 4 <InformationKey name=\"{key}\" \
             location=\"vtkDataArray\">\n m/s \n</InformationKey></DataArray>"
        )
    };
    let text = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>{}{}\
         </PointData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1\
         </DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>\
         <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" \
         format=\"ascii\">10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>",
        array("a", "UNITS_LABEL"),
        array("b", "OTHER")
    );
    assert_eq!(units(&file(&folder, "a.vtu", text.as_bytes())), expected(&[("a", "m/s")]));
    let text = "4 1 4 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n1 4 tet 1 2 3 4\n2 3 1\nU, m/s\np\n1 1 1 1 1\n2 1 1 1 1\n\
        3 1 1 1 1\n4 1 1 1 1\n";
    assert_eq!(units(&file(&folder, "a.inp", text.as_bytes())), expected(&[("U", "m/s")]));
    assert_eq!(units(&path("exodus_faces.e")), expected(&[("s", "K")]));
}
