//! Checks of a library's file before the system's loader maps it: for a file of another kind or processor, or a truncated one, the
//! loader gives a poor message, or crashes. A file damaged elsewhere can still crash.

use crate::ffi::ValidationError;

/// Errors: the file is no library of this system, or truncated.
#[cfg(not(target_os = "linux"))]
pub(crate) fn check(_: &[u8]) -> Result<(), ValidationError> {
    Ok(())
}

/// The ELF header and the program headers (System V ABI, chapters 4 and 5).
#[cfg(target_os = "linux")]
pub(crate) fn check(bytes: &[u8]) -> Result<(), ValidationError> {
    check_bytes(bytes, &own_head()?)
}

/// Hash of all bytes. Each step is a bijection, so that a change in one word of 8 bytes always shows; a change in several, except
/// for a chance of 2⁻⁶⁴.
pub(crate) fn fingerprint(bytes: &[u8]) -> u64 {
    let mix = |sum: u64, word: u64| (sum.rotate_left(29) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let (words, rest) = bytes.as_chunks::<8>();
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    let all = words.iter().chain([&last]).map(|word| u64::from_le_bytes(*word));
    all.fold(bytes.len() as u64, mix)
}

/// The first bytes of this program: class, byte order and processor that a library must share.
#[cfg(target_os = "linux")]
fn own_head() -> Result<Vec<u8>, ValidationError> {
    use std::io::Read;
    let mut head = vec![0; HEAD];
    std::fs::File::open("/proc/self/exe")
        .and_then(|mut file| file.read_exact(&mut head))
        .map_err(|error| format!("this program cannot be read: {error}"))?;
    Ok(head)
}

#[cfg(target_os = "linux")]
const HEAD: usize = 64;

#[cfg(target_os = "linux")]
fn check_bytes(bytes: &[u8], own: &[u8]) -> Result<(), ValidationError> {
    if !bytes.starts_with(b"\x7fELF") {
        return Err(match bytes.is_empty() {
            true => "the file is empty".into(),
            false => "the file is no shared library (it does not begin as one)".into(),
        });
    }
    if bytes.len() < HEAD {
        return Err("the file is cut off: its header is not whole".into());
    }
    if bytes[4..6] != own[4..6] || bytes[18..20] != own[18..20] {
        return Err("it is a library for another processor".into());
    }
    // Little-endian 64-bit files only are looked into; others are left to the loader.
    if bytes[4..6] != [2, 1] {
        return Ok(());
    }
    let number = |at: usize, width: usize| -> Option<u64> {
        let field = bytes.get(at..at.checked_add(width)?)?;
        Some(field.iter().rev().fold(0, |sum, &byte| sum << 8 | u64::from(byte)))
    };
    let wrong = || "the file is damaged: its header contradicts itself".to_string();
    if number(16, 2) != Some(3) {
        return Err("it is a program or an object file, not a shared library".into());
    }
    let (table, size, count) = (number(32, 8), number(54, 2), number(56, 2));
    let (Some(table), Some(56), Some(count @ 1..=256)) = (table, size, count) else { return Err(wrong()) };
    for i in 0..count {
        let at = table.checked_add(56 * i).and_then(|at| usize::try_from(at).ok()).ok_or_else(wrong)?;
        let field = |offset: usize, width| at.checked_add(offset).and_then(|at| number(at, width));
        let (kind, begin, length) = (field(0, 4), field(8, 8), field(32, 8));
        let (Some(kind), Some(begin), Some(length)) = (kind, begin, length) else { return Err(wrong()) };
        // PT_LOAD: what the loader maps. Overrun the end of the file there is nothing to map.
        if kind == 1 && begin.checked_add(length).is_none_or(|end| end > bytes.len() as u64) {
            return Err("the file is cut off: parts that it names are not there".into());
        }
    }
    Ok(())
}
