//! Buffers and their contents.

use shadow_math::{
    material::MaterialData,
    plan::{LightPlan, ViewPlan},
};
use shadow_scene::{Scene, Surfaces};

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
