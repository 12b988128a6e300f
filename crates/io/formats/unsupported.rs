//! Formats that are not read, told by their content: what a file is, and what to do with it.

use super::source::Source;
use std::path::Path;
use voltet_core::{Error, Result};

/// A format that is not read.
struct UnsupportedFormat {
    /// Name of the format, with an article.
    what: &'static str,
    /// Remedy, a clause that can follow "expected".
    remedy: &'static str,
    /// True if a file is one.
    matches: fn(&FileStart) -> bool,
}

/// First bytes of a file.
struct FileStart<'a> {
    /// Its first bytes; of containers, with names somewhere within, more of them.
    bytes: &'a [u8],
    /// Its length.
    len: u64,
    /// The ending of its name, in small letters.
    ending: String,
}

const PARAVIEW: &str = "a .vtu file: open it in ParaView and save its data as .vtu";
const MESHIO: &str = "a .vtu file: `meshio convert FILE out.vtu` (pip install meshio) makes one of its mesh";
const SURFACE: &str =
    "cells with a volume: a surface has to be filled with them by a mesher (Gmsh, TetGen) first";
const IMAGE: &str = "a .vti file (VTK image data): ParaView reads it and saves its data as .vti";
const ARCHIVE: &str = "the file within: unpack it first";

/// Formats that their first bytes tell for sure. Of containers those that are told by what is inside stand first.
const BY_MAGIC: &[UnsupportedFormat] = &[
    UnsupportedFormat {
        what: "a VTKHDF file (VTK's data in HDF5)",
        remedy: PARAVIEW,
        matches: |seen| seen.is_hdf5() && seen.holds("VTKHDF"),
    },
    UnsupportedFormat {
        what: "a CGNS file",
        remedy: PARAVIEW,
        matches: |seen| seen.is_hdf5() && (seen.holds("CGNSLibraryVersion") || seen.holds("CGNSBase_t")),
    },
    UnsupportedFormat {
        what: "an Exodus II file",
        remedy: PARAVIEW,
        matches: |seen| {
            (seen.is_hdf5() || seen.is_netcdf()) && (seen.holds("num_el_blk") || seen.holds("eb_prop1"))
        },
    },
    UnsupportedFormat {
        what: "a MED file (Salome)",
        remedy: "a .vtu file: Salome's ParaVis reads it and saves its data as .vtu, and so does `meshio convert`",
        matches: |seen| seen.is_hdf5() && (seen.holds("ENS_MAA") || seen.holds("INFOS_GENERALES")),
    },
    UnsupportedFormat {
        what: "an HDF5 file",
        remedy: "a .vtu file: the program that wrote this one, or ParaView with the .xdmf file beside it, can save one",
        matches: |seen| seen.is_hdf5(),
    },
    UnsupportedFormat {
        what: "a netCDF file",
        remedy: "a .vtu or .vts file: ParaView reads it and saves its data so",
        matches: |seen| seen.is_netcdf(),
    },
    UnsupportedFormat {
        what: "a mesh of Gmsh",
        remedy: MESHIO,
        matches: |seen| seen.starts_with("$MeshFormat"),
    },
    UnsupportedFormat {
        what: "data of Abaqus (.odb)",
        remedy: "a .vtu file: Abaqus/CAE exports field output as text, or as .inp with `meshio convert` after it",
        matches: |seen| seen.starts_with("HKSRD0"),
    },
    UnsupportedFormat {
        what: "a file of OpenFOAM",
        remedy: OPENFOAM,
        matches: |seen| seen.has_line(|line| line.trim() == "FoamFile"),
    },
    UnsupportedFormat {
        what: "a mesh or case of Ansys Fluent",
        remedy: PARAVIEW,
        matches: |seen| seen.starts_with("(0 ") || seen.starts_with("(1 ") || seen.starts_with("(2 "),
    },
    UnsupportedFormat {
        what: "an EnSight case",
        remedy: PARAVIEW,
        matches: |seen| {
            seen.has_line(|line| line.trim().eq_ignore_ascii_case("format"))
                && seen.has_line(|line| line.to_lowercase().replace(' ', "").starts_with("type:ensight"))
        },
    },
    UnsupportedFormat {
        what: "a geometry file of EnSight",
        remedy: "a .vtu file: open the .case file beside it in ParaView and save its data as .vtu",
        matches: |seen| seen.starts_with("C Binary") || seen.starts_with("Fortran Binary"),
    },
    UnsupportedFormat { what: "a Tecplot file", remedy: PARAVIEW, matches: |seen| seen.starts_with("#!TDV") },
    UnsupportedFormat { what: "an XDMF file", remedy: PARAVIEW, matches: |seen| seen.has_tag("Xdmf") },
    UnsupportedFormat {
        what: "a mesh of FEniCS (XML)",
        remedy: MESHIO,
        matches: |seen| seen.has_tag("dolfin"),
    },
    UnsupportedFormat {
        what: "a surface (PLY)",
        remedy: SURFACE,
        matches: |seen| seen.starts_with("ply\n") || seen.starts_with("ply\r"),
    },
    UnsupportedFormat { what: "a surface (STL)", remedy: SURFACE, matches: |seen| seen.is_stl() },
    UnsupportedFormat {
        what: "a surface (OFF)",
        remedy: SURFACE,
        matches: |seen| seen.starts_with("OFF\n") || seen.starts_with("OFF\r"),
    },
    UnsupportedFormat { what: "a surface (glTF)", remedy: SURFACE, matches: |seen| seen.starts_with("glTF") },
    UnsupportedFormat { what: "an image (PNG)", remedy: IMAGE, matches: |seen| seen.starts(b"\x89PNG") },
    UnsupportedFormat {
        what: "an image (JPEG)",
        remedy: IMAGE,
        matches: |seen| seen.starts(b"\xff\xd8\xff"),
    },
    UnsupportedFormat {
        what: "an image (TIFF)",
        remedy: IMAGE,
        matches: |seen| seen.starts(b"II*\0") || seen.starts(b"MM\0*"),
    },
    UnsupportedFormat { what: "an image (NRRD)", remedy: IMAGE, matches: |seen| seen.starts_with("NRRD000") },
    UnsupportedFormat {
        what: "an image (DICOM)",
        remedy: IMAGE,
        matches: |seen| seen.has_magic_at(128, b"DICM"),
    },
    UnsupportedFormat {
        what: "an image (NIfTI)",
        remedy: IMAGE,
        matches: |seen| seen.has_magic_at(344, b"n+1\0") || seen.has_magic_at(344, b"ni1\0"),
    },
    UnsupportedFormat {
        what: "an image (MetaImage)",
        remedy: IMAGE,
        matches: |seen| seen.has_line(|line| line.starts_with("ObjectType = Image")),
    },
    UnsupportedFormat {
        what: "an OpenVDB file",
        remedy: IMAGE,
        matches: |seen| seen.starts(b" BDV\0\0\0\0"),
    },
    UnsupportedFormat {
        what: "a gzip archive",
        remedy: ARCHIVE,
        matches: |seen| seen.starts(b"\x1f\x8b\x08"),
    },
    UnsupportedFormat { what: "a zip archive", remedy: ARCHIVE, matches: |seen| seen.starts(b"PK\x03\x04") },
    UnsupportedFormat { what: "an xz archive", remedy: ARCHIVE, matches: |seen| seen.starts(b"\xfd7zXZ\0") },
    UnsupportedFormat { what: "a bzip2 archive", remedy: ARCHIVE, matches: |seen| seen.starts_with("BZh") },
    UnsupportedFormat {
        what: "a zstd archive",
        remedy: ARCHIVE,
        matches: |seen| seen.starts(b"\x28\xb5\x2f\xfd"),
    },
];

/// Formats of plain text that only words tell; asked where nothing else is meant.
const BY_WORDS: &[UnsupportedFormat] = &[
    UnsupportedFormat {
        what: "input of LS-DYNA",
        remedy: "a .vtu file: LS-PrePost saves the results (d3plot), and ParaView reads these",
        matches: |seen| seen.has_line(|line| line.to_lowercase().starts_with("*keyword")),
    },
    UnsupportedFormat {
        what: "input of Abaqus (.inp)",
        remedy: MESHIO,
        matches: |seen| {
            let words = ["*heading", "*node", "*part", "*element", "*preprint"];
            seen.has_line(|line| words.iter().any(|word| line.to_lowercase().starts_with(word)))
        },
    },
    UnsupportedFormat {
        what: "input of Ansys (.cdb)",
        remedy: "a .vtu file: `pymapdl_reader` (ansys-mapdl-reader) reads it and saves its grid",
        matches: |seen| {
            seen.has_line(|line| ["/COM,", "/PREP7", "NBLOCK,"].iter().any(|word| line.starts_with(word)))
        },
    },
    UnsupportedFormat {
        what: "results of Ansys",
        remedy: "a .vtu file: `pymapdl_reader` (ansys-mapdl-reader) reads it and saves it by save_as_vtk",
        matches: |seen| ["rst", "rth", "rfl"].contains(&seen.ending.as_str()),
    },
    UnsupportedFormat {
        what: "input of Nastran",
        remedy: MESHIO,
        matches: |seen| {
            seen.has_line(|line| {
                line.starts_with("BEGIN BULK") || line.starts_with("GRID  ") || line.starts_with("GRID,")
            })
        },
    },
    UnsupportedFormat {
        what: "a Tecplot file",
        remedy: PARAVIEW,
        matches: |seen| seen.has_line(|line| line.to_uppercase().replace(' ', "").starts_with("VARIABLES=")),
    },
    UnsupportedFormat {
        what: "data of COMSOL as text",
        remedy: "a .vtu file: COMSOL exports VTK (.vtu) by Export › Data",
        matches: |seen| seen.starts_with("% Model:") || seen.starts_with("# Created by COMSOL"),
    },
    UnsupportedFormat {
        what: "a surface (OBJ)",
        remedy: SURFACE,
        matches: |seen| {
            seen.has_line(|line| line.starts_with("v "))
                && (seen.ending == "obj" || seen.has_line(|line| line.starts_with("f ")))
        },
    },
    UnsupportedFormat {
        what: "a table as text",
        remedy: "a grid with cells: points alone have no volume; ParaView's Delaunay3D joins them to tetrahedra",
        matches: |seen| ["csv", "tsv"].contains(&seen.ending.as_str()),
    },
];

const OPENFOAM: &str =
    "a .vtu file: `foamToVTK` in the case's folder writes one for each time, VTK/…/internal.vtu";

/// Refuses folders, and files that stand for a folder, with what they are.
pub(super) fn refuse_folder(path: &Path) -> Result<()> {
    let is_stub = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("foam"));
    let folder = if is_stub { path.parent().unwrap_or(path) } else { path };
    let is_case = |folder: &Path| {
        ["system/controlDict", "constant/polyMesh"].iter().any(|name| folder.join(name).exists())
    };
    if is_stub || path.is_dir() && is_case(folder) {
        return Err(refusal("a case of OpenFOAM", OPENFOAM).in_file(path));
    }
    Ok(())
}

/// Refuses what its first bytes tell to be of a format that is not read.
pub(super) fn refuse_by_magic(source: &Source) -> Result<()> {
    refuse(source, BY_MAGIC)
}

/// Refuses what words in it tell to be of a format that is not read.
pub(super) fn refuse_by_words(source: &Source) -> Result<()> {
    refuse(source, BY_WORDS)
}

/// Bytes searched of a text; names in HDF5 and netCDF stand anywhere, for the most part early.
const HEAD: u64 = 4096;
const CONTAINER_HEAD: u64 = 4 << 20;

fn refuse(source: &Source, formats: &[UnsupportedFormat]) -> Result<()> {
    let ending = source.path().extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let mut bytes = source.head(HEAD)?;
    let is_container = |seen: &FileStart| seen.is_hdf5() || seen.is_netcdf();
    if is_container(&FileStart { bytes: &bytes, len: source.len(), ending: String::new() }) {
        bytes = source.head(CONTAINER_HEAD)?;
    }
    let seen = FileStart { bytes: &bytes, len: source.len(), ending };
    match formats.iter().find(|format| (format.matches)(&seen)) {
        Some(format) => Err(refusal(format.what, format.remedy)),
        None => Ok(()),
    }
}

fn refusal(what: &str, remedy: &str) -> Error {
    Error::run("the format of the file is known, but not read").got(what).expected(remedy)
}

impl FileStart<'_> {
    fn starts(&self, magic: &[u8]) -> bool {
        self.bytes.starts_with(magic)
    }

    /// True if the text begins so, after a byte order mark.
    fn starts_with(&self, word: &str) -> bool {
        self.text().starts_with(word.as_bytes())
    }

    fn text(&self) -> &[u8] {
        self.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(self.bytes)
    }

    fn has_magic_at(&self, place: usize, magic: &[u8]) -> bool {
        self.bytes.get(place..).is_some_and(|rest| rest.starts_with(magic))
    }

    /// True if the word stands anywhere.
    fn holds(&self, word: &str) -> bool {
        self.bytes.windows(word.len()).any(|window| window == word.as_bytes())
    }

    /// True if some line of text is one of those; bytes that are no text have none.
    fn has_line(&self, is_one: impl Fn(&str) -> bool) -> bool {
        let head = &self.text()[..self.text().len().min(HEAD as usize)];
        !head.contains(&0) && String::from_utf8_lossy(head).lines().any(is_one)
    }

    /// True if it is XML with this element at its root.
    fn has_tag(&self, tag: &str) -> bool {
        self.text().trim_ascii_start().starts_with(b"<") && self.holds(&format!("<{tag}"))
    }

    fn is_hdf5(&self) -> bool {
        // A block for the user's own may stand before it.
        [0, 512, 1024, 2048].iter().any(|&place| self.has_magic_at(place, b"\x89HDF\r\n\x1a\n"))
    }

    fn is_netcdf(&self) -> bool {
        [b"CDF\x01", b"CDF\x02", b"CDF\x05"].iter().any(|magic| self.starts(*magic))
    }

    /// Text, or 80 bytes of anything, the number of triangles and 50 bytes for each.
    fn is_stl(&self) -> bool {
        let words =
            self.starts_with("solid") && self.has_line(|line| line.trim_start().starts_with("facet normal"));
        let count = self.bytes.get(80..84).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes);
        words || count.is_some_and(|count| count > 0 && self.len == 84 + 50 * u64::from(count))
    }
}
