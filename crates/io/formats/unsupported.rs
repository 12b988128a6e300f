//! Formats that are not read, told by their content: what a file is, and what to do with it.

use super::source::{HEAD, Source};
use std::path::Path;
use voltet_core::{Error, Result};

/// A format that is not read: its name with an article, a remedy (a clause that can follow "expected"), and what tells its files.
pub(super) type UnsupportedFormat = (&'static str, &'static str, fn(&FileStart) -> bool);

/// First bytes of a file.
pub(super) struct FileStart {
    bytes: Vec<u8>,
    len: u64,
    /// The ending of its name, in small letters.
    ending: String,
}

const PARAVIEW: &str = "a .vtu file: open it in ParaView and save its data as .vtu";
const MESHIO: &str = "a .vtu file: `meshio convert FILE out.vtu` (pip install meshio) makes one of its mesh";
const GMSH: &str = "a mesh of Gmsh: `gmsh FILE -save -o out.msh` makes one of it";
const NASTRAN_RESULTS: &str = "the bulk data (.bdf) that they belong to, whose mesh is read; pyNastran (pip install pyNastran) reads the results";
const SU2_RESTART: &str =
    "the mesh (.su2), with the restart file as its solution (--solution); a file of surfaces has no cells";
const SURFACE: &str =
    "cells with a volume: a surface has to be filled with them by a mesher (Gmsh, TetGen) first";
const IMAGE: &str = "a .vti file (VTK image data): ParaView reads it and saves its data as .vti";
const ARCHIVE: &str = "the file within: unpack it first";
const OPENFOAM: &str = "the case that it belongs to: its folder, a file .foam there, or system/controlDict";
const SALOME: &str =
    "a .vtu file: Salome's ParaVis reads it and saves its data as .vtu, and so does `meshio convert`";
/// Beginning of every file in HDF5.
pub(super) const HDF5_MAGIC: &[u8] = b"\x89HDF\r\n\x1a\n";
pub(super) const HDF5: &str = "the .xdmf file beside it, if there is one: it says what the numbers are; or a .vtu file of the program that wrote this one";
const CGNS_ADF: &str = "a CGNS file in HDF5: `adf2hdf FILE` of the CGNS tools makes one of it";
const ABAQUS: &str =
    "a .vtu file: Abaqus/CAE exports field output as text, or as .inp with `meshio convert` after it";
const ENSIGHT: &str = "the .case file beside it";
const LS_DYNA: &str = "a .vtu file: LS-PrePost saves the results (d3plot), and ParaView reads these";
const ANSYS: &str = "a .vtu file: `pymapdl_reader` (ansys-mapdl-reader) reads it and saves its grid";
const SUBZONES: &str = "a .plt file: Tecplot writes one by File › Write Data (Tecplot Binary Data)";
const MFEM: &str = "a .vtu file: MFEM writes one by ParaViewDataCollection";
const ADIOS2: &str = "a .vtu file: ParaView opens data of ADIOS2 that describe a grid (VTX, as FEniCSx writes) and saves it as .vtu";
const GRID_FUNCTION: &str = "the mesh that it belongs to, with this file as its solution";
const TABLE: &str =
    "a grid with cells: points alone have no volume; ParaView's Delaunay3D joins them to tetrahedra";

/// Test for a format; it is given a function that says whether the file holds a name.
type TellsFormat = fn(&dyn Fn(&str) -> bool) -> bool;

/// Formats in HDF5, as [`UnsupportedFormat`], by the names in them.
const IN_HDF5: [(&str, &str, TellsFormat); 4] = [
    ("a MED file (Salome)", SALOME, |has_name| has_name("ENS_MAA") || has_name("INFOS_GENERALES")),
    ("results of Nastran", NASTRAN_RESULTS, |has_name| has_name("NASTRAN")),
    ("a case or results of Ansys Fluent", PARAVIEW, |has_name| {
        has_name("settings") && (has_name("meshes") || has_name("results"))
    }),
    // Meshes of Conduit (Blueprint) have topologies beside their coordinates.
    ("a checkpoint of Firedrake", "a .pvd file: VTKFile of Firedrake writes one", |has_name| {
        has_name("topologies") && !has_name("coordsets")
    }),
];

/// Formats that their first bytes tell for sure.
pub(super) const BY_MAGIC: &[UnsupportedFormat] = &[
    ("a CGNS file in ADF, its older form", CGNS_ADF, |file| {
        !file.has_magic_at(0, HDF5_MAGIC) && file.holds("ADF Database Version")
    }),
    ("data of Abaqus (.odb)", ABAQUS, |file| file.begins(&["HKSRD0"])),
    ("a file of OpenFOAM", OPENFOAM, |file| file.has_line(|line| line.trim() == "FoamFile")),
    ("a mesh or case of Ansys Fluent", PARAVIEW, |file| file.begins(&["(0 ", "(1 ", "(2 "])),
    ("a geometry file of EnSight", ENSIGHT, |file| file.begins(&["C Binary", "Fortran Binary"])),
    ("a subzone file of Tecplot (.szplt)", SUBZONES, |file| file.begins(&["#!SZPLT"])),
    ("a non-conforming mesh of MFEM", MFEM, |file| file.begins(&["MFEM NC mesh v", "MFEM mesh v1.1"])),
    ("a mesh of MFEM made of splines (NURBS)", MFEM, |file| file.begins(&["MFEM NURBS "])),
    ("a mesh of MFEM that is not written out (INLINE)", MFEM, |file| file.begins(&["MFEM INLINE mesh"])),
    ("a grid function of MFEM", GRID_FUNCTION, |file| {
        file.begins(&["FiniteElementSpace\n", "FiniteElementSpace\r", "MFEM FiniteElementSpace v"])
    }),
    ("a mesh of Medit (.mesh)", MESHIO, |file| {
        // The first line of a legacy VTK file looks like a comment, and the second is free.
        !file.begins(&["# vtk DataFile"]) && file.begins_after_comments("MeshVersionFormatted")
    }),
    ("a mesh of FEniCS (XML)", MESHIO, |file| file.has_tag("dolfin")),
    (
        "an HDF5 file whose line ends were changed",
        "the file as it was written, by a transfer of bytes: Git and FTP change those of text",
        |file| file.has_magic_at(0, b"\x89HDF\n\x1a\n"),
    ),
    ("a restart or surface file of SU2", SU2_RESTART, |file| {
        file.has_magic_at(0, b"\xec\x2b\x08\0") || file.begins(&["\"PointID\""])
    }),
    ("AVS UCD as bytes", PARAVIEW, |file| {
        file.has_magic_at(0, b"\x07\0") && ["inp", "ucd", "avs"].contains(&file.ending.as_str())
    }),
    ("a surface (PLY)", SURFACE, |file| file.begins(&["ply\n", "ply\r"])),
    ("a surface (STL)", SURFACE, |file| file.is_stl()),
    ("a surface (OFF)", SURFACE, |file| file.begins(&["OFF\n", "OFF\r"])),
    ("a surface (glTF)", SURFACE, |file| file.begins(&["glTF"])),
    ("an image (PNG)", IMAGE, |file| file.has_magic_at(0, b"\x89PNG")),
    ("an image (JPEG)", IMAGE, |file| file.has_magic_at(0, b"\xff\xd8\xff")),
    ("an image (TIFF)", IMAGE, |file| file.has_magic_at(0, b"II*\0")),
    ("an image (TIFF)", IMAGE, |file| file.has_magic_at(0, b"MM\0*")),
    ("an image (NRRD)", IMAGE, |file| file.begins(&["NRRD000"])),
    ("an image (DICOM)", IMAGE, |file| file.has_magic_at(128, b"DICM")),
    ("an image (NIfTI)", IMAGE, |file| file.has_magic_at(344, b"n+1\0")),
    ("an image (NIfTI)", IMAGE, |file| file.has_magic_at(344, b"ni1\0")),
    ("an image (MetaImage)", IMAGE, |file| file.has_line_with(&["ObjectType = Image"])),
    ("an OpenVDB file", IMAGE, |file| file.has_magic_at(0, b" BDV\0\0\0\0")),
    ("a gzip archive", ARCHIVE, |file| file.has_magic_at(0, b"\x1f\x8b\x08")),
    ("a zip archive", ARCHIVE, |file| file.has_magic_at(0, b"PK\x03\x04")),
    ("an xz archive", ARCHIVE, |file| file.has_magic_at(0, b"\xfd7zXZ\0")),
    ("a bzip2 archive", ARCHIVE, |file| file.begins(&["BZh"])),
    ("a zstd archive", ARCHIVE, |file| file.has_magic_at(0, b"\x28\xb5\x2f\xfd")),
];

/// Formats of plain text that only words tell; asked where nothing else is meant.
pub(super) const BY_WORDS: &[UnsupportedFormat] = &[
    (
        "an HDF5 file behind a block of its writer's own",
        "the file without that block: `h5unjam -i FILE -o NEW` makes one",
        |file| [512, 1024, 2048].iter().any(|&place| file.has_magic_at(place, HDF5_MAGIC)),
    ),
    ("a neutral file of Femap", "a .bdf file: Femap exports Nastran", |file| {
        file.universal_set() == Some(100)
    }),
    ("a universal file of I-DEAS (.unv)", GMSH, |file| file.universal_set().is_some()),
    ("a neutral file of GAMBIT", "a .vtu file: vtkGAMBITReader of VTK (pip install vtk) reads it", |file| {
        file.has_line(|line| line.trim_start().starts_with("CONTROL INFO"))
    }),
    (
        "a mesh of FrontISTR (HEC-MW)",
        "a .vtu file: FrontISTR writes its results as such by `!WRITE, VISUAL` with `!output_type = VTK`",
        |file| file.has_line_with(&["!NODE", "!HEADER"]),
    ),
    ("an EnSight case of several servers", "one of the .case files that it names", |file| {
        file.has_line(|line| line.contains("master_server"))
    }),
    ("input of LS-DYNA", LS_DYNA, |file| file.has_line(|line| line.to_lowercase().starts_with("*keyword"))),
    ("input of Ansys (.cdb)", ANSYS, |file| file.has_line_with(&["/COM,", "/PREP7", "NBLOCK,"])),
    (
        "results of Ansys",
        "a .vtu file: `pymapdl_reader` (ansys-mapdl-reader) reads it and saves it by save_as_vtk",
        |file| ["rst", "rth", "rfl"].contains(&file.ending.as_str()),
    ),
    ("data of COMSOL as text", "a .vtu file: COMSOL exports VTK (.vtu) by Export › Data", |file| {
        file.begins(&["% Model:", "# Created by COMSOL"])
    }),
    ("a surface (OBJ)", SURFACE, |file| {
        file.has_line_with(&["v "]) && (file.ending == "obj" || file.has_line_with(&["f "]))
    }),
    ("data of ADIOS2 (.bp)", ADIOS2, |file| file.ending == "bp"),
    ("a table as text", TABLE, |file| ["csv", "tsv"].contains(&file.ending.as_str())),
];

/// Bytes of damaged HDF5 that are searched for names, which stand anywhere, for the most part early.
const HDF5_HEAD: u64 = 4 << 20;

/// Refuses a folder of a format whose data are one.
pub(super) fn refuse_folder(path: &Path) -> Result<()> {
    match path.is_dir() && path.join("md.idx").is_file() {
        true => Err(refusal("data of ADIOS2 (.bp)", ADIOS2)),
        false => Ok(()),
    }
}

pub(super) fn refuse(source: &Source, formats: &[UnsupportedFormat]) -> Result<()> {
    let ending = source.path().extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let file = FileStart { bytes: source.head(HEAD)?, len: source.len(), ending };
    match formats.iter().find(|(_, _, is_one)| is_one(&file)) {
        Some((what, remedy, _)) => Err(refusal(what, remedy)),
        None => Ok(()),
    }
}

/// Refuses a file in HDF5 of another format by the names in its root group.
pub(super) fn refuse_hdf5(has_name: impl Fn(&str) -> bool) -> Result<()> {
    match IN_HDF5.iter().find(|(_, _, is_one)| is_one(&has_name)) {
        Some((what, remedy, _)) => Err(refusal(what, remedy)),
        None => Ok(()),
    }
}

/// Refuses such a file whose root group cannot be read, by names anywhere in it, which stand between zeros.
pub(super) fn refuse_damaged_hdf5(source: &Source) -> Result<()> {
    let bytes = source.head(HDF5_HEAD)?;
    refuse_hdf5(|name| holds(&bytes, format!("\0{name}\0").as_bytes()))
}

fn refusal(what: &str, remedy: &str) -> Error {
    Error::run("the format of the file is known, but not read").got(what).expected(remedy)
}

/// True if a word stands anywhere in the bytes.
fn holds(bytes: &[u8], word: &[u8]) -> bool {
    let mut rest = bytes;
    while let Some(place) = rest.iter().position(|byte| word.first() == Some(byte)) {
        if rest[place..].starts_with(word) {
            return true;
        }
        rest = &rest[place + 1..];
    }
    false
}

impl FileStart {
    fn text(&self) -> &[u8] {
        self.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&self.bytes)
    }

    fn has_magic_at(&self, place: usize, magic: &[u8]) -> bool {
        self.bytes.get(place..).is_some_and(|rest| rest.starts_with(magic))
    }

    /// True if the text begins in one of these ways.
    fn begins(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.text().starts_with(word.as_bytes()))
    }

    /// True if the first line that is neither empty nor a comment begins so.
    fn begins_after_comments(&self, word: &str) -> bool {
        let is_read = |line: &&[u8]| !line.is_empty() && !line.starts_with(b"#");
        let mut lines = self.text().split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_start);
        lines.find(is_read).is_some_and(|line| line.starts_with(word.as_bytes()))
    }

    /// True if it is XML with this element.
    fn has_tag(&self, tag: &str) -> bool {
        self.text().trim_ascii_start().starts_with(b"<") && self.holds(&format!("<{tag}"))
    }

    /// True if the word stands anywhere.
    fn holds(&self, word: &str) -> bool {
        holds(&self.bytes, word.as_bytes())
    }

    /// The number of the first set of data of a universal file: a line -1, and one of the number.
    fn universal_set(&self) -> Option<u32> {
        let text = String::from_utf8_lossy(self.text());
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        lines.next().filter(|line| *line == "-1")?;
        lines.next()?.parse().ok()
    }

    /// True if some line of text is one of those; there may be bytes behind it.
    fn has_line(&self, is_one: impl Fn(&str) -> bool) -> bool {
        let head = &self.text()[..self.text().len().min(HEAD as usize)];
        let text = head.split(|&byte| byte == 0).next().unwrap_or_default();
        String::from_utf8_lossy(text).lines().any(is_one)
    }

    fn has_line_with(&self, words: &[&str]) -> bool {
        self.has_line(|line| words.iter().any(|word| line.starts_with(word)))
    }

    /// Text, or 80 bytes of anything, the number of triangles and 50 bytes for each.
    fn is_stl(&self) -> bool {
        let words = self.text().starts_with(b"solid")
            && self.has_line(|line| line.trim_start().starts_with("facet normal"));
        let count = self.bytes.get(80..84).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes);
        words || count.is_some_and(|count| count > 0 && self.len == 84 + 50 * u64::from(count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_in_hdf5_are_told_by_whole_names() {
        let found = |names: &str| {
            let found = refuse_hdf5(|name| names.split(' ').any(|own| own == name));
            found.err().map_or(String::new(), |error| error.to_string())
        };
        assert!(found("settings meshes").contains("Ansys Fluent"));
        assert!(found("results settings").contains("Ansys Fluent"));
        assert!(found("INDEX NASTRAN").contains("Nastran"));
        assert!(found("topologies").contains("Firedrake"));
        for others in ["settings meshesPath", "coordsets fields topologies", "PYNASTRAN2", "", "data"] {
            assert_eq!(found(others), "", "{others}");
        }
    }
}
