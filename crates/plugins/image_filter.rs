//! An image filter of a plug-in: its call, and the node that it is.

use crate::grids::{Fresh, fresh, overran};
use crate::host::State;
use crate::interface::{FilterImage, ImageCall};
use crate::node;
use crate::outcome::{Beyond, Said, Whose};
use crate::runner::Offered;
use crate::task::{Outcome, Task};
use crate::values::Owned;
use std::mem::size_of;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_graph::{Node, Outputs, Port, PortType, RunContext, Value};

/// What an image filter is given.
pub(crate) struct GivenImage {
    pub picture: Arc<Picture>,
    pub values: Owned,
}

impl GivenImage {
    /// Calls the function that filters.
    pub fn filter(&self, function: FilterImage, state: &State) -> (Said, Vec<[f32; 4]>) {
        let Picture { width, height, rgba } = &*self.picture;
        let mut filtered = match fresh::<[f32; 4], f32>(rgba.len()) {
            Ok(filtered) => filtered,
            Err(wrong) => return (Said::not_called(wrong, state), Vec::new()),
        };
        let pointers = self.values.pointers();
        let values = self.values.by(&pointers);
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
        let beyond = overran::<_, f32>(&mut filtered, rgba.len()).then(|| Beyond {
            what: "the picture".into(),
            accepted: format!("4 numbers for each of the {width} x {height} pixels"),
        });
        (Said { beyond, ..Said::new(code, state) }, filtered)
    }
}

/// The node.
pub(crate) fn node(offered: Offered) -> &'static Node {
    let image = |summary| Port { name: "image", port_type: PortType::Image, summary };
    let [inputs, outputs] =
        [image("the picture"), image("the filtered picture")].map(|port| [port].to_vec().leak());
    let example = node::example(offered.declared.kind, "picture", "image", "image = \"filtered\"");
    let of_run = offered.clone();
    node::leaked(&offered, |node| Node {
        inputs,
        outputs,
        example,
        run: node::leak(move |call: &mut RunContext| run(&of_run, call)),
        ..node
    })
}

fn run(offered: &Offered, call: &mut RunContext) -> Result<Outputs> {
    let picture = call.image("image")?;
    let given =
        GivenImage { picture: picture.clone(), values: Owned::new(&offered.declared, call.parameters)? };
    let (said, rgba) = offered.run(Task::Image(Box::new(given)), call.progress(), Outcome::pixels)?;
    judged(&picture, &rgba, offered.whose())?;
    call.notes.warnings.extend(offered.whose().warnings(&said));
    Ok(vec![Value::Image(Arc::new(Picture { rgba, ..*picture }))])
}

/// Errors: a pixel that is none.
fn judged(picture: &Picture, rgba: &[[f32; 4]], whose: Whose) -> Result<()> {
    let good = |pixel: &[f32; 4]| pixel.iter().all(|x| x.is_finite()) && (0.0..=1.0).contains(&pixel[3]);
    let at = |place: usize| format!("at column {} of row {}", place % picture.width, place / picture.width);
    if let Some(place) = rgba.iter().position(|pixel| pixel.iter().any(Fresh::is_unset)) {
        let missing = rgba.iter().filter(|pixel| pixel.iter().any(Fresh::is_unset)).count();
        let found = format!("{missing} without, the first {}", at(place));
        let error = whose.error("did not give every pixel a colour").got(found);
        return Err(
            error.expected(format!("one for each of the {} x {} pixels", picture.width, picture.height))
        );
    }
    match rgba.iter().position(|pixel| !good(pixel)) {
        None if rgba.len() == picture.rgba.len() => Ok(()),
        None => {
            Err(whose.error("gave a picture of another size").got(rgba.len()).expected(picture.rgba.len()))
        }
        Some(place) => {
            let error =
                whose.error("gave a pixel that is none").got(format!("{:?} {}", rgba[place], at(place)));
            Err(error.expected("finite numbers, the last (opacity) from 0 to 1"))
        }
    }
}
