//! Text of the shader of a scene, composed of pieces by its key.

use crate::generate::generate;
use crate::parts::Layout;
use crate::passes::FramePass;
use crate::pieces::{PIECES, WgslPiece};
use crate::shader_key::ShaderKey;
use crate::text::{Shader, compose_pieces_with};

/// The shader of a scene.
pub fn compose(shader_key: &ShaderKey) -> Shader {
    let generated = generate(shader_key);
    compose_pieces_with(&generated.text, &generated.uses, shader_key.method.pieces())
}

impl Shader {
    /// The pieces that are not in it although some scene asks for them: what makes frames is put together apart.
    pub fn leaves_out(&self) -> Vec<&'static WgslPiece> {
        let frames: Vec<Shader> = FramePass::ALL.iter().map(|pass| pass.shader(&Layout::WHOLE)).collect();
        let apart = |piece: &WgslPiece| frames.iter().any(|frame| frame.files().any(|f| f == piece.file));
        PIECES.iter().filter(|piece| !apart(piece) && !self.files().any(|file| file == piece.file)).collect()
    }
}
