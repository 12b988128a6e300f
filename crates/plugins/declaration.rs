//! Declarations of a plug-in's items, read from the header's structs and checked.

use crate::ffi::{ValidationError, sized, values};
use crate::interface::{self, Check, FilterGrid, FilterImage, Gradient, Read};
use crate::parameters::parameters;
use crate::text::{MAX_NAME_BYTES, MAX_PARAMETERS, MAX_TEXT_BYTES, identifier, leak, line, required};
use std::ffi::c_char;
use voltet_core::parameters::VariantSchema;

/// Largest number of extensions of a reader, and of bytes that its files begin with.
const MAX_EXTENSIONS: u32 = 16;
const MAX_MAGIC_BYTES: u32 = 64;

/// Declaration of one item of a plug-in.
#[derive(Clone)]
pub(crate) struct Declaration {
    pub schema: VariantSchema,
    pub family: Family,
    /// True if it has a function that checks parameters.
    pub checks: bool,
    /// Components of the point array that each parameter names; 0 for parameters that name none.
    pub components: Vec<u32>,
}

/// Kinds of items, with what each alone declares.
#[derive(Clone, Copy)]
pub(crate) enum Family {
    /// Scalar and grid to gradient; `needs`: flags of the tables to compute for it.
    GradientFilter { needs: u32 },
    /// File to grid; extensions and first bytes of its files.
    Reader { extensions: &'static [&'static str], magic: &'static [u8] },
    /// Grid to grid; names of the arrays that it makes.
    GridFilter { made: &'static [&'static str] },
    /// Picture to picture.
    ImageFilter,
}

impl Family {
    /// Name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Family::GradientFilter { .. } => "gradient filter",
            Family::Reader { .. } => "reader",
            Family::GridFilter { .. } => "grid filter",
            Family::ImageFilter => "image filter",
        }
    }
}

/// One item of a loaded library: its declaration and its functions.
#[derive(Clone)]
pub(crate) struct LibraryItem {
    pub declaration: Declaration,
    pub check: Option<Check>,
    pub function: EntryPoint,
}

/// Function of a library that does an item's work.
#[derive(Clone, Copy)]
pub(crate) enum EntryPoint {
    /// Function of a gradient filter.
    Gradient(Gradient),
    /// Functions of a reader.
    Reader { inspect: Read, read: Read },
    /// Function of a grid filter.
    GridFilter(FilterGrid),
    /// Function of an image filter.
    ImageFilter(FilterImage),
}

/// Name and version of the plug-in at an address.
pub(crate) fn plugin(address: *const interface::Plugin) -> Result<[String; 2], ValidationError> {
    let (read, _) = sized(address)?;
    let name = line("the name of the plug-in", read.name, MAX_NAME_BYTES)?;
    let version = line("the version of the plug-in", read.version, MAX_NAME_BYTES)?;
    Ok([required("the name of the plug-in", name)?, required("the version of the plug-in", version)?])
}

/// Fields that the structs of all families share.
struct Common {
    name: *const c_char,
    summary: *const c_char,
    parameter_count: u32,
    parameters: *const interface::Parameter,
    check: Option<Check>,
}

macro_rules! common {
    ($read:expr) => {{
        let read = &$read;
        Common {
            name: read.name,
            summary: read.summary,
            parameter_count: read.parameter_count,
            parameters: read.parameters,
            check: read.check,
        }
    }};
}

/// The gradient filter at an address; its texts and lists live from now on as long as the program.
pub(crate) fn gradient_filter(
    address: *const interface::GradientFilter,
) -> Result<LibraryItem, ValidationError> {
    let (read, _) = sized(address)?;
    item("filter", &common!(read), || {
        let known = interface::NEEDS_NEIGHBOURS | interface::NEEDS_CELLS_OF_POINTS;
        if read.needs & !known != 0 {
            return Err(format!("'needs' has flags that this version does not know: {:#x}", read.needs));
        }
        let gradient = present("gradient", read.gradient)?;
        Ok((Family::GradientFilter { needs: read.needs }, EntryPoint::Gradient(gradient)))
    })
}

/// The reader at an address.
pub(crate) fn reader(address: *const interface::Reader) -> Result<LibraryItem, ValidationError> {
    let (read, _) = sized(address)?;
    item("reader", &common!(read), || {
        let (inspect, read_) = (present("inspect", read.inspect)?, present("read", read.read)?);
        let extensions = names("an extension", read.extensions, read.extension_count, MAX_EXTENSIONS)?;
        let wrong = |name: &&&str| !name.chars().all(|c| c.is_ascii_graphic() && !c.is_ascii_uppercase());
        if let Some(name) = extensions.iter().find(wrong) {
            return Err(format!("the extension '{name}' is not in lower-case letters without spaces"));
        }
        let magic = match read.magic_length {
            0 => Vec::new(),
            length @ 1..=MAX_MAGIC_BYTES => {
                values(read.magic, length as usize).map_err(|wrong| format!("'magic' {wrong}"))?
            }
            length => return Err(format!("'magic_length' is {length}, at most {MAX_MAGIC_BYTES}")),
        };
        let family = Family::Reader { extensions: extensions.leak(), magic: magic.leak() };
        Ok((family, EntryPoint::Reader { inspect, read: read_ }))
    })
}

/// The grid filter at an address.
pub(crate) fn grid_filter(address: *const interface::GridFilter) -> Result<LibraryItem, ValidationError> {
    let (read, _) = sized(address)?;
    item("grid filter", &common!(read), || {
        let filter = present("filter", read.filter)?;
        let made = names("an array that it makes", read.made, read.made_count, MAX_PARAMETERS)?;
        Ok((Family::GridFilter { made: made.leak() }, EntryPoint::GridFilter(filter)))
    })
}

/// The image filter at an address.
pub(crate) fn image_filter(address: *const interface::ImageFilter) -> Result<LibraryItem, ValidationError> {
    let (read, _) = sized(address)?;
    item("image filter", &common!(read), || {
        Ok((Family::ImageFilter, EntryPoint::ImageFilter(present("filter", read.filter)?)))
    })
}

/// An item from the shared fields, and from `read_family`, which reads the others.
fn item(
    what: &str,
    common: &Common,
    read_family: impl FnOnce() -> Result<(Family, EntryPoint), ValidationError>,
) -> Result<LibraryItem, ValidationError> {
    let name = identifier(&format!("the name of the {what}"), common.name)?;
    let located = |wrong: ValidationError| format!("of the {what} '{name}', {wrong}");
    let summary = line("the summary", common.summary, MAX_TEXT_BYTES).map_err(located)?;
    let summary = required("the summary", summary).map_err(located)?;
    let (family, function) = read_family().map_err(located)?;
    if common.parameter_count > MAX_PARAMETERS {
        return Err(located(format!(
            "there are {} parameters, at most {MAX_PARAMETERS} can be",
            common.parameter_count
        )));
    }
    let read = parameters(common.parameters, common.parameter_count as usize);
    let (parameters, components) = read.map_err(located)?;
    match family {
        Family::Reader { .. } | Family::ImageFilter if components.iter().any(|&count| count > 0) => {
            return Err(located(format!(
                "a {} has no use for a parameter that names a point array",
                family.name()
            )));
        }
        _ => {}
    }
    let schema =
        VariantSchema { name: leak(name.clone()), summary: leak(summary), parameters: parameters.leak() };
    let declaration = Declaration { schema, family, checks: common.check.is_some(), components };
    Ok(LibraryItem { declaration, check: common.check, function })
}

/// A function pointer that must not be null.
fn present<T>(name: &str, function: Option<T>) -> Result<T, ValidationError> {
    function.ok_or_else(|| format!("the function '{name}' is a null pointer"))
}

/// A list of texts without duplicates.
fn names(
    what: &str,
    address: *const *const c_char,
    count: u32,
    max: u32,
) -> Result<Vec<&'static str>, ValidationError> {
    if count > max {
        return Err(format!("{what}: there are {count}, at most {max} can be"));
    }
    if count == 0 {
        return Ok(Vec::new());
    }
    let texts = values(address, count as usize).map_err(|wrong| format!("{what}: the list {wrong}"))?;
    let mut found: Vec<&str> = Vec::new();
    for text in texts {
        let name = required(what, line(what, text, MAX_NAME_BYTES)?)?;
        if found.contains(&name.as_str()) {
            return Err(format!("{what}: '{name}' is there twice"));
        }
        found.push(leak(name));
    }
    Ok(found)
}
