//! Waiting for the GPU: as a future, so that the same code runs where blocking is not allowed.

use std::{
    future::Future,
    pin::Pin,
    sync::{Arc, Mutex, PoisonError},
    task::{Context, Poll, Waker},
};

use crate::error::GpuError;

/// The state that a callback and the future that waits for it share.
struct Shared<T> {
    value: Option<T>,
    /// Whether the callback was dropped: there will be no value then, and nothing to wait for.
    is_broken: bool,
    waker: Option<Waker>,
}

/// A value that a callback will bring; `None` if the callback is dropped without being called.
pub(crate) struct Pending<T>(Arc<Mutex<Shared<T>>>);

/// Where the callback puts it.
pub(crate) struct Promise<T>(Arc<Mutex<Shared<T>>>);

/// A promise and what waits for it.
pub(crate) fn promise<T>() -> (Promise<T>, Pending<T>) {
    let shared = Arc::new(Mutex::new(Shared { value: None, is_broken: false, waker: None }));
    (Promise(Arc::clone(&shared)), Pending(shared))
}

impl<T> Promise<T> {
    pub(crate) fn keep(self, value: T) {
        // A poisoned lock means that a waker panicked; the value is still whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).value = Some(value);
    }
}

impl<T> Drop for Promise<T> {
    /// Wakes whoever waits, whether the promise was kept or not.
    fn drop(&mut self) {
        let mut shared = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        shared.is_broken = shared.value.is_none();
        if let Some(waker) = shared.waker.take() {
            waker.wake();
        }
    }
}

impl<T> Future for Pending<T> {
    type Output = Option<T>;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<T>> {
        let mut shared = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(value) = shared.value.take() {
            return Poll::Ready(Some(value));
        }
        if shared.is_broken {
            return Poll::Ready(None);
        }
        shared.waker = Some(context.waker().clone());
        Poll::Pending
    }
}

/// The error of a device that stopped working.
pub(crate) fn driver_error(device: &wgpu::Device, message: impl Into<String>) -> GpuError {
    GpuError::Driver { adapter: device.adapter_info().name, message: message.into() }
}

/// Lets the callbacks of finished work run: outside browsers somebody has to ask for it.
pub(crate) fn run_callbacks(device: &wgpu::Device) -> Result<(), GpuError> {
    match device.poll(wgpu::PollType::wait_indefinitely()) {
        Ok(_) => Ok(()),
        Err(error) => Err(driver_error(device, format!("waiting for it failed: {error}"))),
    }
}

/// Waits until everything that was submitted is done.
pub(crate) async fn submitted_work(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<(), GpuError> {
    let (promise, pending) = promise();
    queue.on_submitted_work_done(move || promise.keep(()));
    run_callbacks(device)?;
    pending.await.ok_or_else(|| driver_error(device, "it never finished its work"))
}

#[cfg(test)]
mod tests {
    use std::task::Waker;

    use super::*;

    fn poll<T>(pending: &mut Pending<T>) -> Poll<Option<T>> {
        Pin::new(pending).poll(&mut Context::from_waker(Waker::noop()))
    }

    #[test]
    fn a_kept_promise_brings_its_value() {
        let (promise, mut pending) = promise();
        assert_eq!(poll(&mut pending), Poll::Pending);
        promise.keep(7);
        assert_eq!(poll(&mut pending), Poll::Ready(Some(7)));
    }

    #[test]
    fn a_broken_promise_ends_the_wait() {
        let (promise, mut pending) = promise::<u32>();
        drop(promise);
        assert_eq!(poll(&mut pending), Poll::Ready(None));
    }
}
