//! The file of a plug-in, opened and read once: its hash, the checks of its contents and what is loaded are of the same bytes.

use std::fs::{File, Metadata};
use std::io::{Error as IoError, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;
use voltet_core::field::{Plugin, fingerprint};
use voltet_core::{Error, Result};

/// Largest file (bytes).
const MAX_BYTES: u64 = 1 << 30;

/// First bytes of a WebAssembly module.
const MODULE_MAGIC: &[u8] = b"\0asm";

/// A file as it was when it was read.
pub struct PluginFile {
    path: PathBuf,
    pub(crate) bytes: Arc<Vec<u8>>,
    modified: Option<SystemTime>,
    /// True if every user of the machine may change it.
    is_open_to_all: bool,
}

impl PluginFile {
    /// Opens and reads the file at `path`.
    ///
    /// # Errors
    ///
    /// - It cannot be read, is no regular file, or is larger than 1 GiB.
    pub fn read(path: &Path) -> Result<PluginFile> {
        let wrong = |found: String| {
            Error::usage("the plug-in cannot be read")
                .got(found)
                .expected("the path of a shared library")
                .in_file(path)
        };
        let unreadable = |error: IoError| wrong(error.to_string());
        let file = open(path).map_err(unreadable)?;
        let metadata = file.metadata().map_err(unreadable)?;
        if !metadata.is_file() {
            return Err(wrong(if metadata.is_dir() { "a folder" } else { "a pipe or a device" }.into()));
        }
        let mut bytes = Vec::new();
        (&file).take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(wrong(format!("more than {} MiB", MAX_BYTES >> 20)));
        }
        let is_open_to_all = is_open_to_all(&metadata);
        Ok(PluginFile {
            path: path.into(),
            bytes: Arc::new(bytes),
            modified: metadata.modified().ok(),
            is_open_to_all,
        })
    }

    /// Its path, as the user gave it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its hash, as pictures record it.
    pub fn fingerprint(&self) -> String {
        self.plugin().fingerprint_text()
    }

    /// True if it is a WebAssembly module, which runs in a sandbox.
    pub fn is_module(&self) -> bool {
        self.bytes.starts_with(MODULE_MAGIC)
    }

    /// Reason to distrust the file: every user of the machine may change it.
    pub fn warning(&self) -> Option<String> {
        self.is_open_to_all.then(|| {
            format!(
                "every user of this machine may change the plug-in '{}'; `chmod o-w` ends that",
                self.path.display()
            )
        })
    }

    /// Its state; name and version of the plug-in are still empty.
    pub(crate) fn plugin(&self) -> Plugin {
        Plugin {
            name: String::new(),
            version: String::new(),
            path: self.path.clone(),
            bytes: self.bytes.len() as u64,
            fingerprint: fingerprint(&self.bytes),
            modified: self.modified,
        }
    }
}

/// A pipe is opened without waiting for its writer.
#[cfg(unix)]
fn open(path: &Path) -> std::io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    std::fs::OpenOptions::new().read(true).custom_flags(libc::O_NONBLOCK).open(path)
}

#[cfg(not(unix))]
fn open(path: &Path) -> std::io::Result<File> {
    File::open(path)
}

#[cfg(unix)]
fn is_open_to_all(metadata: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::mode(metadata) & 0o002 != 0
}

#[cfg(not(unix))]
fn is_open_to_all(_: &Metadata) -> bool {
    false
}

/// Descriptors up to which private copies are made: each keeps one, and many systems allow a process 1,024.
#[cfg(target_os = "linux")]
const MAX_DESCRIPTOR: i32 = 512;

/// A copy that nobody else can change, at a path that the loader can open.
#[cfg(target_os = "linux")]
pub(crate) struct PrivateCopy {
    /// Open as long as the library is loaded: the loader takes two libraries of one path for the same.
    _file: File,
    pub path: PathBuf,
}

#[cfg(target_os = "linux")]
impl PrivateCopy {
    /// A sealed copy in memory.
    ///
    /// Errors: the system has no room for it, or has no such files.
    pub fn new(bytes: &[u8]) -> std::io::Result<PrivateCopy> {
        use std::io::Write;
        use std::os::fd::{AsRawFd, FromRawFd};
        let flags = libc::MFD_CLOEXEC | libc::MFD_ALLOW_SEALING;
        // SAFETY: the name is a text that lives as long as the program.
        let descriptor = unsafe { libc::memfd_create(c"voltet-plug-in".as_ptr(), flags) };
        if descriptor < 0 {
            return Err(IoError::last_os_error());
        }
        // SAFETY: just made, and nobody else's.
        let mut file = unsafe { File::from_raw_fd(descriptor) };
        if descriptor > MAX_DESCRIPTOR {
            return Err(std::io::ErrorKind::QuotaExceeded.into());
        }
        file.write_all(bytes)?;
        let seals = libc::F_SEAL_WRITE | libc::F_SEAL_SHRINK | libc::F_SEAL_GROW | libc::F_SEAL_SEAL;
        // SAFETY: a descriptor of this process.
        if unsafe { libc::fcntl(file.as_raw_fd(), libc::F_ADD_SEALS, seals) } < 0 {
            return Err(IoError::last_os_error());
        }
        // By the number of the process, so that a debugger finds it, too.
        let path = PathBuf::from(format!("/proc/{}/fd/{}", std::process::id(), file.as_raw_fd()));
        std::fs::metadata(&path)?;
        Ok(PrivateCopy { _file: file, path })
    }
}
