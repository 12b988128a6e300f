//! Messages between the program and the process of a plug-in: a tag, a length, and bytes in this machine's own order.

use std::io::{self, Read, Write};

/// Numbers that are read at a time.
const PART: usize = 1 << 22;

/// Longest message but for arrays: bytes.
const MESSAGE_MOST: u64 = 16 << 20;

/// Writes the parts of a message one after the other.
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
        self.number(bytes.len() as u64);
        self.0.extend_from_slice(bytes);
    }

    pub fn floats(&mut self, xs: &[f64]) {
        self.number(xs.len() as u64);
        xs.iter().for_each(|&x| self.float(x));
    }

    /// Whether there is something, and what.
    pub fn optional<T>(&mut self, thing: Option<T>, write: impl FnOnce(&mut Writer, T)) {
        self.number(u64::from(thing.is_some()));
        if let Some(thing) = thing {
            write(self, thing);
        }
    }
}

/// Reads them again; `None` where they are not what was written: whoever writes may have been damaged.
pub(crate) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn number(&mut self) -> Option<u64> {
        let (head, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(u64::from_ne_bytes(*head))
    }

    /// A number of things, each of at least 8 bytes.
    pub fn count(&mut self) -> Option<usize> {
        let count = usize::try_from(self.number()?).ok()?;
        (count <= self.0.len() / 8).then_some(count)
    }

    pub fn float(&mut self) -> Option<f64> {
        self.number().map(f64::from_bits)
    }

    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(self.number()?).ok()?;
        let (bytes, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(bytes)
    }

    pub fn text(&mut self) -> Option<String> {
        String::from_utf8(self.bytes()?.to_vec()).ok()
    }

    pub fn floats(&mut self) -> Option<Vec<f64>> {
        (0..self.count()?).map(|_| self.float()).collect()
    }

    /// What [`Writer::optional`] wrote.
    pub fn optional<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<Option<T>> {
        match self.number()? {
            0 => Some(None),
            1 => read(self).map(Some),
            _ => None,
        }
    }

    /// Several things, as many as the count before them says.
    pub fn list<T>(&mut self, mut read: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        (0..self.count()?).map(|_| read(self)).collect()
    }
}

/// Sends a message.
pub(crate) fn send(to: &mut impl Write, tag: u8, bytes: &[u8]) -> io::Result<()> {
    to.write_all(&[tag])?;
    to.write_all(&(bytes.len() as u64).to_ne_bytes())?;
    to.write_all(bytes)
}

/// The tag and the length of the next message; `None` at the end.
pub(crate) fn head(from: &mut impl Read) -> io::Result<Option<(u8, u64)>> {
    let mut tag = [0];
    if from.read(&mut tag)? == 0 {
        return Ok(None);
    }
    let mut length = [0; 8];
    from.read_exact(&mut length)?;
    Ok(Some((tag[0], u64::from_ne_bytes(length))))
}

/// The bytes of a message that is no array.
pub(crate) fn body(from: &mut impl Read, length: u64) -> io::Result<Vec<u8>> {
    if length > MESSAGE_MOST {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a message is too long"));
    }
    let mut bytes = vec![0; length as usize];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// An array of numbers, of that many. What was damaged may name any number: memory is touched as numbers come.
pub(crate) fn array<T: bytemuck::Pod>(from: &mut impl Read, count: usize) -> io::Result<Vec<T>> {
    let mut items = Vec::new();
    let none = |_| io::Error::new(io::ErrorKind::OutOfMemory, "there is no memory for an array");
    items.try_reserve_exact(count).map_err(none)?;
    while items.len() < count {
        let begin = items.len();
        items.resize(begin + (count - begin).min(PART), T::zeroed());
        from.read_exact(bytemuck::cast_slice_mut(&mut items[begin..]))?;
    }
    Ok(items)
}

/// The same as bytes.
pub(crate) fn send_array<T: bytemuck::Pod>(to: &mut impl Write, items: &[T]) -> io::Result<()> {
    to.write_all(bytemuck::cast_slice(items))
}
