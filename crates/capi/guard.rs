//! The border of the library: handles, errors as status and message, and panics, none of which leaves it.

use std::any::Any;
use std::cell::{RefCell, UnsafeCell};
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet::Pipeline;
use voltet_core::error::ErrorKind;
use voltet_core::{Error, Result};

/// `VOLTET_DONE`.
pub const DONE: c_int = 0;
/// `VOLTET_FAILED`.
pub const FAILED: c_int = 1;
/// `VOLTET_WRONG`.
pub const USAGE: c_int = 2;
/// `VOLTET_STOPPED`.
pub const CANCELLED: c_int = 3;
/// `VOLTET_PANIC`.
pub const PANIC: c_int = 4;

/// Pipeline of a session that has loaded none.
const DEFAULT_PIPELINE: &str = include_str!("default.toml");

/// `voltet_session`.
pub struct Handle {
    /// True during a call.
    busy: AtomicBool,
    state: UnsafeCell<State>,
}

struct State {
    pipeline: Pipeline,
    /// Message of the last error.
    error: CString,
}

thread_local! {
    /// Message of this thread's last failed call.
    static LAST: RefCell<CString> = RefCell::default();
}

impl Handle {
    /// A session with the default pipeline.
    pub(crate) fn new() -> Result<Handle> {
        let mut pipeline = Pipeline::new(voltet_nodes::registry()?)?;
        pipeline.load(DEFAULT_PIPELINE.into(), Path::new("the standard pipeline"), Path::new(""))?;
        let state = UnsafeCell::new(State { pipeline, error: CString::default() });
        Ok(Handle { busy: AtomicBool::new(false), state })
    }
}

/// Status of a call, and the message of a failure.
fn status_and_message(
    outcome: std::result::Result<Result<()>, Box<dyn Any + Send>>,
) -> (c_int, Option<CString>) {
    let (status, text) = match outcome {
        Ok(Ok(())) => return (DONE, None),
        Ok(Err(error)) => match error.kind {
            ErrorKind::Usage => (USAGE, error.to_string()),
            ErrorKind::Cancelled => (CANCELLED, error.to_string()),
            ErrorKind::Panic => (PANIC, error.to_string()),
            _ => (FAILED, error.to_string()),
        },
        Err(panic) => (PANIC, voltet::panic_message(panic.as_ref())),
    };
    let text = CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default();
    LAST.with(|last| last.replace(text.clone()));
    (status, Some(text))
}

/// Runs a call without a session.
pub(crate) fn guarded(work: impl FnOnce() -> Result<()>) -> c_int {
    status_and_message(catch_unwind(AssertUnwindSafe(work))).0
}

/// Runs a call with the pipeline of its session.
///
/// # Safety
/// `handle` is null or from `voltet_open` and not closed.
pub(crate) unsafe fn with(handle: *const Handle, work: impl FnOnce(&mut Pipeline) -> Result<()>) -> c_int {
    // SAFETY: the caller's promise.
    let Some(handle) = (unsafe { handle.as_ref() }) else { return guarded(|| Err(null("the session"))) };
    if handle.busy.swap(true, Ordering::Acquire) {
        return guarded(in_use);
    }
    // SAFETY: `busy` was not set, so no other call has it, and none can until it is set back.
    let state = unsafe { &mut *handle.state.get() };
    let (status, text) = status_and_message(catch_unwind(AssertUnwindSafe(|| work(&mut state.pipeline))));
    if status == PANIC {
        // Half-done work is dropped.
        let _ = catch_unwind(AssertUnwindSafe(|| state.pipeline.reset()));
    }
    if let Some(text) = text {
        state.error = text;
    }
    handle.busy.store(false, Ordering::Release);
    status
}

/// Closes a session.
///
/// # Safety
/// As of [`with`]; on success it must not be used any more.
pub(crate) unsafe fn close(handle: *mut Handle) -> c_int {
    if handle.is_null() {
        return DONE;
    }
    guarded(|| {
        // SAFETY: not null; the caller's promise.
        if unsafe { &*handle }.busy.swap(true, Ordering::Acquire) {
            return in_use();
        }
        // SAFETY: it came from a box in `voltet_open`, and no call has it.
        drop(unsafe { Box::from_raw(handle) });
        Ok(())
    })
}

fn in_use() -> Result<()> {
    Err(Error::usage("the session is in use: by another thread, or by the call that calls back")
        .expected("one call at a time; a session for each thread"))
}

/// The text of the session's last error, else of this thread's.
///
/// # Safety
/// As of [`with`].
pub(crate) unsafe fn error_text(handle: *const Handle) -> *const c_char {
    // SAFETY: the caller's promise.
    if let Some(handle) = unsafe { handle.as_ref() }
        && !handle.busy.swap(true, Ordering::Acquire)
    {
        // SAFETY: as in `with`.
        let text = unsafe { &*handle.state.get() }.error.as_ptr();
        handle.busy.store(false, Ordering::Release);
        return text;
    }
    LAST.with(|last| last.borrow().as_ptr())
}

/// Error for a null pointer.
pub(crate) fn null(what: &str) -> Error {
    Error::usage(format!("{what} is missing")).got("a null pointer").expected("an address")
}

/// A caller's text.
///
/// # Safety
/// `text` is null or ends with a 0 byte, and stays as it is during the call.
pub(crate) unsafe fn text<'a>(text: *const c_char, what: &str) -> Result<&'a str> {
    // SAFETY: the caller's promise.
    unsafe { optional_text(text, what) }?.ok_or_else(|| null(what))
}

/// Like [`text`], where null means that there is none.
///
/// # Safety
/// As of [`text`].
pub(crate) unsafe fn optional_text<'a>(text: *const c_char, what: &str) -> Result<Option<&'a str>> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map(Some).map_err(|error| {
        let found = format!("byte {} is none", error.valid_up_to());
        Error::usage(format!("{what} is no UTF-8")).got(found).expected("text in UTF-8")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_status_with_a_text_and_the_session_goes_on() {
        let handle = Handle::new().unwrap();
        let text = |handle: *const Handle| {
            // SAFETY: the handle lives, and its text until the next call.
            unsafe { CStr::from_ptr(error_text(handle)) }.to_str().unwrap().to_string()
        };
        // SAFETY: the handle lives.
        let status = unsafe { with(&handle, |_| panic!("seven of {}", 6)) };
        assert_eq!(status, PANIC);
        assert!(text(&handle).contains("seven of 6"), "{}", text(&handle));
        // One that was caught further in, such as on another thread.
        let caught = || Err(Error::new(ErrorKind::Panic, "a call panicked"));
        // SAFETY: as before.
        assert_eq!(unsafe { with(&handle, |_| caught()) }, PANIC);
        // SAFETY: as before.
        assert_eq!(unsafe { with(&handle, |_| Ok(())) }, DONE);
    }

    #[test]
    fn a_call_out_of_a_call_is_refused() {
        let handle = Handle::new().unwrap();
        // SAFETY: the handle lives.
        let outer = unsafe {
            with(&handle, |_| {
                assert_eq!(with(&handle, |_| Ok(())), USAGE);
                Ok(())
            })
        };
        assert_eq!(outer, DONE);
    }
}
