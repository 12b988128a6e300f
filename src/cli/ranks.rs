//! Processes of one run that an MPI launcher has started, `mpirun -n 4 voltet run scene.toml`: each reads and draws its own pieces of the
//! grid, the first one writes.

#[cfg(feature = "mpi")]
use crate::cli::present;
use crate::cli::present::{hold_back, say};
use crate::core::{Error, Result};
use crate::graph::ranks::{OneRank, Ranks};
#[cfg(feature = "mpi")]
use crate::lanes::LaneSet;
#[cfg(feature = "mpi")]
use crate::launched_ranks::LaunchedRanks;
use crate::launcher::launched_count;
#[cfg(feature = "mpi")]
use crate::launcher::launched_rank;
use std::cell::Cell;
use std::sync::Arc;

/// The processes of this run; MPI ends with it.
pub struct Launch {
    pub ranks: Arc<dyn Ranks>,
    /// True once the failure of this process was announced.
    is_announced: Cell<bool>,
    /// The processes by MPI, where there are several.
    #[cfg(feature = "mpi")]
    several: Option<Arc<LaunchedRanks>>,
}

impl Launch {
    /// Joins the other processes, if a launcher started any. Those after the first say nothing from here on but why they fail.
    /// `is_apart`: each has pictures of its own, and none waits for another.
    /// Errors: several processes of a program that was built without MPI; a launcher that does not number them.
    pub fn join(is_apart: bool) -> Result<Launch> {
        let count = launched_count();
        let launch = match count {
            Some(2..) if !is_apart => Launch::of_several(count.unwrap_or_default())?,
            _ => Launch {
                ranks: Arc::new(OneRank),
                is_announced: Cell::new(false),
                #[cfg(feature = "mpi")]
                several: None,
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
        let error = || Error::run("the launcher does not tell a process which of several it is").got(count);
        let rank = launched_rank().ok_or_else(|| error().expected("mpirun, or srun"))?;
        // While MPI starts the environment is not read: what comes of it is found before.
        LaneSet::detect()?;
        rayon::current_num_threads();
        present::is_plain();
        let several = Arc::new(LaunchedRanks::start(rank, count)?);
        Ok(Launch { ranks: several.clone(), is_announced: Cell::new(false), several: Some(several) })
    }

    /// Names the process that fails, before its error is shown, once. Where all fail alike the first one ends the others meanwhile.
    pub fn announce_failure(&self) {
        let (rank, count) = (self.ranks.rank(), self.ranks.count());
        if count > 1 && !self.is_announced.replace(true) {
            // As long as a launcher takes to end them; where MPI does not start, none ends another.
            let is_waiting = rank > 0 && self.ranks.wait_for_start().is_ok();
            let patience = if is_waiting { 2000 + 300 * rank.min(10) as u64 } else { 0 };
            std::thread::sleep(std::time::Duration::from_millis(patience));
            hold_back(false);
            say(&format!("rank {rank} of {count}{} fails:\n", self.machine()));
        }
    }

    /// Ends all processes where there are several: the others wait for this one. Where MPI does not start, returns.
    pub fn end_all(&self, _exit_code: u8) {
        #[cfg(feature = "mpi")]
        if let Some(several) = &self.several {
            // A launcher that ends the processes drops what it has not passed on of their messages; MPICH's does so often.
            std::thread::sleep(std::time::Duration::from_millis(500));
            several.abort(_exit_code);
        }
    }

    /// ", on the machine NAME,".
    fn machine(&self) -> String {
        #[cfg(feature = "mpi")]
        if let Some(name) = self.several.as_ref().and_then(|several| several.machine()) {
            return format!(", on {name},");
        }
        String::new()
    }
}
