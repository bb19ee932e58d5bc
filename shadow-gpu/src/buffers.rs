//! Buffers and their contents.

use shadow_scene::{Scene, Surfaces};

/// Creates a buffer with contents; never empty, since WebGPU cannot bind nothing.
pub(crate) fn buffer_with(device: &wgpu::Device, label: &str, usage: wgpu::BufferUsages, contents: &[u8]) -> wgpu::Buffer {
    /// One element of the largest kind of array that may be empty: a material, of 48 bytes as the shaders count.
    const SMALLEST: usize = 64;
    let size = contents.len().max(SMALLEST).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT as usize);
    let buffer =
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size: size as u64, usage, mapped_at_creation: true });
    if let Ok(mut range) = buffer.slice(..).get_mapped_range_mut() {
        range.slice(..contents.len()).copy_from_slice(contents);
    }
    buffer.unmap();
    buffer
}

/// Creates a storage buffer that a shader writes.
pub(crate) fn output_buffer(device: &wgpu::Device, label: &str, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.max(16),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

/// The vertices as `geometry.wgsl` reads them: all positions, then nine attributes a vertex.
pub(crate) fn vertex_floats(scene: &Scene) -> Vec<f32> {
    let vertices = scene.vertices();
    let mut floats = Vec::with_capacity(vertices.positions.len() * 12);
    floats.extend(vertices.positions.iter().flat_map(|position| position.to_array()));
    for ((normal, uv), color) in vertices.normals.iter().zip(&vertices.uvs).zip(&vertices.colors) {
        floats.extend(normal.to_array());
        floats.extend(uv.to_array());
        floats.extend(color.to_array());
    }
    floats
}

/// The triangles as `geometry.wgsl` reads them: all indices, then a material a triangle.
pub(crate) fn triangle_words(scene: &Scene) -> Vec<u32> {
    let mut words = Vec::with_capacity(scene.triangles().len() * 4);
    words.extend(scene.triangles().iter().flatten());
    words.extend(scene.triangle_materials());
    words
}

/// The surfaces' two buffers: materials, and words.
pub(crate) fn surface_bytes(surfaces: &Surfaces) -> (&[u8], &[u8]) {
    (bytemuck::cast_slice(&surfaces.materials), bytemuck::cast_slice(&surfaces.words))
}
