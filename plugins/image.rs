//! Whether a file can be a library of this system, before its loader maps it: what is none, is of another processor or was cut
//! off would be explained badly, or crash. A file damaged elsewhere can still crash.

use crate::foreign::Wrong;
use std::path::Path;

/// Errors: what speaks against loading the file.
#[cfg(not(target_os = "linux"))]
pub(crate) fn check(_: &Path) -> Result<(), Wrong> {
    Ok(())
}

/// The ELF header and the program headers (System V ABI, chapters 4 and 5).
#[cfg(target_os = "linux")]
pub(crate) fn check(path: &Path) -> Result<(), Wrong> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    check_bytes(&bytes, &own_head()?)
}

/// The first bytes of this program: class, byte order and processor that a library must share.
#[cfg(target_os = "linux")]
fn own_head() -> Result<Vec<u8>, Wrong> {
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
fn check_bytes(bytes: &[u8], own: &[u8]) -> Result<(), Wrong> {
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
        // PT_LOAD: what the loader maps. Beyond the end of the file there is nothing to map.
        if kind == 1 && begin.checked_add(length).is_none_or(|end| end > bytes.len() as u64) {
            return Err("the file is cut off: parts that it names are not there".into());
        }
    }
    Ok(())
}
