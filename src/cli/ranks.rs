//! Processes of one run that an MPI launcher has started, `mpirun -n 4 voltet run scene.toml`: each reads and draws its own pieces of the
//! grid, the first one writes.

use crate::cli::present::{hold_back, say};
use crate::core::{Error, Result};
use crate::graph::ranks::{OneRank, Ranks};
use std::cell::Cell;
use std::sync::Arc;

/// Variables by which launchers tell a process how many there are: Open MPI's, that of MPICH and Intel MPI, and Slurm's, which starts
/// programs without MPI, too.
const COUNTS: &[&str] = match cfg!(feature = "mpi") {
    true => &["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"],
    false => &["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"],
};

/// The processes of this run; MPI ends with it.
pub struct Launch {
    pub ranks: Arc<dyn Ranks>,
    /// True once the failure of this process was announced.
    is_announced: Cell<bool>,
    #[cfg(feature = "mpi")]
    _universe: Option<mpi::environment::Universe>,
}

impl Launch {
    /// Joins the other processes, if a launcher started any. Those after the first say nothing from here on but why they fail.
    /// `is_apart`: each has pictures of its own, and none waits for another.
    ///
    /// # Errors
    /// - several processes of a program that was built without MPI; an MPI that does not start.
    pub fn join(is_apart: bool) -> Result<Launch> {
        let count = COUNTS.iter().find_map(|name| std::env::var(name).ok()?.parse::<usize>().ok());
        let launch = match count {
            Some(2..) if !is_apart => Launch::of_several(count.unwrap_or_default())?,
            _ => Launch {
                ranks: Arc::new(OneRank),
                is_announced: Cell::new(false),
                #[cfg(feature = "mpi")]
                _universe: None,
            },
        };
        hold_back(launch.ranks.rank() > 0);
        Ok(launch)
    }

    #[cfg(not(feature = "mpi"))]
    fn of_several(count: usize) -> Result<Launch> {
        let error = Error::usage("the program was built without MPI, and is run by several processes");
        let expected =
            "a program built by: cargo build --release --features mpi; one process; or --part for each";
        Err(error.got(format!("{count} of them")).expected(expected))
    }

    #[cfg(feature = "mpi")]
    fn of_several(count: usize) -> Result<Launch> {
        let (universe, _) = mpi::initialize_with_threading(mpi::Threading::Funneled)
            .ok_or_else(|| Error::run("MPI does not start: it was started before"))?;
        let ranks = by_mpi::MpiRanks::new();
        if ranks.count() != count {
            let error =
                Error::run("the launcher is of another MPI than the one that the program was built with");
            let found = format!("{count} processes, of which MPI knows {}", ranks.count());
            return Err(error
                .got(found)
                .expected("mpirun of the same MPI as mpicc when it was built, or --part for each"));
        }
        Ok(Launch { ranks: Arc::new(ranks), is_announced: Cell::new(false), _universe: Some(universe) })
    }

    /// Names the process that fails, before its error is shown, once. Where all fail alike the first one ends the others meanwhile.
    pub fn announce_failure(&self) {
        let (rank, count) = (self.ranks.rank(), self.ranks.count());
        if count > 1 && !self.is_announced.replace(true) {
            // As long as a launcher takes to end them.
            let patience = if rank == 0 { 0 } else { 2000 + 300 * rank.min(10) as u64 };
            std::thread::sleep(std::time::Duration::from_millis(patience));
            hold_back(false);
            say(&format!("rank {rank} of {count}{} fails:\n", host()));
        }
    }

    /// Ends all processes where there are several: the others wait for this one.
    pub fn end_all(&self, _exit_code: u8) {
        #[cfg(feature = "mpi")]
        if self.ranks.count() > 1 {
            by_mpi::abort(_exit_code);
        }
    }
}

/// ", on the machine NAME".
fn host() -> String {
    #[cfg(feature = "mpi")]
    if let Ok(name) = mpi::environment::processor_name() {
        return format!(", on {name},");
    }
    String::new()
}

#[cfg(feature = "mpi")]
mod by_mpi {
    use super::{Ranks, Result};
    use mpi::collective::SystemOperation;
    use mpi::datatype::{Partition, PartitionMut};
    use mpi::topology::SimpleCommunicator;
    use mpi::traits::*;

    /// The processes of MPI's world. Functions are called on the thread that started MPI.
    #[derive(Debug)]
    pub struct MpiRanks {
        rank: usize,
        count: usize,
    }

    impl MpiRanks {
        pub fn new() -> MpiRanks {
            let world = SimpleCommunicator::world();
            MpiRanks { rank: world.rank() as usize, count: world.size() as usize }
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
            let world = SimpleCommunicator::world();
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
                let mut out: Vec<u8> = parts.flatten().copied().collect();
                out.push(0);
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
}
