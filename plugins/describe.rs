//! What a plug-in declares, read and checked, as declarations of the program's own.

use crate::foreign::{Wrong, several, sized, text, values};
use crate::interface::{self, Check};
use crate::library::{Piece, Work};
use std::ffi::c_char;
use voltet_core::parameters::{Kind, Parameter, ParameterType, Range, Standard};

/// Longest name, word or unit: bytes.
const NAME_MOST: usize = 64;

/// Longest summary, help or version: bytes.
const TEXT_MOST: usize = 1024;

/// Most parameters of a filter, and words of a choice.
pub(crate) const PARAMETERS_MOST: u32 = 64;

/// Most extensions of a reader, and bytes that its files begin with.
const EXTENSIONS_MOST: u32 = 16;
const MAGIC_MOST: u32 = 64;

/// Longest vector.
pub(crate) const VECTOR_MOST: u32 = 1024;

/// Something that a plug-in offers, as it was declared.
#[derive(Clone)]
pub(crate) struct Declared {
    pub kind: Kind,
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
    let (parameters, components) = parameters(common).map_err(of)?;
    match family {
        Family::Reader { .. } | Family::ImageFilter if components.iter().any(|&count| count > 0) => {
            return Err(of(format!(
                "a {} has no use for a parameter that names a point array",
                family.name()
            )));
        }
        _ => {}
    }
    let kind = Kind { name: leak(name.clone()), summary: leak(summary), parameters: parameters.leak() };
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

fn parameters(common: &Common) -> Result<(Vec<Parameter>, Vec<u32>), Wrong> {
    let (mut parameters, mut components) = (Vec::new(), Vec::new());
    let all = several(common.parameters, common.parameter_count as usize);
    for (i, read) in all.map_err(|wrong| format!("parameter {wrong}"))?.iter().enumerate() {
        let name = identifier("the name", read.name).map_err(|wrong| format!("parameter {i}: {wrong}"))?;
        let parameter = parameter(read, &name).map_err(|wrong| format!("parameter '{name}': {wrong}"))?;
        parameters.push(parameter);
        let of_array = read.parameter_type == interface::POINT_ARRAY;
        components.push(if of_array { read.length } else { 0 });
    }
    Ok((parameters, components))
}

fn parameter(read: &interface::Parameter, name: &str) -> Result<Parameter, Wrong> {
    let unit = line("the unit", read.unit, NAME_MOST)?.unwrap_or_default();
    let help = required("the help", line("the help", read.help, TEXT_MOST)?)?;
    let known = interface::REQUIRED | interface::ABOVE_LEAST | interface::BELOW_MOST;
    if read.flags & !known != 0 {
        return Err(format!("'flags' has some that this version does not know: {:#x}", read.flags));
    }
    let required_ = read.flags & interface::REQUIRED != 0;
    let unless_required = |standard| if required_ { Standard::Required } else { standard };
    let (parameter_type, standard) = match read.parameter_type {
        interface::BOOLEAN if read.number == 0.0 || read.number == 1.0 => {
            (ParameterType::Boolean, unless_required(Standard::Boolean(read.number == 1.0)))
        }
        interface::BOOLEAN => return Err(format!("the default is {}, neither 0 nor 1", read.number)),
        interface::INTEGER => {
            let whole = read.number as i64;
            if whole as f64 != read.number && !required_ {
                return Err(format!("the default is {}, no whole number", read.number));
            }
            (ParameterType::Integer(range(read)?), unless_required(Standard::Integer(whole)))
        }
        interface::NUMBER => {
            (ParameterType::Number(range(read)?), unless_required(Standard::Number(read.number)))
        }
        interface::CHOICE => {
            let words = words(read)?;
            let given = line("the default", read.text, NAME_MOST)?;
            let standard = match given {
                _ if required_ => Standard::Required,
                Some(word) => Standard::Text(leak(word)),
                None => return Err("there is no default, and it is not required".into()),
            };
            (ParameterType::Choice(words.leak()), standard)
        }
        interface::TEXT => (ParameterType::Text, unless_required(text_or_unset(read)?)),
        interface::POINT_ARRAY if (1..=9).contains(&read.length) => {
            (ParameterType::Text, unless_required(text_or_unset(read)?))
        }
        interface::POINT_ARRAY => {
            return Err(format!("'length' is {}, and a point array has 1 to 9 components", read.length));
        }
        interface::VECTOR if read.length > VECTOR_MOST => {
            return Err(format!("'length' is {}, at most {VECTOR_MOST}", read.length));
        }
        interface::VECTOR => {
            let length = (read.length > 0).then_some(read.length as usize);
            let standard = match read.numbers.is_null() {
                true => unset(read)?,
                false => {
                    let numbers = values(read.numbers, read.length as usize);
                    Standard::Numbers(numbers.map_err(|wrong| format!("'numbers' {wrong}"))?.leak())
                }
            };
            (ParameterType::Numbers(length, range(read)?), unless_required(standard))
        }
        other => return Err(format!("its type is {other}, which this version does not know")),
    };
    Ok(Parameter { name: leak(name.into()), parameter_type, unit: leak(unit), standard, help: leak(help) })
}

/// A default text, or what leaving it out means.
fn text_or_unset(read: &interface::Parameter) -> Result<Standard, Wrong> {
    match line("the default", read.text, TEXT_MOST)? {
        Some(text) => Ok(Standard::Text(leak(text))),
        None => unset(read),
    }
}

fn unset(read: &interface::Parameter) -> Result<Standard, Wrong> {
    if read.flags & interface::REQUIRED != 0 {
        return Ok(Standard::Required);
    }
    match line("'unset'", read.unset, TEXT_MOST)?.filter(|text| !text.is_empty()) {
        Some(meaning) => Ok(Standard::Unset(leak(meaning))),
        None => Err("there is no default, and 'unset' does not say what that means".into()),
    }
}

/// The range of numbers; both ends 0: none.
fn range(read: &interface::Parameter) -> Result<Range, Wrong> {
    let (min, max) = (read.least, read.most);
    if min == 0.0 && max == 0.0 {
        return Ok(Range::ANY);
    }
    let above_min = read.flags & interface::ABOVE_LEAST != 0;
    let below_max = read.flags & interface::BELOW_MOST != 0;
    if min.is_nan() || max.is_nan() || min > max || (min == max && (above_min || below_max)) {
        return Err(format!("no number is in its range, from {min} to {max}"));
    }
    Ok(Range { min, max, above_min, below_max, infinite: false })
}

/// The words of a choice with their meanings.
fn words(read: &interface::Parameter) -> Result<Vec<(&'static str, &'static str)>, Wrong> {
    if !(1..=PARAMETERS_MOST).contains(&read.word_count) {
        return Err(format!("there are {} words, 1 to {PARAMETERS_MOST} can be", read.word_count));
    }
    let list = |what: &str, address: *const *const c_char| {
        values(address, read.word_count as usize).map_err(|wrong| format!("'{what}' {wrong}"))
    };
    let (words, meanings) = (list("words", read.words)?, list("meanings", read.meanings)?);
    let mut found: Vec<(&str, &str)> = Vec::new();
    for (word, meaning) in words.into_iter().zip(meanings) {
        let word = identifier("a word", word)?;
        if found.iter().any(|(known, _)| *known == word) {
            return Err(format!("there are two words '{word}'"));
        }
        let meaning = required("the meaning of a word", line("the meaning of a word", meaning, TEXT_MOST)?)?;
        found.push((leak(word), leak(meaning)));
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
fn identifier(what: &str, address: *const c_char) -> Result<String, Wrong> {
    let name = required(what, line(what, address, NAME_MOST)?)?;
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    match name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(fits) {
        true => Ok(name),
        false => Err(format!(
            "{what} is '{name}', and may have lower-case letters, digits, '-' and '_' after a letter"
        )),
    }
}

fn leak(text: String) -> &'static str {
    text.leak()
}
