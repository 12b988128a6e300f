//! The 64-bit reference picture, kept in a folder under a key made of everything that it shows.

use super::Subject;
use super::picture_cache::{decode, decode_tiles, encode, encode_tiles};
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
use voltet_reference as reference;

/// The reference picture and what it cost.
#[derive(Debug, Clone)]
pub struct Reference {
    /// The picture.
    pub picture: Picture,
    /// Seconds that drawing it took, when it was drawn.
    pub seconds: f64,
    /// True if it was found in the folder.
    pub cached: bool,
}

/// Default folder of reference pictures: the user's cache folder.
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
