//! Memory of the process: bytes still available, and the peak that was resident.

/// Bytes that this process may still take: what the system has left, and what limits on the process leave of it. `None` where
/// the system does not tell.
pub fn available() -> Option<u64> {
    [system_available(), group(), address_space()].into_iter().flatten().min()
}

/// Memory that Linux has for new work without swapping.
fn system_available() -> Option<u64> {
    kibibytes(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// Memory that the process's control groups leave (version 2: every group up to the root; version 1: the mounted one).
fn group() -> Option<u64> {
    let of_process = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let own = of_process.lines().find_map(|line| line.strip_prefix("0::/")).unwrap_or_default();
    let root = std::path::Path::new("/sys/fs/cgroup");
    let own = root.join(own);
    let groups = own.ancestors().take_while(|folder| folder.starts_with(root));
    let second =
        groups.filter_map(|folder| cgroup_available(folder, "memory.max", "memory.current", "inactive_file"));
    let first = cgroup_available(
        &root.join("memory"),
        "memory.limit_in_bytes",
        "memory.usage_in_bytes",
        "total_inactive_file",
    );
    second.chain(first).min()
}

/// Memory that one group leaves; idle cached files give way.
fn cgroup_available(folder: &std::path::Path, limit: &str, used: &str, idle: &str) -> Option<u64> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let limit: u64 = read(limit)?.trim().parse().ok()?;
    let used: u64 = read(used)?.trim().parse().ok()?;
    let statistics = read("memory.stat").unwrap_or_default();
    let idle =
        statistics.lines().find_map(|line| line.strip_prefix(idle)?.trim().parse().ok()).unwrap_or(0u64);
    Some(limit.saturating_sub(used.saturating_sub(idle)))
}

/// Bytes that the limit on the address space (`ulimit -v`) leaves; `None` where there is none, or the system does not tell.
pub fn address_space() -> Option<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let used = kibibytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some(limit.saturating_sub(used))
}

/// The number of a line such as "VmSize:  1024 kB", in bytes.
fn kibibytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// The largest resident memory so far, or since [`forget_peak`], in bytes; `None` where the system does not tell.
pub fn peak() -> Option<u64> {
    kibibytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// Lets the system's count of it begin anew (Linux: proc(5), clear_refs); whether it does.
pub fn forget_peak() -> bool {
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_of_memory_is_forgotten_and_found_again() {
        if !forget_peak() {
            eprintln!("skipped: this system does not let a process forget its peak");
            return;
        }
        let touched = |mebibytes: usize| std::hint::black_box(vec![1u8; mebibytes << 20]).len();
        touched(256);
        let high = peak().unwrap();
        assert!(forget_peak());
        touched(16);
        let low = peak().unwrap();
        // Other tests of this process may hold some memory.
        assert!(high > low + (64 << 20), "{high} {low}");
    }
}
