//! Time and memory on one large grid, filters taking turns.

use super::fields::SMOOTH;
use super::meshes::Mesh;
use super::report::Cost;
use super::subject::Subject;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::grid::generate::sample;
use voltet_core::progress::Progress;
use voltet_io::memory;

/// Measures all of them: `rounds` times each after one that warms up.
pub(super) fn costs(
    subjects: &mut [Subject<'_>],
    count: usize,
    rounds: usize,
    progress: &dyn Progress,
    step: &dyn Fn(),
) -> Result<()> {
    let grid = Mesh::Distorted.grid(count).grid;
    let scalar = sample(&grid, SMOOTH[0].value);
    let mut seconds = vec![Vec::with_capacity(rounds); subjects.len()];
    let mut most: Vec<Option<u64>> = vec![None; subjects.len()];
    for round in 0..=rounds {
        for (k, subject) in subjects.iter_mut().enumerate() {
            let before = memory::forget_peak().then(memory::peak).flatten();
            let at = || format!("the grid of {} points that is timed", grid.points.len());
            let faults = subject.found.faults.len();
            let begun = Instant::now();
            let found = subject.gradient(at, &grid, &scalar, progress)?;
            let taken = begun.elapsed().as_secs_f64();
            if round > 0 {
                // Said once.
                subject.found.faults.truncate(faults);
            }
            let peak = memory::peak().zip(before).map(|(peak, before)| peak.saturating_sub(before));
            if found.is_some() && round > 0 {
                seconds[k].push(taken);
            }
            // The first takes memory that the later ones have.
            most[k] = most[k].max(peak);
            step();
        }
    }
    for ((subject, mut seconds), memory_bytes) in subjects.iter_mut().zip(seconds).zip(most) {
        seconds.sort_by(f64::total_cmp);
        let (Some(&fastest_s), Some(&slowest_s)) = (seconds.first(), seconds.last()) else { continue };
        subject.found.cost = Some(Cost {
            points: grid.points.len(),
            tetrahedra: grid.tetrahedra.len(),
            median_s: seconds[seconds.len() / 2],
            fastest_s,
            slowest_s,
            memory_bytes,
        });
    }
    Ok(())
}
