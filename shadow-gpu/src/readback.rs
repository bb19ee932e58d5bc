//! Bringing results back from the GPU.

use bytemuck::Pod;

use crate::{
    error::GpuError,
    wait::{driver_error, promise, run_callbacks},
};

/// The contents of a buffer that has `COPY_SRC`, as numbers.
pub(crate) async fn read_buffer<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    source: &wgpu::Buffer,
    count: usize,
) -> Result<Vec<T>, GpuError> {
    let bytes = (count * size_of::<T>()) as u64;
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("staging"),
        size: bytes.max(wgpu::COPY_BUFFER_ALIGNMENT),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, bytes);
    queue.submit([encoder.finish()]);
    let (promise, pending) = promise();
    staging.slice(..).map_async(wgpu::MapMode::Read, move |result| promise.keep(result));
    run_callbacks(device)?;
    let failed = |message: String| driver_error(device, format!("reading a buffer back failed: {message}"));
    match pending.await {
        Some(Ok(())) => {}
        Some(Err(error)) => return Err(failed(error.to_string())),
        None => return Err(failed("it never answered".into())),
    }
    let view = staging.slice(..bytes).get_mapped_range().map_err(|error| failed(error.to_string()))?;
    // The mapped memory need not be aligned for T.
    let mut values = vec![T::zeroed(); count];
    bytemuck::cast_slice_mut::<T, u8>(&mut values).copy_from_slice(&view);
    Ok(values)
}
