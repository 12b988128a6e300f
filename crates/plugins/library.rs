//! A shared library: loading, its entry, its items.

use crate::binary;
use crate::crash;
use crate::declaration::{self, Declaration, LibraryItem};
use crate::ffi::{ValidationError, sized};
use crate::host::State;
use crate::interface::{
    Deinit, ENTRY, Entry, Factory, GRADIENT_FILTERS, GRID_FILTERS, GetFactory, IMAGE_FILTERS, MAJOR, READERS,
};
use crate::watchdog::{self, CallFailure};
use std::ffi::{CStr, CString, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::{Error, Result};

/// Largest number of items of a family.
const MAX_FILTERS: u32 = 256;

/// Errors: a number of filters that is 0 or too large.
pub(crate) fn check_filter_count(count: u32) -> std::result::Result<u32, ValidationError> {
    match (1..=MAX_FILTERS).contains(&count) {
        true => Ok(count),
        false => Err(format!("it says that it has {count} filters, 1 to {MAX_FILTERS} can be")),
    }
}

/// Errors: two filters of one name.
pub(crate) fn refuse_same_names<'a>(
    filters: impl IntoIterator<Item = &'a Declaration>,
) -> std::result::Result<(), ValidationError> {
    let mut names = Vec::new();
    for Declaration { schema, .. } in filters {
        if names.contains(&schema.name) {
            return Err(format!("two of its filters are called '{}'", schema.name));
        }
        names.push(schema.name);
    }
    Ok(())
}

/// Longest time to load and to describe itself.
const START_TIME_LIMIT: Duration = Duration::from_secs(20);

/// A loaded plug-in. Stays in memory until the program ends: threads of a run-time library that it brought may still be there.
pub(crate) struct Library {
    pub plugin: Plugin,
    /// True while one of its functions runs.
    pub busy: AtomicBool,
    deinit: Option<Deinit>,
    _loaded: ManuallyDrop<libloading::Library>,
}

impl Drop for Library {
    fn drop(&mut self) {
        if let Some(deinit) = self.deinit {
            // SAFETY: init was carried out, and no function of the plug-in runs: each holds this library.
            crash::attribute(&self.plugin, "while it ended (deinit)", || unsafe { deinit() });
        }
    }
}

/// Loads a library and reads what it declares.
///
/// Errors: no library that can be loaded, none of this interface, or what it declares is wrong; each says what.
pub(crate) fn load(path: &Path) -> Result<(Library, Vec<LibraryItem>)> {
    let failed = |wrong: ValidationError| load_error(path, wrong);
    let (plugin, bytes) = read_file(path)?;
    binary::check(&bytes).map_err(failed)?;
    let whole = std::fs::canonicalize(path).map_err(|error| failed(error.to_string()))?;
    let start = Instant::now();
    // Compilers can make a library change how its thread rounds; so that thread is none of ours.
    let nameless = Plugin { name: file_name(path), ..plugin };
    let open = move || crash::attribute(&nameless, "while it was loaded", || open(&whole, &nameless));
    let loaded = watchdog::run(open, || start.elapsed() < START_TIME_LIMIT);
    match loaded {
        Ok(outcome) => outcome.map_err(failed),
        Err(CallFailure::GivenUp) => {
            Err(failed(format!("it did not begin within {} s", START_TIME_LIMIT.as_secs())))
        }
        Err(CallFailure::NoThread | CallFailure::Ended) => Err(failed("there is no thread for it".into())),
    }
}

/// Error of a plug-in that cannot be loaded.
pub(crate) fn load_error(path: &Path, wrong: ValidationError) -> Error {
    Error::usage("the plug-in cannot be loaded")
        .got(wrong)
        .expected("a library that keeps to include/voltet_plugin.h")
        .in_file(path)
}

/// The file's contents and state; name and version of the plug-in are still empty.
///
/// Errors: it cannot be read.
pub(crate) fn read_file(path: &Path) -> Result<(Plugin, Vec<u8>)> {
    let unreadable = |error: std::io::Error| {
        Error::usage("the plug-in cannot be read")
            .got(error)
            .expected("the path of a shared library")
            .in_file(path)
    };
    let modified = std::fs::metadata(path).map_err(unreadable)?.modified().ok();
    let bytes = std::fs::read(path).map_err(unreadable)?;
    let plugin = Plugin {
        name: String::new(),
        version: String::new(),
        path: path.to_path_buf(),
        bytes: bytes.len() as u64,
        fingerprint: binary::fingerprint(&bytes),
        modified,
    };
    Ok((plugin, bytes))
}

fn open(
    whole: &Path,
    nameless: &Plugin,
) -> std::result::Result<(Library, Vec<LibraryItem>), ValidationError> {
    let loaded = ManuallyDrop::new(open_library(whole).map_err(|error| join_lines(&error.to_string()))?);
    // SAFETY: the symbol is only taken for an address, and what is there read with care.
    let entry = unsafe { loaded.get::<*const Entry>(ENTRY.as_bytes()) };
    let entry = entry.map_err(|_| format!("it does not export the symbol '{ENTRY}'"))?;
    // SAFETY: the address of a data symbol.
    let address = unsafe { entry.into_raw() }.into_raw().cast::<Entry>().cast_const();
    let entry = read_entry(address)?;
    let (Some(init), Some(get_factory)) = (entry.init, entry.get_factory) else {
        let missing = if entry.init.is_none() { "init" } else { "get_factory" };
        return Err(format!("the function '{missing}' of its entry is a null pointer"));
    };
    let path = CString::new(whole.to_string_lossy().into_owned()).map_err(|error| error.to_string())?;
    let state = State::default();
    // SAFETY: the entry was checked; both arguments live through the call.
    let said = unsafe { init(path.as_ptr(), &state.host()) };
    if said.is_null() {
        return Err(state.init_failure());
    }
    let [name, version] = declaration::plugin(said)?;
    let plugin = Plugin { name, version, ..nameless.clone() };
    let busy = AtomicBool::new(false);
    // From here on it is ended properly.
    let library = Library { plugin, busy, deinit: entry.deinit, _loaded: loaded };
    Ok((library, items(get_factory)?))
}

/// The entry.
///
/// Errors: it is of another version of the interface.
fn read_entry(address: *const Entry) -> std::result::Result<Entry, ValidationError> {
    // The version stands where it always will, whatever the size.
    let head = crate::ffi::values(address.cast::<u32>(), 4).map_err(|wrong| format!("its entry {wrong}"))?;
    let [_, major, minor, patch] = head[..] else { return Err("its entry is too short".into()) };
    if major != MAJOR {
        return Err(format!(
            "its interface is version {major}.{minor}.{patch}, and this program's {MAJOR}.x"
        ));
    }
    Ok(sized(address)?.0)
}

/// Reader of a description at an address.
type Describe = fn(*const c_void) -> std::result::Result<LibraryItem, ValidationError>;

/// Families: name of the factory, name of an item in messages, and reader of its description.
const FAMILIES: [(&CStr, &str, Describe); 4] = [
    (GRADIENT_FILTERS, "filter", |at| declaration::gradient_filter(at.cast())),
    (READERS, "reader", |at| declaration::reader(at.cast())),
    (GRID_FILTERS, "grid filter", |at| declaration::grid_filter(at.cast())),
    (IMAGE_FILTERS, "image filter", |at| declaration::image_filter(at.cast())),
];

/// The items of all families.
fn items(get_factory: GetFactory) -> std::result::Result<Vec<LibraryItem>, ValidationError> {
    let (mut items, mut known) = (Vec::new(), Vec::new());
    for (kind, what, describe) in FAMILIES {
        // SAFETY: init was carried out; the text lives as long as the program.
        let factory = unsafe { get_factory(kind.as_ptr()) };
        // One that gives the same whatever it is asked for means the first: there was no other kind in version 1.0.
        if factory.is_null() || known.contains(&factory) {
            continue;
        }
        known.push(factory);
        items.extend(factory_items(factory.cast(), what, describe)?);
    }
    if items.is_empty() {
        let kinds = "gradient filters, readers, grid filters or image filters";
        return Err(format!("it has no {kinds} (get_factory gave nothing)"));
    }
    refuse_same_names(items.iter().map(|item| &item.declaration))?;
    Ok(items)
}

fn factory_items(
    factory: *const Factory,
    what: &str,
    describe: Describe,
) -> std::result::Result<Vec<LibraryItem>, ValidationError> {
    let (factory, _) = sized(factory).map_err(|wrong| format!("{what}s: {wrong}"))?;
    let (Some(count), Some(at)) = (factory.count, factory.at) else {
        return Err(format!("a function of its factory is a null pointer ({what}s)"));
    };
    // SAFETY: the plug-in's own function, after init.
    let count = check_filter_count(unsafe { count() })?;
    let one = |place: u32| {
        // SAFETY: the same, with a place below the count.
        describe(unsafe { at(place) }).map_err(|wrong| format!("{what} {place}: {wrong}"))
    };
    (0..count).map(one).collect()
}

/// All symbols are looked up now: one that is missing is an error, and not a crash later.
#[cfg(unix)]
fn open_library(path: &Path) -> std::result::Result<libloading::Library, libloading::Error> {
    use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
    // SAFETY: the user named the file; what its start-up code does is its own.
    unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map(Into::into)
}

#[cfg(not(unix))]
fn open_library(path: &Path) -> std::result::Result<libloading::Library, libloading::Error> {
    // SAFETY: the user named the file; what its start-up code does is its own.
    unsafe { libloading::Library::new(path) }
}

pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn join_lines(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
