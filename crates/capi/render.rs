//! A caller's camera to the parameters of a node, runs with callbacks from the caller's thread, and pictures into the caller's memory.

use crate::structs::{Camera, Follow, Image};
use std::ffi::CString;
use std::sync::Arc;
use voltet::{Pipeline, RenderPlan, Result, RunStatus, run_in_background};
use voltet_core::picture::Picture;
use voltet_core::{Error, counted};
use voltet_graph::ParameterValue;
use voltet_io::encode::srgb8;

/// Sets all parameters of a camera node. `node` is `None`: the only one.
pub(crate) fn set_camera(pipeline: &mut Pipeline, node: Option<&str>, camera: &Camera) -> Result<()> {
    let node = pipeline.camera_node(node)?;
    // 0 stands for the default, or for the other projection.
    let projection = |value: f64| (value != 0.0).then_some(ParameterValue::Number(value));
    let up = if camera.up == [0.0; 3] { [0.0, 0.0, 1.0] } else { camera.up };
    let mut values = vec![
        ("eye", Some(camera.eye.into_iter().collect())),
        ("target", Some(camera.target.into_iter().collect())),
        ("up", Some(up.into_iter().collect())),
        ("near", Some(ParameterValue::Number(camera.near_plane))),
        ("samples", Some(ParameterValue::Integer(i64::from(camera.samples.max(1))))),
        ("fov_y", projection(camera.fov_y)),
        ("height", projection(camera.height)),
    ];
    values.extend(voltet_nodes::VIEW_PARAMETERS.map(|name| (name, None)));
    if camera.pixels != [0, 0] {
        let sides = camera.pixels.into_iter().map(|side| ParameterValue::Integer(side.into()));
        values.push(("size", Some(sides.collect())));
    }
    pipeline.set_parameters(&node, values)
}

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

/// Memory for a picture: rows of floats, rows of bytes, or both.
pub(crate) struct Target {
    image: Image,
    rgba_stride: usize,
    srgb_stride: usize,
}

impl Target {
    /// Checks a caller's image against the size of the picture to come.
    pub fn check(image: Image, [width, height]: [usize; 2]) -> Result<Target> {
        if [image.width, image.height] != [width, height] {
            return Err(Error::usage("the image has another size than the picture")
                .got(format!("{} × {}", image.width, image.height))
                .expected(format!("{width} × {height}, the camera's")));
        }
        if image.rgba.is_null() && image.srgb.is_null() {
            return Err(Error::usage("the image has no memory").expected("rgba, srgb, or both"));
        }
        if image.background.iter().any(|channel| !channel.is_finite()) {
            let found = format!("{:?}", image.background);
            return Err(Error::usage("the background is not finite").got(found).expected("linear RGB"));
        }
        let stride = |given: usize, min: usize, unit: usize, name: &str| {
            let stride = if given == 0 { min } else { given };
            let fits = stride.checked_mul(height).is_some_and(|bytes| bytes <= isize::MAX as usize);
            if stride < min || !stride.is_multiple_of(unit) || !fits {
                let multiple = if unit > 1 { format!(", a multiple of {unit}") } else { String::new() };
                return Err(Error::usage(format!("{name} is out of range"))
                    .got(counted(given, "byte"))
                    .expected(format!("0, or at least {min} bytes from row to row{multiple}")));
            }
            Ok(stride)
        };
        if !image.rgba.is_null() && !image.rgba.is_aligned() {
            let error = Error::usage("rgba is at an odd address").got(format!("{:p}", image.rgba));
            return Err(error.expected("a multiple of 4"));
        }
        let rgba_stride = stride(image.rgba_stride, width * 16, 4, "rgba_stride")?;
        let srgb_stride = stride(image.srgb_stride, width * 3, 1, "srgb_stride")?;
        Ok(Target { image, rgba_stride, srgb_stride })
    }

    /// Writes the picture.
    ///
    /// # Safety
    /// The image's memory holds as many rows as it says.
    pub unsafe fn write(&self, picture: &Picture) -> Result<()> {
        let image = &self.image;
        if [picture.width, picture.height] != [image.width, image.height] {
            return Err(Error::run("the picture has another size than its camera")
                .got(format!("{} × {}", picture.width, picture.height)));
        }
        for (j, row) in picture.rgba.chunks_exact(picture.width).enumerate() {
            if !image.rgba.is_null() {
                // SAFETY: the caller's promise, for each row.
                let to = unsafe { image.rgba.byte_add(j * self.rgba_stride) };
                // SAFETY: as before; aligned, as the address and the stride are.
                unsafe { std::slice::from_raw_parts_mut(to, 4 * row.len()) }
                    .copy_from_slice(row.as_flattened());
            }
            if !image.srgb.is_null() {
                // SAFETY: the caller's promise, for each row.
                let to = unsafe {
                    std::slice::from_raw_parts_mut(image.srgb.byte_add(j * self.srgb_stride), 3 * row.len())
                };
                for (to, pixel) in to.as_chunks_mut::<3>().0.iter_mut().zip(row) {
                    *to = srgb8(*pixel, image.background);
                }
            }
        }
        Ok(())
    }
}
