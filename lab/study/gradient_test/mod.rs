//! The test of gradient filters: how right each one is, how it scales, what it costs and what it does to a picture, one
//! filter beside others. Truth is formulas alone.
//!
//! | file | what |
//! | --- | --- |
//! | `options`, `filters`, `requirements` | what is measured, of which filters, and what the first is held to |
//! | `fields`, `meshes` | manufactured fields, and families of grids |
//! | `convergence` | errors on finer and finer grids, exactness, two materials |
//! | `invariance`, `noise`, `cost`, `picture` | the other measurements |
//! | `subject` | a filter that is measured, and what it says meanwhile |
//! | `report` | what is found |
//! | `text`, `plot`, `page` | how it is shown |

mod convergence;
mod cost;
mod fields;
mod filters;
mod invariance;
mod meshes;
mod noise;
mod options;
mod page;
mod picture;
mod plot;
mod report;
mod requirements;
mod subject;
mod text;

pub use filters::methods;
pub use options::{RequirementKind, TestOptions};
pub use page::page;
pub use plot::plot;
pub use report::{
    Convergence, Cost, Exactness, Fault, FilterReport, GradientTest, Invariance, Materials, Noise,
    PictureError, Requirement, Series,
};
pub use text::text;

use meshes::Mesh;
use picture::TestRenderer;
use std::sync::atomic::{AtomicUsize, Ordering};
use subject::Subject;
use voltet_core::Result;
use voltet_core::field::Method;
use voltet_core::progress::Progress;

/// Measures filters; the first is held to the wish.
///
/// Errors: a stopped run, and what keeps a picture from being drawn. A filter that fails is no error: it is what is found.
pub fn gradient_test(
    methods: &[Method],
    wish: &TestOptions,
    progress: &dyn Progress,
) -> Result<GradientTest> {
    let mut subjects: Vec<Subject<'_>> = methods.iter().map(Subject::new).collect();
    let pieces = Pieces::of(wish, subjects.len());
    let done = AtomicUsize::new(0);
    let step = |stage: &str| {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report(stage, done as f64 / pieces.all() as f64);
    };
    for subject in &mut subjects {
        let name = subject.found.name.clone();
        let step = || step(&name);
        subject.found.convergence = convergence::convergence(subject, &wish.levels, progress, &step)?;
        subject.found.exactness = convergence::exactness(subject, progress, &step)?;
        subject.found.materials = convergence::materials(subject, &wish.levels, progress, &step)?;
        subject.found.invariance = invariance::invariance(subject, progress, &step)?;
        subject.found.noise = noise::noise(subject, progress, &step)?;
    }
    cost::costs(&mut subjects, wish.timed, wish.rounds, progress, &|| step("time"))?;
    let renderer = TestRenderer::new(progress)?;
    for subject in &mut subjects {
        subject.found.picture = renderer.draw(subject, progress)?;
        step("picture");
    }
    let filters: Vec<FilterReport> = subjects.into_iter().map(|subject| subject.found).collect();
    let requirements = filters.first().map_or(Vec::new(), |first| requirements::requirements(first, wish));
    Ok(GradientTest {
        filters,
        requirements,
        levels: wish.levels.clone(),
        threads: rayon::current_num_threads(),
        engine: renderer.engine(),
        exact_png: renderer.exact_png()?,
    })
}

/// Number of steps the work has, for the progress.
struct Pieces {
    of_each: usize,
    filters: usize,
}

impl Pieces {
    fn of(wish: &TestOptions, filters: usize) -> Pieces {
        let (levels, meshes) = (wish.levels.len(), Mesh::EVERY.len());
        // Convergence, exactness, materials, six changes, two noises; then times and a picture.
        let of_each = levels * meshes + meshes + levels + 6 + 2 + wish.rounds + 1 + 1;
        Pieces { of_each, filters }
    }

    fn all(&self) -> usize {
        self.of_each * self.filters
    }
}

#[cfg(test)]
mod tests;
