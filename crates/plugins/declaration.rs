//! Declarations of a plug-in's items and their parameters, read from the header's structs and checked.

use crate::ffi::{CheckResult, ValidationError, several, sized, text, values};
use crate::interface::{self, Check, FilterGrid, FilterImage, Gradient, Read};
use std::ffi::c_char;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range, VariantSchema};

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
pub(crate) fn plugin(address: *const interface::Plugin) -> CheckResult<[String; 2]> {
    let (read, _) = sized(address)?;
    let name = line("the name of the plug-in", read.name, MAX_NAME_BYTES)?;
    let version = line("the version of the plug-in", read.version, MAX_NAME_BYTES)?;
    Ok([required("the name of the plug-in", name)?, required("the version of the plug-in", version)?])
}

/// The gradient filter at an address; its texts and lists live from now on as long as the program.
pub(crate) fn gradient_filter(address: *const interface::GradientFilter) -> CheckResult<LibraryItem> {
    let (read, _) = sized(address)?;
    item("filter", read.name, read.summary, (read.parameters, read.parameter_count), read.check, || {
        let known = interface::NEEDS_NEIGHBOURS | interface::NEEDS_CELLS_OF_POINTS;
        if read.needs & !known != 0 {
            return Err(format!("'needs' has flags that this version does not know: {:#x}", read.needs));
        }
        let gradient = present("gradient", read.gradient)?;
        Ok((Family::GradientFilter { needs: read.needs }, EntryPoint::Gradient(gradient)))
    })
}

/// The reader at an address.
pub(crate) fn reader(address: *const interface::Reader) -> CheckResult<LibraryItem> {
    let (read, _) = sized(address)?;
    item("reader", read.name, read.summary, (read.parameters, read.parameter_count), read.check, || {
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
pub(crate) fn grid_filter(address: *const interface::GridFilter) -> CheckResult<LibraryItem> {
    let (read, _) = sized(address)?;
    item("grid filter", read.name, read.summary, (read.parameters, read.parameter_count), read.check, || {
        let filter = present("filter", read.filter)?;
        let made = names("an array that it makes", read.made, read.made_count, MAX_PARAMETERS)?;
        Ok((Family::GridFilter { made: made.leak() }, EntryPoint::GridFilter(filter)))
    })
}

/// The image filter at an address.
pub(crate) fn image_filter(address: *const interface::ImageFilter) -> CheckResult<LibraryItem> {
    let (read, _) = sized(address)?;
    item("image filter", read.name, read.summary, (read.parameters, read.parameter_count), read.check, || {
        Ok((Family::ImageFilter, EntryPoint::ImageFilter(present("filter", read.filter)?)))
    })
}

/// An item from the fields that the structs of all families share, and from `read_family`, which reads the others.
fn item(
    what: &str,
    name: *const c_char,
    summary: *const c_char,
    (parameters, parameter_count): (*const interface::Parameter, u32),
    check: Option<Check>,
    read_family: impl FnOnce() -> CheckResult<(Family, EntryPoint)>,
) -> CheckResult<LibraryItem> {
    let name = identifier(&format!("the name of the {what}"), name)?;
    let located = |wrong: ValidationError| format!("of the {what} '{name}', {wrong}");
    let summary = line("the summary", summary, MAX_TEXT_BYTES).map_err(located)?;
    let summary = required("the summary", summary).map_err(located)?;
    let (family, function) = read_family().map_err(located)?;
    if parameter_count > MAX_PARAMETERS {
        return Err(located(format!(
            "there are {} parameters, at most {MAX_PARAMETERS} can be",
            parameter_count
        )));
    }
    let read = self::parameters(parameters, parameter_count as usize);
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
        VariantSchema { name: name.clone().leak(), summary: summary.leak(), parameters: parameters.leak() };
    let declaration = Declaration { schema, family, checks: check.is_some(), components };
    Ok(LibraryItem { declaration, check, function })
}

/// A function pointer that must not be null.
fn present<T>(name: &str, function: Option<T>) -> CheckResult<T> {
    function.ok_or_else(|| format!("the function '{name}' is a null pointer"))
}

/// A list of texts without duplicates.
fn names(what: &str, address: *const *const c_char, count: u32, max: u32) -> CheckResult<Vec<&'static str>> {
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
        found.push(name.leak());
    }
    Ok(found)
}

/// Longest vector.
pub(crate) const MAX_VECTOR_LENGTH: u32 = 1024;

/// The parameters at an address, and the components of the point array that each names; 0 for parameters that name none.
pub(crate) fn parameters(
    address: *const interface::Parameter,
    count: usize,
) -> CheckResult<(Vec<Parameter>, Vec<u32>)> {
    let (mut parameters, mut components) = (Vec::new(), Vec::new());
    let all = several(address, count);
    for (i, read) in all.map_err(|wrong| format!("parameter {wrong}"))?.iter().enumerate() {
        let name = identifier("the name", read.name).map_err(|wrong| format!("parameter {i}: {wrong}"))?;
        let parameter = parameter(read, &name).map_err(|wrong| format!("parameter '{name}': {wrong}"))?;
        parameters.push(parameter);
        let of_array = read.parameter_type == interface::POINT_ARRAY;
        components.push(if of_array { read.length } else { 0 });
    }
    Ok((parameters, components))
}

fn parameter(read: &interface::Parameter, name: &str) -> CheckResult<Parameter> {
    let unit = line("the unit", read.unit, MAX_NAME_BYTES)?.unwrap_or_default();
    let help = required("the help", line("the help", read.help, MAX_TEXT_BYTES)?)?;
    let known = interface::REQUIRED | interface::EXCLUSIVE_MIN | interface::EXCLUSIVE_MAX;
    if read.flags & !known != 0 {
        return Err(format!("'flags' has some that this version does not know: {:#x}", read.flags));
    }
    let required_ = read.flags & interface::REQUIRED != 0;
    let unless_required = |standard| if required_ { DefaultValue::Required } else { standard };
    let (parameter_type, standard) = match read.parameter_type {
        interface::BOOLEAN if read.number == 0.0 || read.number == 1.0 => {
            (ParameterType::Boolean, unless_required(DefaultValue::Boolean(read.number == 1.0)))
        }
        interface::BOOLEAN => return Err(format!("the default is {}, neither 0 nor 1", read.number)),
        interface::INTEGER => {
            let whole = read.number as i64;
            if whole as f64 != read.number && !required_ {
                return Err(format!("the default is {}, no whole number", read.number));
            }
            (ParameterType::Integer(range(read)?), unless_required(DefaultValue::Integer(whole)))
        }
        interface::NUMBER => {
            (ParameterType::Number(range(read)?), unless_required(DefaultValue::Number(read.number)))
        }
        interface::CHOICE => {
            let words = words(read)?;
            let given = line("the default", read.text, MAX_NAME_BYTES)?;
            let standard = match given {
                _ if required_ => DefaultValue::Required,
                Some(word) => DefaultValue::Text(word.leak()),
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
        interface::VECTOR if read.length > MAX_VECTOR_LENGTH => {
            return Err(format!("'length' is {}, at most {MAX_VECTOR_LENGTH}", read.length));
        }
        interface::VECTOR => {
            let length = (read.length > 0).then_some(read.length as usize);
            let standard = match read.numbers.is_null() {
                true => unset(read)?,
                false => {
                    let numbers = values(read.numbers, read.length as usize);
                    DefaultValue::Numbers(numbers.map_err(|wrong| format!("'numbers' {wrong}"))?.leak())
                }
            };
            (ParameterType::Numbers(length, range(read)?), unless_required(standard))
        }
        other => return Err(format!("its type is {other}, which this version does not know")),
    };
    Ok(Parameter {
        name: name.to_string().leak(),
        parameter_type,
        unit: unit.leak(),
        default: standard,
        help: help.leak(),
    })
}

/// A default text, or what leaving it out means.
fn text_or_unset(read: &interface::Parameter) -> CheckResult<DefaultValue> {
    match line("the default", read.text, MAX_TEXT_BYTES)? {
        Some(text) => Ok(DefaultValue::Text(text.leak())),
        None => unset(read),
    }
}

fn unset(read: &interface::Parameter) -> CheckResult<DefaultValue> {
    if read.flags & interface::REQUIRED != 0 {
        return Ok(DefaultValue::Required);
    }
    match line("'unset'", read.unset, MAX_TEXT_BYTES)?.filter(|text| !text.is_empty()) {
        Some(meaning) => Ok(DefaultValue::Unset(meaning.leak())),
        None => Err("there is no default, and 'unset' does not say what that means".into()),
    }
}

/// The range of numbers; both ends 0: none.
fn range(read: &interface::Parameter) -> CheckResult<Range> {
    let (min, max) = (read.min, read.max);
    if min == 0.0 && max == 0.0 {
        return Ok(Range::ANY);
    }
    let above_min = read.flags & interface::EXCLUSIVE_MIN != 0;
    let below_max = read.flags & interface::EXCLUSIVE_MAX != 0;
    if min.is_nan() || max.is_nan() || min > max || (min == max && (above_min || below_max)) {
        return Err(format!("no number is in its range, from {min} to {max}"));
    }
    Ok(Range { min, max, above_min, below_max, infinite: false })
}

/// The words of a choice with their meanings.
fn words(read: &interface::Parameter) -> CheckResult<Vec<(&'static str, &'static str)>> {
    if !(1..=MAX_PARAMETERS).contains(&read.word_count) {
        return Err(format!("there are {} words, 1 to {MAX_PARAMETERS} can be", read.word_count));
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
        let meaning =
            required("the meaning of a word", line("the meaning of a word", meaning, MAX_TEXT_BYTES)?)?;
        found.push((word.leak(), meaning.leak()));
    }
    Ok(found)
}

/// Longest name, word or unit (bytes).
pub(crate) const MAX_NAME_BYTES: usize = 64;

/// Longest summary, help or version (bytes).
pub(crate) const MAX_TEXT_BYTES: usize = 1024;

/// Largest number of parameters of a filter, and of words of a choice.
pub(crate) const MAX_PARAMETERS: u32 = 64;

/// A text of one line; `None` for a null pointer.
pub(crate) fn line(what: &str, address: *const c_char, most: usize) -> CheckResult<Option<String>> {
    let text = text(address, most).map_err(|wrong| format!("{what} {wrong}"))?;
    match text {
        Some(text) if text.chars().any(char::is_control) => {
            Err(format!("{what} has control characters: {text:?}"))
        }
        text => Ok(text),
    }
}

/// A text that is neither absent nor empty.
pub(crate) fn required(what: &str, text: Option<String>) -> CheckResult<String> {
    match text {
        None => Err(format!("{what} is a null pointer")),
        Some(text) if text.trim().is_empty() => Err(format!("{what} is empty")),
        Some(text) => Ok(text),
    }
}

/// A name that a pipeline file can spell without quotes.
pub(crate) fn identifier(what: &str, address: *const c_char) -> CheckResult<String> {
    let name = required(what, line(what, address, MAX_NAME_BYTES)?)?;
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    match name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(fits) {
        true => Ok(name),
        false => Err(format!(
            "{what} is '{name}', and may have lower-case letters, digits, '-' and '_' after a letter"
        )),
    }
}
