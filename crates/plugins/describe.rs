//! What a plug-in declares, read and checked, as declarations of the program's own.

use crate::foreign::{Wrong, sized, text, values};
use crate::interface::{self, Check};
use crate::library::{Piece, Work};
use crate::parameters::parameters;
use std::ffi::c_char;
use voltet_core::parameters::VariantSchema;

/// Longest name, word or unit: bytes.
pub(crate) const NAME_MOST: usize = 64;

/// Longest summary, help or version: bytes.
pub(crate) const TEXT_MOST: usize = 1024;

/// Most parameters of a filter, and words of a choice.
pub(crate) const PARAMETERS_MOST: u32 = 64;

/// Most extensions of a reader, and bytes that its files begin with.
const EXTENSIONS_MOST: u32 = 16;
const MAGIC_MOST: u32 = 64;

/// Something that a plug-in offers, as it was declared.
#[derive(Clone)]
pub(crate) struct Declared {
    pub kind: VariantSchema,
    pub family: Family,
    /// Whether it has a function that checks parameters.
    pub checks: bool,
    /// For each parameter that names a point array how many components a point has; 0 for the others.
    pub components: Vec<u32>,
}

/// What it is, and what belongs to that alone.
#[derive(Clone, Copy)]
pub(crate) enum Family {
    /// `needs`: what is computed for it.
    GradientFilter { needs: u32 },
    /// How its files are known.
    Reader { extensions: &'static [&'static str], magic: &'static [u8] },
    /// The arrays that it makes.
    GridFilter { made: &'static [&'static str] },
    /// Pictures to pictures.
    ImageFilter,
}

impl Family {
    /// As messages call it.
    pub fn name(self) -> &'static str {
        match self {
            Family::GradientFilter { .. } => "gradient filter",
            Family::Reader { .. } => "reader",
            Family::GridFilter { .. } => "grid filter",
            Family::ImageFilter => "image filter",
        }
    }
}

/// The name and version of a plug-in.
pub(crate) fn plugin(address: *const interface::Plugin) -> Result<[String; 2], Wrong> {
    let (read, _) = sized(address)?;
    let name = line("the name of the plug-in", read.name, NAME_MOST)?;
    let version = line("the version of the plug-in", read.version, NAME_MOST)?;
    Ok([required("the name of the plug-in", name)?, required("the version of the plug-in", version)?])
}

/// What begins the description of everything that a plug-in offers.
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
pub(crate) fn gradient_filter(address: *const interface::GradientFilter) -> Result<Piece, Wrong> {
    let (read, _) = sized(address)?;
    piece("filter", &common!(read), || {
        let known = interface::NEEDS_NEIGHBOURS | interface::NEEDS_CELLS_OF_POINTS;
        if read.needs & !known != 0 {
            return Err(format!("'needs' has flags that this version does not know: {:#x}", read.needs));
        }
        let gradient = there("gradient", read.gradient)?;
        Ok((Family::GradientFilter { needs: read.needs }, Work::Gradient(gradient)))
    })
}

/// The reader at an address.
pub(crate) fn reader(address: *const interface::Reader) -> Result<Piece, Wrong> {
    let (read, _) = sized(address)?;
    piece("reader", &common!(read), || {
        let (inspect, read_) = (there("inspect", read.inspect)?, there("read", read.read)?);
        let extensions = names("an extension", read.extensions, read.extension_count, EXTENSIONS_MOST)?;
        let wrong = |name: &&&str| !name.chars().all(|c| c.is_ascii_graphic() && !c.is_ascii_uppercase());
        if let Some(name) = extensions.iter().find(wrong) {
            return Err(format!("the extension '{name}' is not in lower-case letters without spaces"));
        }
        let magic = match read.magic_length {
            0 => Vec::new(),
            length @ 1..=MAGIC_MOST => {
                values(read.magic, length as usize).map_err(|wrong| format!("'magic' {wrong}"))?
            }
            length => return Err(format!("'magic_length' is {length}, at most {MAGIC_MOST}")),
        };
        let family = Family::Reader { extensions: extensions.leak(), magic: magic.leak() };
        Ok((family, Work::Reader { inspect, read: read_ }))
    })
}

/// The grid filter at an address.
pub(crate) fn grid_filter(address: *const interface::GridFilter) -> Result<Piece, Wrong> {
    let (read, _) = sized(address)?;
    piece("grid filter", &common!(read), || {
        let filter = there("filter", read.filter)?;
        let made = names("an array that it makes", read.made, read.made_count, PARAMETERS_MOST)?;
        Ok((Family::GridFilter { made: made.leak() }, Work::GridFilter(filter)))
    })
}

/// The image filter at an address.
pub(crate) fn image_filter(address: *const interface::ImageFilter) -> Result<Piece, Wrong> {
    let (read, _) = sized(address)?;
    piece("image filter", &common!(read), || {
        Ok((Family::ImageFilter, Work::ImageFilter(there("filter", read.filter)?)))
    })
}

/// What all have, and what `own` says of it beside.
fn piece(
    what: &str,
    common: &Common,
    own: impl FnOnce() -> Result<(Family, Work), Wrong>,
) -> Result<Piece, Wrong> {
    let name = identifier(&format!("the name of the {what}"), common.name)?;
    let of = |wrong: Wrong| format!("of the {what} '{name}', {wrong}");
    let summary = line("the summary", common.summary, TEXT_MOST).map_err(of)?;
    let summary = required("the summary", summary).map_err(of)?;
    let (family, work) = own().map_err(of)?;
    if common.parameter_count > PARAMETERS_MOST {
        return Err(of(format!(
            "there are {} parameters, at most {PARAMETERS_MOST} can be",
            common.parameter_count
        )));
    }
    let declared = parameters(common.parameters, common.parameter_count as usize);
    let (parameters, components) = declared.map_err(of)?;
    match family {
        Family::Reader { .. } | Family::ImageFilter if components.iter().any(|&count| count > 0) => {
            return Err(of(format!(
                "a {} has no use for a parameter that names a point array",
                family.name()
            )));
        }
        _ => {}
    }
    let kind =
        VariantSchema { name: leak(name.clone()), summary: leak(summary), parameters: parameters.leak() };
    let declared = Declared { kind, family, checks: common.check.is_some(), components };
    Ok(Piece { declared, check: common.check, work })
}

/// A function that must be there.
fn there<T>(name: &str, function: Option<T>) -> Result<T, Wrong> {
    function.ok_or_else(|| format!("the function '{name}' is a null pointer"))
}

/// A list of texts, none twice.
fn names(
    what: &str,
    address: *const *const c_char,
    count: u32,
    most: u32,
) -> Result<Vec<&'static str>, Wrong> {
    if count > most {
        return Err(format!("{what}: there are {count}, at most {most} can be"));
    }
    if count == 0 {
        return Ok(Vec::new());
    }
    let texts = values(address, count as usize).map_err(|wrong| format!("{what}: the list {wrong}"))?;
    let mut found: Vec<&str> = Vec::new();
    for text in texts {
        let name = required(what, line(what, text, NAME_MOST)?)?;
        if found.contains(&name.as_str()) {
            return Err(format!("{what}: '{name}' is there twice"));
        }
        found.push(leak(name));
    }
    Ok(found)
}

/// A text of one line; `None` for a null pointer.
pub(crate) fn line(what: &str, address: *const c_char, most: usize) -> Result<Option<String>, Wrong> {
    let text = text(address, most).map_err(|wrong| format!("{what} {wrong}"))?;
    match text {
        Some(text) if text.chars().any(char::is_control) => {
            Err(format!("{what} has control characters: {text:?}"))
        }
        text => Ok(text),
    }
}

pub(crate) fn required(what: &str, text: Option<String>) -> Result<String, Wrong> {
    match text {
        None => Err(format!("{what} is a null pointer")),
        Some(text) if text.trim().is_empty() => Err(format!("{what} is empty")),
        Some(text) => Ok(text),
    }
}

/// A name that a pipeline file can have as it is.
pub(crate) fn identifier(what: &str, address: *const c_char) -> Result<String, Wrong> {
    let name = required(what, line(what, address, NAME_MOST)?)?;
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    match name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(fits) {
        true => Ok(name),
        false => Err(format!(
            "{what} is '{name}', and may have lower-case letters, digits, '-' and '_' after a letter"
        )),
    }
}

pub(crate) fn leak(text: String) -> &'static str {
    text.leak()
}
