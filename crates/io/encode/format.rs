//! The declaration of a format of pictures.

use crate::provenance::Provenance;
use std::io::{BufRead, Seek};
use voltet_core::Result;
use voltet_core::picture::Picture;

/// A format of picture files.
pub struct PictureFormat {
    /// Its name in pipelines, and the ending of its files.
    pub name: &'static str,
    /// Contents of its files, for help.
    pub summary: &'static str,
    /// First bytes of its files, at most 8.
    pub(super) signature: &'static [u8],
    /// The file of a picture. A format without opacity shows it over the background (linear RGB), and one that carries texts
    /// carries the provenance.
    pub encode: EncodePicture,
    /// The named texts that a file carries; `None`: the format carries none.
    pub(super) embedded_texts: Option<ReadTexts>,
}

/// Function that makes the bytes of a file: of a picture, over a background, with provenance.
pub type EncodePicture = fn(&Picture, [f64; 3], Option<&Provenance>) -> Result<Vec<u8>>;

/// Function that reads the named texts of a file.
pub(super) type ReadTexts = fn(&mut dyn PictureFile) -> Result<Vec<(String, String)>>;

/// A file that is read by parts.
pub(super) trait PictureFile: BufRead + Seek {}

impl<F: BufRead + Seek> PictureFile for F {}
