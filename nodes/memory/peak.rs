//! The largest resident memory of this process.

use super::kibibytes;

/// The largest so far, or since [`forget_peak`], in bytes; `None` where the system does not tell.
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
