//! Buffers and textures that are used again: what is new to a software adapter costs a page fault for every 4 KiB, and a picture has many.

use std::{
    ops::Deref,
    sync::{Arc, Mutex, PoisonError},
};

/// The most resources of a kind that wait to be used again. A frame has a few; those of sizes that no frame has any more make room.
const MAX_WAITING: usize = 16;

/// Resources that wait to be used again.
pub(crate) struct Shelf<T>(Arc<Mutex<Vec<T>>>);

/// A resource that goes back to its shelf when it is dropped.
pub(crate) struct Kept<T: Clone> {
    resource: T,
    shelf: Arc<Mutex<Vec<T>>>,
}

impl<T: Clone> Shelf<T> {
    /// One that fits, or a new one. What it holds is left from earlier: all of it must be written.
    pub(crate) fn take(&self, fits: impl Fn(&T) -> bool, new: impl FnOnce() -> T) -> Kept<T> {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = waiting.iter().position(fits).map(|index| waiting.swap_remove(index));
        drop(waiting);
        Kept { resource: found.unwrap_or_else(new), shelf: Arc::clone(&self.0) }
    }
}

impl<T> Default for Shelf<T> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

impl<T: Clone> Deref for Kept<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.resource
    }
}

impl<T: Clone> Drop for Kept<T> {
    fn drop(&mut self) {
        let mut waiting = self.shelf.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.len() == MAX_WAITING {
            waiting.remove(0);
        }
        waiting.push(self.resource.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_dropped_is_taken_again_where_it_fits() {
        let shelf = Shelf::<u32>::default();
        drop(shelf.take(|_| true, || 7));
        let seven = shelf.take(|&number| number == 7, || unreachable!());
        assert_eq!(*shelf.take(|&number| number == 7, || 8), 8, "only one was there");
        drop(seven);
        let many: Vec<_> = (0..100).map(|i| shelf.take(|_| false, move || i)).collect();
        drop(many);
        assert_eq!(shelf.0.lock().unwrap().len(), MAX_WAITING);
    }
}
