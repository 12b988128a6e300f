//! A shared library in this process: checks of its file, loading, its entry and items, and the runner of its functions.

use crate::call::{CallOutput, Task};
use crate::declaration::{Declaration, LibraryItem};
use crate::ffi::{AddressSpace, CheckResult, Process, ValidationError};
use crate::file::PluginFile;
#[cfg(target_os = "linux")]
use crate::file::PrivateCopy;
use crate::guard::CallFailure;
use crate::host::{CallLabel, State};
use crate::interface::{
    Deinit, ENTRY, Entry, Factory, GRADIENT_FILTERS, GRID_FILTERS, GetFactory, IMAGE_FILTERS, MAJOR, READERS,
};
use crate::item::Runner;
use crate::{declaration, guard};
use std::ffi::{CStr, CString};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, counted};

/// Largest number of items of a family.
const MAX_FILTERS: u32 = 256;

/// Errors: a number of filters that is 0 or too large.
pub(crate) fn check_filter_count(count: u32) -> CheckResult<u32> {
    match (1..=MAX_FILTERS).contains(&count) {
        true => Ok(count),
        false => Err(format!("it says that it has {}, 1 to {MAX_FILTERS} can be", counted(count, "filter"))),
    }
}

/// Errors: two filters of one name.
pub(crate) fn refuse_same_names<'a>(filters: impl IntoIterator<Item = &'a Declaration>) -> CheckResult<()> {
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
struct Library {
    plugin: Plugin,
    /// True while one of its functions runs.
    busy: AtomicBool,
    deinit: Option<Deinit>,
    _loaded: ManuallyDrop<libloading::Library>,
}

impl Drop for Library {
    fn drop(&mut self) {
        if let Some(deinit) = self.deinit {
            let start = Instant::now();
            // SAFETY: init was carried out, and no function of the plug-in runs: each holds this library.
            let work = move || unsafe { deinit() };
            // One that does not return keeps nobody: its work is done.
            let may_go_on = || start.elapsed() < STOP_TIME_LIMIT;
            let _ = guard::run_attributed(&self.plugin, "while it ended (deinit)", work, may_go_on);
        }
    }
}

/// Loads a library and reads what it declares.
///
/// Errors: no library that can be loaded, none of this interface, or what it declares is wrong; each says what.
pub(crate) fn load(file: &PluginFile) -> Result<Native> {
    let path = file.path();
    let failed = |wrong: ValidationError| load_error(path, wrong);
    check_file(&file.bytes).map_err(failed)?;
    let whole = std::fs::canonicalize(path).map_err(|error| failed(error.to_string()))?;
    let code = LibraryCode {
        #[cfg(target_os = "linux")]
        bytes: file.bytes.clone(),
        whole,
    };
    let start = Instant::now();
    // Compilers can make a library change how its thread rounds; so that thread is none of ours.
    let nameless = Plugin { name: file_name(path), ..file.plugin() };
    let own = nameless.clone();
    let open = move || open(&code, &own);
    let may_go_on = || start.elapsed() < START_TIME_LIMIT;
    let loaded = guard::run_attributed(&nameless, "while it was loaded", open, may_go_on);
    match loaded {
        Ok(outcome) => outcome.map_err(failed),
        Err(CallFailure::GivenUp) => {
            Err(failed(format!("it did not begin within {} s", START_TIME_LIMIT.as_secs())))
        }
        Err(CallFailure::NoThread) => Err(failed("there is no thread for it".into())),
        Err(CallFailure::ThreadEnded) => Err(failed("it ended the thread that it was loaded on".into())),
    }
}

/// Error of a plug-in that cannot be loaded.
pub(crate) fn load_error(path: &Path, wrong: ValidationError) -> Error {
    Error::usage("the plug-in cannot be loaded")
        .got(wrong)
        .expected("a library that keeps to include/voltet_plugin.h")
        .in_file(path)
}

/// Code to load: the bytes that were hashed and checked, and the path of their file without links.
struct LibraryCode {
    #[cfg(target_os = "linux")]
    bytes: Arc<Vec<u8>>,
    whole: PathBuf,
}

impl LibraryCode {
    /// Loads it; the library stays loaded.
    ///
    /// Errors: it cannot be loaded; another file is at its path, where it is loaded from there.
    #[cfg(target_os = "linux")]
    fn open(&self) -> CheckResult<ManuallyDrop<libloading::Library>> {
        // A library that looks for others or for data beside itself must lie where it lies.
        let is_bound = [&b"$ORIGIN"[..], b"${ORIGIN}", b"\0dladdr"]
            .iter()
            .any(|name| self.bytes.windows(name.len()).any(|text| text == *name));
        // Some systems run no code of memory without a file. Of what is wrong with the library, its file tells, too.
        if let Some(copy) = PrivateCopy::new(&self.bytes).ok().filter(|_| !is_bound)
            && let Ok(loaded) = open_library(&copy.path)
        {
            // Its descriptor stays open, as it stays loaded.
            std::mem::forget(copy);
            return Ok(ManuallyDrop::new(loaded));
        }
        let held = std::fs::File::open(&self.whole).map_err(|error| error.to_string())?;
        self.refuse_another(&held)?;
        let loaded = ManuallyDrop::new(open_library(&self.whole).map_err(by_its_name)?);
        // The loader opened the path once more. Its start-up functions have run; no other has.
        self.refuse_another(&held)?;
        Ok(loaded)
    }

    #[cfg(not(target_os = "linux"))]
    fn open(&self) -> CheckResult<ManuallyDrop<libloading::Library>> {
        open_library(&self.whole).map(ManuallyDrop::new).map_err(by_its_name)
    }

    /// Errors: the open file has other bytes, or is not the one at the path.
    #[cfg(target_os = "linux")]
    fn refuse_another(&self, held: &std::fs::File) -> CheckResult<()> {
        use std::io::{BufReader, Read, Seek};
        use std::os::unix::fs::MetadataExt;
        let is_same = || -> std::io::Result<bool> {
            let (own, at_path) = (held.metadata()?, std::fs::metadata(&self.whole)?);
            if (own.dev(), own.ino(), own.len()) != (at_path.dev(), at_path.ino(), self.bytes.len() as u64) {
                return Ok(false);
            }
            let mut file = BufReader::new(held);
            file.rewind()?;
            let mut part = [0; 1 << 16];
            for wanted in self.bytes.chunks(part.len()) {
                file.read_exact(&mut part[..wanted.len()])?;
                if part[..wanted.len()] != *wanted {
                    return Ok(false);
                }
            }
            Ok(true)
        };
        match is_same() {
            Ok(true) => Ok(()),
            _ => Err("its file has changed since it was checked".into()),
        }
    }
}

fn by_its_name(error: libloading::Error) -> ValidationError {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

fn open(code: &LibraryCode, nameless: &Plugin) -> CheckResult<Native> {
    let loaded = code.open()?;
    // SAFETY: the symbol is only taken for an address, and what is there read with care.
    let entry = unsafe { loaded.get::<*const Entry>(ENTRY.as_bytes()) };
    let entry = entry.map_err(|_| format!("it does not export the symbol '{ENTRY}'"))?;
    // SAFETY: the address of a data symbol.
    let address = unsafe { entry.into_raw() }.into_raw() as usize;
    let entry = read_entry(Process, address)?;
    let (Some(init), Some(get_factory)) = (entry.init, entry.get_factory) else {
        let missing = if entry.init.is_none() { "init" } else { "get_factory" };
        return Err(format!("the function '{missing}' of its entry is a null pointer"));
    };
    let path = CString::new(code.whole.to_string_lossy().into_owned()).map_err(|error| error.to_string())?;
    let state = State::default();
    // SAFETY: the entry was checked; both arguments live through the call.
    let said = unsafe { init(path.as_ptr(), &state.host()) };
    if said.is_null() {
        return Err(state.init_failure());
    }
    let [name, version] = declaration::plugin(Process, said as usize)?;
    let plugin = Plugin { name, version, ..nameless.clone() };
    let busy = AtomicBool::new(false);
    // From here on it is ended properly.
    let library = Library { plugin, busy, deinit: entry.deinit, _loaded: loaded };
    Ok(Native { library: Arc::new(library), items: items(get_factory)? })
}

/// The entry.
///
/// Errors: it is of another version of the interface.
pub(crate) fn read_entry<A: AddressSpace>(space: A, address: A::Address) -> CheckResult<Entry<A>> {
    // The version stands where it always will, whatever the size.
    let head = space.values::<u32>(address, 4).map_err(|wrong| format!("its entry {wrong}"))?;
    let [_, major, minor, patch] = head[..] else { return Err("its entry is too short".into()) };
    if major != MAJOR {
        return Err(format!(
            "its interface is version {major}.{minor}.{patch}, and this program's {MAJOR}.x"
        ));
    }
    Ok(space.sized(address)?.0)
}

/// Reader of a description at an address.
type Describe = fn(usize) -> CheckResult<LibraryItem>;

/// Families: name of the factory, name of an item in messages, and reader of its description.
const FAMILIES: [(&CStr, &str, Describe); 4] = [
    (GRADIENT_FILTERS, "filter", declaration::library_gradient_filter),
    (READERS, "reader", declaration::reader),
    (GRID_FILTERS, "grid filter", declaration::grid_filter),
    (IMAGE_FILTERS, "image filter", declaration::image_filter),
];

fn items(get_factory: GetFactory) -> CheckResult<Vec<LibraryItem>> {
    let (mut items, mut known) = (Vec::new(), Vec::new());
    for (kind, what, describe) in FAMILIES {
        // SAFETY: init was carried out; the text lives as long as the program.
        let factory = unsafe { get_factory(kind.as_ptr()) };
        // One that gives the same whatever it is asked for means the first: there was no other kind in version 1.0.
        if factory.is_null() || known.contains(&factory) {
            continue;
        }
        known.push(factory);
        items.extend(factory_items(factory as usize, what, describe)?);
    }
    if items.is_empty() {
        let kinds = "gradient filters, readers, grid filters or image filters";
        return Err(format!("it has no {kinds} (get_factory gave nothing)"));
    }
    refuse_same_names(items.iter().map(|item| &item.declaration))?;
    Ok(items)
}

fn factory_items(factory: usize, what: &str, describe: Describe) -> CheckResult<Vec<LibraryItem>> {
    let (factory, _) = Process.sized::<Factory>(factory).map_err(|wrong| format!("{what}s: {wrong}"))?;
    let (Some(count), Some(at)) = (factory.count, factory.at) else {
        return Err(format!("a function of its factory is a null pointer ({what}s)"));
    };
    // SAFETY: the plug-in's own function, after init.
    let count = check_filter_count(unsafe { count() })?;
    let one = |place: u32| {
        // SAFETY: the same, with a place below the count.
        describe(unsafe { at(place) } as usize).map_err(|wrong| format!("{what} {place}: {wrong}"))
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

/// Errors: the file is no library of this system, or truncated.
#[cfg(not(target_os = "linux"))]
fn check_file(_: &[u8]) -> CheckResult<()> {
    Ok(())
}

/// The ELF header and the program headers (System V ABI, chapters 4 and 5).
#[cfg(target_os = "linux")]
fn check_file(bytes: &[u8]) -> CheckResult<()> {
    // The first bytes of this program: class, byte order and processor that a library must share.
    const HEAD: usize = 64;
    let mut own = [0; HEAD];
    std::fs::File::open("/proc/self/exe")
        .and_then(|mut file| std::io::Read::read_exact(&mut file, &mut own))
        .map_err(|error| format!("this program cannot be read: {error}"))?;
    if !bytes.starts_with(b"\x7fELF") {
        return Err(match bytes.is_empty() {
            true => "the file is empty".into(),
            false => "the file is no shared library (it does not begin as one)".into(),
        });
    }
    if bytes.len() < HEAD {
        return Err("the file is cut off: its header is not whole".into());
    }
    if bytes[4..6] != own[4..6] || bytes[18..20] != own[18..20] {
        return Err("it is a library for another processor".into());
    }
    // Little-endian 64-bit files only are looked into; others are left to the loader.
    if bytes[4..6] != [2, 1] {
        return Ok(());
    }
    let number = |at: usize, width: usize| -> Option<u64> {
        let field = bytes.get(at..at.checked_add(width)?)?;
        Some(field.iter().rev().fold(0, |sum, &byte| sum << 8 | u64::from(byte)))
    };
    let wrong = || "the file is damaged: its header contradicts itself".to_string();
    if number(16, 2) != Some(3) {
        return Err("it is a program or an object file, not a shared library".into());
    }
    let (table, size, count) = (number(32, 8), number(54, 2), number(56, 2));
    let (Some(table), Some(56), Some(count @ 1..=256)) = (table, size, count) else { return Err(wrong()) };
    for i in 0..count {
        let at = table.checked_add(56 * i).and_then(|at| usize::try_from(at).ok()).ok_or_else(wrong)?;
        let field = |offset: usize, width| at.checked_add(offset).and_then(|at| number(at, width));
        let (kind, begin, length) = (field(0, 4), field(8, 8), field(32, 8));
        let (Some(kind), Some(begin), Some(length)) = (kind, begin, length) else { return Err(wrong()) };
        // PT_LOAD: what the loader maps. Overrun the end of the file there is nothing to map.
        if kind == 1 && begin.checked_add(length).is_none_or(|end| end > bytes.len() as u64) {
            return Err("the file is cut off: parts that it names are not there".into());
        }
    }
    Ok(())
}

/// Longest time of a plug-in to stop, and of a check.
const STOP_TIME_LIMIT: Duration = Duration::from_secs(3);

/// A loaded library with its items.
pub(crate) struct Native {
    library: Arc<Library>,
    pub items: Vec<LibraryItem>,
}

/// Guard of a library while one of its functions runs.
struct BusyGuard(Arc<Library>);

impl Drop for BusyGuard {
    fn drop(&mut self) {
        self.0.busy.store(false, Ordering::Release);
    }
}

impl Native {
    pub fn declarations(&self) -> Vec<Declaration> {
        self.items.iter().map(|item| item.declaration.clone()).collect()
    }

    /// Runs a function of the plug-in, one at a time, on a thread of its own, while `may_go_on` is true.
    fn call<T: Send + 'static>(
        &self,
        label: CallLabel<'_>,
        work: impl FnOnce() -> T + Send + 'static,
        mut may_go_on: impl FnMut() -> bool,
    ) -> std::result::Result<T, CallFailure> {
        while self.library.busy.swap(true, Ordering::Acquire) {
            if !may_go_on() {
                return Err(CallFailure::GivenUp);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let (busy, when) = (BusyGuard(self.library.clone()), format!("in the {}", label.item()));
        // The next call begins once this one is over.
        let work = move || (work(), busy);
        let called = guard::run_attributed(&self.library.plugin, &when, work, may_go_on);
        called.map(|(outcome, _)| outcome).inspect_err(|failure| {
            // The guard is gone with the thread's stack.
            if *failure == CallFailure::ThreadEnded {
                self.library.busy.store(false, Ordering::Release);
            }
        })
    }
}

impl Runner for Native {
    fn plugin(&self) -> &Plugin {
        &self.library.plugin
    }

    fn run(&self, declaration: &Declaration, task: Task, progress: &dyn Progress) -> Result<CallOutput> {
        let label = CallLabel::new(declaration, &self.library.plugin);
        let item = self.items.iter().find(|item| item.declaration.schema.name == declaration.schema.name);
        let Some(item) = item.cloned() else { return Err(label.error("is not there any more")) };
        let (is_check, stage, start) = (matches!(task, Task::Check(_)), task.stage(), Instant::now());
        let state = Arc::new(State::default());
        let mut cancelled: Option<Instant> = None;
        let may_go_on = || {
            if is_check {
                return start.elapsed() < STOP_TIME_LIMIT;
            }
            progress.report(stage, state.fraction());
            if progress.cancelled() {
                state.cancel();
                cancelled.get_or_insert_with(Instant::now);
            }
            cancelled.is_none_or(|cancelled| cancelled.elapsed() < STOP_TIME_LIMIT)
        };
        let called = {
            let state = state.clone();
            self.call(label, move || task.run(&item, &state), may_go_on)
        };
        called.map_err(|failure| match failure {
            CallFailure::GivenUp if is_check => {
                label.error("does not come back from checking its parameters")
            }
            CallFailure::GivenUp => label.error("was asked to stop and goes on").expected(format!(
                "it to stop within {} s; only the end of the program ends it, or --plugin-process",
                STOP_TIME_LIMIT.as_secs()
            )),
            CallFailure::NoThread => label.error("cannot be run: the system gives no thread for it"),
            CallFailure::ThreadEnded => label.error("ended the thread that it was called on"),
        })
    }
}
