//! The pictures of table widgets: read by a thread of their own, and drawn as textures.

use eframe::egui::{Color32, ColorImage, Context, Rgba, TextureHandle, TextureId, TextureOptions};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// The most texels along a side that are drawn: as fine as the histogram below. Larger pictures are drawn by the means of blocks.
const FINEST: usize = 256;

/// Texels of a picture: width, height, and straight linear RGBA from the top row on.
type Texels = (usize, usize, Vec<[f32; 4]>);

enum State {
    Coming,
    Here { texels: Texels, texture: TextureHandle },
    Failed(String),
}

/// A file, and when it was written.
type Key = (PathBuf, Option<SystemTime>);

#[derive(Clone, Default)]
pub(super) struct Images {
    ctx: Context,
    /// Folder of relative paths.
    folder: PathBuf,
    known: Arc<Mutex<HashMap<Key, State>>>,
}

impl Images {
    /// This cache, for widgets of a file in another folder.
    pub fn in_folder(&self, ctx: &Context, folder: PathBuf) -> Images {
        Images { ctx: ctx.clone(), folder, known: self.known.clone() }
    }

    /// Texels of a picture; one clear texel while it is unknown.
    pub fn texels(&self, path: &str) -> Texels {
        self.look(path, |state| match state {
            State::Here { texels, .. } => texels.clone(),
            State::Coming | State::Failed(_) => (1, 1, vec![[0.0; 4]]),
        })
    }

    pub fn texture(&self, path: &str) -> Option<TextureId> {
        self.look(path, |state| match state {
            State::Here { texture, .. } => Some(texture.id()),
            State::Coming | State::Failed(_) => None,
        })
    }

    pub fn fault(&self, path: &str) -> Option<String> {
        self.look(path, |state| match state {
            State::Failed(why) => Some(why.clone()),
            State::Coming | State::Here { .. } => None,
        })
    }

    /// Looks at a picture; it is read where it was not, or where the file is another since.
    fn look<T>(&self, path: &str, look: impl FnOnce(&State) -> T) -> T {
        let path = self.folder.join(path);
        let written = std::fs::metadata(&path).and_then(|data| data.modified()).ok();
        let key = (path, written);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let state = known.entry(key.clone()).or_insert_with(|| {
            let (images, ctx) = (self.known.clone(), self.ctx.clone());
            let read = move || {
                let state = read(&ctx, &key.0);
                let mut images = images.lock().unwrap_or_else(PoisonError::into_inner);
                images.retain(|(path, _), _| *path != key.0);
                images.insert(key, state);
                drop(images);
                ctx.request_repaint();
            };
            match std::thread::Builder::new().name("image".into()).spawn(read) {
                Ok(_) => State::Coming,
                Err(error) => State::Failed(format!("no thread can be started: {error}")),
            }
        });
        look(state)
    }
}

fn read(ctx: &Context, path: &Path) -> State {
    match voltet_nodes::table_image(path) {
        Err(error) => State::Failed(error.to_string()),
        Ok(texels) => {
            let texels = reduced(texels);
            let (width, height, all) = &texels;
            let shown = |&[r, g, b, a]: &[f32; 4]| {
                let [r, g, b] = [r, g, b].map(|x| x.clamp(0.0, 1.0));
                Color32::from(Rgba::from_rgba_unmultiplied(r, g, b, a))
            };
            let image = ColorImage { size: [*width, *height], pixels: all.iter().map(shown).collect() };
            let name = path.display().to_string();
            State::Here { texture: ctx.load_texture(name, image, TextureOptions::LINEAR), texels }
        }
    }
}

/// The picture by the means of blocks, so that no side has more than the finest; colours weigh as much as they cover.
fn reduced((width, height, texels): Texels) -> Texels {
    let block = width.max(height).div_ceil(FINEST);
    if block <= 1 {
        return (width, height, texels);
    }
    let (wide, high) = (width.div_ceil(block), height.div_ceil(block));
    let mean = |place: usize| {
        let (i, j) = (place % wide * block, place / wide * block);
        let rows = j..(j + block).min(height);
        let all = rows.flat_map(|row| &texels[row * width + i..row * width + (i + block).min(width)]);
        let (mut sum, mut count) = ([0.0; 4], 0.0);
        for [r, g, b, a] in all {
            [r * a, g * a, b * a, *a].iter().zip(&mut sum).for_each(|(x, sum)| *sum += x);
            count += 1.0;
        }
        let [r, g, b, a] = sum;
        if a > 0.0 { [r / a, g / a, b / a, a / count] } else { [0.0; 4] }
    };
    (wide, high, (0..wide * high).map(mean).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_means_in_which_clear_texels_have_no_colour() {
        let texel = |i: usize| if i < 512 { [1.0, 0.0, 0.0, 0.5] } else { [0.0, 1.0, 0.0, 0.0] };
        let (width, height, texels) = reduced((512, 2, (0..1024).map(texel).collect()));
        assert_eq!((width, height, texels.len()), (256, 1, 256));
        assert!(texels.iter().all(|texel| *texel == [1.0, 0.0, 0.0, 0.25]), "{:?}", texels[0]);
        // What is left over at the ends has a block of its own.
        let (width, height, texels) = reduced((257, 1, vec![[0.5, 0.25, 1.0, 1.0]; 257]));
        assert_eq!((width, height, texels.last()), (129, 1, Some(&[0.5, 0.25, 1.0, 1.0])));
    }
}
