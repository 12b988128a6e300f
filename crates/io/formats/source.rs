//! A file that is read at positions, from several threads.

use std::cell::RefCell;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use voltet_core::parameters::nearest;
use voltet_core::{Error, Result, counted};
use voltet_files::names_beside;

/// An open file of known length.
#[derive(Debug)]
pub(super) struct Source {
    /// `None`: it is opened for each reading.
    file: Option<File>,
    path: PathBuf,
    len: u64,
    /// True if `file` is a copy in another encoding, without a name.
    is_copy: bool,
    /// Number by which a thread knows the file that it read last.
    number: u64,
}

/// Files that are opened for each reading are read whole up to this many bytes: to open one takes longer than to read it.
const SMALL: u64 = 1 << 16;

thread_local! {
    /// Number of the small file that the thread read last, and its at most [`SMALL`] bytes as they were then: one reading opens it once.
    static LAST_READ: RefCell<(Option<u64>, Vec<u8>)> = const { RefCell::new((None, Vec::new())) };
}

/// A number that no other file has.
fn next_number() -> u64 {
    static COUNT: AtomicU64 = AtomicU64::new(1);
    COUNT.fetch_add(1, Ordering::Relaxed)
}

/// A clause for an error's `expected` where there is no file at `path`: the file beside it that was meant, if any. `may_be_read`: true for
/// those that may be; only near names are looked at.
pub(super) fn file_beside(path: &Path, may_be_read: impl Fn(&Path) -> bool) -> String {
    let mut names = names_beside(path);
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    while let Some(near) = nearest(&wanted, names.iter().map(String::as_str)).map(str::to_string) {
        if may_be_read(&path.with_file_name(&near)) {
            return format!("a file that is there, such as '{near}' beside it");
        }
        names.retain(|name| *name != near);
    }
    "the path of a file that is there".into()
}

/// True for files of the same ending.
pub(super) fn has_same_ending(path: &Path, other: &Path) -> bool {
    path.extension() == other.extension()
}

impl Source {
    /// A file whose first bytes are of a format; `None` for others and those that cannot be read.
    pub fn open_if(path: &Path, matches: impl FnOnce(&[u8]) -> bool) -> Option<Arc<Source>> {
        let source = Source::open(path).ok()?;
        source.head(HEAD).is_ok_and(|head| matches(&head)).then_some(source)
    }

    /// Opens a file; a folder or a missing file is an error that names the path.
    pub fn open(path: &Path) -> Result<Arc<Source>> {
        let failed = |what: &str, error: std::io::Error| Error::run(what).got(error).in_file(path);
        let file = File::open(path).map_err(|error| {
            if error.kind() == std::io::ErrorKind::NotFound {
                Error::run("there is no such file")
                    .expected(file_beside(path, |file| has_same_ending(path, file)))
                    .in_file(path)
            } else {
                failed("the file cannot be opened", error)
            }
        })?;
        let metadata = file.metadata().map_err(|error| failed("the file cannot be opened", error))?;
        if !metadata.is_file() {
            return Err(Error::run("this is not a file").expected("the path of a data file").in_file(path));
        }
        if metadata.len() == 0 {
            return Err(Error::run("the file is empty").expected("a data file").in_file(path));
        }
        let (file, path, len) = (Some(file), path.to_owned(), metadata.len());
        let source = Source { file, path, len, is_copy: false, number: next_number() };
        let head = source.head(4)?;
        let mark = if head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) { 2 } else { 0 };
        let wide: Option<fn([u8; 2]) -> u16> = match head[..] {
            [0xff, 0xfe, b'<', 0] | [b'<', 0, b'?', 0] => Some(u16::from_le_bytes),
            [0xfe, 0xff, 0, b'<'] | [0, b'<', 0, b'?'] => Some(u16::from_be_bytes),
            _ => None,
        };
        match wide {
            Some(word) => source.in_utf_8(mark, word).map(Arc::new),
            None => Ok(Arc::new(source)),
        }
    }

    /// A file of UTF-16 as one of UTF-8 without a name; `start`: of its text, `word`: from its bytes.
    fn in_utf_8(&self, start: u64, word: fn([u8; 2]) -> u16) -> Result<Source> {
        let bytes = self.read(start, self.len - start)?;
        let words: Vec<u16> = bytes.as_chunks().0.iter().map(|&bytes| word(bytes)).collect();
        let text = String::from_utf16(&words).map_err(|error| {
            Error::run("the file is damaged").got(error).expected("UTF-16 text").in_file(&self.path)
        })?;
        let kept = |error| Error::run("the file cannot be kept as UTF-8").got(error).in_file(&self.path);
        let mut file = tempfile::tempfile().map_err(kept)?;
        file.write_all(text.as_bytes()).map_err(kept)?;
        Ok(self.copy(file, text.len() as u64))
    }

    /// The file opened anew for each reading, for programs may keep few open; a copy of it without a name stays open.
    pub fn closed(self: Arc<Self>) -> Arc<Self> {
        if self.is_copy {
            return self;
        }
        let (path, number) = (self.path.clone(), self.number);
        Arc::new(Source { file: None, path, len: self.len, is_copy: false, number })
    }

    /// True for a gzip archive.
    pub fn is_packed(&self) -> Result<bool> {
        Ok(self.head(2)? == [0x1f, 0x8b])
    }

    /// A gzip archive as what it holds, of which `limit` bytes at most, in a file without a name.
    pub fn unpacked(&self, limit: Option<u64>) -> Result<Arc<Source>> {
        let failed = |error| Error::run("the file cannot be unpacked").got(error).in_file(&self.path);
        let packed = File::open(&self.path).map_err(failed)?;
        let mut reader = flate2::read::MultiGzDecoder::new(packed).take(limit.unwrap_or(u64::MAX));
        let mut file = tempfile::tempfile().map_err(failed)?;
        let len = std::io::copy(&mut reader, &mut file).map_err(failed)?;
        Ok(Arc::new(self.copy(file, len)))
    }

    /// A copy of the file in another encoding.
    fn copy(&self, file: File, len: u64) -> Source {
        Source { file: Some(file), path: self.path.clone(), len, is_copy: true, number: next_number() }
    }

    /// The path as the user wrote it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes of the file.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Fills `bytes` from `offset` on.
    pub fn read_at(&self, offset: u64, bytes: &mut [u8]) -> Result<()> {
        self.check(offset, bytes.len() as u64)?;
        let read = match &self.file {
            _ if bytes.is_empty() => Ok(()),
            Some(file) => read_exact_at(file, offset, bytes),
            None if self.len <= SMALL => self.read_of_whole(offset, bytes),
            None => File::open(&self.path).and_then(|file| read_exact_at(&file, offset, bytes)),
        };
        read.map_err(|error| Error::run("the file cannot be read").got(error).in_file(&self.path))
    }

    /// Fills `bytes` from those of the whole file, which is read if it is not the thread's last.
    fn read_of_whole(&self, offset: u64, bytes: &mut [u8]) -> std::io::Result<()> {
        LAST_READ.with_borrow_mut(|(number, whole)| {
            if *number != Some(self.number) {
                *number = None;
                whole.resize(self.len as usize, 0);
                read_exact_at(&File::open(&self.path)?, 0, whole)?;
                *number = Some(self.number);
            }
            bytes.copy_from_slice(&whole[offset as usize..offset as usize + bytes.len()]);
            Ok(())
        })
    }

    /// Reads `len` bytes from `offset` on; checks against the file's length before it allocates.
    pub fn read(&self, offset: u64, len: u64) -> Result<Vec<u8>> {
        self.check(offset, len)?;
        let mut bytes = vec![0; len as usize];
        self.read_at(offset, &mut bytes)?;
        Ok(bytes)
    }

    /// The first bytes, at most `len` of them.
    pub fn head(&self, len: u64) -> Result<Vec<u8>> {
        self.read(0, len.min(self.len))
    }

    /// That `len` bytes from `offset` on lie within the file.
    pub fn check(&self, offset: u64, len: u64) -> Result<()> {
        match offset.checked_add(len) {
            Some(end) if end <= self.len => Ok(()),
            _ => Err(Error::run("the file ends early")
                .got(counted(self.len, "byte"))
                .expected(format_args!("{len} bytes from byte {offset} on"))
                .in_file(&self.path)),
        }
    }
}

#[cfg(unix)]
fn read_exact_at(file: &File, offset: u64, bytes: &mut [u8]) -> std::io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, offset)
}

#[cfg(windows)]
fn read_exact_at(file: &File, mut offset: u64, mut bytes: &mut [u8]) -> std::io::Result<()> {
    while !bytes.is_empty() {
        let count = std::os::windows::fs::FileExt::seek_read(file, bytes, offset)?;
        if count == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        offset += count as u64;
        bytes = &mut bytes[count..];
    }
    Ok(())
}

/// First bytes of a file, which tell its format.
pub(super) const HEAD: u64 = 4096;

/// The head of a file as text: without the mark of UTF-8 and white space before it.
pub(super) fn text_of(head: &[u8]) -> &[u8] {
    head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head).trim_ascii_start()
}

/// Bytes as a message can show them, in quotes: the first few, what cannot be printed as dots.
pub(super) fn quoted(bytes: &[u8]) -> String {
    let text: String =
        bytes.iter().take(24).map(|&b| if (0x20..0x7f).contains(&b) { b as char } else { '·' }).collect();
    format!("'{text}'")
}

/// A phrase of a message about a file, by its head.
pub(super) fn printable(bytes: &[u8]) -> String {
    format!("a file that begins with {}", quoted(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_opened_for_each_reading_keep_apart() {
        let folder = tempfile::tempdir().unwrap();
        let small: Vec<u8> = (0..=255).collect();
        let sizes = [(0_u8, 300), (1, 300), (2, SMALL as usize), (3, SMALL as usize + 1)];
        let files = sizes.map(|(number, size)| {
            let bytes: Vec<u8> = small.iter().cycle().map(|byte| byte ^ number).take(size).collect();
            let path = folder.path().join(number.to_string());
            std::fs::write(&path, &bytes).unwrap();
            (Source::open(&path).unwrap().closed(), bytes)
        });
        for round in 0..3 {
            for (source, bytes) in &files {
                let at = bytes.len() - 40 - round;
                assert_eq!(source.read(at as u64, 40).unwrap(), bytes[at..at + 40]);
                assert!(source.read(at as u64, 60).is_err());
            }
        }
        // The next reading of one that was written since opens it anew, in the thread that read it last, too.
        let (source, bytes) = &files[0];
        assert_eq!(source.read(0, 4).unwrap(), bytes[..4]);
        std::fs::write(source.path(), vec![7; bytes.len()]).unwrap();
        let again = Source::open(source.path()).unwrap().closed();
        assert_eq!(again.read(0, 4).unwrap(), [7; 4]);
        // One that was cut since is an error, not what another file or reading left.
        std::fs::write(files[1].0.path(), b"short").unwrap();
        let error = files[1].0.read(0, 4).unwrap_err();
        assert!(error.location.file.is_some() && error.to_string().contains("cannot be read"), "{error}");
        assert_eq!(again.read(0, 4).unwrap(), [7; 4]);
    }
}
