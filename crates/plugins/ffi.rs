//! Memory shared with a plug-in: bounded reads of what it points to, checked by the system where it can; and buffers that it writes to,
//! filled with numbers that no computation gives, and with a guard behind them, so that missing numbers and writes beyond the end show.

use std::mem::MaybeUninit;
use voltet_core::counted;

/// A struct of the interface that begins with its size.
///
/// # Safety
///
/// Every pattern of bits is a value: numbers, raw pointers, and functions that may be absent.
pub(crate) unsafe trait Sized32: Copy {
    /// Name in messages.
    const NAME: &'static str;
}

/// Largest struct of any version of the interface (bytes).
const MAX_STRUCT_BYTES: u32 = 4096;

/// Fault of something that a plug-in points to; a clause.
pub(crate) type ValidationError = String;

/// Result of a check of something that a plug-in points to.
pub(crate) type CheckResult<T> = Result<T, ValidationError>;

/// Address space of a plug-in's pointers: this process, or the memory of a module in the sandbox.
pub(crate) trait AddressSpace: Copy {
    /// Pointer to data in a struct of the interface.
    type Address: Copy + TryInto<usize>;
    /// Pointer to a function of type `F` in a struct of the interface.
    type Function<F: Copy>: Copy;

    fn is_null<F: Copy>(function: Self::Function<F>) -> bool;

    /// Copies the bytes at an address; `None` where some of them are not there.
    fn copy(self, address: usize, into: &mut [MaybeUninit<u8>]) -> Option<()>;

    /// Plain values at an address.
    ///
    /// Errors: null, or not there.
    fn values<T: Copy>(self, address: impl TryInto<usize>, count: usize) -> CheckResult<Vec<T>> {
        let address = match address.try_into() {
            Ok(address) if address != 0 => address,
            _ => return Err("is a null pointer".into()),
        };
        let mut values = Vec::<T>::with_capacity(count);
        let spare = &mut values.spare_capacity_mut()[..count];
        // SAFETY: the same memory as bytes, of which any may be uninitialised.
        let spare = unsafe {
            std::slice::from_raw_parts_mut(spare.as_mut_ptr().cast::<MaybeUninit<u8>>(), size_of_val(spare))
        };
        self.copy(address, spare).ok_or("points to memory that is not there")?;
        // SAFETY: all bytes were copied, and T is a number or a raw pointer here.
        unsafe { values.set_len(count) };
        Ok(values)
    }

    /// A struct at an address, and the size in its first field.
    ///
    /// Errors: null, not there, or smaller than in version 1.0 of the interface.
    fn sized<T: Sized32>(self, address: impl TryInto<usize>) -> CheckResult<(T, usize)> {
        let address: usize = address.try_into().unwrap_or(0);
        let wrong = |what| format!("{} {what}", T::NAME);
        let size = self.values::<u32>(address, 1).map_err(wrong)?[0];
        if (size as usize) < size_of::<T>()
            || size > MAX_STRUCT_BYTES
            || !(size as usize).is_multiple_of(align_of::<T>())
        {
            let (name, min) = (T::NAME, size_of::<T>());
            return Err(format!("{name} says that its size is {size} bytes, in place of {min} (sizeof)"));
        }
        let read = self.values(address, 1).map_err(wrong)?;
        Ok((read[0], size as usize))
    }

    /// Structs side by side, each of the size that the first has in its first field.
    ///
    /// Errors: those of [`AddressSpace::sized`], with the struct's index; one of another size than the first.
    fn several<T: Sized32>(self, address: impl TryInto<usize>, count: usize) -> CheckResult<Vec<T>> {
        let address: usize = address.try_into().unwrap_or(0);
        let (mut found, mut stride) = (Vec::new(), 0);
        for i in 0..count {
            let (read, size) =
                self.sized(address.wrapping_add(i * stride)).map_err(|wrong| format!("{i}: {wrong}"))?;
            if i > 0 && size != stride {
                return Err(format!("{i}: its size is {size} bytes, and that of the first {stride}"));
            }
            stride = size;
            found.push(read);
        }
        Ok(found)
    }

    /// A text; `None` for a null pointer.
    ///
    /// Errors: longer than `max` bytes, no UTF-8, or not there.
    fn text(self, address: impl TryInto<usize>, max: usize) -> CheckResult<Option<String>> {
        match self.bytes_of_text(address, max)? {
            None => Ok(None),
            Some((bytes, true)) => String::from_utf8(bytes).map(Some).map_err(|error| {
                let at = error.utf8_error().valid_up_to();
                format!("is no UTF-8 at byte {at}: \"{}\"", String::from_utf8_lossy(error.as_bytes()))
            }),
            Some((bytes, false)) => {
                let begin: String = String::from_utf8_lossy(&bytes).chars().take(32).collect();
                Err(format!("is longer than {max} bytes: \"{begin}…\""))
            }
        }
    }

    /// A text of one line; `None` for a null pointer.
    fn line(self, what: &str, address: impl TryInto<usize>, max: usize) -> CheckResult<Option<String>> {
        match self.text(address, max).map_err(|wrong| format!("{what} {wrong}"))? {
            Some(text) if text.chars().any(char::is_control) => {
                Err(format!("{what} has control characters: {text:?}"))
            }
            text => Ok(text),
        }
    }

    /// A text of one line that is neither absent nor empty.
    fn required_line(self, what: &str, address: impl TryInto<usize>, max: usize) -> CheckResult<String> {
        match self.line(what, address, max)? {
            None => Err(format!("{what} is a null pointer")),
            Some(text) if text.trim().is_empty() => Err(format!("{what} is empty")),
            Some(text) => Ok(text),
        }
    }

    /// The readable part of a text, for a message.
    fn message(self, address: impl TryInto<usize>) -> String {
        match self.bytes_of_text(address, MAX_MESSAGE_BYTES) {
            Ok(Some((bytes, _))) => String::from_utf8_lossy(&bytes).into_owned(),
            Ok(None) => "(a null pointer in place of a text)".into(),
            Err(wrong) => format!("(a text that {wrong})"),
        }
    }

    /// The bytes of a text, and true if it ends within `max` of them; `None` for a null pointer.
    fn bytes_of_text(self, address: impl TryInto<usize>, max: usize) -> CheckResult<Option<(Vec<u8>, bool)>> {
        let address: usize = address.try_into().unwrap_or(0);
        if address == 0 {
            return Ok(None);
        }
        let mut found = Vec::new();
        let mut end = None;
        while found.len() <= max && end.is_none() {
            let begin = address.wrapping_add(found.len());
            // Within one page of 4096 bytes: the next need not be there.
            let part = self.values::<u8>(begin, (4096 - begin % 4096).min(64))?;
            end = part.iter().position(|&byte| byte == 0).map(|end| found.len() + end);
            found.extend(part);
        }
        found.truncate(end.unwrap_or(max).min(max));
        Ok(Some((found, end.is_some_and(|end| end <= max))))
    }
}

/// Longest error or note (bytes).
const MAX_MESSAGE_BYTES: usize = 4096;

/// Address space of this process.
#[derive(Clone, Copy)]
pub(crate) struct Process;

impl AddressSpace for Process {
    type Address = usize;
    type Function<F: Copy> = Option<F>;

    fn is_null<F: Copy>(function: Option<F>) -> bool {
        function.is_none()
    }

    // Where the system cannot check, unmapped memory ends the program, as it would in the plug-in itself.
    fn copy(self, address: usize, into: &mut [MaybeUninit<u8>]) -> Option<()> {
        address.checked_add(into.len())?;
        if into.is_empty() {
            return Some(());
        }
        #[cfg(target_os = "linux")]
        {
            let own = libc::iovec { iov_base: into.as_mut_ptr().cast(), iov_len: into.len() };
            let theirs = libc::iovec { iov_base: address as *mut libc::c_void, iov_len: into.len() };
            // SAFETY: `own` is the buffer; the system checks every address of `theirs`, and copies what is there.
            let copied = unsafe { libc::process_vm_readv(libc::getpid(), &own, 1, &theirs, 1, 0) };
            if copied == into.len() as isize {
                return Some(());
            }
            if copied >= 0 || std::io::Error::last_os_error().raw_os_error() == Some(libc::EFAULT) {
                return None;
            }
            // Not allowed here: as on other systems.
        }
        // SAFETY: the interface says that the plug-in keeps what it points to until deinit.
        unsafe { std::ptr::copy_nonoverlapping(address as *const u8, into.as_mut_ptr().cast(), into.len()) };
        Some(())
    }
}

/// Tuples of the guard behind a buffer: a filter that miscounts by a few, or by a block of 4,096, is found.
pub(crate) const GUARD_COUNT: usize = 4096 + 64;

/// Marker of a gradient that was not written: a NaN with digits that no computation gives.
pub(crate) const UNSET: f64 = f64::from_bits(0x7ff7_766f_6c74_6574);

/// Write beyond the end of a buffer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Overrun {
    /// Name of the buffer: "the gradient".
    pub buffer: String,
    /// Numbers to write: "3 numbers for each of the 64 points".
    pub capacity: String,
}

crate::wire::wire!(fields of Overrun { buffer, capacity });

impl Overrun {
    /// Overrun of the gradient at `point_count` points.
    pub fn gradient(point_count: usize) -> Overrun {
        let capacity = format!("3 numbers for each of the {}", counted(point_count, "point"));
        Overrun { buffer: "the gradient".into(), capacity }
    }
}

/// Number type with a marker value, which stands where nothing was written.
pub(crate) trait Sentinel: bytemuck::Pod + Send + Sync {
    /// The marker.
    const UNSET: Self;

    /// True if this number is the marker, bit by bit.
    fn is_unset(&self) -> bool {
        bytemuck::bytes_of(self) == bytemuck::bytes_of(&Self::UNSET)
    }
}

macro_rules! sentinels {
    ($($number:ty = $unset:expr),*) => {$(
        impl Sentinel for $number {
            const UNSET: $number = $unset;
        }
    )*};
}

sentinels!(u8 = u8::MAX, u32 = u32::MAX, i64 = i64::MIN, f32 = f32::from_bits(0x7fd6_6f6c), f64 = UNSET);

/// Buffer of `count` tuples of numbers and the guard, all unset.
pub(crate) fn guarded_vec<V: bytemuck::Pod, T: Sentinel>(count: usize) -> CheckResult<Vec<V>> {
    let mut tuples = Vec::<V>::new();
    let total = count + GUARD_COUNT;
    tuples.try_reserve_exact(total).map_err(|_| {
        format!("there is no memory for {total} tuples of {}", counted(size_of::<V>(), "byte"))
    })?;
    let mut unset = [V::zeroed()];
    bytemuck::cast_slice_mut::<V, T>(&mut unset).fill(T::UNSET);
    tuples.resize(total, unset[0]);
    Ok(tuples)
}

/// Removes the guard behind `count` tuples; true if it was written to.
pub(crate) fn remove_guard<V: bytemuck::Pod, T: Sentinel>(tuples: &mut Vec<V>, count: usize) -> bool {
    let overran = !bytemuck::cast_slice::<V, T>(&tuples[count..]).iter().all(T::is_unset);
    tuples.truncate(count);
    overran
}
