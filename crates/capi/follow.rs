//! A run with callbacks: the caller's functions are called from the caller's thread.

use crate::structs::Follow;
use std::ffi::CString;
use std::sync::Arc;
use voltet::{Pipeline, RenderPlan, RunStatus, run_in_background};
use voltet_core::Result;
use voltet_core::picture::Picture;

/// Renders, and calls the caller's functions meanwhile.
///
/// # Safety
/// The functions may be called with their address.
pub(crate) unsafe fn render(
    pipeline: &mut Pipeline,
    plan: &RenderPlan,
    callbacks: Option<&Follow>,
) -> Result<Arc<Picture>> {
    let callbacks = callbacks.filter(|follow| follow.progress.is_some() || follow.cancelled.is_some());
    // SAFETY: the caller's promise.
    let stops = callbacks.map(|follow| move |status: &RunStatus| unsafe { call(follow, status) });
    run_in_background(|observer| pipeline.render_with(plan, observer), stops, &mut std::iter::empty())
}

/// Reports the status of the run; true if the caller cancels it.
///
/// # Safety
/// As of [`render`].
unsafe fn call(follow: &Follow, status: &RunStatus) -> bool {
    if let Some(progress) = follow.progress {
        let [node, stage] =
            [&status.node, &status.stage].map(|text| CString::new(&**text).unwrap_or_default());
        // SAFETY: the caller's promise; the texts live during the call.
        unsafe { progress(follow.user, node.as_ptr(), stage.as_ptr(), status.fraction) };
    }
    // SAFETY: the caller's promise.
    follow.cancelled.is_some_and(|cancelled| unsafe { cancelled(follow.user) } != 0)
}
