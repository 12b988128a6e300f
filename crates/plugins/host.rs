//! Functions of the host that a plug-in calls and their state; the result of a call, and the beginning of messages about it.

use crate::declaration::Declaration;
use crate::ffi::{AddressSpace, Overrun, Process, ValidationError};
use crate::guard::Caller;
use crate::interface::{CANCELLED, ERROR, Host, LoopBody, MAJOR, MINOR, OK, PATCH};
use crate::thread_state::with_same_rounding;
use crate::wire::wire;
use rayon::prelude::*;
use std::cell::Cell;
use std::ffi::{c_char, c_void};
use std::mem::size_of;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use voltet_core::error::ErrorKind;
use voltet_core::field::{Fallback, Plugin};
use voltet_core::{Error, Result};

/// Largest number of different texts of fall-backs.
const MAX_FALLBACKS: usize = 32;

#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Reports {
    pub error: Option<String>,
    /// Reason for which the host refused what it was handed.
    pub refusal: Option<ValidationError>,
    /// Counts of the fall-backs by text.
    pub fallbacks: Vec<Fallback>,
}

/// State of one call: reports of the plug-in, and its cancellation. Shared by the plug-in's threads and the host's.
#[derive(Default)]
pub(crate) struct State {
    /// Bits of the completed fraction.
    fraction: AtomicU64,
    cancelled: AtomicBool,
    reports: Mutex<Reports>,
}

impl State {
    /// Completed fraction of the work, 0 to 1.
    pub fn fraction(&self) -> f64 {
        let fraction = f64::from_bits(self.fraction.load(Ordering::Relaxed));
        if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Records the completed fraction.
    pub fn set_fraction(&self, fraction: f64) {
        self.fraction.store(fraction.to_bits(), Ordering::Relaxed);
    }

    /// Requests the plug-in to stop.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Everything reported so far.
    pub fn reports(&self) -> MutexGuard<'_, Reports> {
        self.reports.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Records the error message, unless there is one.
    pub fn set_error(&self, text: String) {
        self.reports().error.get_or_insert(text);
    }

    /// Records a reason to refuse what the host was handed, unless there is one.
    pub fn refuse(&self, refusal: ValidationError) {
        self.reports().refusal.get_or_insert(refusal);
    }

    /// Reason for which the function `init` gave nothing.
    pub fn init_failure(&self) -> ValidationError {
        match &self.reports().error {
            Some(text) => format!("it says: {text}"),
            None => "its init gave nothing, and no reason".into(),
        }
    }

    /// Counts points at which the filter fell back.
    pub fn add_fallback(&self, what: String, point_count: u64) {
        if point_count == 0 {
            return;
        }
        let mut reports = self.reports();
        let fallbacks = &mut reports.fallbacks;
        match fallbacks.iter().position(|known| known.what == what) {
            Some(i) => fallbacks[i].point_count = fallbacks[i].point_count.saturating_add(point_count),
            None if fallbacks.len() < MAX_FALLBACKS => fallbacks.push(Fallback { what, point_count }),
            None => {}
        }
    }

    /// The header's struct for a call; the state must outlive it.
    pub fn host(&self) -> Host {
        Host {
            size: size_of::<Host>() as u32,
            major: MAJOR,
            minor: MINOR,
            patch: PATCH,
            thread_count: rayon::current_num_threads() as u32,
            reserved: 0,
            program: concat!("voltet ", env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast(),
            context: std::ptr::from_ref(self).cast_mut().cast(),
            progress,
            cancelled,
            error,
            fallback,
            parallel_for,
        }
    }
}

/// The state behind a host; `None` for none.
///
/// # Safety
///
/// `host` is null or what [`State::host`] gave, and the state is still there.
unsafe fn state<'a>(host: *const Host) -> Option<&'a State> {
    // SAFETY: the caller's contract; `context` is a state, which is shared by reference only.
    unsafe { host.as_ref().and_then(|host| host.context.cast::<State>().cast_const().as_ref()) }
}

unsafe extern "C-unwind" fn progress(host: *const Host, fraction: f64) {
    // SAFETY: the plug-in hands over the host of the call that it is in.
    if let Some(state) = unsafe { state(host) } {
        state.set_fraction(fraction);
    }
}

unsafe extern "C-unwind" fn cancelled(host: *const Host) -> i32 {
    // SAFETY: as in `progress`.
    i32::from(unsafe { state(host) }.is_some_and(State::is_cancelled))
}

unsafe extern "C-unwind" fn error(host: *const Host, text: *const c_char) {
    // SAFETY: as in `progress`.
    if let Some(state) = unsafe { state(host) } {
        state.set_error(Process.message(text as usize));
    }
}

unsafe extern "C-unwind" fn fallback(host: *const Host, what: *const c_char, point_count: u64) {
    // SAFETY: as in `progress`.
    let Some(state) = (unsafe { state(host) }) else { return };
    state.add_fallback(Process.message(what as usize), point_count);
}

thread_local! {
    /// True if this thread is within the body of a loop.
    static IN_BODY: Cell<bool> = const { Cell::new(false) };
}

/// Pointer of the plug-in for its own loop body, passed on to every thread.
#[derive(Clone, Copy)]
struct User(*mut c_void);
// SAFETY: the host only hands it on; the interface says that bodies run on several threads.
unsafe impl Send for User {}
// SAFETY: the same.
unsafe impl Sync for User {}

impl User {
    fn get(self) -> *mut c_void {
        self.0
    }
}

unsafe extern "C-unwind" fn parallel_for(
    host: *const Host,
    count: u64,
    chunk: u64,
    body: Option<LoopBody>,
    user: *mut c_void,
) -> i32 {
    // SAFETY: as in `progress`.
    let Some(state) = (unsafe { state(host) }) else { return ERROR };
    let Some(body) = body else {
        state.set_error("parallel_for was called without a body".into());
        return ERROR;
    };
    let threads = rayon::current_num_threads() as u64;
    let chunk = match chunk {
        0 => (count / (16 * threads)).clamp(1, 4096),
        chunk => chunk,
    };
    let (user, caller) = (User(user), Caller::current());
    let part = |number: u64| {
        if state.is_cancelled() {
            return;
        }
        let first = number * chunk;
        let thread = rayon::current_thread_index().unwrap_or(0) as u32;
        let outer = IN_BODY.replace(true);
        let end = first.saturating_add(chunk).min(count);
        // SAFETY: the plug-in's own function with its own pointer, as it asked for.
        caller.run(|| with_same_rounding(|| unsafe { body(user.get(), first, end, thread) }));
        IN_BODY.set(outer);
    };
    let parts = 0..count.div_ceil(chunk);
    // A thread that waited within a body could take another part under the same number.
    match IN_BODY.get() {
        true => parts.for_each(part),
        false => parts.into_par_iter().for_each(part),
    }
    if state.is_cancelled() { CANCELLED } else { OK }
}

/// Return code of a plug-in's function, and what it reported to the host.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CallStatus {
    pub code: i32,
    pub overrun: Option<Overrun>,
    pub reports: Reports,
}

wire!(fields of CallStatus { code, overrun, reports });
wire!(fields of Reports { error, refusal, fallbacks });
wire!(fields of Fallback { what, point_count });

impl CallStatus {
    pub fn new(code: i32, state: &State) -> CallStatus {
        CallStatus { code, overrun: None, reports: state.reports().clone() }
    }
}

/// Name of an item and its plug-in, for messages.
#[derive(Clone, Copy)]
pub(crate) struct CallLabel<'a> {
    declaration: &'a Declaration,
    plugin: &'a Plugin,
}

impl<'a> CallLabel<'a> {
    pub fn new(declaration: &'a Declaration, plugin: &'a Plugin) -> CallLabel<'a> {
        CallLabel { declaration, plugin }
    }

    /// "gradient filter 'x'".
    pub fn item(&self) -> String {
        format!("{} '{}'", self.declaration.family.name(), self.declaration.schema.name)
    }

    /// An error that begins "the gradient filter 'x' of the plug-in 'y' (path)" and goes on with `what`.
    pub fn error(&self, what: &str) -> Error {
        Error::run(format!("the {} of the {} {what}", self.item(), self.plugin))
    }

    /// Errors: the plug-in's own check refused the parameters.
    pub fn check_parameters(&self, status: CallStatus) -> Result<()> {
        match status.code {
            OK => Ok(()),
            _ => Err(Error { kind: ErrorKind::Usage, ..self.failure(&status) }),
        }
    }

    /// Errors: the call failed, or was stopped. `cancelled`: the user cancelled it.
    pub fn check_call(&self, status: &CallStatus, cancelled: bool) -> Result<()> {
        if let Some(Overrun { buffer, capacity }) = &status.overrun {
            let what = format!("wrote beyond the end of {buffer}: what else it wrote over is unknown");
            return Err(self.error(&what).expected(capacity));
        }
        if let Some(refusal) = &status.reports.refusal {
            return Err(self.error("is refused").got(refusal));
        }
        match status.code {
            OK => Ok(()),
            _ if cancelled => Err(Error::cancelled()),
            CANCELLED => Err(self.error("stopped, and nobody asked it to")),
            _ => Err(self.failure(status)),
        }
    }

    fn failure(&self, status: &CallStatus) -> Error {
        match &status.reports.error {
            Some(text) => self.error("says").got(text),
            None => self.error("failed and did not say why").got(format!("code {}", status.code)),
        }
    }

    /// Sentences about the points at which the item fell back to something simpler.
    pub fn warnings(&self, status: &CallStatus) -> impl Iterator<Item = String> {
        let fallbacks = status.reports.fallbacks.iter();
        fallbacks.map(|fallback| format!("The {} of the {}: {fallback}.", self.item(), self.plugin))
    }
}
