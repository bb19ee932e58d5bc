//! Buffers and their contents.

use bytemuck::Pod;
use shadow_math::material::{ALPHA_TABLE, DECODE_TABLE_LEN};
use shadow_math::{
    material::MaterialData,
    plan::{LightPlan, ViewPlan},
};
use shadow_scene::{Scene, Surfaces};

use crate::{
    error::GpuError,
    shaders::TABLE_WIDTH_BITS,
    wait::{driver_error, promise, run_callbacks},
};

/// Creates a buffer with contents; never empty, since WebGPU cannot bind nothing, and wants room for one element of the
/// array that a shader reads even where there are none, as in a scene without triangles.
pub(crate) fn buffer_with(device: &wgpu::Device, label: &str, usage: wgpu::BufferUsages, contents: &[u8]) -> wgpu::Buffer {
    const SMALLEST: usize = 512;
    const LARGEST_ELEMENTS: [usize; 3] = [size_of::<MaterialData>(), size_of::<LightPlan>(), size_of::<ViewPlan>()];
    const { assert!(LARGEST_ELEMENTS[0] <= SMALLEST && LARGEST_ELEMENTS[1] <= SMALLEST && LARGEST_ELEMENTS[2] <= SMALLEST) };
    let size = contents.len().max(SMALLEST).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT as usize);
    let buffer =
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size: size as u64, usage, mapped_at_creation: true });
    if let Ok(mut range) = buffer.slice(..).get_mapped_range_mut() {
        range.slice(..contents.len()).copy_from_slice(contents);
    }
    buffer.unmap();
    buffer
}

/// The size of an output of so many bytes: never nothing.
pub(crate) fn output_size(bytes: u64) -> u64 {
    const SMALLEST: u64 = 16;
    bytes.max(SMALLEST)
}

/// Creates a storage buffer that a shader writes.
pub(crate) fn output_buffer(device: &wgpu::Device, label: &str, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: output_size(bytes),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

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

/// The width of a table, a texture that holds a list, in texels.
pub(crate) const TABLE_WIDTH: u32 = 1 << TABLE_WIDTH_BITS;

/// How many rows a table of `texels` texels has: an odd number, and never one. Lavapipe compiles a shader anew, which takes a second, for textures whose
/// height is a power of two where the last one's was not.
pub(crate) fn table_rows(texels: u64) -> u64 {
    texels.div_ceil(u64::from(TABLE_WIDTH)).max(3) | 1
}

/// Texels with which the last row is full.
fn full_rows<T: bytemuck::Zeroable>(mut texels: Vec<T>) -> Vec<T> {
    let len = table_rows(texels.len() as u64) as usize * TABLE_WIDTH as usize;
    texels.resize_with(len, T::zeroed);
    texels
}

/// The vertices as `geometry.wgsl` reads them: position and u, normal and v, colour, and how far facets lean away from the normal.
pub(crate) fn vertex_table(scene: &Scene) -> Vec<[f32; 4]> {
    let vertices = scene.vertices();
    let mut texels = Vec::with_capacity(vertices.positions.len() * 4 + TABLE_WIDTH as usize);
    let streams =
        vertices.positions.iter().zip(&vertices.normals).zip(&vertices.uvs).zip(&vertices.colors).zip(scene.deviations());
    for ((((position, normal), uv), color), deviation) in streams {
        texels.push(position.extend(uv.x).to_array());
        texels.push(normal.extend(uv.y).to_array());
        texels.push(color.to_array());
        texels.push([*deviation, 0.0, 0.0, 0.0]);
    }
    full_rows(texels)
}

/// The triangles as `geometry.wgsl` reads them: three vertex indices and a material.
pub(crate) fn triangle_table(scene: &Scene) -> Vec<[u32; 4]> {
    let mut texels = Vec::with_capacity(scene.triangles().len() + TABLE_WIDTH as usize);
    texels.extend(scene.triangles().iter().zip(scene.triangle_materials()).map(|([a, b, c], material)| [*a, *b, *c, *material]));
    full_rows(texels)
}

/// The materials as `surfaces.wgsl` reads them: three texels each.
pub(crate) fn material_table(surfaces: &Surfaces) -> Vec<[u32; 4]> {
    full_rows(surfaces.materials.iter().flat_map(|material| bytemuck::cast::<_, [[u32; 4]; 3]>(*material)).collect())
}

/// The words of all textures, a texel each.
pub(crate) fn word_table(surfaces: Surfaces) -> Vec<u32> {
    full_rows(surfaces.words)
}

/// The decode table as a uniform array has it: elements 16 bytes apart.
pub(crate) fn decode_array(surfaces: &Surfaces) -> Vec<[u32; 4]> {
    let (colors, alphas) = surfaces.words[..DECODE_TABLE_LEN as usize].split_at(ALPHA_TABLE as usize);
    colors.iter().zip(alphas).map(|(&color, &alpha)| [color, alpha, 0, 0]).collect()
}
