//! Declarations of a plug-in's items and their parameters, read from the header's structs and checked.

use crate::ffi::{AddressSpace, CheckResult, Process, ValidationError};
use crate::interface::{self, Check, FilterGrid, FilterImage, Gradient, Read};
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range, VariantSchema};

/// Largest number of extensions of a reader, and of bytes that its files begin with.
const MAX_EXTENSIONS: u32 = 16;
const MAX_MAGIC_BYTES: u32 = 64;

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

/// Function of a library that does an item's work; declared ones are there.
#[derive(Clone, Copy)]
pub(crate) enum EntryPoint {
    /// Function of a gradient filter.
    Gradient(Option<Gradient>),
    /// Functions of a reader.
    Reader { inspect: Option<Read>, read: Option<Read> },
    /// Function of a grid filter.
    GridFilter(Option<FilterGrid>),
    /// Function of an image filter.
    ImageFilter(Option<FilterImage>),
}

/// Name and version of the plug-in at an address.
pub(crate) fn plugin<A: AddressSpace>(space: A, address: A::Address) -> CheckResult<[String; 2]> {
    let (read, _) = space.sized::<interface::Plugin<A>>(address)?;
    let name = space.required_line("the name of the plug-in", read.name, MAX_NAME_BYTES)?;
    Ok([name, space.required_line("the version of the plug-in", read.version, MAX_NAME_BYTES)?])
}

/// The gradient filter at an address, and the struct there.
pub(crate) fn gradient_filter<A: AddressSpace>(
    space: A,
    address: A::Address,
) -> CheckResult<(Declaration, interface::GradientFilter<A>)> {
    let (read, _) = space.sized::<interface::GradientFilter<A>>(address)?;
    let declaration = declaration(space, "filter", &read.item, || {
        let needs = read.item.needs;
        let known = interface::NEEDS_NEIGHBOURS
            | interface::NEEDS_CELLS_OF_POINTS
            | interface::NEEDS_BOUNDARY
            | interface::NEEDS_SECOND_RINGS;
        if needs & !known != 0 {
            return Err(format!("'needs' has flags that this version does not know: {needs:#x}"));
        }
        refuse_null::<A, Gradient>("gradient", read.gradient)?;
        Ok(Family::GradientFilter { needs })
    })?;
    Ok((declaration, read))
}

pub(crate) fn library_gradient_filter(address: usize) -> CheckResult<LibraryItem> {
    let (declaration, read) = gradient_filter(Process, address)?;
    Ok(LibraryItem { declaration, check: read.item.check, function: EntryPoint::Gradient(read.gradient) })
}

pub(crate) fn reader(address: usize) -> CheckResult<LibraryItem> {
    let (read, _) = Process.sized::<interface::Reader>(address)?;
    let declaration = declaration(Process, "reader", &read.item, || {
        refuse_null::<Process, Read>("inspect", read.inspect)?;
        refuse_null::<Process, Read>("read", read.read)?;
        let extensions = names("an extension", read.extensions, read.item.name_count, MAX_EXTENSIONS)?;
        let wrong = |name: &&&str| !name.chars().all(|c| c.is_ascii_graphic() && !c.is_ascii_uppercase());
        if let Some(name) = extensions.iter().find(wrong) {
            return Err(format!("the extension '{name}' is not in lower-case letters without spaces"));
        }
        let magic = match read.magic_length {
            0 => Vec::new(),
            length @ 1..=MAX_MAGIC_BYTES => {
                Process.values(read.magic, length as usize).map_err(|wrong| format!("'magic' {wrong}"))?
            }
            length => return Err(format!("'magic_length' is {length}, at most {MAX_MAGIC_BYTES}")),
        };
        Ok(Family::Reader { extensions: extensions.leak(), magic: magic.leak() })
    })?;
    let function = EntryPoint::Reader { inspect: read.inspect, read: read.read };
    Ok(LibraryItem { declaration, check: read.item.check, function })
}

pub(crate) fn grid_filter(address: usize) -> CheckResult<LibraryItem> {
    let (read, _) = Process.sized::<interface::GridFilter>(address)?;
    let declaration = declaration(Process, "grid filter", &read.item, || {
        refuse_null::<Process, FilterGrid>("filter", read.filter)?;
        let made = names("an array that it makes", read.made, read.item.name_count, MAX_PARAMETERS)?;
        Ok(Family::GridFilter { made: made.leak() })
    })?;
    Ok(LibraryItem { declaration, check: read.item.check, function: EntryPoint::GridFilter(read.filter) })
}

pub(crate) fn image_filter(address: usize) -> CheckResult<LibraryItem> {
    let (read, _) = Process.sized::<interface::ImageFilter>(address)?;
    let declaration = declaration(Process, "image filter", &read.item, || {
        refuse_null::<Process, FilterImage>("filter", read.filter).map(|()| Family::ImageFilter)
    })?;
    Ok(LibraryItem { declaration, check: read.item.check, function: EntryPoint::ImageFilter(read.filter) })
}

/// A declaration from the fields that the structs of all families share, and from `read_family`, which reads the others. Its texts
/// and lists live from now on as long as the program.
fn declaration<A: AddressSpace>(
    space: A,
    what: &str,
    item: &interface::Item<A>,
    read_family: impl FnOnce() -> CheckResult<Family>,
) -> CheckResult<Declaration> {
    let name = identifier(space, &format!("the name of the {what}"), item.name)?;
    let located = |wrong: ValidationError| format!("of the {what} '{name}', {wrong}");
    let summary = space.required_line("the summary", item.summary, MAX_TEXT_BYTES).map_err(located)?;
    let family = read_family().map_err(located)?;
    let count = item.parameter_count;
    if count > MAX_PARAMETERS {
        return Err(located(format!("there are {count} parameters, at most {MAX_PARAMETERS} can be")));
    }
    let (parameters, components) = parameters(space, item.parameters, count as usize).map_err(located)?;
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
    Ok(Declaration { schema, family, checks: !A::is_null::<Check>(item.check), components })
}

/// Errors: the function is a null pointer.
fn refuse_null<A: AddressSpace, F: Copy>(name: &str, function: A::Function<F>) -> CheckResult<()> {
    match A::is_null::<F>(function) {
        true => Err(format!("the function '{name}' is a null pointer")),
        false => Ok(()),
    }
}

/// A list of texts without duplicates.
fn names(what: &str, address: usize, count: u32, max: u32) -> CheckResult<Vec<&'static str>> {
    if count > max {
        return Err(format!("{what}: there are {count}, at most {max} can be"));
    }
    if count == 0 {
        return Ok(Vec::new());
    }
    let texts = Process.values::<usize>(address, count as usize);
    let mut found: Vec<&str> = Vec::new();
    for text in texts.map_err(|wrong| format!("{what}: the list {wrong}"))? {
        let name = Process.required_line(what, text, MAX_NAME_BYTES)?;
        if found.contains(&name.as_str()) {
            return Err(format!("{what}: '{name}' is there twice"));
        }
        found.push(name.leak());
    }
    Ok(found)
}

/// Longest vector.
const MAX_VECTOR_LENGTH: u32 = 1024;

/// The parameters at an address, and the components of the point array that each names; 0 for parameters that name none.
fn parameters<A: AddressSpace>(
    space: A,
    address: A::Address,
    count: usize,
) -> CheckResult<(Vec<Parameter>, Vec<u32>)> {
    let (mut parameters, mut components) = (Vec::new(), Vec::new());
    let all = space.several::<interface::Parameter<A>>(address, count);
    for (i, read) in all.map_err(|wrong| format!("parameter {wrong}"))?.iter().enumerate() {
        let name =
            identifier(space, "the name", read.name).map_err(|wrong| format!("parameter {i}: {wrong}"))?;
        let parameter =
            parameter(space, read, &name).map_err(|wrong| format!("parameter '{name}': {wrong}"))?;
        parameters.push(parameter);
        let of_array = read.parameter_type == interface::POINT_ARRAY;
        components.push(if of_array { read.length } else { 0 });
    }
    Ok((parameters, components))
}

fn parameter<A: AddressSpace>(
    space: A,
    read: &interface::Parameter<A>,
    name: &str,
) -> CheckResult<Parameter> {
    let unit = space.line("the unit", read.unit, MAX_NAME_BYTES)?.unwrap_or_default();
    let help = space.required_line("the help", read.help, MAX_TEXT_BYTES)?;
    let known = interface::REQUIRED | interface::EXCLUSIVE_MIN | interface::EXCLUSIVE_MAX;
    if read.flags & !known != 0 {
        return Err(format!("'flags' has some that this version does not know: {:#x}", read.flags));
    }
    let is_required = read.flags & interface::REQUIRED != 0;
    // A default text, or what leaving it out means.
    let text_or_unset = |address: Option<A::Address>| {
        let text = address.map_or(Ok(None), |address| space.line("the default", address, MAX_TEXT_BYTES))?;
        if let Some(text) = text {
            return Ok(DefaultValue::Text(text.leak()));
        }
        match space.line("'unset'", read.unset, MAX_TEXT_BYTES)?.filter(|text| !text.is_empty()) {
            Some(meaning) => Ok(DefaultValue::Unset(meaning.leak())),
            None if is_required => Ok(DefaultValue::Required),
            None => Err("there is no default, and 'unset' does not say what that means".to_string()),
        }
    };
    let (parameter_type, default) = match read.parameter_type {
        interface::BOOLEAN if read.number != 0.0 && read.number != 1.0 => {
            return Err(format!("the default is {}, neither 0 nor 1", read.number));
        }
        interface::BOOLEAN => (ParameterType::Boolean, DefaultValue::Boolean(read.number == 1.0)),
        interface::INTEGER if read.number as i64 as f64 != read.number && !is_required => {
            return Err(format!("the default is {}, no whole number", read.number));
        }
        interface::INTEGER => {
            (ParameterType::Integer(range(read)?), DefaultValue::Integer(read.number as i64))
        }
        interface::NUMBER => (ParameterType::Number(range(read)?), DefaultValue::Number(read.number)),
        interface::CHOICE => {
            let words = words(space, read)?;
            match space.line("the default", read.text, MAX_NAME_BYTES)? {
                None if !is_required => return Err("there is no default, and it is not required".into()),
                word => {
                    let word = word.unwrap_or_default();
                    (ParameterType::Choice(words.leak()), DefaultValue::Text(word.leak()))
                }
            }
        }
        interface::POINT_ARRAY if !(1..=9).contains(&read.length) => {
            return Err(format!("'length' is {}, and a point array has 1 to 9 components", read.length));
        }
        interface::TEXT => (ParameterType::Text, text_or_unset(Some(read.text))?),
        // The type is that of names with one value a point.
        interface::POINT_ARRAY if read.length > 1 => (ParameterType::Text, text_or_unset(Some(read.text))?),
        interface::POINT_ARRAY => (ParameterType::ArrayName, text_or_unset(Some(read.text))?),
        interface::VECTOR if read.length > MAX_VECTOR_LENGTH => {
            return Err(format!("'length' is {}, at most {MAX_VECTOR_LENGTH}", read.length));
        }
        interface::VECTOR => {
            let length = (read.length > 0).then_some(read.length as usize);
            let default = match TryInto::<usize>::try_into(read.numbers) {
                Ok(0) => text_or_unset(None)?,
                _ => {
                    let numbers = space.values(read.numbers, read.length as usize);
                    DefaultValue::Numbers(numbers.map_err(|wrong| format!("'numbers' {wrong}"))?.leak())
                }
            };
            (ParameterType::Numbers(length, range(read)?), default)
        }
        other => return Err(format!("its type is {other}, which this version does not know")),
    };
    Ok(Parameter {
        name: name.to_string().leak(),
        parameter_type,
        unit: unit.leak(),
        default: if is_required { DefaultValue::Required } else { default },
        help: help.leak(),
    })
}

/// The range of numbers; both ends 0: none.
fn range<A: AddressSpace>(read: &interface::Parameter<A>) -> CheckResult<Range> {
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

fn words<A: AddressSpace>(
    space: A,
    read: &interface::Parameter<A>,
) -> CheckResult<Vec<(&'static str, &'static str)>> {
    if !(1..=MAX_PARAMETERS).contains(&read.word_count) {
        return Err(format!("there are {} words, 1 to {MAX_PARAMETERS} can be", read.word_count));
    }
    let list = |what: &str, address: A::Address| {
        space
            .values::<A::Address>(address, read.word_count as usize)
            .map_err(|wrong| format!("'{what}' {wrong}"))
    };
    let (words, meanings) = (list("words", read.words)?, list("meanings", read.meanings)?);
    let mut found: Vec<(&str, &str)> = Vec::new();
    for (word, meaning) in words.into_iter().zip(meanings) {
        let word = identifier(space, "a word", word)?;
        if found.iter().any(|(known, _)| *known == word) {
            return Err(format!("there are two words '{word}'"));
        }
        let meaning = space.required_line("the meaning of a word", meaning, MAX_TEXT_BYTES)?;
        found.push((word.leak(), meaning.leak()));
    }
    Ok(found)
}

/// Longest name, word or unit (bytes).
const MAX_NAME_BYTES: usize = 64;

/// Longest summary, help or version (bytes).
pub(crate) const MAX_TEXT_BYTES: usize = 1024;

/// Largest number of parameters of a filter, and of words of a choice.
const MAX_PARAMETERS: u32 = 64;

/// A name that a pipeline file can spell without quotes.
fn identifier<A: AddressSpace>(space: A, what: &str, address: A::Address) -> CheckResult<String> {
    let name = space.required_line(what, address, MAX_NAME_BYTES)?;
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    match name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(fits) {
        true => Ok(name),
        false => Err(format!(
            "{what} is '{name}', and may have lower-case letters, digits, '-' and '_' after a letter"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Editors offer names of arrays with one value a point for the type of these.
    #[test]
    fn names_of_point_arrays_of_several_components_are_texts() {
        let help = c"the array";
        let of = |length| {
            let read = interface::Parameter::<Process> {
                size: size_of::<interface::Parameter>() as u32,
                parameter_type: interface::POINT_ARRAY,
                name: 0,
                unit: 0,
                help: help.as_ptr().expose_provenance(),
                flags: interface::REQUIRED,
                length,
                min: 0.0,
                max: 0.0,
                number: 0.0,
                text: 0,
                numbers: 0,
                unset: 0,
                word_count: 0,
                reserved: 0,
                words: 0,
                meanings: 0,
            };
            parameter(Process, &read, "by").map(|parameter| parameter.parameter_type)
        };
        assert!(matches!(of(1), Ok(ParameterType::ArrayName)));
        assert!([2, 3, 9].map(of).iter().all(|found| matches!(found, Ok(ParameterType::Text))));
        assert!([0, 10].map(of).iter().all(Result::is_err));
    }
}
