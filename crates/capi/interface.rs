//! Functions that the library exports; `include/voltet.h` documents each, with ownership and errors.
//!
//! # Safety
//! Addresses are null or as the header says.
#![allow(missing_docs, clippy::missing_safety_doc)]

use crate::grid::{self, GridHandle};
use crate::guard::{self, Handle, guarded, null, optional_text, text, with};
use crate::render::{Target, render, set_camera};
use crate::structs::{Camera, Follow, GridInfo, GridSource, Image, read, stated_size};
use std::ffi::{c_char, c_int};
use std::path::Path;
use voltet::{Error, Pipeline, Result};

/// `VOLTET_INTERFACE` of the header that this library was made with.
const INTERFACE: u32 = 1;

#[unsafe(no_mangle)]
pub extern "C" fn voltet_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

#[unsafe(no_mangle)]
pub extern "C" fn voltet_interface() -> u32 {
    INTERFACE
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_open(session: *mut *mut Handle) -> c_int {
    guarded(|| {
        if session.is_null() {
            return Err(null("the place of the session"));
        }
        // SAFETY: it holds an address.
        unsafe { session.write(std::ptr::null_mut()) };
        let handle = Box::new(Handle::new()?);
        // SAFETY: as before.
        unsafe { session.write(Box::into_raw(handle)) };
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_close(session: *mut Handle) -> c_int {
    // SAFETY: as the header says.
    unsafe { guard::close(session) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_error_text(session: *const Handle) -> *const c_char {
    // SAFETY: as the header says.
    unsafe { guard::error_text(session) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_load(session: *mut Handle, path: *const c_char) -> c_int {
    // SAFETY: as the header says.
    unsafe { with(session, |pipeline| pipeline.load_file(text(path, "the path")?)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_load_text(
    session: *mut Handle,
    pipeline: *const c_char,
    folder: *const c_char,
) -> c_int {
    // SAFETY: as the header says.
    unsafe {
        with(session, |loaded| {
            let folder = Path::new(optional_text(folder, "the folder")?.unwrap_or(""));
            loaded.load(text(pipeline, "the pipeline")?.into(), Path::new("the pipeline's text"), folder)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_set(session: *mut Handle, option: *const c_char) -> c_int {
    // SAFETY: as the header says.
    unsafe { with(session, |pipeline| pipeline.set(text(option, "the option")?)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_set_node(
    session: *mut Handle,
    node: *const c_char,
    parameters: *const c_char,
) -> c_int {
    // SAFETY: as the header says.
    unsafe {
        with(session, |pipeline| {
            pipeline.set_node(text(node, "the node")?, text(parameters, "the parameters")?)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_set_camera(
    session: *mut Handle,
    node: *const c_char,
    camera: *const Camera,
) -> c_int {
    // SAFETY: as the header says.
    unsafe {
        with(session, |pipeline| set_camera(pipeline, optional_text(node, "the node")?, &read(camera)?))
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_grid_new(
    session: *mut Handle,
    source: *const GridSource,
    grid: *mut *mut GridHandle,
) -> c_int {
    // SAFETY: as the header says.
    unsafe {
        with(session, |_| {
            if grid.is_null() {
                return Err(null("the place of the grid"));
            }
            grid.write(std::ptr::null_mut());
            grid.write(Box::into_raw(Box::new(grid::make(source)?)));
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_grid_about(grid: *const GridHandle, info: *mut GridInfo) -> c_int {
    guarded(|| {
        // SAFETY: as the header says.
        let handle = unsafe { grid.as_ref() }.ok_or_else(|| null("the grid"))?;
        // SAFETY: as the header says.
        let size = unsafe { stated_size(info) }?;
        // SAFETY: so many bytes are there.
        unsafe { info.write_unaligned(handle.info(size)) };
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_grid_release(grid: *mut GridHandle) {
    if !grid.is_null() {
        guarded(|| {
            // SAFETY: it came from a box in `voltet_grid_new`.
            drop(unsafe { Box::from_raw(grid) });
            Ok(())
        });
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_set_grid(
    session: *mut Handle,
    node: *const c_char,
    grid: *const GridHandle,
) -> c_int {
    // SAFETY: as the header says.
    unsafe {
        with(session, |pipeline| {
            let grid = grid.as_ref().map(|handle| &handle.grid);
            pipeline.set_grid(optional_text(node, "the node")?, grid).map(drop)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_picture_size(
    session: *mut Handle,
    node: *const c_char,
    width: *mut usize,
    height: *mut usize,
) -> c_int {
    // SAFETY: as the header says.
    unsafe {
        with(session, |pipeline| {
            if width.is_null() || height.is_null() {
                return Err(null("the place of the size"));
            }
            let [picture_width, picture_height] =
                pipeline.render_plan(optional_text(node, "the node")?)?.size;
            width.write(picture_width);
            height.write(picture_height);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_render(
    session: *mut Handle,
    node: *const c_char,
    image: *const Image,
    follow: *const Follow,
) -> c_int {
    // SAFETY: as the header says.
    unsafe {
        with(session, |pipeline| {
            let follow = if follow.is_null() { None } else { Some(read(follow)?) };
            let plan = pipeline.render_plan(optional_text(node, "the node")?)?;
            let target = Target::check(read(image)?, plan.size)?;
            target.write(&*render(pipeline, &plan, follow.as_ref())?)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_report(session: *mut Handle, buffer: *mut c_char, size: usize) -> usize {
    // SAFETY: as the header says.
    unsafe { copied(session, buffer, size, |pipeline| pipeline.report().ok_or_else(not_rendered)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltet_warnings(session: *mut Handle, buffer: *mut c_char, size: usize) -> usize {
    // SAFETY: as the header says.
    unsafe {
        copied(session, buffer, size, |pipeline| Ok(pipeline.warnings().ok_or_else(not_rendered)?.join("\n")))
    }
}

/// Length returned by a call that failed.
const NO_LENGTH: usize = usize::MAX;

/// Error where there is no report.
fn not_rendered() -> Error {
    Error::usage("nothing has been drawn").expected("voltet_render before it")
}

/// Copies as much of a text as the buffer holds, with a 0 byte behind it; returns the whole text's length.
unsafe fn copied(
    session: *mut Handle,
    buffer: *mut c_char,
    size: usize,
    text: impl FnOnce(&Pipeline) -> Result<String>,
) -> usize {
    let mut length = NO_LENGTH;
    // SAFETY: as the header says.
    unsafe {
        with(session, |pipeline| {
            if buffer.is_null() && size > 0 {
                return Err(null("the buffer"));
            }
            let text = text(pipeline)?;
            if size > 0 {
                let max = text.len().min(size - 1);
                let fits = (0..=max).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
                std::ptr::copy_nonoverlapping(text.as_ptr(), buffer.cast(), fits);
                buffer.add(fits).write(0);
            }
            length = text.len();
            Ok(())
        })
    };
    length
}
