//! An array as it lies in a file, known from headers alone.

use super::codec::Codec;
use super::numbers::{ByteOrder, NumberType};
use super::source::Source;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// Progress of one reading, shared by all its arrays; counts bytes of the file.
pub(super) struct Meter<'a> {
    progress: &'a dyn Progress,
    done: AtomicU64,
    total: u64,
}

impl<'a> Meter<'a> {
    /// A meter over `total` bytes.
    pub fn new(progress: &'a dyn Progress, total: u64) -> Self {
        Meter { progress, done: AtomicU64::new(0), total: total.max(1) }
    }

    /// Progress, for code that reports by itself.
    pub fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    /// Says that `bytes` more were decoded; an error once the user has stopped the run.
    pub fn advance(&self, bytes: u64) -> Result<()> {
        let done = self.done.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.progress.report("reading", (done as f64 / self.total as f64).min(1.0));
        if self.progress.cancelled() { Err(Error::cancelled()) } else { Ok(()) }
    }
}

/// Makes the values of an array that no part of the file holds as such (PLOT3D's derived quantities).
pub(super) type Compute = Arc<dyn Fn(&Meter) -> Result<Vec<f64>> + Send + Sync>;

/// Location and encoding of the values.
#[derive(Clone)]
pub(super) enum Encoding {
    /// Bytes of the file, without a header.
    Bytes(u64),
    /// Words of text in these parts of the file.
    Text(Vec<Range<u64>>),
    /// The binary form of the VTK XML formats: a length or block table, then the values; `base64` text or bytes,
    /// between `at` and `end`.
    Xml { at: u64, end: u64, base64: bool, wide: bool, codec: Option<Codec> },
    /// Not in the file.
    Computed(Compute),
}

impl std::fmt::Debug for Encoding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Encoding::Bytes(at) => write!(f, "bytes from {at}"),
            Encoding::Text(parts) => write!(f, "text in {parts:?}"),
            Encoding::Xml { at, base64, codec, .. } => {
                write!(f, "XML binary at {at}, base64 {base64}, {codec:?}")
            }
            Encoding::Computed(_) => write!(f, "computed"),
        }
    }
}

/// An array that lies in a file.
#[derive(Debug, Clone)]
pub(super) struct Stored {
    pub source: Arc<Source>,
    pub name: String,
    pub number_type: NumberType,
    pub order: ByteOrder,
    /// Components of a tuple, at least 1.
    pub component_count: usize,
    /// Tuples that the headers promise; `None` where only the data itself tells.
    pub tuple_count: Option<u64>,
    pub encoding: Encoding,
}

impl Stored {
    /// Number of values that the headers promise.
    pub(super) fn promised(&self) -> Result<Option<u64>> {
        let Some(tuple_count) = self.tuple_count else { return Ok(None) };
        match tuple_count.checked_mul(self.component_count as u64).filter(|&n| n <= isize::MAX as u64 / 32) {
            Some(count) => Ok(Some(count)),
            None => Err(Error::run("the array cannot be that large")
                .got(format_args!("{tuple_count} tuples of {} components", self.component_count))),
        }
    }
}
