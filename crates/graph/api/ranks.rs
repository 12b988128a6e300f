//! Ranks: several processes that run one graph together, each with its own pieces of the grid.

use std::fmt::Debug;
use voltet_core::{Error, Result};

/// The processes of a run, as one of them sees them. All of them call the same functions in the same order.
pub trait Ranks: Send + Sync + Debug {
    /// Number of this process, from 0.
    fn rank(&self) -> usize;

    /// Number of processes.
    fn count(&self) -> usize;

    /// Sends bytes to each process, in order of their numbers, and gives what each has sent to this one.
    ///
    /// # Errors
    /// - another process ended, or the network failed.
    fn exchange(&self, to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>>;

    /// Waits until this process can send to the others; sends nothing. A run whose processes exchange nothing asks it before it works.
    ///
    /// # Errors
    /// - it never can.
    fn wait_for_start(&self) -> Result<()> {
        Ok(())
    }
}

/// The only process of a run.
#[derive(Debug, Clone, Copy)]
pub struct OneRank;

impl Ranks for OneRank {
    fn rank(&self) -> usize {
        0
    }

    fn count(&self) -> usize {
        1
    }

    fn exchange(&self, to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        Ok(to_each)
    }
}

/// Numbers of 64 bits as bytes that are sent.
pub fn to_bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// The numbers of [`to_bytes`].
///
/// # Errors
/// - another count of bytes.
pub fn from_bytes(bytes: &[u8]) -> Result<Vec<f64>> {
    let (numbers, rest) = bytes.as_chunks::<8>();
    if !rest.is_empty() {
        return Err(Error::run("another process sent a broken message")
            .got(bytes.len())
            .expected("whole numbers"));
    }
    Ok(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
}
