//! Surface files: STL, PLY, OBJ, VTK's PolyData, and points of CSV files.
//!
//! | format | module |
//! | --- | --- |
//! | .stl (ASCII and binary) | [`stl`] |
//! | .ply (ASCII and binary) | [`ply`] |
//! | .obj | [`obj`] |
//! | .vtp | `super::xml::poly_data` |
//! | .csv | [`csv`] |
//!
//! STL and OBJ are read here and not through crates: stl_io 0.11 drops all solids but the first in silence, and takes binary files whose
//! header begins with "solid" for text; tobj 4.0 panics on some numbers of normals.

mod csv;
mod obj;
mod ply;
mod stl;

use super::contents::Meter;
use super::elements::{SurfaceColors, SurfaceFile};
use super::source::{Source, printable, text_of};
use super::xml::poly_data;
use std::path::Path;
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::{Error, Result, counted};

/// File types of surfaces, for help.
pub const SURFACE_FILES: &str =
    "STL (.stl), PLY (.ply), OBJ (.obj), VTK PolyData (.vtp), or points of a table (.csv)";

/// Reads the polygons of a surface file as triangles or, if `edges`, as lines; its lines and vertices; and what gives their colours.
///
/// # Errors
/// One error that names the file, the line or element, what was found and what would be right.
pub fn read_surface(
    path: &Path,
    colors: SurfaceColors<'_>,
    edges: bool,
    progress: &dyn Progress,
) -> Result<SurfaceFile> {
    let source = Source::open(path)?;
    let read = || {
        let head = source.head(256)?;
        let text = text_of(&head);
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        // Text becomes no more than a few numbers of 64 bits each two bytes.
        let what = || format!("a surface file of {}", counted(source.len(), "byte"));
        refuse_beyond_memory(progress, what, source.len().saturating_mul(8))?;
        progress.check_cancelled()?;
        let bytes = || source.read(0, source.len());
        let elements = if text.starts_with(b"<") {
            poly_data::read(&source, colors, &Meter::new(progress, source.len()))?
        } else if text.starts_with(b"ply") {
            ply::read(&bytes()?, colors)?.or_vertices()?
        } else if ending == "stl" || text.to_ascii_lowercase().starts_with(b"solid") {
            refuse_array(colors, "an STL file")?;
            stl::read(&bytes()?)?
        } else if ending == "obj" {
            refuse_array(colors, "an OBJ file")?;
            obj::read(&bytes()?)?.or_vertices()?
        } else if ending == "csv" {
            csv::read(&bytes()?, colors.array())?.or_vertices()?
        } else {
            let error = Error::run("the format of the surface file is not known");
            return Err(error.got(printable(&head)).expected(SURFACE_FILES));
        };
        elements.into_surface(edges)
    };
    read().map_err(|error| error.in_file(path))
}

fn refuse_array(colors: SurfaceColors<'_>, file: &str) -> Result<()> {
    let Some(name) = colors.array() else { return Ok(()) };
    let error = Error::run(format!("{file} holds no arrays")).got(format!("'{name}'"));
    Err(error.expected("a PLY, .vtp or CSV file, or one colour"))
}
