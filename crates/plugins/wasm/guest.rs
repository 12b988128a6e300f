//! Memory of a module: bounded reads, and arguments appended behind the module's own.

use crate::ffi::ValidationError;
use bytemuck::Pod;
use wasmtime::{AsContext, AsContextMut, Memory};

/// Page of WebAssembly (bytes).
const PAGE: u64 = 1 << 16;

/// Longest text that is read; descriptions have smaller limits (bytes).
const MAX_TEXT_BYTES: usize = 4096;

/// Current memory of a module.
#[derive(Clone, Copy)]
pub(super) struct Guest<'a> {
    bytes: &'a [u8],
}

impl<'a> Guest<'a> {
    pub fn new<T: 'static>(memory: Memory, store: &'a impl AsContext<Data = T>) -> Guest<'a> {
        Guest { bytes: memory.data(store) }
    }

    fn slice(&self, address: u32, length: usize) -> Result<&'a [u8], ValidationError> {
        let begin = address as usize;
        let part = begin.checked_add(length).and_then(|end| self.bytes.get(begin..end));
        part.ok_or_else(|| "points to memory that is not there".to_string())
    }

    /// A number at an address.
    pub fn read<T: Pod>(&self, address: u32) -> Result<T, ValidationError> {
        Ok(bytemuck::pod_read_unaligned(self.slice(address, size_of::<T>())?))
    }

    /// Several numbers side by side.
    pub fn list<T: Pod>(&self, address: u32, count: usize) -> Result<Vec<T>, ValidationError> {
        if address == 0 {
            return Err("is a null pointer".into());
        }
        let part = self.slice(address, count.saturating_mul(size_of::<T>()))?;
        Ok(part.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect())
    }

    /// The bytes of a text without the 0 that ends it, cut where they are too many; `None` for a null pointer.
    pub fn text(&self, address: u32) -> Result<Option<Vec<u8>>, ValidationError> {
        if address == 0 {
            return Ok(None);
        }
        let rest = self.bytes.get(address as usize..).ok_or("points to memory that is not there")?;
        let max = rest.len().min(MAX_TEXT_BYTES + 1);
        let end = rest[..max].iter().position(|&byte| byte == 0);
        if end.is_none() && max == rest.len() {
            return Err("points to memory that is not there".into());
        }
        Ok(Some(rest[..end.unwrap_or(max)].to_vec()))
    }

    /// The readable part of a text, for a message.
    pub fn message(&self, address: u32) -> String {
        match self.text(address) {
            Ok(Some(bytes)) => String::from_utf8_lossy(&bytes).into_owned(),
            Ok(None) => "(a null pointer in place of a text)".into(),
            Err(wrong) => format!("(a text that {wrong})"),
        }
    }
}

/// Arguments of a call, collected before the module's memory grows by them: their addresses are known meanwhile.
pub(super) struct GuestArgs {
    begin: u64,
    bytes: Vec<u8>,
}

impl GuestArgs {
    /// Arguments behind the module's memory.
    pub fn behind<T: 'static>(memory: Memory, store: &impl AsContext<Data = T>) -> GuestArgs {
        GuestArgs { begin: memory.size(store) * PAGE, bytes: Vec::new() }
    }

    /// Appends numbers at a multiple of 16; returns their address.
    pub fn put<T: Pod>(&mut self, values: &[T]) -> u32 {
        self.bytes.resize(self.bytes.len().next_multiple_of(16), 0);
        let address = self.begin + self.bytes.len() as u64;
        self.bytes.extend_from_slice(bytemuck::cast_slice(values));
        // Overrun 32 bits the memory cannot grow, which is found then.
        address as u32
    }

    /// Appends a text with a final 0; returns its address.
    pub fn text(&mut self, text: &[u8]) -> u32 {
        let address = self.put(text);
        self.bytes.push(0);
        address
    }

    /// Grows the memory and copies everything there; false if there is no room.
    pub fn write_to<T: 'static>(self, memory: Memory, store: &mut impl AsContextMut<Data = T>) -> bool {
        let pages = (self.bytes.len() as u64).div_ceil(PAGE);
        memory.grow(&mut *store, pages).is_ok_and(|old| old * PAGE == self.begin)
            && memory.write(store, self.begin as usize, &self.bytes).is_ok()
    }
}
