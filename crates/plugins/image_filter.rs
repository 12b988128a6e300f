//! An image filter of a plug-in: its call, and its node.

use crate::declaration::{EntryPoint, LibraryItem};
use crate::ffi::{Overrun, Sentinel, guarded_vec, remove_guard};
use crate::host::State;
use crate::interface::ImageCall;
use crate::runner::{self, PluginItem};
use crate::status::{CallLabel, CallStatus};
use crate::task::{Outcome, Task, TaskKind};
use crate::values::ParameterValues;
use crate::wire::wire;
use std::mem::size_of;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_graph::{Node, Outputs, Port, PortType, RunContext, Value};

/// Filtering of a picture.
pub(crate) struct ImageTask {
    picture: Arc<Picture>,
    values: ParameterValues,
}

wire!(fields of ImageTask { picture, values });
wire!(fields of Picture { width, height, rgba });

impl ImageTask {
    pub const KIND: TaskKind = TaskKind::new::<ImageTask>(5, "filter");
}

impl Task for ImageTask {
    fn kind(&self) -> &'static TaskKind {
        &ImageTask::KIND
    }

    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome) {
        let EntryPoint::ImageFilter(function) = item.function else { return Default::default() };
        let Picture { width, height, rgba } = &*self.picture;
        let mut filtered = match guarded_vec::<[f32; 4], f32>(rgba.len()) {
            Ok(filtered) => filtered,
            Err(wrong) => return (CallStatus::not_called(wrong, state), Outcome::Pixels(Vec::new())),
        };
        let pointers = self.values.pointers();
        let values = self.values.header_values(&pointers);
        let call = ImageCall {
            size: size_of::<ImageCall>() as u32,
            reserved: 0,
            width: *width as u64,
            height: *height as u64,
            rgba: rgba.as_ptr().cast(),
            values: &values,
            filtered: filtered.as_mut_ptr().cast(),
        };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { function(&call, &state.host()) };
        let overrun = remove_guard::<_, f32>(&mut filtered, rgba.len()).then(|| Overrun {
            buffer: "the picture".into(),
            capacity: format!("4 numbers for each of the {width} x {height} pixels"),
        });
        (CallStatus { overrun, ..CallStatus::new(code, state) }, Outcome::Pixels(filtered))
    }
}

/// The node of an image filter.
pub(crate) fn image_node(item: PluginItem) -> &'static Node {
    let image = |summary| Port { name: "image", port_type: PortType::Image, summary };
    let [inputs, outputs] =
        [image("the picture"), image("the filtered picture")].map(|port| [port].to_vec().leak());
    let example = runner::example(item.declaration.schema, "picture", "image", "image = \"filtered\"");
    let run_item = item.clone();
    runner::leaked_node(&item, |node| Node {
        inputs,
        outputs,
        example,
        run: runner::leak(move |call: &mut RunContext| run(&run_item, call)),
        ..node
    })
}

fn run(item: &PluginItem, call: &mut RunContext) -> Result<Outputs> {
    let picture = call.image("image")?;
    let values = ParameterValues::new(&item.declaration, call.parameters)?;
    let task = ImageTask { picture: picture.clone(), values };
    let (status, rgba) = item.run(Box::new(task), call.progress(), Outcome::pixels)?;
    refuse_invalid(&picture, &rgba, item.label())?;
    call.notes.warnings.extend(item.label().warnings(&status));
    Ok(vec![Value::Image(Arc::new(Picture { rgba, ..*picture }))])
}

/// Errors: a pixel that was not written or is not a colour; another number of pixels.
fn refuse_invalid(picture: &Picture, rgba: &[[f32; 4]], label: CallLabel) -> Result<()> {
    let is_valid = |pixel: &[f32; 4]| pixel.iter().all(|x| x.is_finite()) && (0.0..=1.0).contains(&pixel[3]);
    let is_unset = |pixel: &[f32; 4]| pixel.iter().any(Sentinel::is_unset);
    let position = |i: usize| format!("at column {} of row {}", i % picture.width, i / picture.width);
    if let Some(first) = rgba.iter().position(is_unset) {
        let missing = rgba.iter().filter(|pixel| is_unset(pixel)).count();
        let found = format!("{missing} without, the first {}", position(first));
        let expected = format!("one for each of the {} x {} pixels", picture.width, picture.height);
        return Err(label.error("did not give every pixel a colour").got(found).expected(expected));
    }
    match rgba.iter().position(|pixel| !is_valid(pixel)) {
        None if rgba.len() == picture.rgba.len() => Ok(()),
        None => {
            Err(label.error("gave a picture of another size").got(rgba.len()).expected(picture.rgba.len()))
        }
        Some(i) => {
            let error =
                label.error("gave a pixel that is none").got(format!("{:?} {}", rgba[i], position(i)));
            Err(error.expected("finite numbers, the last (opacity) from 0 to 1"))
        }
    }
}
