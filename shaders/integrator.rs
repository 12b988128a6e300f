//! Shader text of integrators from outside.

use crate::pieces::WgslPiece;
use voltet_core::transfer::TransferFunction;
use voltet_optics::integrators::Integrator;

/// Extension by which a kind of integrators has shader text ([`voltet_optics::integrators::IntegratorKind::extensions`]).
pub struct WgslExtension(pub &'static dyn WgslIntegrator);

/// Shader text of a kind of integrators. Without one, devices do not draw with it.
pub trait WgslIntegrator: Send + Sync {
    /// A name of its own: equal names mean equal text.
    fn name(&self) -> &'static str;

    /// The pieces that the crate of the integrator adds to those that ship ([`crate::PIECES`]).
    fn pieces(&self) -> &'static [WgslPiece];

    /// The call that integrates a segment.
    fn call(&self, constant_emitter: bool) -> WgslCall;

    /// Samples or pieces of a segment: `scene.piece_count`.
    fn piece_count(&self, _integrator: &Integrator) -> Option<usize> {
        None
    }

    /// Size of the table that the text reads.
    fn table_size(&self, _integrator: &Integrator, _transfer_function: &TransferFunction) -> TableSize {
        TableSize::default()
    }

    /// The numbers of a table that stand in front of those of the widgets ([`TableSize::entries`] of them).
    fn entries(&self, _integrator: &Integrator, _transfer_function: &TransferFunction) -> Vec<f32> {
        Vec::new()
    }
}

/// Size of the table that an integrator's text reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TableSize {
    /// Vectors that stand for all widgets ([`WgslCall::Table`]); 0 without such a table.
    pub vectors: u64,
    /// Vectors of the table that those are made from, if it is another: it has buffers of its own.
    pub source_vectors: u64,
    /// Numbers beside the vectors.
    pub entries: u64,
}

/// The call of a function that integrates a segment; the function returns the colour, and the optical depth in the fourth component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WgslCall {
    /// A function of the widgets as members (`Members`) and the number of pieces.
    Samples {
        /// Its name.
        function: &'static str,
        /// The pieces that it stands in.
        pieces: &'static [&'static str],
        /// True if the pieces read `numbers`.
        reads_numbers: bool,
    },
    /// A function of length, scalar at the front and scalar at the back, which reads a table that stands for all widgets.
    Table {
        /// Its name.
        function: &'static str,
        /// The pieces that it stands in.
        pieces: &'static [&'static str],
    },
}

/// Shader text, compared by its name.
#[derive(Clone, Copy)]
pub struct RegisteredMethod(pub &'static dyn WgslIntegrator);

impl std::fmt::Debug for RegisteredMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.name())
    }
}

impl PartialEq for RegisteredMethod {
    fn eq(&self, other: &RegisteredMethod) -> bool {
        self.0.name() == other.0.name()
    }
}

impl Eq for RegisteredMethod {}

impl std::hash::Hash for RegisteredMethod {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.0.name().hash(state);
    }
}

/// The shader text of an integrator's kind.
pub(crate) fn registered(integrator: &Integrator) -> Option<&'static dyn WgslIntegrator> {
    integrator.extension().map(|WgslExtension(text)| *text)
}
