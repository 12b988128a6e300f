//! Messages between the program and the process of a plug-in: a tag, a length, and bytes in this machine's order.

use std::io::{self, Read, Write};

/// Numbers read at a time.
const CHUNK: usize = 1 << 22;

/// Longest message without its arrays (bytes).
const MAX_MESSAGE_BYTES: u64 = 16 << 20;

/// Message under construction.
#[derive(Default)]
pub(crate) struct Writer(pub Vec<u8>);

impl Writer {
    pub fn number(&mut self, n: u64) {
        self.0.extend_from_slice(&n.to_ne_bytes());
    }

    pub fn float(&mut self, x: f64) {
        self.number(x.to_bits());
    }

    pub fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    pub fn bytes(&mut self, bytes: &[u8]) {
        self.count(bytes.len());
        self.0.extend_from_slice(bytes);
    }

    pub fn floats(&mut self, xs: &[f64]) {
        self.list(xs, |to, &x| to.float(x));
    }

    pub fn count(&mut self, count: usize) {
        self.number(count as u64);
    }

    /// A count, and the items.
    pub fn list<T>(&mut self, items: &[T], mut write: impl FnMut(&mut Writer, &T)) {
        self.count(items.len());
        items.iter().for_each(|item| write(self, item));
    }

    /// A flag, and the item if there is one.
    pub fn optional<T>(&mut self, item: Option<T>, write: impl FnOnce(&mut Writer, T)) {
        self.number(u64::from(item.is_some()));
        if let Some(item) = item {
            write(self, item);
        }
    }
}

/// Message under reading; each method gives `None` where the bytes are not as written: the writer may have been damaged.
pub(crate) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn number(&mut self) -> Option<u64> {
        let (head, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(u64::from_ne_bytes(*head))
    }

    pub fn length(&mut self) -> Option<usize> {
        usize::try_from(self.number()?).ok()
    }

    /// A count of items of at least 8 bytes each.
    pub fn count(&mut self) -> Option<usize> {
        let count = self.length()?;
        (count <= self.0.len() / 8).then_some(count)
    }

    pub fn float(&mut self) -> Option<f64> {
        self.number().map(f64::from_bits)
    }

    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.length()?;
        let (bytes, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(bytes)
    }

    pub fn text(&mut self) -> Option<String> {
        String::from_utf8(self.bytes()?.to_vec()).ok()
    }

    pub fn floats(&mut self) -> Option<Vec<f64>> {
        self.list(Reader::float)
    }

    /// Counterpart of [`Writer::optional`].
    pub fn optional<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<Option<T>> {
        match self.number()? {
            0 => Some(None),
            1 => read(self).map(Some),
            _ => None,
        }
    }

    /// Counterpart of [`Writer::list`].
    pub fn list<T>(&mut self, mut read: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        (0..self.count()?).map(|_| read(self)).collect()
    }
}

/// Error of a message that does not follow the format.
pub(crate) fn garbled() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "a message is not as agreed")
}

/// Sends a message.
pub(crate) fn send(to: &mut dyn Write, tag: u8, bytes: &[u8]) -> io::Result<()> {
    to.write_all(&[tag])?;
    to.write_all(&(bytes.len() as u64).to_ne_bytes())?;
    to.write_all(bytes)
}

/// The tag and the length of the next message; `None` at the end.
pub(crate) fn head(from: &mut dyn Read) -> io::Result<Option<(u8, u64)>> {
    let mut tag = [0];
    if from.read(&mut tag)? == 0 {
        return Ok(None);
    }
    let mut length = [0; 8];
    from.read_exact(&mut length)?;
    Ok(Some((tag[0], u64::from_ne_bytes(length))))
}

/// The bytes of a message without its arrays.
pub(crate) fn body(from: &mut dyn Read, length: u64) -> io::Result<Vec<u8>> {
    if length > MAX_MESSAGE_BYTES {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a message is too long"));
    }
    let mut bytes = vec![0; length as usize];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// An array of `count` numbers. A damaged message may have any count: memory is touched as numbers come.
pub(crate) fn array<T: bytemuck::Pod>(from: &mut dyn Read, count: usize) -> io::Result<Vec<T>> {
    let mut items = Vec::new();
    let none = |_| io::Error::new(io::ErrorKind::OutOfMemory, "there is no memory for an array");
    items.try_reserve_exact(count).map_err(none)?;
    while items.len() < count {
        let begin = items.len();
        items.resize(begin + (count - begin).min(CHUNK), T::zeroed());
        from.read_exact(bytemuck::cast_slice_mut(&mut items[begin..]))?;
    }
    Ok(items)
}

/// Counterpart of [`array`].
pub(crate) fn send_array<T: bytemuck::Pod>(to: &mut dyn Write, items: &[T]) -> io::Result<()> {
    to.write_all(bytemuck::cast_slice(items))
}
