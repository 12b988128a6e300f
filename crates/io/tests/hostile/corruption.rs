//! Every kind of small file, cut short and with bytes changed, thousands of times, always the same ones.

use crate::damage::{case_count, corrupt, corrupt_case, corrupt_files, corrupt_in, packed};
use std::path::Path;
use voltet_testing::files::samples::{file, structured, unstructured};
use voltet_testing::files::xml::{Compressor, Encoding, Mode};
use voltet_testing::files::{legacy, plot3d};

#[test]
fn damaged_xml_files_are_errors_or_other_grids() {
    for mode in [Mode::Ascii, Mode::Inline, Mode::AppendedRaw, Mode::AppendedBase64] {
        for compressor in [Compressor::None, Compressor::Zlib, Compressor::Lz4, Compressor::Lzma] {
            if mode == Mode::Ascii && compressor != Compressor::None {
                continue;
            }
            let wide_headers = compressor == Compressor::Lz4;
            let encoding = Encoding { mode, compressor, big_endian: wide_headers, wide_headers, block: 256 };
            corrupt("tetrahedra.vtu", "Float64", &unstructured(encoding, 3, false), case_count().max(200));
            corrupt("mixed.vtu", "Float64", &unstructured(encoding, 3, true), case_count().max(100));
        }
    }
    for (kind, mode) in [
        ("StructuredGrid", Mode::AppendedRaw),
        ("RectilinearGrid", Mode::Inline),
        ("ImageData", Mode::AppendedRaw),
        ("ImageData", Mode::Ascii),
    ] {
        let compressor = if mode == Mode::Ascii { Compressor::None } else { Compressor::Zlib };
        let encoding = Encoding { mode, compressor, big_endian: false, wide_headers: false, block: 256 };
        corrupt("structured", "s", &structured(kind, encoding), case_count().max(150));
    }
}

#[test]
fn damaged_legacy_files_are_errors_or_other_grids() {
    for version in ["4.2", "5.1"] {
        for binary in [false, true] {
            corrupt("a.vtk", "double", &legacy::unstructured(version, binary), case_count().max(300));
        }
    }
    for kind in ["STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS"] {
        for binary in [false, true] {
            corrupt("a.vtk", "s", &legacy::structured(kind, binary), case_count().max(100));
        }
    }
}

#[test]
fn damaged_plot3d_files_are_errors_or_other_grids() {
    for layout in plot3d::layouts().step_by(3) {
        corrupt("a.xyz", "", &plot3d::grid_file(layout), case_count() / 3);
    }
}

#[test]
fn damaged_vtkhdf_files_are_errors_or_other_grids() {
    let names = ["partitions", "polyhedra", "image_steps", "moving", "blocks", "collection", "cells"];
    for name in [&names[..], &["image", "rectilinear", "curvilinear", "short_offsets"]].concat() {
        let name = format!("vtkhdf_{name}.vtkhdf");
        corrupt(&name, if name.contains("moving") { "T" } else { "s" }, &packed(&name), case_count());
    }
}

#[test]
fn damaged_gmsh_files_are_errors_or_other_grids() {
    corrupt("a.msh", "f", include_bytes!("../files/every_element_4.msh"), case_count().max(200));
    corrupt("a.msh", "jumps", include_bytes!("../files/every_element_2.msh"), case_count().max(200));
    corrupt("a.msh", "transient", include_bytes!("../files/linear_4.msh"), case_count().max(200));
    corrupt("a.msh", "mean f", include_bytes!("../files/linear_2.msh"), case_count().max(200));
}

#[test]
fn damaged_results_of_mfem_are_errors_or_other_grids() {
    for (name, scalar) in
        [("straight", "quadratic"), ("curved", "linear"), ("curved", "by_nodes:1"), ("straight", "constant")]
    {
        let [root, mesh] = [format!("{name}_000003.mfem_root"), format!("{name}_000003/mesh.000000")];
        let fields = ["linear", "quadratic", "by_nodes", "by_vdim", "constant"];
        let fields = fields.map(|field| format!("{name}_000003/{field}.000000"));
        let files: Vec<&str> = [&root, &mesh].into_iter().chain(&fields).map(String::as_str).collect();
        corrupt_case(&format!("mfem/{name}"), &root, scalar, &files, case_count().max(300));
    }
}

#[test]
fn damaged_discontinuous_fields_of_mfem_are_errors_or_other_grids() {
    let mesh = "MFEM mesh v1.0\n\ndimension\n3\n\nelements\n2\n1 5 0 1 2 3 4 5 6 7\n1 6 1 8 2 5 9 6\n\nboundary\n0\n\nvertices\n10\n3\n\
        0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n2 0 0\n2 0 1\n";
    let values = (0..14).map(|i| i.to_string()).collect::<Vec<_>>().join(" ");
    let field = format!(
        "FiniteElementSpace\nFiniteElementCollection: L2_T2_3D_P1\nVDim: 1\nOrdering: 0\n\n{values}\n"
    );
    let files = [("a.mesh", mesh.as_bytes().to_vec()), ("a.gf", field.into_bytes())];
    corrupt_files(&files, "a.mesh", "a", case_count().max(400));
}

#[test]
fn damaged_cases_of_openfoam_are_errors_or_other_grids() {
    let mesh = ["points", "faces", "owner", "neighbour", "cellZones"];
    let mesh = |ending: &str| mesh.map(|name| format!("constant/polyMesh/{name}{ending}"));
    for (name, ending, fields) in [
        ("text", "", ["10/T", "10/D"]),
        ("bytes", "", ["10/T", "10/D"]),
        ("packed", ".gz", ["10/T.gz", "10/D.gz"]),
        ("dual", "", ["10/T", "10/D"]),
    ] {
        let mesh = mesh(ending);
        let files: Vec<&str> = mesh.iter().map(String::as_str).chain(fields).collect();
        let name = format!("openfoam/{name}");
        corrupt_case(&name, "", "T", &files, case_count().max(200));
        corrupt_case(&name, "", "D:0", &files, case_count().max(200) / 2);
    }
}

#[test]
fn damaged_patches_and_collated_files_of_openfoam_are_errors_or_other_grids() {
    for name in ["bytes", "text"] {
        let mesh = ["boundary", "faces", "owner", "points", "neighbour"];
        let mesh = mesh.map(|name| format!("constant/polyMesh/{name}"));
        let files: Vec<&str> = mesh.iter().map(String::as_str).chain(["10/C"]).collect();
        corrupt_case(&format!("openfoam/{name}"), "", "C:0", &files, case_count().max(200));
    }
    for form in ["ascii", "binary"] {
        let mesh = ["points", "faces", "owner", "neighbour", "cellZones", "boundary"];
        let mesh = mesh.map(|name| format!("processors2/constant/polyMesh/{name}"));
        let files: Vec<&str> = mesh.iter().map(String::as_str).chain(["processors2/10/T"]).collect();
        corrupt_case(&format!("openfoam/collated_{form}"), "case.foam", "T", &files, case_count().max(200));
    }
}

#[test]
fn damaged_cgns_files_are_errors_or_other_grids() {
    for name in ["cells", "mixed_old", "polyhedra", "polyhedra_old", "zones"] {
        let name = format!("cgns_{name}.cgns");
        corrupt(&name, "s", &packed(&name), case_count());
    }
    corrupt("cgns_units.cgns", "Velocity:X", &packed("cgns_units.cgns"), case_count());
    corrupt("cgns_steps.cgns", "T", &packed("cgns_steps.cgns"), case_count());
}

#[test]
fn damaged_xdmf_files_and_their_data_are_errors_or_other_grids() {
    for name in ["polyhedra", "xml"] {
        let name = format!("xdmf_{name}.xdmf");
        corrupt(&name, "s", &packed(&name), case_count());
    }
    for (name, scalar) in [("blocks", "s"), ("dolfin", "T"), ("hdf", "s"), ("tetra", "s")] {
        let (text, data) = (format!("xdmf_{name}.xdmf"), format!("xdmf_{name}.h5"));
        let files = [(&*text, packed(&text)), (&*data, packed(&data))];
        corrupt_files(&files, &text, scalar, 2 * case_count());
    }
}

#[test]
fn damaged_exodus_files_are_errors_or_other_grids() {
    for name in ["exodus_kinds.exo", "exodus_kinds.ex2", "exodus_old.g", "exodus_hdf5.e"] {
        for scalar in ["T", "disp:magnitude", "p"] {
            corrupt(name, scalar, &packed(name), case_count());
        }
    }
    for scalar in ["s", "c"] {
        corrupt("exodus_faces.e", scalar, &packed("exodus_faces.e"), case_count());
    }
}

#[test]
fn damaged_trees_are_errors_or_other_grids() {
    let encoding = Encoding {
        mode: Mode::Ascii,
        compressor: Compressor::None,
        big_endian: false,
        wide_headers: false,
        block: 256,
    };
    let folder = tempfile::tempdir().unwrap();
    let leaf = file(&folder, "leaf.vtu", &unstructured(encoding, 2, false));
    let leaf = leaf.display();
    let tree = format!(
        "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><Block index=\"0\" name=\"a\">\
         <DataSet index=\"0\" name=\"b\" file=\"{leaf}\"/><Piece index=\"1\"><DataSet index=\"0\" file=\"{leaf}\"/></Piece></Block>\
         <DataSet index=\"1\" file=\"{leaf}\"/></vtkMultiBlockDataSet></VTKFile>"
    );
    corrupt("tree.vtm", "Float64", tree.as_bytes(), case_count().max(300));
    let series = format!(
        "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" name=\"a\" part=\"0\" file=\"{leaf}\"/>\
         <DataSet timestep=\"0\" group=\"b\" part=\"1\" file=\"{leaf}\"/></Collection></VTKFile>"
    );
    corrupt("series.pvd", "Float64", series.as_bytes(), case_count().max(300));
}

#[test]
fn damaged_meshes_of_text_are_errors_or_other_grids() {
    corrupt("a.ucd", "f", include_bytes!("../files/mesh.ucd"), case_count().max(200));
    corrupt("a.su2", "", include_bytes!("../files/mesh.su2"), case_count().max(200));
    corrupt("a.bdf", "", include_bytes!("../files/mesh.bdf"), case_count().max(200));
    corrupt("b.bdf", "", include_bytes!("../files/systems.bdf"), case_count().max(200));
    corrupt("a.inp", "", include_bytes!("../files/mesh.inp"), case_count().max(200));
    let folder = tempfile::tempdir().unwrap();
    file(&folder, "b.bdf", include_bytes!("../files/systems.bdf"));
    file(&folder, "c.bdf", b"INCLUDE\n'b.\nbdf'\nGRID,101,1,9.\n");
    let text = b"INCLUDE c.bdf\nGRID,102,,8.\nGRID,103,,8.,1.\nGRID,104,,8.,,1.\nCTETRA,900,1,101,102,103,104\nENDDATA\n";
    corrupt_in(&folder, ["a.bdf", "a.bdf"], "", text, case_count().max(200));
    file(&folder, "b.inp", include_bytes!("../files/mesh.inp"));
    let text = b"*INCLUDE, INPUT=b.inp\n*NODE, INPUT=c.txt\n*ELEMENT, TYPE=C3D4, ELSET=a\n90001, 90001, 90002, 90003, 90004\n";
    file(&folder, "c.txt", b"90001, 0, 0, 9\n90002, 1, 0, 9\n90003, 0, 1, 9\n90004, 0, 0, 10\n");
    corrupt_in(&folder, ["a.inp", "a.inp"], "", text, case_count().max(200));
    corrupt("a.dat", "f", include_bytes!("../files/mesh.dat"), case_count().max(200));
    let faces = "VARIABLES = x y z f\nZONE NODES=4 FACES=4 ELEMENTS=1 ZONETYPE=FEPOLYHEDRON TOTALNUMFACENODES=12\n\
        0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 4\n# nodes\n3 3 3 3\n1 2 3 1 2 4 2 3 4 1 3 4\n1 1 1 1\n0 0 0 0\n";
    corrupt("b.dat", "f", faces.as_bytes(), case_count().max(400));
}

#[test]
fn damaged_binary_files_of_tecplot_are_errors_or_other_grids() {
    for (name, scalar) in
        [("double", "s"), ("double", "c"), ("single", "s"), ("steps", "c"), ("107", "c"), ("108", "s")]
    {
        let name = format!("tecplot_{name}.plt");
        corrupt(&name, scalar, &packed(&name), case_count().max(200));
    }
}

#[test]
fn damaged_cases_of_ensight_are_errors_or_other_grids() {
    let files =
        ["parts.0.case", "parts.0.00000.geo", "parts.0.00000_n.f", "parts.0.00000_n.p", "parts.0.00000_c.g"];
    for scalar in ["f_n", "p_n:1", "g_c"] {
        corrupt_case("ensight", files[0], scalar, &files, case_count().max(200));
    }
}

#[test]
fn damaged_blocks_of_ensight_are_errors_or_other_grids() {
    let line = |text: &str| format!("{text:\0<80}").into_bytes();
    let case = "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: f a.f\n";
    let floats = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let part = [line("part"), 1_i32.to_le_bytes().to_vec()].concat();
    let values =
        [line("f"), part.clone(), line("block"), floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])].concat();
    for form in ["uniform", "rectilinear"] {
        let head = ["C Binary", "a", "b", "node id off", "element id off"].map(line).concat();
        let counts: Vec<u8> = [2_i32; 3].iter().flat_map(|n| n.to_le_bytes()).collect();
        let numbers = floats(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let geometry =
            [head, part.clone(), line("box"), line(&format!("block {form}")), counts, numbers].concat();
        let files = [("a.case", case.as_bytes().to_vec()), ("a.geo", geometry), ("a.f", values.clone())];
        corrupt_files(&files, "a.case", "f", case_count().max(600));
    }
}

#[test]
fn damaged_files_of_several_steps_of_ensight_are_errors_or_other_grids() {
    let line = |text: &str| format!("{text:\0<80}").into_bytes();
    let sample = |name: &str| {
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/ensight").join(name)).unwrap()
    };
    let steps = |head: Vec<u8>, step: &[u8]| {
        let step = [&line("BEGIN TIME STEP"), step, &line("END TIME STEP")].concat();
        let (first, table) = (head.len() as u64, (head.len() + 2 * step.len()) as u64);
        let places = [first.to_le_bytes(), (first + step.len() as u64).to_le_bytes()].concat();
        let end =
            [&2_u32.to_le_bytes()[..], &places, &[0; 4], &table.to_le_bytes(), &line("FILE_INDEX")].concat();
        [&head, &step[..], &step, &end].concat()
    };
    let case = "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 1 a.geo\nVARIABLE\nscalar per node: 1 1 f a.f\nTIME\n\
        time set: 1\nnumber of steps: 2\ntime values: 0 1\nFILE\nfile set: 1\nnumber of steps: 2\n";
    let files = [
        ("a.case", case.as_bytes().to_vec()),
        ("a.geo", steps(line("C Binary"), &sample("parts.0.00000.geo")[80..])),
        ("a.f", steps(Vec::new(), &sample("parts.0.00000_n.f"))),
    ];
    corrupt_files(&files, "a.case", "f", case_count().max(600));
}

#[test]
fn damaged_adaptive_grids_are_errors_or_other_grids() {
    for name in ["trees_1_ascii.htg", "trees_1_appended.htg", "trees_2_binary.htg", "trees_2_appended.htg"] {
        corrupt(name, "c", &packed(name), case_count().max(200));
    }
    for (name, scalar) in
        [("vtkhdf_trees.vtkhdf", "c"), ("vtkhdf_patches.vtkhdf", "c"), ("vtkhdf_patches.vtkhdf", "p")]
    {
        corrupt(name, scalar, &packed(name), case_count());
    }
    let image = |extent: &str, spacing: &str, count: usize| {
        let values = "1 ".repeat(count);
        format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" Spacing=\"{spacing}\"><Piece \
             Extent=\"{extent}\"><CellData><DataArray type=\"Int8\" Name=\"c\" format=\"ascii\">{values}</DataArray></CellData>\
             </Piece></ImageData></VTKFile>"
        )
    };
    let tree = "<VTKFile type=\"vtkOverlappingAMR\"><vtkOverlappingAMR origin=\"0 0 0\" grid_description=\"XYZ\">\
        <Block level=\"0\"><DataSet index=\"0\" amr_box=\"0 1 0 1 0 1\" file=\"0.vti\"/></Block>\
        <Block level=\"1\"><DataSet index=\"0\" amr_box=\"0 1 0 1 0 1\" file=\"1.vti\"/></Block></vtkOverlappingAMR></VTKFile>";
    let files = [
        ("a.vthb", tree.to_owned().into_bytes()),
        ("0.vti", image("0 2 0 2 0 2", "1 1 1", 8).into_bytes()),
        ("1.vti", image("0 2 0 2 0 2", "0.5 0.5 0.5", 8).into_bytes()),
    ];
    corrupt_files(&files, "a.vthb", "c", case_count().max(600));
}
