//! Progress of long work, and stopping it.

/// Receives progress and says whether the work should stop. Shared by all threads of a stage.
pub trait Progress: Sync {
    /// A stage is `fraction` (0 … 1) done. May be called from any thread, often; cheap when ignored.
    fn report(&self, stage: &str, fraction: f64);
    /// True once the user asked to stop; long loops ask now and then and return [`crate::Error::cancelled`].
    fn cancelled(&self) -> bool {
        false
    }
}

/// Ignores progress and never stops.
pub struct Silent;

impl Progress for Silent {
    fn report(&self, _stage: &str, _fraction: f64) {}
}

/// Hands on that the work should stop, and no progress: for parts of a work whose own progress says nothing of the whole.
pub struct Unreported<'a>(pub &'a dyn Progress);

impl Progress for Unreported<'_> {
    fn report(&self, _stage: &str, _fraction: f64) {}

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
