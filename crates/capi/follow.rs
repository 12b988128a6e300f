//! A run that the caller follows: the caller's functions are called from the caller's thread.

use crate::session::Session;
use crate::structs::Follow;
use std::ffi::CString;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_embed::{Drawing, Moment, follow};

/// Draws, and calls the caller's functions meanwhile.
///
/// # Safety
/// The functions may be called with their address.
pub(crate) unsafe fn draw(
    session: &mut Session,
    drawing: &Drawing,
    told: Option<&Follow>,
) -> Result<Arc<Picture>> {
    let told = told.filter(|follow| follow.progress.is_some() || follow.cancelled.is_some());
    // SAFETY: the caller's promise.
    let stops = told.map(|told| move |moment: &Moment| unsafe { call(told, moment) });
    follow(|observer| session.draw(drawing, observer), stops, &mut std::iter::empty())
}

/// Says where the run is, and asks whether to stop.
///
/// # Safety
/// As of [`draw`].
unsafe fn call(follow: &Follow, moment: &Moment) -> bool {
    if let Some(progress) = follow.progress {
        let [node, stage] =
            [&moment.node, &moment.stage].map(|text| CString::new(&**text).unwrap_or_default());
        // SAFETY: the caller's promise; the texts live during the call.
        unsafe { progress(follow.user, node.as_ptr(), stage.as_ptr(), moment.fraction) };
    }
    // SAFETY: the caller's promise.
    follow.cancelled.is_some_and(|cancelled| unsafe { cancelled(follow.user) } != 0)
}
