//! The memory of a module: read within its bounds, and laid out beyond what the module has.

use crate::foreign::Wrong;
use bytemuck::Pod;
use wasmtime::{AsContext, AsContextMut, Memory};

/// A page of WebAssembly: bytes.
const PAGE: u64 = 1 << 16;

/// Longest text that is looked at; descriptions have limits of their own: bytes.
const TEXT_MOST: usize = 4096;

/// The memory of a module as it is now.
#[derive(Clone, Copy)]
pub(super) struct Guest<'a> {
    bytes: &'a [u8],
}

impl<'a> Guest<'a> {
    pub fn of<T: 'static>(memory: Memory, store: &'a impl AsContext<Data = T>) -> Guest<'a> {
        Guest { bytes: memory.data(store) }
    }

    fn part(&self, address: u32, length: usize) -> Result<&'a [u8], Wrong> {
        let begin = address as usize;
        let part = begin.checked_add(length).and_then(|end| self.bytes.get(begin..end));
        part.ok_or_else(|| "points to memory that is not there".to_string())
    }

    /// A number at an address.
    pub fn read<T: Pod>(&self, address: u32) -> Result<T, Wrong> {
        Ok(bytemuck::pod_read_unaligned(self.part(address, size_of::<T>())?))
    }

    /// Several numbers side by side.
    pub fn list<T: Pod>(&self, address: u32, count: usize) -> Result<Vec<T>, Wrong> {
        if address == 0 {
            return Err("is a null pointer".into());
        }
        let part = self.part(address, count.saturating_mul(size_of::<T>()))?;
        Ok(part.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect())
    }

    /// The bytes of a text without the 0 that ends it, cut where they are too many; `None` for a null pointer.
    pub fn text(&self, address: u32) -> Result<Option<Vec<u8>>, Wrong> {
        if address == 0 {
            return Ok(None);
        }
        let rest = self.bytes.get(address as usize..).ok_or("points to memory that is not there")?;
        let most = rest.len().min(TEXT_MOST + 1);
        let end = rest[..most].iter().position(|&byte| byte == 0);
        if end.is_none() && most == rest.len() {
            return Err("points to memory that is not there".into());
        }
        Ok(Some(rest[..end.unwrap_or(most)].to_vec()))
    }

    /// A text for a message: what is there of it.
    pub fn message(&self, address: u32) -> String {
        match self.text(address) {
            Ok(Some(bytes)) => String::from_utf8_lossy(&bytes).into_owned(),
            Ok(None) => "(a null pointer in place of a text)".into(),
            Err(wrong) => format!("(a text that {wrong})"),
        }
    }
}

/// What a call hands over, put together before the module's memory grows by it: addresses are known as it is.
pub(super) struct Handed {
    begin: u64,
    bytes: Vec<u8>,
}

impl Handed {
    /// Behind what the module has.
    pub fn behind<T: 'static>(memory: Memory, store: &impl AsContext<Data = T>) -> Handed {
        Handed { begin: memory.size(store) * PAGE, bytes: Vec::new() }
    }

    /// Numbers side by side, at a multiple of 16; their address.
    pub fn put<T: Pod>(&mut self, values: &[T]) -> u32 {
        self.bytes.resize(self.bytes.len().next_multiple_of(16), 0);
        let address = self.begin + self.bytes.len() as u64;
        self.bytes.extend_from_slice(bytemuck::cast_slice(values));
        // Beyond 32 bits the memory cannot grow, which is found then.
        address as u32
    }

    /// A text with the 0 that ends it.
    pub fn text(&mut self, text: &[u8]) -> u32 {
        let address = self.put(text);
        self.bytes.push(0);
        address
    }

    /// Lets the memory grow and copies everything there; whether there is room.
    pub fn give<T: 'static>(self, memory: Memory, store: &mut impl AsContextMut<Data = T>) -> bool {
        let pages = (self.bytes.len() as u64).div_ceil(PAGE);
        memory.grow(&mut *store, pages).is_ok_and(|old| old * PAGE == self.begin)
            && memory.write(store, self.begin as usize, &self.bytes).is_ok()
    }
}
