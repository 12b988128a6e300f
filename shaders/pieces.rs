//! The pieces, and what their first lines say.

/// A WGSL file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WgslPiece {
    /// Its path under `wgsl/`, without the ending.
    pub name: &'static str,
    /// Its path in this crate, for messages.
    pub file: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// Every piece, by name: the files that `build.rs` finds.
pub const PIECES: &[WgslPiece] = include!(concat!(env!("OUT_DIR"), "/pieces.rs"));

/// The piece of that name.
pub fn piece(name: &str) -> Option<&'static WgslPiece> {
    PIECES.iter().find(|piece| piece.name == name)
}

impl WgslPiece {
    /// Pieces that it uses.
    pub fn uses(&self) -> Vec<&'static str> {
        self.list("Uses: ")
    }

    /// Slots that it fills.
    pub fn fills(&self) -> Vec<&'static str> {
        self.list("Fills: ")
    }

    /// Slots that must be filled for it.
    pub fn asks_for(&self) -> Vec<&'static str> {
        self.list("Asks for: ")
    }

    /// The names behind `key` in the first line.
    fn list(&self, key: &str) -> Vec<&'static str> {
        let header = self.text.lines().next().unwrap_or("");
        let Some(at) = header.find(key) else { return Vec::new() };
        let rest = &header[at + key.len()..];
        let names = rest.split('.').next().unwrap_or("");
        names.split(", ").filter(|name| !name.is_empty() && *name != "nothing").collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_header_is_complete_and_names_pieces() {
        for piece in PIECES {
            let header = piece.text.lines().next().unwrap_or("");
            assert!(header.starts_with("// Uses: ") && header.contains(". Fills: "), "{}", piece.file);
            assert!(header.ends_with('.'), "{}", piece.file);
            for name in piece.uses() {
                assert!(super::piece(name).is_some(), "{} uses '{name}', which is no piece", piece.file);
            }
            for slot in piece.asks_for() {
                let filled = PIECES.iter().any(|other| other.fills().contains(&slot));
                let filled = filled || crate::generate::FILLS.contains(&slot);
                assert!(filled, "{} asks for '{slot}', which nothing fills", piece.file);
            }
        }
    }
}
