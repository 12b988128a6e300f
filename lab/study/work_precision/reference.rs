//! The 64-bit reference picture, kept in a folder under a key made of everything that it shows.

use super::Subject;
use std::path::{Path, PathBuf};
use std::time::Instant;
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_nodes::files::{self, Fnv};
use voltet_optics::WidgetBlend;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_optics::trace::tiles::{TILE_PIXELS, Tiles};
use voltet_reference as reference;

#[derive(Debug, Clone)]
pub struct Reference {
    pub picture: Picture,
    /// Seconds that drawing it took, when it was drawn.
    pub seconds: f64,
    /// True if it was found in the folder.
    pub cached: bool,
}

pub fn cache_folder() -> PathBuf {
    files::cache_folder().join("reference")
}

/// The picture that the scene means: every segment by adaptive quadrature, exact order, overlaps in their order.
///
/// A damaged kept picture is drawn anew; a stop keeps the tiles that are drawn, and the next call goes on from there. Errors: those of the referee, and a folder that cannot be written.
pub fn reference(subject: &Subject, folder: &Path, progress: &dyn Progress) -> Result<Reference> {
    let shading = Shading { overlap: WidgetBlend::Exact, ..subject.scene.shading };
    let scene = &Scene { shading, order: VisibilityOrder::Exact, ..subject.scene.clone() };
    let path = folder.join(format!("{:032x}.picture", key(scene)));
    let size = scene.camera.size.map(|n| n as usize);
    if let Some((picture, seconds)) = std::fs::read(&path).ok().and_then(|bytes| decode(&bytes, size)) {
        return Ok(Reference { picture, seconds, cached: true });
    }
    std::fs::create_dir_all(folder).map_err(|error| {
        let what = format!("the folder '{}' for reference pictures cannot be made", folder.display());
        Error::run(what).got(error).expected("--cache with a folder that can be written to")
    })?;
    files::refuse_unwritable(&path)?;
    let begun = path.with_extension("tiles");
    let (mut tiles, before) = std::fs::read(&begun).ok().and_then(|b| decode_tiles(&b)).unwrap_or_default();
    let start = Instant::now();
    let drawn = reference::draw_further(scene, &mut tiles, progress);
    let seconds = before + start.elapsed().as_secs_f64();
    match drawn {
        Ok(picture) => {
            files::write_whole(&path, &encode(&picture, seconds))?;
            // What is left of a stopped one has served.
            let _ = std::fs::remove_file(&begun);
            Ok(Reference { picture, seconds, cached: false })
        }
        Err(error) => {
            if error.kind == ErrorKind::Cancelled && !tiles.is_empty() {
                files::write_whole(&begun, &encode_tiles(&tiles, seconds))?;
            }
            Err(error)
        }
    }
}

/// A number made of the content: cells, values, transfer function, camera, light. Integrator, order, overlap and
/// the paths of files are of no account.
fn key(scene: &Scene) -> u128 {
    let mut hash = Fnv::default();
    hash.text(env!("CARGO_PKG_VERSION"));
    let Scene { volume, transfer_function, camera, shading, .. } = scene;
    // Debug prints every number so that it reads back the same.
    hash.text(&format!("{transfer_function:?}|{camera:?}|{:?}|{:?}", shading.light, shading.silhouette));
    volume.grid.points.iter().for_each(|p| hash.numbers(&p.to_array()));
    hash.text("cells");
    volume.grid.tetrahedra.iter().flatten().for_each(|corner| hash.bytes(&corner.to_le_bytes()));
    hash.text("values");
    hash.numbers(&volume.scalar);
    if transfer_function.uses_gradient_magnitude()
        && let Some(g) = &volume.gradient_magnitude
    {
        hash.text("gradient magnitude");
        hash.numbers(g);
    }
    if (shading.light.is_some() || shading.silhouette.is_some())
        && let Some(gradient) = &volume.gradient
    {
        hash.text("gradient");
        gradient.iter().for_each(|v| hash.numbers(&v.to_array()));
    }
    for name in transfer_function.fields() {
        hash.text(name);
        if let Some(array) = volume.grid.point_arrays.get(name) {
            hash.numbers(&array.values);
        }
    }
    hash.0
}

/// First bytes of a kept picture. The number changes with the format, and with the referee's meaning of a scene.
const MAGIC: &[u8; 16] = b"voltet picture 1";

/// First bytes of a picture that was stopped.
const MAGIC_TILES: &[u8; 16] = b"voltet tiles   1";

pub(super) fn encode(picture: &Picture, seconds: f64) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    [picture.width as u64, picture.height as u64].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    bytes.extend(seconds.to_le_bytes());
    picture.rgba.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    checked(bytes)
}

/// With a hash of the content behind it.
fn checked(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut check = Fnv::default();
    check.bytes(&bytes);
    bytes.extend(check.0.to_le_bytes());
    bytes
}

/// The content behind the first bytes; `None` for what is damaged or something else.
fn content<'a>(bytes: &'a [u8], magic: &[u8; 16]) -> Option<&'a [u8]> {
    let (content, check) = bytes.split_at_checked(bytes.len().checked_sub(16)?)?;
    let mut found = Fnv::default();
    found.bytes(content);
    content.strip_prefix(magic).filter(|_| check == found.0.to_le_bytes())
}

/// The picture and its seconds; `None` for what is damaged, of another size or another version.
pub(super) fn decode(bytes: &[u8], [width, height]: [usize; 2]) -> Option<(Picture, f64)> {
    let (head, pixels) = content(bytes, MAGIC)?.split_first_chunk::<24>()?;
    let number = |k: usize| <[u8; 8]>::try_from(&head[8 * k..8 * k + 8]).ok();
    let size = [u64::from_le_bytes(number(0)?), u64::from_le_bytes(number(1)?)];
    let sound = size == [width as u64, height as u64] && pixels.len() == 16 * width * height;
    let rgba = || pixels.chunks_exact(16).map(pixel).collect();
    Some((sound.then(|| Picture { width, height, rgba: rgba() })?, f64::from_le_bytes(number(2)?)))
}

fn pixel(bytes: &[u8]) -> [f32; 4] {
    std::array::from_fn(|k| f32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * k + byte])))
}

/// The tiles that are drawn, and the seconds that they took.
pub(super) fn encode_tiles(tiles: &Tiles, seconds: f64) -> Vec<u8> {
    let mut bytes = MAGIC_TILES.to_vec();
    bytes.extend(seconds.to_le_bytes());
    for (tile, pixels) in tiles {
        bytes.extend(tile.to_le_bytes());
        pixels.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    checked(bytes)
}

/// Tiles read back; `None` for what is damaged.
pub(super) fn decode_tiles(bytes: &[u8]) -> Option<(Tiles, f64)> {
    let (seconds, tiles) = content(bytes, MAGIC_TILES)?.split_first_chunk::<8>()?;
    let each = tiles.chunks_exact(4 + 16 * TILE_PIXELS);
    let whole = each.remainder().is_empty();
    let tiles = each.map(|bytes| {
        let (number, pixels) = bytes.split_at(4);
        let number = u32::from_le_bytes([number[0], number[1], number[2], number[3]]);
        (number, pixels.chunks_exact(16).map(pixel).collect())
    });
    whole.then(|| (tiles.collect(), f64::from_le_bytes(*seconds)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_picture_reads_back_and_a_damaged_one_does_not() {
        let picture = Picture { width: 2, height: 1, rgba: vec![[0.1, 2.5, 1e-20, 1.0], [0.0; 4]] };
        let bytes = encode(&picture, 3.5);
        assert_eq!(decode(&bytes, [2, 1]), Some((picture, 3.5)));
        assert_eq!(decode(&bytes, [1, 2]), None);
        for (place, _) in bytes.iter().enumerate() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert_eq!(decode(&damaged, [2, 1]), None, "byte {place}");
            assert_eq!(decode(&bytes[..place], [2, 1]), None, "cut at {place}");
        }
    }

    #[test]
    fn tiles_read_back_and_damaged_ones_do_not() {
        let pixels = |x: f32| vec![[x, 0.5, 1e-20, 1.0]; TILE_PIXELS];
        let tiles = Tiles::from([(0, pixels(0.25)), (7, pixels(3.5))]);
        let bytes = encode_tiles(&tiles, 2.5);
        assert_eq!(decode_tiles(&bytes), Some((tiles, 2.5)));
        assert_eq!(decode(&bytes, [16, 16]), None);
        for place in [0, 20, 30, 5000, bytes.len() - 1] {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert_eq!(decode_tiles(&damaged), None, "byte {place}");
            assert_eq!(decode_tiles(&bytes[..place]), None, "cut at {place}");
        }
    }
}
