//! The 64-bit reference picture, kept in a folder under a key made of everything that it shows.

use super::Scene;
use std::path::{Path, PathBuf};
use std::time::Instant;
use voltet_core::optics::Overlap;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::reference;
use voltet_core::shading::{Order, Shading};
use voltet_core::{Error, Result};
use voltet_nodes::files;

/// First bytes of a kept picture. The number changes with the format, and with the referee's meaning of a scene.
const MAGIC: &[u8; 16] = b"voltet picture 1";

/// The reference picture and what it cost.
#[derive(Debug, Clone)]
pub struct Reference {
    /// The picture.
    pub picture: Picture,
    /// Seconds that drawing it took, when it was drawn.
    pub seconds: f64,
    /// Whether it was found in the folder.
    pub cached: bool,
}

/// Where pictures are kept when nothing else is said: the user's cache folder.
pub fn cache_folder() -> PathBuf {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = || {
        set("HOME").map(|home| home.join(if cfg!(target_os = "macos") { "Library/Caches" } else { ".cache" }))
    };
    let base = set("XDG_CACHE_HOME").or_else(|| set("LOCALAPPDATA")).or_else(home);
    base.unwrap_or_else(std::env::temp_dir).join("voltet").join("reference")
}

/// The picture that the scene means: every segment by adaptive quadrature, exact order, overlaps in their order.
///
/// A damaged kept picture is drawn anew. Errors: those of the referee, and a folder that cannot be written.
pub fn reference(scene: &Scene, folder: &Path, progress: &dyn Progress) -> Result<Reference> {
    let path = folder.join(format!("{:032x}.picture", key(scene)));
    let size = scene.camera.size.map(|n| n as usize);
    if let Some((picture, seconds)) = std::fs::read(&path).ok().and_then(|bytes| decode(&bytes, size)) {
        return Ok(Reference { picture, seconds, cached: true });
    }
    std::fs::create_dir_all(folder).map_err(|error| {
        let what = format!("the folder '{}' for reference pictures cannot be made", folder.display());
        Error::run(what).found(error).accepted("--cache with a folder that can be written to")
    })?;
    files::refuse_unwritable(&path)?;
    let start = Instant::now();
    let shading = Shading { overlap: Overlap::Exact, ..scene.shading };
    let Scene { volume, transfer_function, camera, .. } = scene;
    let picture = reference::draw(volume, transfer_function, camera, &shading, Order::Exact, progress)?;
    let seconds = start.elapsed().as_secs_f64();
    files::write_whole(&path, &encode(&picture, seconds))?;
    Ok(Reference { picture, seconds, cached: false })
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

/// FNV-1a of 128 bits (Fowler, Noll, Vo; RFC 9923), which stays the same from build to build.
struct Fnv(u128);

impl Default for Fnv {
    fn default() -> Self {
        Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }
}

impl Fnv {
    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// With its length, so that two texts are not one.
    fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u64).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    fn numbers(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|x| self.bytes(&x.to_bits().to_le_bytes()));
    }
}

fn encode(picture: &Picture, seconds: f64) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    [picture.width as u64, picture.height as u64].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    bytes.extend(seconds.to_le_bytes());
    picture.rgba.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    let mut check = Fnv::default();
    check.bytes(&bytes);
    bytes.extend(check.0.to_le_bytes());
    bytes
}

/// The picture and its seconds; `None` for what is damaged, of another size or another version.
fn decode(bytes: &[u8], [width, height]: [usize; 2]) -> Option<(Picture, f64)> {
    let (content, check) = bytes.split_at_checked(bytes.len().checked_sub(16)?)?;
    let mut found = Fnv::default();
    found.bytes(content);
    let (magic, content) = content.split_at_checked(MAGIC.len())?;
    let (head, pixels) = content.split_first_chunk::<24>()?;
    let number = |k: usize| <[u8; 8]>::try_from(&head[8 * k..8 * k + 8]).ok();
    let size = [u64::from_le_bytes(number(0)?), u64::from_le_bytes(number(1)?)];
    let sound = magic == MAGIC
        && check == found.0.to_le_bytes()
        && size == [width as u64, height as u64]
        && pixels.len() == 16 * width * height;
    let float = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let pixel = |bytes: &[u8]| std::array::from_fn(|k| float(&bytes[4 * k..4 * k + 4]));
    let rgba = || pixels.chunks_exact(16).map(pixel).collect();
    Some((sound.then(|| Picture { width, height, rgba: rgba() })?, f64::from_le_bytes(number(2)?)))
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
    fn the_hash_is_the_published_one() {
        // RFC 9923 gives the value for no input (the basis) and for "a".
        let mut hash = Fnv::default();
        hash.bytes(b"a");
        assert_eq!(hash.0, 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
    }
}
