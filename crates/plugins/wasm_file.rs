//! Recognition and loading of WebAssembly modules, where this program was built with a sandbox for them.

use std::path::Path;

/// First bytes of a module.
const MAGIC: [u8; 4] = *b"\0asm";

/// True if the file begins as a module.
pub(crate) fn is_module(path: &Path) -> bool {
    use std::io::Read;
    let mut begin = [0; 4];
    std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut begin)).is_ok() && begin == MAGIC
}

#[cfg(feature = "wasm")]
pub(crate) use crate::wasm::load;

#[cfg(not(feature = "wasm"))]
pub(crate) use without::load;

#[cfg(not(feature = "wasm"))]
mod without {
    use crate::runner::PluginItem;
    use std::path::Path;
    use voltet_core::{Error, Result};

    /// Errors: always; this build has no sandbox.
    pub(crate) fn load(path: &Path) -> Result<Vec<PluginItem>> {
        let error = Error::usage(
            "the plug-in is a WebAssembly module, and this program was built without the sandbox for them",
        );
        Err(error.expected("a build with the feature \"wasm\", or a shared library").in_file(path))
    }
}
