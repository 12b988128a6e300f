//! First lines of files as writers of each program make them, and the format that takes them.

use super::*;

/// Name and beginning of a file.
type Head = (&'static str, &'static [u8]);

/// Heads by format. Names without an ending and with that of another format stand for files that were renamed.
const HEADS: [(&Format, &[Head]); 16] = [
    (
        &xdmf::FORMAT,
        &[
            ("a.xdmf", b"<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\">\n"),
            ("a", b"\xEF\xBB\xBF\r\n<Xdmf Version=\"3.0\">\r\n<Domain>\r\n"),
            ("a.vtu", b"<?xml version='1.0'?>\n<!-- made by hand -->\n<Xdmf xmlns:xi=\"http://www.w3.org/2001/XInclude\">"),
            ("a.XMF", b"<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!DOCTYPE x SYSTEM \"x.dtd\" [\n<!ENTITY h \"a.h5\">\n"),
            // UTF-16.
            ("a.xdmf", b"\xff\xfe<\0X\0d\0m\0f\0>\0"),
        ],
    ),
    (
        &xml::FORMAT,
        &[
            ("a.vtu", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">\n"),
            ("a", b"\r\n  <VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"BigEndian\">\r\n"),
            ("a.xdmf", b"\xEF\xBB\xBF<VTKFile type=\"Collection\" version=\"0.1\">"),
            ("a.vtk", b"<!-- <Xdmf> -->\n<VTKFile type=\"RectilinearGrid\">"),
        ],
    ),
    (
        &legacy::FORMAT,
        &[
            ("a.vtk", b"# vtk DataFile Version 3.0\nvtk output\nASCII\nDATASET UNSTRUCTURED_GRID\n"),
            ("a.dat", b"# vtk DataFile Version 5.1\r\nTITLE = \"of Tecplot\"\r\nBINARY\r\n"),
            ("a.inp", b"# vtk DataFile Version 2.0\n8 1 0 0 0\nASCII\nDATASET STRUCTURED_GRID\n"),
            ("a.bdf", b"\n# vtk DataFile Version 4.2\nBEGIN BULK\nASCII\n"),
            ("mesh.mesh", b"# vtk DataFile Version 2.0\nMeshVersionFormatted 2\nASCII\n"),
        ],
    ),
    (
        &SERIES,
        &[
            ("a.vtu.series", b"{\n  \"file-series-version\" : \"1.0\",\n  \"files\" : [\n"),
            ("a.json", b"\xEF\xBB\xBF{\"files\":[],\"file-series-version\":\"1.0\"}"),
            ("a.vtk.SERIES", b"{ \"files\": [ { \"name\": \"a.vtk\", \"time\": 0 } ] }"),
        ],
    ),
    (
        &HDF5,
        &[
            ("a.vtkhdf", b"\x89HDF\r\n\x1a\n\0\0\0\0"),
            ("a.g", b"\x89HDF\r\n\x1a\n\x02\x08\x08\0"),
            ("a.inp", b"\x89HDF\r\n\x1a\n\0\0\0\0"),
            ("a", b"\x89HDF\r\n\x1a\n\x03\x08\x08\0"),
        ],
    ),
    (
        &exodus::FORMAT,
        &[
            ("a.e", b"CDF\x01\0\0\0\0\0\0\0\x0a"),
            ("a.g", b"CDF\x02\0\0\0\x01\0\0\0\x0a"),
            ("a.bdf", b"CDF\x05\0\0\0\0\0\0\0\0"),
            ("a.exo.4.0", b"CDF\x01\0\0\0\0\0\0\0\x0a"),
        ],
    ),
    (
        &gmsh::FORMAT,
        &[
            ("a.msh", b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n"),
            ("a.mesh", b"\xEF\xBB\xBF$MeshFormat\r\n2.2 0 8\r\n$EndMeshFormat\r\n"),
            ("a.msh", b"\n\n$Comments\n*NODE\nBEGIN BULK\n$EndComments\n$MeshFormat\n2.2 0 8\n"),
            ("a", b"$NOD\n4\n1 0 0 0\n"),
            // A comment of Nastran.
            ("a.dat", b"$MeshFormat \n2.2 1 8\n\x01\0\0\0"),
        ],
    ),
    (
        &mfem::FORMAT,
        &[
            ("a.mesh", b"MFEM mesh v1.0\n\n#\n# MFEM Geometry Types (see mesh/geom.hpp):\n#\n"),
            ("a.msh", b"MFEM mesh v1.3\r\n\r\ndimension\r\n3\r\n"),
            ("mesh.000000", b"MFEM mesh v1.2\ndimension\n3\n"),
            ("a.mfem_root", b"{ \"dsets\" : { \"main\" : { \"cycle\" : 0 } } }"),
        ],
    ),
    (
        &ensight::FORMAT,
        &[
            ("a.case", b"FORMAT\ntype: ensight gold\n\nGEOMETRY\nmodel: a.geo\n"),
            ("a.encas", b"# Case of OpenFOAM\n# TITLE = a\n\nFORMAT\r\ntype:\tensight gold\r\n"),
            ("a", b"\xEF\xBB\xBF\n  format\n  Type : EnSight Gold\n"),
            ("a.dat", b"FORMAT\ntype: ensight gold\nVARIABLE\nscalar per node: zone = a.scl\n"),
        ],
    ),
    (
        &tecplot::BINARY,
        &[
            ("a.plt", b"#!TDV112\x01\0\0\0\0\0\0\0"),
            ("a.dat", b"#!TDV107\x01\0\0\0"),
            ("a", b"#!TDV111\0\0\0\x01"),
        ],
    ),
    (
        &tecplot::TEXT,
        &[
            ("a.dat", b"TITLE     = \"a mesh\"\nVARIABLES = \"X\"\n\"Y\"\n\"Z\"\nZONE T=\"a\"\n"),
            ("a.tec", b"\xEF\xBB\xBF# by hand\r\n\r\n variables = \"x\", \"y\", \"z\", \"p\"\r\n"),
            ("a.inp", b"Variables=\"X\",\"Y\",\"Z\"\nZone N=8, E=1, F=FEPOINT, ET=BRICK\n"),
            ("a", b"FILETYPE = FULL\nVARIABLES = X Y Z\n"),
            ("a.plt", b"ZONE\nT=\"a\"\nNODES=4, ELEMENTS=1\n"),
            ("a.szplt", b"zone\tT=\"a\"\n"),
            ("a.dat", b"TITLE = \"GRID        1  of *NODE\"\nVARIABLES = \"NDIME=\"\n"),
        ],
    ),
    (
        &ucd::FORMAT,
        &[
            ("a.inp", b"8 1 1 0 0\n1 0 0 0\n"),
            ("a.ucd", b"# AVS UCD\r\n#\r\n  8   1   0   0   0\r\n"),
            ("a.avs", b"\xEF\xBB\xBF# *NODE\n\n8\t5\t1\t2\t0\n"),
            ("a.INP", b"# a comment of many lines, behind which the counts stand\n"),
        ],
    ),
    (
        &abaqus::FORMAT,
        &[
            ("a.inp", b"*Heading\n** Job name: a Model name: Model-1\n*Preprint, echo=NO\n*Part, name=a\n"),
            ("a", b"**\r\n** ABAQUS Input Deck Generated by HyperMesh\r\n**\r\n*NODE\r\n 1, 0., 0., 0.\r\n"),
            ("a.dat", b"\xEF\xBB\xBF\n*node, nset=all\n1, 0, 0, 0\n"),
            ("a.inp", b"*INCLUDE, INPUT=mesh.msh\n*STEP\n"),
            ("a.msh", b"*NODE, NSET=Nall\n1,0.0,0.0,0.0\n*ELEMENT, TYPE=C3D10, ELSET=Eall\n"),
            ("a.inp", b"** 8 1 0 0 0\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n"),
        ],
    ),
    (
        &su2::FORMAT,
        &[
            ("a.su2", b"NDIME= 3\nNELEM= 1\n10 0 1 2 3 0\n"),
            ("a", b"%\r\n% Problem dimension\r\n%\r\nNDIME=3\r\n"),
            ("a.mesh", b"\xEF\xBB\xBF\nNZONE = 2\nIZONE = 1\nNDIME= 3\n"),
            ("a.dat", b"% TITLE = a\nndime = 3 % of space\n"),
        ],
    ),
    (
        &nastran::FORMAT,
        &[
            ("a.bdf", b"$ Generated by a preprocessor\nSOL 101\nCEND\nTITLE = a\nBEGIN BULK\n"),
            ("a.nas", b"TITLE = VARIABLES\nGRID,1,,0.,0.,0.\n"),
            ("a.dat", b"TITLE=a deck of statics\r\nSUBCASE 1\r\nBEGIN BULK\r\nGRID           1       0      0.\r\n"),
            ("a", b"ID A,B\nSOL 101\nCEND $ of the executive control\nTITLE = a\n"),
            ("a.dat", b"\xEF\xBB\xBF\n$ a comment\ngrid*                  1               0\n"),
            ("a.txt", b"$ elements before points\nCTETRA  1       1       1       2       3       4\n"),
            ("a.inp", b"chexa,1,1,1,2,3,4,5,6\n,7,8\n"),
            ("a.dat", b"begin  bulk\nCQUAD4,1,1,1,2,3,4\n"),
        ],
    ),
    (
        &plot3d::FORMAT,
        &[
            ("a.xyz", b"\x0c\0\0\0\x05\0\0\0\x05\0\0\0\x05\0\0\0"),
            ("a.p3d", b"1\n 5 5 5\n 0.0 0.25 0.5\n"),
            ("a.X", b"  2\r\n  3 3 3\r\n  3 3 3\r\n"),
            ("a.g", b"\0\0\0\x01\0\0\0\x05\0\0\0\x05"),
        ],
    ),
];

/// Heads of no format that is read: of other programs, or with too little to tell.
const FOREIGN: [Head; 8] = [
    ("a.dat", b"1 0.0 0.0 0.0\n2 1.0 0.0 0.0\n"),
    ("a.txt", b"8 1 0 0 0\n1 0 0 0\n"),
    ("a.txt", b"Grid 1 of the campus: zone of title\n"),
    ("a.txt", b"zones = 3\nBEGIN\n"),
    ("a.k", b"$ LS-DYNA\n*KEYWORD\n*NODE\n"),
    ("a.vtk", b"# VTK\nASCII\n"),
    ("a.case", b"FORMAT\n\nBODY\n"),
    ("a.json", b"{\"files\": []}"),
];

#[test]
fn every_format_takes_its_own_heads_whatever_their_names_and_no_other_does() {
    let folder = tempfile::tempdir().unwrap();
    // The format that a file of such a name and beginning is opened by.
    let taken_by = |(name, head): &Head| {
        let path = folder.path().join(name);
        std::fs::write(&path, head).unwrap();
        let source = Source::open(&path).unwrap();
        unsupported::refuse(&source, unsupported::BY_MAGIC).unwrap();
        let head = source.head(HEAD).unwrap();
        format_of(&head, &path, &Request::default()).map(|format| format.files)
    };
    for format in FORMATS {
        let own = HEADS.iter().filter(|(of, _)| of.files == format.files);
        let heads: Vec<&Head> = own.flat_map(|(_, heads)| *heads).collect();
        assert!(heads.len() >= 3, "heads of {}", format.files);
        for head in heads {
            assert_eq!(taken_by(head), Some(format.files), "{head:?}");
        }
    }
    for head in &FOREIGN {
        assert_eq!(taken_by(head), None, "{head:?}");
    }
}
