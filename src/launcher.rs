//! Processes that a launcher of MPI, such as `mpirun`, has started: their numbers, which are known before MPI itself is started.

/// Variables by which launchers tell a process how many there are and which it is: Open MPI's, those of MPICH and Intel MPI, and Slurm's,
/// which starts programs without MPI, too.
const VARIABLES: &[[&str; 2]] = match cfg!(feature = "mpi") {
    true => &[OPEN_MPI, MPICH, ["SLURM_STEP_NUM_TASKS", "SLURM_PROCID"]],
    false => &[OPEN_MPI, MPICH],
};

const OPEN_MPI: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"];
const MPICH: [&str; 2] = ["PMI_SIZE", "PMI_RANK"];

fn number(variable: &str) -> Option<usize> {
    std::env::var(variable).ok()?.parse().ok()
}

/// Number of processes that the launcher has started together; `None` without a launcher.
pub fn launched_count() -> Option<usize> {
    VARIABLES.iter().find_map(|[count, _]| number(count))
}

/// Number of this process, from 0, among those of [`launched_count`]; `None` without a launcher, or where it does not say.
pub fn launched_rank() -> Option<usize> {
    VARIABLES.iter().find(|[count, _]| number(count).is_some()).and_then(|[_, rank]| number(rank))
}
