//! A library: loaded, its entry checked, its filters described.

use crate::apart::{self, Lost};
use crate::crash;
use crate::describe::{self, Declared};
use crate::foreign::{Wrong, sized};
use crate::host::State;
use crate::image;
use crate::interface::{Check, Deinit, ENTRY, Entry, GRADIENT_FILTERS, Gradient, GradientFactory, MAJOR};
use std::ffi::CString;
use std::mem::ManuallyDrop;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::{Error, Result};

/// Most filters of a plug-in.
const FILTERS_MOST: u32 = 256;

/// The number of filters that a plug-in says it has, if it may have as many.
pub(crate) fn filter_count(count: u32) -> std::result::Result<u32, Wrong> {
    match (1..=FILTERS_MOST).contains(&count) {
        true => Ok(count),
        false => Err(format!("it says that it has {count} filters, 1 to {FILTERS_MOST} can be")),
    }
}

/// Refuses filters of one name.
pub(crate) fn refuse_same_names<'a>(
    filters: impl IntoIterator<Item = &'a Declared>,
) -> std::result::Result<(), Wrong> {
    let mut names = Vec::new();
    for Declared { kind, .. } in filters {
        if names.contains(&kind.name) {
            return Err(format!("two of its filters are called '{}'", kind.name));
        }
        names.push(kind.name);
    }
    Ok(())
}

/// A library whose plug-in does not begin within this is given up.
const PATIENCE: Duration = Duration::from_secs(20);

/// A loaded plug-in. Stays in memory until the program ends: threads of a run-time library that it brought may still be there.
pub(crate) struct Library {
    pub plugin: Plugin,
    /// Whether one of its functions runs.
    pub busy: AtomicBool,
    deinit: Option<Deinit>,
    _loaded: ManuallyDrop<libloading::Library>,
}

/// A filter of it: what it declares, and its functions.
#[derive(Clone)]
pub(crate) struct Filter {
    pub declared: Declared,
    pub check: Option<Check>,
    pub gradient: Gradient,
}

impl Drop for Library {
    fn drop(&mut self) {
        if let Some(deinit) = self.deinit {
            // SAFETY: init was carried out, and no function of the plug-in runs: each holds this library.
            crash::during(&self.plugin, "while it ended (deinit)", || unsafe { deinit() });
        }
    }
}

/// Loads a library and reads what it declares.
///
/// Errors: no library that can be loaded, none of this interface, or what it declares is wrong; each says what.
pub(crate) fn load(path: &Path) -> Result<(Library, Vec<Filter>)> {
    let failed = |wrong: Wrong| failed(path, wrong);
    let (stated, bytes) = state_of(path)?;
    image::check(&bytes).map_err(failed)?;
    let whole = std::fs::canonicalize(path).map_err(|error| failed(error.to_string()))?;
    let start = Instant::now();
    // Compilers can make a library change how its thread rounds; so that thread is none of ours.
    let nameless = Plugin { name: file_name(path), ..stated };
    let open = move || crash::during(&nameless, "while it was loaded", || open(&whole, &nameless));
    let begun = apart::run(open, || start.elapsed() < PATIENCE);
    match begun {
        Ok(outcome) => outcome.map_err(failed),
        Err(Lost::GivenUp) => Err(failed(format!("it did not begin within {} s", PATIENCE.as_secs()))),
        Err(Lost::NoThread | Lost::Ended) => Err(failed("there is no thread for it".into())),
    }
}

/// What keeps a plug-in from being loaded.
pub(crate) fn failed(path: &Path, wrong: Wrong) -> Error {
    Error::usage("the plug-in cannot be loaded")
        .found(wrong)
        .accepted("a library that keeps to include/voltet_plugin.h")
        .in_file(path)
}

/// The file's state, in a plug-in without a name yet, and what is in it.
///
/// Errors: it cannot be read.
pub(crate) fn state_of(path: &Path) -> Result<(Plugin, Vec<u8>)> {
    let unreadable = |error: std::io::Error| {
        Error::usage("the plug-in cannot be read")
            .found(error)
            .accepted("the path of a shared library")
            .in_file(path)
    };
    let modified = std::fs::metadata(path).map_err(unreadable)?.modified().ok();
    let bytes = std::fs::read(path).map_err(unreadable)?;
    let plugin = Plugin {
        name: String::new(),
        version: String::new(),
        path: path.to_path_buf(),
        bytes: bytes.len() as u64,
        fingerprint: image::fingerprint(&bytes),
        modified,
    };
    Ok((plugin, bytes))
}

fn open(whole: &Path, nameless: &Plugin) -> std::result::Result<(Library, Vec<Filter>), Wrong> {
    let loaded = ManuallyDrop::new(open_library(whole).map_err(|error| in_one_line(&error.to_string()))?);
    // SAFETY: the symbol is only taken for an address, and what is there read with care.
    let entry = unsafe { loaded.get::<*const Entry>(ENTRY.as_bytes()) };
    let entry = entry.map_err(|_| format!("it does not export the symbol '{ENTRY}'"))?;
    // SAFETY: the address of a data symbol.
    let address = unsafe { entry.into_raw() }.into_raw().cast::<Entry>().cast_const();
    let entry = checked(address)?;
    let (Some(init), Some(get_factory)) = (entry.init, entry.get_factory) else {
        let missing = if entry.init.is_none() { "init" } else { "get_factory" };
        return Err(format!("the function '{missing}' of its entry is a null pointer"));
    };
    let path = CString::new(whole.to_string_lossy().into_owned()).map_err(|error| error.to_string())?;
    let state = State::default();
    // SAFETY: the entry was checked; both arguments live through the call.
    let said = unsafe { init(path.as_ptr(), &state.host()) };
    if said.is_null() {
        return Err(match state.error() {
            Some(text) => format!("it says: {text}"),
            None => "its init gave nothing, and no reason".into(),
        });
    }
    let [name, version] = describe::plugin(said)?;
    let plugin = Plugin { name, version, ..nameless.clone() };
    let busy = AtomicBool::new(false);
    // From here on it is ended properly.
    let library = Library { plugin, busy, deinit: entry.deinit, _loaded: loaded };
    // SAFETY: init was carried out; the text lives as long as the program.
    let factory = unsafe { get_factory(GRADIENT_FILTERS.as_ptr()) };
    let filters = filters(factory.cast())?;
    Ok((library, filters))
}

/// The entry, if it is of a version that can be understood.
fn checked(address: *const Entry) -> std::result::Result<Entry, Wrong> {
    // The version stands where it always will, whatever the size.
    let head =
        crate::foreign::values(address.cast::<u32>(), 4).map_err(|wrong| format!("its entry {wrong}"))?;
    let [_, major, minor, patch] = head[..] else { return Err("its entry is too short".into()) };
    if major != MAJOR {
        return Err(format!(
            "its interface is version {major}.{minor}.{patch}, and this program's {MAJOR}.x"
        ));
    }
    Ok(sized(address)?.0)
}

fn filters(factory: *const GradientFactory) -> std::result::Result<Vec<Filter>, Wrong> {
    if factory.is_null() {
        return Err("it has no gradient filters (get_factory gave nothing)".into());
    }
    let (factory, _) = sized(factory)?;
    let (Some(count), Some(filter)) = (factory.filter_count, factory.filter) else {
        return Err("a function of its factory is a null pointer".into());
    };
    // SAFETY: the plug-in's own function, after init.
    let count = filter_count(unsafe { count() })?;
    let describe = |place: u32| {
        // SAFETY: the same, with a place below the count.
        let described = describe::filter(unsafe { filter(place) });
        described.map_err(|wrong| format!("filter {place}: {wrong}"))
    };
    let filters: Vec<Filter> = (0..count).map(describe).collect::<std::result::Result<_, _>>()?;
    refuse_same_names(filters.iter().map(|filter| &filter.declared))?;
    Ok(filters)
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

fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
