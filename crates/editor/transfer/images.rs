//! The pictures of table widgets: read by a thread of their own, and drawn as textures.

use crate::threads;
use eframe::egui::{Color32, ColorImage, Context, Rgba, TextureHandle, TextureOptions};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;
use voltet_core::colormap::ColorCurve;
use voltet_core::error::system_words;
use voltet_core::transfer::LoadFiles;

/// The most texels along a side that are drawn: as fine as the histogram below. Larger pictures are drawn by the means of blocks.
const FINEST: usize = 256;

/// Texels of a picture: width, height, and straight linear RGBA from the top row on.
type Texels = (usize, usize, Vec<[f32; 4]>);

/// A picture as it is drawn.
pub(super) struct Image {
    texels: Texels,
    pub texture: TextureHandle,
}

/// Result of reading a picture, or the reason why it cannot be read; `None` while it is read.
type State = Option<Result<Arc<Image>, String>>;

/// A file, and when it was written.
type Key = (PathBuf, Option<SystemTime>);

#[derive(Clone, Default)]
pub(super) struct Images {
    ctx: Context,
    folder: PathBuf,
    known: Arc<Mutex<HashMap<Key, State>>>,
}

impl Images {
    /// This cache, for widgets of a file in another folder.
    pub fn in_folder(&self, ctx: &Context, folder: PathBuf) -> Images {
        Images { ctx: ctx.clone(), folder, known: self.known.clone() }
    }

    /// A picture; it is read where it was not, or where the file is another since.
    pub fn get(&self, path: &str) -> State {
        let path = self.folder.join(path);
        let written = std::fs::metadata(&path).and_then(|data| data.modified()).ok();
        let key = (path, written);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let begin = || {
            let (images, ctx, key) = (self.known.clone(), self.ctx.clone(), key.clone());
            let read = move || {
                let found = read(&ctx, &key.0);
                let mut images = images.lock().unwrap_or_else(PoisonError::into_inner);
                images.retain(|(path, _), _| *path != key.0);
                images.insert(key, Some(found));
                drop(images);
                ctx.request_repaint();
            };
            let thread = threads::begin("image", read);
            thread.err().map(|error| Err(format!("no thread can be started: {}", system_words(&error))))
        };
        known.entry(key.clone()).or_insert_with(begin).clone()
    }
}

impl LoadFiles for Images {
    /// One clear texel while the picture is unknown.
    fn image(&self, path: &str) -> voltet_core::Result<Texels> {
        let found = self.get(path).and_then(Result::ok);
        Ok(found.map_or_else(|| (1, 1, vec![[0.0; 4]]), |image| image.texels.clone()))
    }

    fn colors(&self, path: &str) -> voltet_core::Result<ColorCurve> {
        voltet_io::colormaps::read(&self.folder.join(path))
    }
}

fn read(ctx: &Context, path: &Path) -> Result<Arc<Image>, String> {
    let texels = reduced(voltet_nodes::table_image(path).map_err(|error| error.to_string())?);
    let (width, height, all) = &texels;
    let shown = |&[r, g, b, a]: &[f32; 4]| {
        let [r, g, b] = [r, g, b].map(|x| x.clamp(0.0, 1.0));
        Color32::from(Rgba::from_rgba_unmultiplied(r, g, b, a))
    };
    let image = ColorImage::new([*width, *height], all.iter().map(shown).collect());
    let texture = ctx.load_texture(path.display().to_string(), image, TextureOptions::LINEAR);
    Ok(Arc::new(Image { texels, texture }))
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
