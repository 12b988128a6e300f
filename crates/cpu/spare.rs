//! What a frame leaves to the next one: what was found out, and memory, since pages that nobody has touched yet cost as much as
//! projecting a cell does.

use crate::composite::lists::Lists;
use crate::project::tiles::Tiles;
use std::sync::{Arc, Mutex, PoisonError};

/// What lies there to be used again.
#[derive(Debug, Default)]
pub(crate) struct Spare {
    pub tiles: Shelf<Tiles>,
    pub lists: Shelf<Lists>,
}

/// Things of one kind; which of them one gets, no picture depends on.
#[derive(Debug)]
pub(crate) struct Shelf<T>(Mutex<Vec<T>>);

impl<T> Default for Shelf<T> {
    fn default() -> Shelf<T> {
        Shelf(Mutex::new(Vec::new()))
    }
}

impl<T: Default> Shelf<T> {
    /// One that was put back, the last first, or else a new one.
    pub fn take(&self) -> T {
        self.with(Vec::pop).unwrap_or_default()
    }

    pub fn put(&self, thing: T) {
        self.with(|things| things.push(thing));
    }

    fn with<U>(&self, act: impl FnOnce(&mut Vec<T>) -> U) -> U {
        // A thing is whole in a list whatever panicked elsewhere.
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// What is kept if it is right, else made anew and kept instead. Nobody waits for another who makes it.
pub(crate) fn kept<T>(
    place: &Mutex<Option<Arc<T>>>,
    is_right: impl Fn(&T) -> bool,
    make: impl FnOnce() -> T,
) -> Arc<T> {
    let there = place.lock().unwrap_or_else(PoisonError::into_inner).clone();
    if let Some(there) = there.filter(|there| is_right(there)) {
        return there;
    }
    let made = Arc::new(make());
    *place.lock().unwrap_or_else(PoisonError::into_inner) = Some(made.clone());
    made
}
