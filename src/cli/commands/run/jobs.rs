//! Pieces of work by several threads at a time, of which the results are taken in order.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

/// Pieces for each thread that may be begun before the first result that is not taken yet.
const AHEAD: usize = 16;

/// Does `count` pieces of work, `jobs` at a time, and takes the results one after the other: `take` has the number of a piece and
/// a function that waits for its result, and gives false to stop. `worker`: the state of one thread; `prepare`: work for the next
/// piece, which is done while one alone is in work.
pub(super) fn in_order<W, T: Send, E>(
    (count, jobs): (usize, usize),
    worker: impl Fn() -> W + Sync,
    (work, prepare): (impl Fn(&mut W, usize) -> T + Sync, impl Fn(usize) + Sync),
    mut take: impl FnMut(usize, &mut dyn FnMut() -> T) -> Result<bool, E>,
) -> Result<(), E> {
    let jobs = jobs.min(count);
    if jobs < 2 {
        let mut own = worker();
        for piece in 0..count {
            let mut work = || {
                thread::scope(|scope| {
                    if piece + 1 < count {
                        scope.spawn(|| prepare(piece + 1));
                    }
                    work(&mut own, piece)
                })
            };
            if !take(piece, &mut work)? {
                break;
            }
        }
        return Ok(());
    }
    let queue = Queue { count, ahead: AHEAD * jobs, state: Mutex::default(), has_changed: Condvar::new() };
    thread::scope(|scope| {
        // The threads end with the function, however it does.
        let _stop = StopOnDrop(&queue);
        for _ in 0..jobs {
            scope.spawn(|| {
                let mut own = worker();
                while let Some(piece) = queue.next() {
                    queue.put(piece, catch_unwind(AssertUnwindSafe(|| work(&mut own, piece))));
                }
            });
        }
        for piece in 0..count {
            if !take(piece, &mut || queue.wait(piece))? {
                break;
            }
        }
        Ok(())
    })
}

/// Pieces of work that several threads take.
struct Queue<T> {
    count: usize,
    /// Pieces that may be begun before the first one that is not taken yet.
    ahead: usize,
    state: Mutex<QueueState<T>>,
    has_changed: Condvar,
}

struct QueueState<T> {
    next: usize,
    taken: usize,
    is_stopped: bool,
    done: BTreeMap<usize, thread::Result<T>>,
}

impl<T> Default for QueueState<T> {
    fn default() -> Self {
        QueueState { next: 0, taken: 0, is_stopped: false, done: BTreeMap::new() }
    }
}

impl<T> Queue<T> {
    fn lock(&self) -> MutexGuard<'_, QueueState<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until something changes.
    fn changed<'a>(&self, state: MutexGuard<'a, QueueState<T>>) -> MutexGuard<'a, QueueState<T>> {
        self.has_changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    /// The next piece of work; waits while too many results are not taken. `None`: there is none.
    fn next(&self) -> Option<usize> {
        let mut state = self.lock();
        loop {
            if state.is_stopped || state.next >= self.count {
                return None;
            }
            if state.next < state.taken + self.ahead {
                state.next += 1;
                return Some(state.next - 1);
            }
            state = self.changed(state);
        }
    }

    fn put(&self, piece: usize, result: thread::Result<T>) {
        self.lock().done.insert(piece, result);
        self.has_changed.notify_all();
    }

    /// Waits for the result of a piece; a panic of its thread goes on here.
    fn wait(&self, piece: usize) -> T {
        let mut state = self.lock();
        loop {
            if let Some(result) = state.done.remove(&piece) {
                state.taken = piece + 1;
                drop(state);
                self.has_changed.notify_all();
                return result.unwrap_or_else(|panic| resume_unwind(panic));
            }
            state = self.changed(state);
        }
    }
}

/// Ends the work of the threads when it is dropped.
struct StopOnDrop<'a, T>(&'a Queue<T>);

impl<T> Drop for StopOnDrop<'_, T> {
    fn drop(&mut self) {
        self.0.lock().is_stopped = true;
        self.0.has_changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn taken(jobs: usize, work: impl Fn(usize) -> usize + Sync, last: usize) -> Vec<(usize, usize)> {
        let mut all = Vec::new();
        let take = |piece: usize, result: &mut dyn FnMut() -> usize| {
            all.push((piece, result()));
            Ok::<bool, ()>(piece < last)
        };
        in_order((100, jobs), || (), (|(): &mut (), piece| work(piece), |_| ()), take).unwrap();
        all
    }

    #[test]
    fn results_come_in_order_whatever_the_threads_do() {
        let squares: Vec<(usize, usize)> = (0..100).map(|piece| (piece, piece * piece)).collect();
        for jobs in [1, 2, 7, 1000] {
            assert_eq!(taken(jobs, |piece| piece * piece, 1000), squares, "{jobs}");
            assert_eq!(taken(jobs, |piece| piece * piece, 30), squares[..=30], "{jobs}");
        }
    }

    /// Each piece waits for another, which no single thread could meet.
    #[test]
    fn several_pieces_are_in_work_at_a_time() {
        let both = Barrier::new(2);
        let pairs = taken(
            2,
            |piece| {
                both.wait();
                piece
            },
            1000,
        );
        assert_eq!(pairs.len(), 100);
    }

    #[test]
    fn no_more_results_wait_than_are_asked_for() {
        let begun = AtomicUsize::new(0);
        let jobs = 3;
        let take = |piece: usize, result: &mut dyn FnMut()| {
            result();
            let begun = begun.load(Ordering::SeqCst);
            assert!(begun <= piece + 1 + AHEAD * jobs, "{begun} begun at {piece}");
            Ok::<bool, ()>(true)
        };
        let work = |(): &mut (), _| {
            begun.fetch_add(1, Ordering::SeqCst);
        };
        in_order((1000, jobs), || (), (work, |_| ()), take).unwrap();
    }

    #[test]
    fn a_panic_of_a_thread_is_one_of_the_caller() {
        let work = |piece: usize| if piece == 5 { panic!("piece 5") } else { piece };
        let panic = catch_unwind(|| taken(2, work, 1000)).unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"piece 5"));
    }

    /// The work of a piece waits for the preparation of the next, which only another thread can do meanwhile.
    #[test]
    fn the_next_piece_is_prepared_while_one_is_in_work() {
        let both = Barrier::new(2);
        let work = |(): &mut (), piece| {
            if piece < 9 {
                both.wait();
            }
        };
        let prepare = |_| {
            both.wait();
        };
        let take = |_, result: &mut dyn FnMut()| {
            result();
            Ok::<bool, ()>(true)
        };
        in_order((10, 1), || (), (work, prepare), take).unwrap();
    }
}
