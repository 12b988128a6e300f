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

/// Asks for large pages for the whole ones within a buffer that was not written yet.
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
}
