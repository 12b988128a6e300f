//! A panic in words: it is a mistake of the program, and must not leave it.

use std::any::Any;

/// What is said of a panic that was caught.
pub fn said(panic: &(dyn Any + Send)) -> String {
    let what = panic.downcast_ref::<&str>().copied();
    let what = what.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    format!("this is a mistake of voltet itself: {what}; please report it")
}
