//! Memory for many numbers in large pages.
//!
//! The system gives memory a page at a time, when it is first written. A page of 4 KiB takes it about as long as a reader takes for the
//! numbers of the page, so Linux is asked for pages of 2 MiB (where /sys/kernel/mm/transparent_hugepage/enabled is `madvise`, as most
//! distributions have it; elsewhere nothing changes).

use bytemuck::Zeroable;

/// Bytes of a large page, of x86-64 and of 64-bit ARM with small pages of 4 KiB.
const LARGE_PAGE: usize = 2 << 20;

/// Numbers that are all zero, in large pages where they fill such.
pub(super) fn zeros<T: Zeroable + Clone>(count: usize) -> Vec<T> {
    let mut numbers = vec![T::zeroed(); count];
    advise(&mut numbers);
    numbers
}

/// Asks for large pages for the whole ones within a buffer.
///
/// It serves what was not written yet: the allocator takes buffers of more than 32 MiB from the system, and smaller ones, too, until the
/// program has freed some of their size. Memory that it uses again was written before; for that the advice changes nothing.
#[cfg(target_os = "linux")]
fn advise<T>(buffer: &mut [T]) {
    let bytes = size_of_val(buffer);
    let begin = buffer.as_mut_ptr().cast::<u8>();
    let skipped = begin.addr().next_multiple_of(LARGE_PAGE) - begin.addr();
    let len = bytes.saturating_sub(skipped) / LARGE_PAGE * LARGE_PAGE;
    if len > 0 {
        // SAFETY: the pages lie within the buffer, and the advice changes no byte of them.
        // That it is not followed is no error.
        unsafe { libc::madvise(begin.add(skipped).cast(), len, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise<T>(_: &mut [T]) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_zero_whatever_their_count() {
        for count in [0, 1, LARGE_PAGE / 8 - 1, LARGE_PAGE / 8 + 1, LARGE_PAGE] {
            let numbers: Vec<f64> = zeros(count);
            assert!(numbers.len() == count && numbers.iter().all(|&number| number == 0.0));
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn large_pages_are_asked_for() {
        if !std::path::Path::new("/sys/kernel/mm/transparent_hugepage").exists() {
            eprintln!("skipped: this Linux has no transparent large pages");
            return;
        }
        let numbers: Vec<f64> = zeros(32 * LARGE_PAGE / 8);
        let middle = numbers[numbers.len() / 2..].as_ptr().addr();
        let maps = std::fs::read_to_string("/proc/self/smaps").unwrap();
        let range = |line: &str| {
            let (begin, end) = line.split_once(' ')?.0.split_once('-')?;
            let address = |text| usize::from_str_radix(text, 16).ok();
            Some(address(begin)?..address(end)?)
        };
        let own = maps.lines().skip_while(|line| !range(line).is_some_and(|range| range.contains(&middle)));
        let flags = own.skip(1).find(|line| line.starts_with("VmFlags:")).unwrap();
        assert!(flags.split_whitespace().any(|flag| flag == "hg"), "{flags}");
    }
}
