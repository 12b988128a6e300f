//! The pieces, what their first lines say, and how they are put together to the text of a shader; from a line of the text back to
//! the file it came from.

use voltet_core::Error;

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

    /// The names behind `key` in the first line.
    fn list(&self, key: &str) -> Vec<&'static str> {
        let header = self.text.lines().next().unwrap_or("");
        let Some(at) = header.find(key) else { return Vec::new() };
        let rest = &header[at + key.len()..];
        let names = rest.split('.').next().unwrap_or("");
        names.split(", ").filter(|name| !name.is_empty() && *name != "nothing").collect()
    }
}

/// A composed shader.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Shader {
    /// WGSL. Equal keys give equal text.
    pub text: String,
    /// Line (from 1) of the text at which each part begins, with the part's file.
    parts: Vec<(usize, &'static str)>,
}

/// Name of the generated block in messages.
const GENERATED: &str = "generated for the scene";

/// Pieces with all that they use, behind `text`, which fills the slots they ask for.
///
/// # Panics
/// On a name that is no piece.
pub fn compose_pieces(text: &str, names: &[&str]) -> Shader {
    compose_pieces_with(text, names, &[])
}

/// Like [`compose_pieces`], with further pieces beside those that ship.
///
/// # Panics
/// On a name that is no piece.
pub fn compose_pieces_with(text: &str, names: &[&str], further: &'static [WgslPiece]) -> Shader {
    let find = |name: &str| further.iter().find(|piece| piece.name == name).or_else(|| piece(name));
    let mut pieces: Vec<&WgslPiece> = Vec::new();
    let mut open: Vec<&str> = names.to_vec();
    while let Some(name) = open.pop() {
        let piece = find(name).unwrap_or_else(|| panic!("'{name}' is no piece"));
        if !pieces.contains(&piece) {
            pieces.push(piece);
            open.extend(piece.uses());
        }
    }
    pieces.sort_by_key(|piece| piece.name);
    let mut shader = Shader { text: String::new(), parts: Vec::new() };
    shader.append(GENERATED, text);
    for piece in pieces {
        shader.append(piece.file, piece.text);
    }
    shader
}

impl Shader {
    fn append(&mut self, file: &'static str, text: &str) {
        self.parts.push((self.text.lines().count() + 1, file));
        self.text.push_str(text);
        if !text.ends_with('\n') {
            self.text.push('\n');
        }
    }

    /// Files of the pieces in it.
    pub fn files(&self) -> impl Iterator<Item = &'static str> {
        self.parts.iter().map(|(_, file)| *file).filter(|file| *file != GENERATED)
    }

    /// The file that a line (from 1) of the text came from, and the line there.
    pub fn locate(&self, line: usize) -> (&'static str, usize) {
        let part = self.parts.iter().rev().find(|(start, _)| *start <= line);
        part.map_or((GENERATED, line), |(start, file)| (file, line - start + 1))
    }

    /// Error at the piece's own line from a shader compiler's message about a line (from 1) of the text.
    pub fn error(&self, line: usize, message: &str) -> Error {
        let (file, line) = self.locate(line);
        Error::run("a shader does not compile").got(message).in_file(file).at_line(line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slots that the generated block fills. `wave_mean_on_flank` it fills by choosing between the pieces that do.
    const FILLS: &[&str] = &[
        "values",
        "numbers",
        "members",
        "segment",
        "straight_segment",
        "axes",
        "finish",
        "wave_mean_on_flank",
        "positions",
        "quantity",
        "seen",
        "attributes",
        "tetrahedra",
        "bounds",
        "texels",
        "glows",
    ];

    #[test]
    fn every_header_is_complete_and_names_pieces() {
        for piece in PIECES {
            let header = piece.text.lines().next().unwrap_or("");
            assert!(header.starts_with("// Uses: ") && header.contains(". Fills: "), "{}", piece.file);
            assert!(header.ends_with('.'), "{}", piece.file);
            for name in piece.uses() {
                assert!(super::piece(name).is_some(), "{} uses '{name}', which is no piece", piece.file);
            }
            for slot in piece.list("Asks for: ") {
                let filled = PIECES.iter().any(|other| other.fills().contains(&slot));
                let filled = filled || FILLS.contains(&slot);
                assert!(filled, "{} asks for '{slot}', which nothing fills", piece.file);
            }
        }
    }

    #[test]
    fn a_line_is_found_in_its_own_file() {
        let shader = compose_pieces("const A = 1;\nconst B = 2;", &["elementary/one_minus_exp"]);
        assert_eq!(shader.locate(2), (GENERATED, 2));
        let exponential = "shaders/wgsl/elementary/exponential.wgsl";
        let one_minus_exp = "shaders/wgsl/elementary/one_minus_exp.wgsl";
        assert_eq!(shader.files().collect::<Vec<_>>(), [exponential, one_minus_exp]);
        for (n, line) in shader.text.lines().enumerate() {
            let (file, at) = shader.locate(n + 1);
            if let Some(piece) = PIECES.iter().find(|piece| piece.file == file) {
                assert_eq!(piece.text.lines().nth(at - 1), Some(line));
            }
        }
        let error = shader.error(3, "wrong").to_string();
        assert!(error.contains(&format!("{exponential}:1:1")), "{error}");
    }
}
