//! A library: loaded, its entry checked, its filters described.

use crate::apart::{self, Lost};
use crate::crash;
use crate::describe::{self, Declared};
use crate::foreign::{Wrong, sized};
use crate::host::State;
use crate::image;
use crate::interface::{
    Check, Deinit, ENTRY, Entry, Factory, FilterGrid, FilterImage, GRADIENT_FILTERS, GRID_FILTERS,
    GetFactory, Gradient, IMAGE_FILTERS, MAJOR, READERS, Read,
};
use std::ffi::{CStr, CString, c_void};
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

/// Something that it offers: what that declares, and its functions.
#[derive(Clone)]
pub(crate) struct Piece {
    pub declared: Declared,
    pub check: Option<Check>,
    pub work: Work,
}

/// The function that does the work.
#[derive(Clone, Copy)]
pub(crate) enum Work {
    /// Of a gradient filter.
    Gradient(Gradient),
    /// Of a reader.
    Reader { inspect: Read, read: Read },
    /// Of a grid filter.
    GridFilter(FilterGrid),
    /// Of an image filter.
    ImageFilter(FilterImage),
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
pub(crate) fn load(path: &Path) -> Result<(Library, Vec<Piece>)> {
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
        .got(wrong)
        .expected("a library that keeps to include/voltet_plugin.h")
        .in_file(path)
}

/// The file's state, in a plug-in without a name yet, and what is in it.
///
/// Errors: it cannot be read.
pub(crate) fn state_of(path: &Path) -> Result<(Plugin, Vec<u8>)> {
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
        fingerprint: image::fingerprint(&bytes),
        modified,
    };
    Ok((plugin, bytes))
}

fn open(whole: &Path, nameless: &Plugin) -> std::result::Result<(Library, Vec<Piece>), Wrong> {
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
    Ok((library, pieces(get_factory)?))
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

/// Reads what is at an address.
type Describe = fn(*const c_void) -> std::result::Result<Piece, Wrong>;

/// The kinds of factories, what messages call what they give, and what reads it.
const KINDS: [(&CStr, &str, Describe); 4] = [
    (GRADIENT_FILTERS, "filter", |at| describe::gradient_filter(at.cast())),
    (READERS, "reader", |at| describe::reader(at.cast())),
    (GRID_FILTERS, "grid filter", |at| describe::grid_filter(at.cast())),
    (IMAGE_FILTERS, "image filter", |at| describe::image_filter(at.cast())),
];

/// What the plug-in has of every kind.
fn pieces(get_factory: GetFactory) -> std::result::Result<Vec<Piece>, Wrong> {
    let (mut pieces, mut known) = (Vec::new(), Vec::new());
    for (kind, what, describe) in KINDS {
        // SAFETY: init was carried out; the text lives as long as the program.
        let factory = unsafe { get_factory(kind.as_ptr()) };
        // One that gives the same whatever it is asked for means the first: there was no other kind in version 1.0.
        if factory.is_null() || known.contains(&factory) {
            continue;
        }
        known.push(factory);
        pieces.extend(of_factory(factory.cast(), what, describe)?);
    }
    if pieces.is_empty() {
        let kinds = "gradient filters, readers, grid filters or image filters";
        return Err(format!("it has no {kinds} (get_factory gave nothing)"));
    }
    refuse_same_names(pieces.iter().map(|piece| &piece.declared))?;
    Ok(pieces)
}

fn of_factory(
    factory: *const Factory,
    what: &str,
    describe: Describe,
) -> std::result::Result<Vec<Piece>, Wrong> {
    let (factory, _) = sized(factory).map_err(|wrong| format!("{what}s: {wrong}"))?;
    let (Some(count), Some(at)) = (factory.count, factory.at) else {
        return Err(format!("a function of its factory is a null pointer ({what}s)"));
    };
    // SAFETY: the plug-in's own function, after init.
    let count = filter_count(unsafe { count() })?;
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

fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
