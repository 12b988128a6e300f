//! Processes that a launcher of MPI, such as `mpirun`, has started: their number, which is known before MPI itself is started.

/// Variables by which launchers tell a process how many there are: Open MPI's, that of MPICH and Intel MPI, and Slurm's, which starts
/// programs without MPI, too.
const COUNTS: &[&str] = match cfg!(feature = "mpi") {
    true => &["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"],
    false => &["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"],
};

/// Number of processes that the launcher has started together; `None` without a launcher.
pub fn launched_count() -> Option<usize> {
    COUNTS.iter().find_map(|name| std::env::var(name).ok()?.parse().ok())
}
