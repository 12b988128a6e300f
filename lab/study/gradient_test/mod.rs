//! The test of gradient filters: how right each one is, how it scales, what it costs and what it does to a picture, one
//! filter beside others. Truth is formulas alone.

mod manufactured;
mod measurements;
mod report;
mod requirements;

pub use report::{
    Convergence, Cost, DataError, Exactness, Fault, FilterReport, GradientTest, Invariance, Materials, Noise,
    PictureError, Series, TestOptions, methods, page, plot, text,
};
pub use requirements::{Requirement, RequirementKind};

use manufactured::Mesh;
use measurements::{Subject, TestRenderer};
use std::sync::atomic::{AtomicUsize, Ordering};
use voltet_core::Result;
use voltet_core::field::Method;
use voltet_core::grid::Grid;
use voltet_core::progress::Progress;

/// Measures filters; the first is held to the wish. `data`: a grid of the user's, on which they are measured, too.
///
/// Errors: a stopped run, and what keeps a picture from being drawn. A filter that fails is no error: it is what is found.
pub fn gradient_test(
    methods: &[Method],
    wish: &TestOptions,
    data: Option<&Grid>,
    progress: &dyn Progress,
) -> Result<GradientTest> {
    let levels = wish.levels.len();
    let (meshes, exact, own) = (Mesh::ALL.len(), Mesh::EXACT.len(), usize::from(data.is_some()));
    // Of each filter: convergence, exactness, materials, six changes, two noises; then the user's grid, times and a picture.
    let pieces = (levels * meshes + exact + levels + 6 + 2 + own + wish.rounds + 1 + 1) * methods.len();
    let done = AtomicUsize::new(0);
    let step = |stage: &str| {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report(stage, done as f64 / pieces as f64);
    };
    let mut subjects: Vec<Subject<'_>> =
        methods.iter().map(|method| Subject::new(method, progress, &step)).collect();
    subjects.iter_mut().try_for_each(|subject| subject.measure(&wish.levels))?;
    data.map_or(Ok(()), |grid| measurements::on_data(&mut subjects, grid))?;
    measurements::costs(&mut subjects, wish.timed, wish.rounds)?;
    let renderer = TestRenderer::new(progress)?;
    subjects.iter_mut().try_for_each(|subject| renderer.compare(subject))?;
    let filters: Vec<FilterReport> = subjects.into_iter().map(|subject| subject.found).collect();
    let requirements = filters.first().map_or(Vec::new(), |first| requirements::requirements(first, wish));
    let warnings = filters.first().map_or(Vec::new(), |first| requirements::warnings(first, wish));
    Ok(GradientTest {
        filters,
        requirements,
        warnings,
        levels: wish.levels.clone(),
        threads: rayon::current_num_threads(),
        engine: renderer.engine.label(),
        exact_png: renderer.exact_png()?,
    })
}

#[cfg(test)]
mod tests;
