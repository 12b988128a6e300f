//! Shader text of integrators from outside.

use crate::choices::Choices;
use crate::pieces::WgslPiece;
use crate::places::Places;
use crate::resources::Resources;
use crate::writer::Axis;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::integrators::{Extent, Integrator};

/// The extension by which a kind of integrators has shader text
/// ([`voltet_optics::integrators::IntegratorKind::extensions`]).
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

    /// The sizes of what stands in the buffer `numbers`; `places`: without a table.
    fn places(
        &self,
        _integrator: &Integrator,
        _transfer_function: &TransferFunction,
        places: Places,
    ) -> Places {
        places
    }

    /// The numbers of a table that stand in front of those of the widgets ([`Places::entries`] of them).
    fn entries(&self, _integrator: &Integrator, _transfer_function: &TransferFunction) -> Vec<f32> {
        Vec::new()
    }

    /// The buffers and passes of a table that stands for all widgets ([`WgslCall::Table`]).
    ///
    /// Errors: data without a domain for the table.
    fn fill(&self, _resources: &mut Resources, _scene: &TableScene<'_>) -> Result<()> {
        Ok(())
    }
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

/// The scene that a table is filled for.
pub struct TableScene<'a> {
    /// The choices of the shader that reads the table.
    pub choices: &'a Choices,
    /// The integrator.
    pub integrator: &'a Integrator,
    /// The transfer function.
    pub transfer_function: &'a TransferFunction,
    /// The sizes of what stands in the buffer `numbers`.
    pub places: Places,
    /// Storage of the scalar.
    pub axis: Axis,
    /// World units in a scene length.
    pub length: f64,
    /// The domain of the table.
    pub extent: &'a Extent,
    /// Numbers behind those of the table.
    pub numbers: &'a [f32],
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
