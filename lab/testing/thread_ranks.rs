//! Processes of a run as threads, for tests without MPI.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use voltet_core::{Error, Result};
use voltet_graph::ranks::Ranks;

/// A process as a thread.
#[derive(Debug)]
struct ThreadRank {
    rank: usize,
    to: Vec<Sender<Vec<u8>>>,
    from: Mutex<Vec<Receiver<Vec<u8>>>>,
}

impl Ranks for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.to.len()
    }

    fn exchange(&self, to_each: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        assert_eq!(to_each.len(), self.to.len(), "a message to each process");
        let gone = || Error::run("another process ended");
        for (to, bytes) in self.to.iter().zip(to_each) {
            to.send(bytes).map_err(|_| gone())?;
        }
        self.from.lock().unwrap().iter().map(|from| from.recv().map_err(|_| gone())).collect()
    }
}

/// Runs work on so many threads, each a process of one run; gives what each gave, in order.
pub fn on_ranks<T: Send>(count: usize, work: impl Fn(Arc<dyn Ranks>) -> T + Sync) -> Vec<T> {
    let mut ranks: Vec<ThreadRank> =
        (0..count).map(|rank| ThreadRank { rank, to: Vec::new(), from: Mutex::default() }).collect();
    for from in 0..count {
        for to in 0..count {
            let (sender, receiver) = channel();
            ranks[from].to.push(sender);
            ranks[to].from.get_mut().unwrap().push(receiver);
        }
    }
    std::thread::scope(|scope| {
        let threads: Vec<_> = ranks.into_iter().map(|rank| scope.spawn(|| work(Arc::new(rank)))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}
