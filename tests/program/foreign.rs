//! Data in formats that are not read: named, with what to do, and one error.

use super::support::Folder;

/// Runs and describes a file and asserts that either is refused with its format and a remedy.
#[track_caller]
fn refused(folder: &Folder, name: &str, wanted: &[&str]) {
    folder.voltet(&["info", name]).fails(1, &[wanted, &[name]].concat());
    let ran = folder.voltet(&["run", "slab.toml", "--set", &format!("grid.path={name}")]);
    ran.fails(1, &[wanted, &["node 'grid'"]].concat());
}

#[test]
fn formats_are_told_by_content_and_named_with_a_remedy() {
    let folder = Folder::new();
    const HDF5: &str = "\u{89}HDF\r\n\x1a\n";
    // One byte a character, as Latin 1 has it.
    let bytes = |text: &str| text.chars().map(|c| c as u8).collect::<Vec<u8>>();
    let hdf5 = |inside: &str| bytes(&format!("{HDF5}{}{inside}\0\0", "\0".repeat(5000)));
    let stl = [&[0; 80][..], &1u32.to_le_bytes(), &[7; 50]].concat();
    let paraview = "open it in ParaView and save its data as .vtu";
    let surface = "a surface has to be filled";
    for (name, content, what, remedy) in [
        ("adf.cgns", bytes("@(#)ADF Database Version A02011>"), "a CGNS file in ADF", "adf2hdf"),
        ("a.med", hdf5("ENS_MAA"), "a MED file", "ParaVis"),
        ("user_block.h5", [vec![0; 512], hdf5("VTKHDF")].concat(), "an HDF5 file", "h5unjam"),
        ("fluent.msh", bytes("(0 \"GAMBIT to Fluent File\")\n"), "Ansys Fluent", paraview),
        ("results.h5", hdf5("NASTRAN"), "results of Nastran", "pyNastran"),
        ("room.cas.h5", hdf5("meshes\0settings"), "Ansys Fluent", paraview),
        ("checkpoint.h5", hdf5("topologies"), "a checkpoint of Firedrake", "VTKFile"),
        ("text.h5", bytes("\u{89}HDF\n\x1a\n"), "line ends were changed", "transfer of bytes"),
        ("restart_flow.dat", bytes("\u{ec}\u{2b}\u{8}\0"), "a restart or surface file of SU2", "--solution"),
        ("bytes.inp", bytes("\u{7}\0\0\u{5}"), "AVS UCD as bytes", paraview),
        ("a.unv", bytes("    -1\n  2411\n"), "a universal file of I-DEAS", "gmsh FILE -save"),
        ("femap.neu", bytes("   -1\n   100\n<NULL>\n"), "a neutral file of Femap", "Nastran"),
        ("gambit.neu", bytes("        CONTROL INFO 2.3.16\n"), "a neutral file of GAMBIT", "vtkGAMBITReader"),
        (
            "a.msh",
            bytes("!HEADER\n beam\n!NODE\n1, 0., 0., 0.\n"),
            "a mesh of FrontISTR",
            "!output_type = VTK",
        ),
        ("a.sos", bytes("FORMAT\ntype: master_server gold\n"), "several servers", ".case files"),
        ("faces", bytes("/*---*\\\nFoamFile\n{\n}\n4(\0\0)"), "a file of OpenFOAM", "its folder"),
        ("a.k", bytes("$ a comment\n*KEYWORD\n*NODE\n"), "input of LS-DYNA", "LS-PrePost"),
        ("a.cdb", bytes("/COM,ANSYS RELEASE\n/PREP7\n"), "input of Ansys", "pymapdl_reader"),
        ("a.geo", bytes("C Binary"), "a geometry file of EnSight", ".case file beside it"),
        ("points", bytes("/*---*\\\nFoamFile\n{\n"), "a file of OpenFOAM", "its folder"),
        ("a.xml", bytes("<dolfin>"), "a mesh of FEniCS", "meshio"),
        ("a.mesh", bytes("# a\n\n MeshVersionFormatted 2\nDimension 3\n"), "a mesh of Medit", "meshio"),
        ("text.stl", bytes("solid a\n facet normal 0 0 1\n"), "a surface (STL)", surface),
        ("binary.stl", stl, "a surface (STL)", surface),
        ("a.ply", bytes("ply\nformat ascii 1.0\n"), "a surface (PLY)", surface),
        ("a.obj", bytes("# Blender\nv 0 0 0\nf 1 2 3\n"), "a surface (OBJ)", surface),
        ("points.csv", bytes("-1 0.5 2\n-1 1 3\n"), "a table as text", "points alone have no volume"),
        ("nodes.k", bytes("$NODE of a part\n*KEYWORD\n"), "input of LS-DYNA", "LS-PrePost"),
        ("a.nrrd", bytes("NRRD0004\n"), "an image (NRRD)", ".vti"),
        ("a.vtu.gz", bytes("\x1f\u{8b}\x08\0"), "a gzip archive", "unpack it first"),
        ("a.csv", bytes("x,y,z,t\n0,0,0,1\n"), "a table as text", "points alone have no volume"),
    ] {
        folder.write(name, content);
        refused(&folder, name, &["the format of the file is known, but not read: found", what, remedy]);
    }
    // A picture may carry a pipeline, so `info` looks into it.
    folder.write("a.png", bytes("\u{89}PNG\r\n\x1a\n"));
    folder.voltet(&["info", "a.png"]).fails(2, &["cannot be read as PNG", "volume (.vti)", "a.png"]);
    let ran = folder.voltet(&["run", "slab.toml", "--set", "grid.path=a.png"]);
    ran.fails(1, &["an image (PNG)", ".vti", "node 'grid'"]);
}

#[test]
fn kinds_of_vtk_without_a_volume_are_refused() {
    let folder = Folder::new();
    folder.write("a.vtp", "<VTKFile type=\"PolyData\"><PolyData/></VTKFile>");
    refused(&folder, "a.vtp", &["type 'PolyData'", "a surface has to be filled"]);
    folder.write("a.phtg", "<VTKFile type=\"PHyperTreeGrid\"><PHyperTreeGrid/></VTKFile>");
    refused(&folder, "a.phtg", &["type 'PHyperTreeGrid'", "a file of which it names"]);
}
