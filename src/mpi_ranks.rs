//! Processes of MPI that run one graph together.

use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::environment::{is_finalized, is_initialized};
use mpi::ffi;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::mem::ManuallyDrop;
use voltet_core::{Error, Result};
use voltet_graph::ranks::Ranks;

/// The processes of a communicator of MPI. Functions are called on the thread that started MPI.
pub struct MpiRanks {
    communicator: ManuallyDrop<SimpleCommunicator>,
    rank: usize,
    count: usize,
}

// SAFETY: the handle is used on the thread that started MPI alone.
unsafe impl Send for MpiRanks {}
// SAFETY: as above.
unsafe impl Sync for MpiRanks {}

impl std::fmt::Debug for MpiRanks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "rank {} of {}", self.rank, self.count)
    }
}

impl Drop for MpiRanks {
    fn drop(&mut self) {
        // Without MPI nothing can be given back.
        if !is_finalized() {
            // SAFETY: once, as it is dropped itself.
            unsafe { ManuallyDrop::drop(&mut self.communicator) }
        }
    }
}

impl MpiRanks {
    /// The processes of MPI's world.
    pub fn world() -> MpiRanks {
        Self::new(SimpleCommunicator::world())
    }

    /// The processes of a communicator of a program that has started MPI, given by its number in Fortran (`MPI_Comm_c2f`); `None`: those
    /// of the world. Messages are apart from the program's. `None` where MPI does not run.
    ///
    /// # Errors
    /// - the null communicator.
    pub fn of_program(communicator: Option<i32>) -> Result<Option<MpiRanks>> {
        if !is_initialized() || is_finalized() {
            return Ok(None);
        }
        let Some(number) = communicator else {
            return Ok(Some(Self::new(SimpleCommunicator::world().duplicate())));
        };
        // SAFETY: a number that names no communicator is refused, or ends the program by MPI's own message.
        unsafe {
            let raw = ffi::RSMPI_Comm_f2c(number);
            if raw == ffi::RSMPI_COMM_NULL {
                let error = Error::usage("the number names no communicator of MPI").got(number);
                return Err(error.expected("MPI_Comm_c2f(communicator)"));
            }
            let given = ManuallyDrop::new(SimpleCommunicator::from_raw(raw));
            Ok(Some(Self::new(given.duplicate())))
        }
    }

    fn new(communicator: SimpleCommunicator) -> MpiRanks {
        let [rank, count] = [communicator.rank(), communicator.size()].map(|number| number as usize);
        MpiRanks { communicator: ManuallyDrop::new(communicator), rank, count }
    }
}

/// Ends all processes.
pub fn abort(exit_code: u8) -> ! {
    SimpleCommunicator::world().abort(exit_code.into())
}

impl Ranks for MpiRanks {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.count
    }

    fn exchange(&self, to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        let world = &*self.communicator;
        let lengths: Vec<u64> = to_each.iter().map(|bytes| bytes.len() as u64).collect();
        let mut incoming = vec![0_u64; self.count];
        world.all_to_all_into(&lengths[..], &mut incoming[..]);
        let longest = lengths.iter().chain(&incoming).copied().max().unwrap_or(0);
        let mut longest_of_all = 0_u64;
        world.all_reduce_into(&longest, &mut longest_of_all, SystemOperation::max());
        let mut received: Vec<Vec<u8>> =
            incoming.iter().map(|&length| Vec::with_capacity(length as usize)).collect();
        // MPI counts by 31 bits.
        let most = (i32::MAX as usize / self.count).max(1);
        let mut from = 0;
        while (from as u64) < longest_of_all {
            let share = |length: usize| length.saturating_sub(from).min(most);
            let parts = to_each.iter().map(|bytes| &bytes[from.min(bytes.len())..][..share(bytes.len())]);
            // The address of no bytes is 1 in Rust, and in MPI the sign of a transfer in place.
            let end = &[0][..];
            let out = parts.chain([end]).collect::<Vec<_>>().concat();
            let counts: Vec<i32> = to_each.iter().map(|bytes| share(bytes.len()) as i32).collect();
            let own: Vec<i32> = incoming.iter().map(|&length| share(length as usize) as i32).collect();
            let mut buffer = vec![0_u8; own.iter().map(|&count| count as usize).sum::<usize>() + 1];
            let (sent, taken) = (starts(&counts), starts(&own));
            world.all_to_all_varcount_into(
                &Partition::new(&out[..], &counts[..], &sent[..]),
                &mut PartitionMut::new(&mut buffer[..], &own[..], &taken[..]),
            );
            for ((bytes, &start), &count) in received.iter_mut().zip(&taken).zip(&own) {
                bytes.extend_from_slice(&buffer[start as usize..][..count as usize]);
            }
            from += most;
        }
        Ok(received)
    }
}

/// The sum of the counts before each.
fn starts(counts: &[i32]) -> Vec<i32> {
    counts.iter().scan(0, |sum, count| Some(std::mem::replace(sum, *sum + count))).collect()
}
