//! The tiles of the 64-bit reference picture, kept in a folder under a key made of everything that it shows.

use super::Subject;
use std::path::{Path, PathBuf};
use std::time::Instant;
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
/// Damaged tiles are drawn anew; a stop keeps the tiles that are drawn, and the next call goes on from there. Errors: those of the
/// referee, and a folder that cannot be written.
pub fn reference(subject: &Subject, folder: &Path, progress: &dyn Progress) -> Result<Reference> {
    let shading = Shading { overlap: WidgetBlend::Exact, ..subject.scene.shading };
    let scene = &Scene { shading, order: VisibilityOrder::Exact, ..subject.scene.clone() };
    let path = folder.join(format!("{:032x}.tiles", key(scene)));
    let kept = std::fs::read(&path).ok().and_then(|bytes| decode(&bytes));
    if kept.is_none() {
        std::fs::create_dir_all(folder).map_err(|error| {
            let what = format!("the folder '{}' for reference pictures cannot be made", folder.display());
            Error::run(what).got(error).expected("--cache with a folder that can be written to")
        })?;
        files::refuse_unwritable(&path)?;
    }
    let (mut tiles, mut seconds) = kept.unwrap_or_default();
    let count = tiles.len();
    let start = Instant::now();
    let drawn = reference::draw_further(scene, &mut tiles, progress);
    let cached = tiles.len() == count;
    if !cached {
        seconds += start.elapsed().as_secs_f64();
        files::write_whole(&path, &encode(&tiles, seconds))?;
    }
    Ok(Reference { picture: drawn?, seconds, cached })
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

/// First bytes of kept tiles. The number changes with the format, and with the referee's meaning of a scene.
const MAGIC: &[u8; 16] = b"voltet tiles   2";

/// The tiles that are drawn, and the seconds that they took.
/// A hash of the content stands behind it.
fn encode(tiles: &Tiles, seconds: f64) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(seconds.to_le_bytes());
    for (tile, pixels) in tiles {
        bytes.extend(tile.to_le_bytes());
        pixels.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    bytes.extend(check(&bytes));
    bytes
}

fn check(content: &[u8]) -> [u8; 16] {
    let mut check = Fnv::default();
    check.bytes(content);
    check.0.to_le_bytes()
}

/// Tiles read back; `None` for what is damaged.
fn decode(bytes: &[u8]) -> Option<(Tiles, f64)> {
    let (content, behind) = bytes.split_last_chunk()?;
    let content = content.strip_prefix(MAGIC).filter(|_| check(content) == *behind)?;
    let (seconds, tiles) = content.split_first_chunk()?;
    let tiles = tiles.as_chunks().0.chunks_exact(1 + 4 * TILE_PIXELS).map(|words| {
        let pixels = words[1..].as_chunks().0.iter().map(|pixel: &[_; 4]| pixel.map(f32::from_le_bytes));
        (u32::from_le_bytes(words[0]), pixels.collect())
    });
    Some((tiles.collect(), f64::from_le_bytes(*seconds)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_read_back_and_damaged_ones_do_not() {
        let pixels = |x: f32| vec![[x, 0.5, 1e-20, 1.0]; TILE_PIXELS];
        let tiles = Tiles::from([(0, pixels(0.25)), (7, pixels(3.5))]);
        let bytes = encode(&tiles, 2.5);
        assert_eq!(decode(&bytes), Some((tiles, 2.5)));
        for place in [0, 20, 30, 5000, bytes.len() - 1] {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert_eq!(decode(&damaged), None, "byte {place}");
            assert_eq!(decode(&bytes[..place]), None, "cut at {place}");
        }
    }
}
