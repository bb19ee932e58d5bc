//! An opened adapter, and what it complains about outside of any call that could return it.

use std::sync::{Arc, Mutex, PoisonError};

use crate::{adapter::AdapterSummary, error::GpuError};

/// What adapters need that draw a picture in a pass for each light: its pixels are 32-bit floats.
pub(crate) const BLENDABLE: wgpu::Features = wgpu::Features::FLOAT32_BLENDABLE;

/// What an adapter without memory says, and what to do about it.
const OUT_OF_MEMORY: &str = "out of memory; render a smaller picture or smaller maps, use fewer lights, or the CPU backend";

/// The first error that a device reported outside of any call that could return it.
#[derive(Clone, Default)]
pub(crate) struct DriverErrors(Arc<Mutex<Option<String>>>);

impl DriverErrors {
    /// Listens to a device. Without a listener an error would end the program.
    fn watch(device: &wgpu::Device) -> Self {
        let errors = Self::default();
        let slot = errors.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            slot.keep(match error {
                wgpu::Error::OutOfMemory { .. } => OUT_OF_MEMORY.into(),
                error => error.to_string(),
            });
        }));
        let slot = errors.clone();
        device.set_device_lost_callback(move |reason, message| {
            // Dropping the device at the end is no error.
            if reason != wgpu::DeviceLostReason::Destroyed {
                slot.keep(format!("the device was lost: {message}"));
            }
        });
        errors
    }

    fn keep(&self, message: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
    }

    /// Fails if there was an error since the last check.
    pub(crate) fn check(&self, adapter: &str) -> Result<(), GpuError> {
        match self.0.lock().unwrap_or_else(PoisonError::into_inner).take() {
            None => Ok(()),
            Some(message) => Err(GpuError::Driver { adapter: adapter.into(), message }),
        }
    }
}

/// Opens an adapter with all that its limits allow: real scenes need buffers beyond WebGPU's smallest.
pub(crate) async fn open_device(
    adapter: &wgpu::Adapter,
    summary: &AdapterSummary,
    label: &'static str,
    required_features: wgpu::Features,
) -> Result<(wgpu::Device, wgpu::Queue, DriverErrors), GpuError> {
    let descriptor =
        wgpu::DeviceDescriptor { label: Some(label), required_features, required_limits: adapter.limits(), ..Default::default() };
    let (device, queue) =
        adapter.request_device(&descriptor).await.map_err(|source| GpuError::Device { adapter: summary.name.clone(), source })?;
    let errors = DriverErrors::watch(&device);
    Ok((device, queue, errors))
}
