//! Work side by side that may fail.

use crate::Result;
use rayon::prelude::*;

/// Values of tasks, in their order. Errors: that of the first task that has one, whichever the threads meet first; tasks behind it are
/// left out as soon as it is known.
pub fn all_or_first<T: Send>(results: impl IndexedParallelIterator<Item = Result<T>>) -> Result<Vec<T>> {
    let mut values: Vec<Option<T>> = std::iter::repeat_with(|| None).take(results.len()).collect();
    let failed = results.zip(&mut values).find_map_first(|(result, value)| match result {
        Ok(own) => {
            *value = Some(own);
            None
        }
        Err(error) => Some(error),
    });
    failed.map_or_else(|| Ok(values.into_iter().flatten().collect()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;
    use std::sync::Barrier;

    #[test]
    fn the_error_is_that_of_the_first_task_though_the_last_fails_before() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let last_failed = Barrier::new(2);
        let of_task = |task: usize| {
            if [0, 99].contains(&task) {
                last_failed.wait();
            }
            match task {
                // Long after the other thread went on with its error.
                0 => Err(Error::run((0..1_000_000).fold("task 0", |text, _| std::hint::black_box(text)))),
                99 => Err(Error::run("task 99")),
                _ => Ok(task),
            }
        };
        let failed = pool.install(|| all_or_first((0..100).into_par_iter().map(of_task)));
        assert_eq!(failed.unwrap_err().to_string(), "task 0");
        let all = pool.install(|| all_or_first((0..100).into_par_iter().map(Ok::<usize, Error>)));
        assert!(all.unwrap().into_iter().eq(0..100));
    }
}
