//! Waiting for the GPU: as a future, so that the same code runs where blocking is not allowed.

use std::{
    future::Future,
    pin::Pin,
    sync::{Arc, Mutex, PoisonError},
    task::{Context, Poll, Waker},
};

/// The state that a callback and the future that waits for it share.
struct Shared<T> {
    value: Option<T>,
    waker: Option<Waker>,
}

/// A value that a callback will bring.
pub(crate) struct Pending<T>(Arc<Mutex<Shared<T>>>);

/// Where the callback puts it.
pub(crate) struct Promise<T>(Arc<Mutex<Shared<T>>>);

/// A promise and what waits for it.
pub(crate) fn promise<T>() -> (Promise<T>, Pending<T>) {
    let shared = Arc::new(Mutex::new(Shared { value: None, waker: None }));
    (Promise(Arc::clone(&shared)), Pending(shared))
}

impl<T> Promise<T> {
    pub(crate) fn keep(self, value: T) {
        // A poisoned lock means that a waker panicked; the value is still whole.
        let mut shared = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        shared.value = Some(value);
        if let Some(waker) = shared.waker.take() {
            waker.wake();
        }
    }
}

impl<T> Future for Pending<T> {
    type Output = T;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<T> {
        let mut shared = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match shared.value.take() {
            Some(value) => Poll::Ready(value),
            None => {
                shared.waker = Some(context.waker().clone());
                Poll::Pending
            }
        }
    }
}

/// Lets the callbacks of finished work run: outside browsers somebody has to ask for it.
pub(crate) fn run_callbacks(device: &wgpu::Device) {
    // An error here means that the device is lost, which its own callback reports.
    let _ = device.poll(wgpu::PollType::wait_indefinitely());
}

/// Waits until everything that was submitted is done.
pub(crate) async fn submitted_work(device: &wgpu::Device, queue: &wgpu::Queue) {
    let (promise, pending) = promise();
    queue.on_submitted_work_done(move || promise.keep(()));
    run_callbacks(device);
    pending.await;
}
