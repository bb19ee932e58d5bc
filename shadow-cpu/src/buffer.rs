//! Memory for layers that is used again.
//!
//! The first touch of fresh memory costs a page fault for every 4 KiB, which for a map of 2048 x 2048 texels takes as long as drawing
//! 100,000 triangles into it. A [`Buffer`] goes back to its renderer when it is dropped, and the next frame gets it.

use std::{
    fmt,
    ops::{Deref, DerefMut},
    sync::{Arc, Mutex, PoisonError},
};

/// The most buffers that wait to be used again. A frame has a few layers; what a burst of lights left behind should not stay for ever.
const MAX_WAITING: usize = 16;

/// Buffers that wait to be used again.
pub(crate) struct Pool<T>(Arc<Mutex<Vec<Vec<T>>>>);

/// A layer's numbers. Dropped, its memory goes back to the renderer that made it.
pub struct Buffer<T> {
    values: Vec<T>,
    home: Pool<T>,
}

impl<T: Copy + Default> Pool<T> {
    /// A buffer of `len` values, whatever they are: all of them must be written.
    pub(crate) fn take(&self, len: usize) -> Buffer<T> {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fitting = waiting.iter().position(|values| values.len() == len);
        let values = fitting.map(|index| waiting.swap_remove(index));
        drop(waiting);
        Buffer { values: values.unwrap_or_else(|| vec![T::default(); len]), home: self.clone() }
    }
}

impl<T> Buffer<T> {
    /// The numbers, which then do not go back.
    #[must_use]
    pub fn into_vec(mut self) -> Vec<T> {
        std::mem::take(&mut self.values)
    }
}

impl<T> Drop for Buffer<T> {
    fn drop(&mut self) {
        let values = std::mem::take(&mut self.values);
        if values.is_empty() {
            return;
        }
        let mut waiting = self.home.0.lock().unwrap_or_else(PoisonError::into_inner);
        // The oldest makes room: sizes that no frame has any more die out.
        if waiting.len() == MAX_WAITING {
            waiting.remove(0);
        }
        waiting.push(values);
    }
}

impl<T> Deref for Buffer<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.values
    }
}

impl<T> DerefMut for Buffer<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values
    }
}

impl<T> AsRef<[T]> for Buffer<T> {
    fn as_ref(&self) -> &[T] {
        &self.values
    }
}

impl<T> From<Vec<T>> for Buffer<T> {
    fn from(values: Vec<T>) -> Self {
        Self { values, home: Pool::default() }
    }
}

impl<T> Default for Buffer<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: Clone> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        self.values.clone().into()
    }
}

impl<T: PartialEq> PartialEq for Buffer<T> {
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

impl<T: fmt::Debug> fmt::Debug for Buffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.values.fmt(f)
    }
}

impl<T> Clone for Pool<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

impl<T> fmt::Debug for Pool<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Pool")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dropped_buffer_is_used_again_and_a_taken_one_is_not() {
        let pool = Pool::<f32>::default();
        let mut first = pool.take(3);
        first[1] = 7.0;
        drop(first);
        let again = pool.take(3);
        assert_eq!(again[1], 7.0, "the same memory");
        assert_eq!(pool.take(3)[1], 0.0, "which only one has");
        assert_eq!(again.into_vec(), [0.0, 7.0, 0.0]);
        let other = pool.take(4);
        assert_eq!((other.len(), other[1]), (4, 0.0));
    }

    #[test]
    fn no_more_wait_than_a_frame_has() {
        let pool = Pool::<u32>::default();
        let many: Vec<_> = (1..=100).map(|len| pool.take(len)).collect();
        drop(many);
        assert_eq!(pool.0.lock().unwrap().len(), MAX_WAITING);
    }
}
