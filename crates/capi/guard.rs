//! The border: handles, what is wrong with a call, and panics, none of which leaves the library.

use crate::session::Session;
use std::any::Any;
use std::cell::{RefCell, UnsafeCell};
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
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

/// `voltet_session`.
pub struct Handle {
    /// Set while a call has it.
    busy: AtomicBool,
    held: UnsafeCell<Held>,
}

struct Held {
    session: Session,
    error: CString,
}

thread_local! {
    /// What was wrong with this thread's last call that failed.
    static LAST: RefCell<CString> = RefCell::default();
}

impl Handle {
    pub(crate) fn new(session: Session) -> Handle {
        let held = UnsafeCell::new(Held { session, error: CString::default() });
        Handle { busy: AtomicBool::new(false), held }
    }
}

/// The status of a failure, and its text.
fn told(outcome: std::result::Result<Result<()>, Box<dyn Any + Send>>) -> (c_int, Option<CString>) {
    let (status, text) = match outcome {
        Ok(Ok(())) => return (DONE, None),
        Ok(Err(error)) => match error.kind {
            ErrorKind::Run => (FAILED, error.to_string()),
            ErrorKind::Usage => (USAGE, error.to_string()),
            ErrorKind::Cancelled => (CANCELLED, error.to_string()),
        },
        Err(panic) => (PANIC, voltet_embed::said(panic.as_ref())),
    };
    let text = CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default();
    LAST.with(|last| last.replace(text.clone()));
    (status, Some(text))
}

/// Does what a call without a session asks for.
pub(crate) fn guarded(work: impl FnOnce() -> Result<()>) -> c_int {
    told(catch_unwind(AssertUnwindSafe(work))).0
}

/// Does what a call asks for with its session.
///
/// # Safety
/// `handle` is null or from `voltet_open` and not closed.
pub(crate) unsafe fn with(handle: *const Handle, work: impl FnOnce(&mut Session) -> Result<()>) -> c_int {
    // SAFETY: the caller's promise.
    let Some(handle) = (unsafe { handle.as_ref() }) else { return guarded(|| Err(null("the session"))) };
    if handle.busy.swap(true, Ordering::Acquire) {
        return guarded(in_use);
    }
    // SAFETY: `busy` was not set, so no other call has it, and none can until it is set back.
    let held = unsafe { &mut *handle.held.get() };
    let (status, text) = told(catch_unwind(AssertUnwindSafe(|| work(&mut held.session))));
    if status == PANIC {
        // What it left half done is of no use.
        let _ = catch_unwind(AssertUnwindSafe(|| held.session.begin_anew()));
    }
    if let Some(text) = text {
        held.error = text;
    }
    handle.busy.store(false, Ordering::Release);
    status
}

/// Closes a session.
///
/// # Safety
/// As of [`with`]; on success nobody may use it any more.
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
        let text = unsafe { &*handle.held.get() }.error.as_ptr();
        handle.busy.store(false, Ordering::Release);
        return text;
    }
    LAST.with(|last| last.borrow().as_ptr())
}

/// What a null pointer is answered with.
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

/// The same where null means that there is none.
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
        let handle = Handle::new(Session::new().unwrap());
        let text = |handle: *const Handle| {
            // SAFETY: the handle lives, and its text until the next call.
            unsafe { CStr::from_ptr(error_text(handle)) }.to_str().unwrap().to_string()
        };
        // SAFETY: the handle lives.
        let status = unsafe { with(&handle, |_| panic!("seven of {}", 6)) };
        assert_eq!(status, PANIC);
        assert!(text(&handle).contains("seven of 6"), "{}", text(&handle));
        // SAFETY: as before.
        assert_eq!(unsafe { with(&handle, |_| Ok(())) }, DONE);
    }

    #[test]
    fn a_call_out_of_a_call_is_refused() {
        let handle = Handle::new(Session::new().unwrap());
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
