//! Bringing results back from the GPU.

use wgpu::BufferUsages;

use super::{GpuCameraBuffer, GpuColor, GpuMaps, GpuRenderer, GpuVisibility};
use crate::{
    buffers::{buffer_with, output_buffer, read_buffer},
    error::GpuError,
    limits::{COLOR_BYTES, SMALLER_MAP, SMALLER_PICTURE, color_row_bytes},
    passes::depth_array_view,
};

/// Width and height of a compute workgroup in pixels, as the shaders have it.
const WORKGROUP: u32 = 8;

impl GpuRenderer {
    /// Records a compute pass with one invocation for each pixel.
    fn compute(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::ComputePipeline,
        groups: &[&wgpu::BindGroup],
        [width, height]: [u32; 2],
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        for (index, group) in (0..).zip(groups) {
            pass.set_bind_group(index, *group, &[]);
        }
        pass.dispatch_workgroups(width.div_ceil(WORKGROUP), height.div_ceil(WORKGROUP), 1);
    }

    async fn read_depths(&self, texture: &wgpu::Texture, layer: u32, way_out: &'static str) -> Result<Vec<f32>, GpuError> {
        self.limit_check(&self.limits()).numbers([texture.width(), texture.height()], way_out)?;
        let count = texture.width() as usize * texture.height() as usize;
        let destination = output_buffer(&self.device, "depths read back", 4 * count as u64);
        let selected = buffer_with(&self.device, "layer", BufferUsages::UNIFORM, bytemuck::bytes_of(&layer));
        let view = texture.create_view(&depth_array_view());
        let group = self.bind(
            "readback",
            &self.pipelines.layouts.readback,
            &[wgpu::BindingResource::TextureView(&view), selected.as_entire_binding(), destination.as_entire_binding()],
        );
        let mut encoder = self.encoder("read depths back");
        self.compute(&mut encoder, &self.pipelines.readback, &[&group], [texture.width(), texture.height()]);
        self.queue.submit([encoder.finish()]);
        let depths = read_buffer(&self.device, &self.queue, &destination, count).await?;
        self.check_driver()?;
        Ok(depths)
    }

    /// Reads one layer of shadow maps back: depths row by row from the top.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit into the buffer that it is read through, [`GpuError::Driver`].
    pub async fn read_map(&self, maps: &GpuMaps, layer: u32) -> Result<Vec<f32>, GpuError> {
        self.read_depths(&maps.texture, layer, SMALLER_MAP).await
    }

    /// Reads the camera's triangle indices and depths back.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit into the buffer that it is read through, [`GpuError::Driver`].
    pub async fn read_camera(&self, camera: &GpuCameraBuffer) -> Result<(Vec<u32>, Vec<f32>), GpuError> {
        self.limit_check(&self.limits()).numbers([camera.ids.width(), camera.ids.height()], SMALLER_PICTURE)?;
        let count = camera.ids.width() as usize * camera.ids.height() as usize;
        let destination = output_buffer(&self.device, "triangles read back", 4 * count as u64);
        let view = camera.ids.create_view(&wgpu::TextureViewDescriptor::default());
        let group = self.bind(
            "readback of ids",
            &self.pipelines.layouts.readback_id,
            &[wgpu::BindingResource::TextureView(&view), destination.as_entire_binding()],
        );
        let mut encoder = self.encoder("read triangles back");
        self.compute(&mut encoder, &self.pipelines.readback_id, &[&group], [camera.ids.width(), camera.ids.height()]);
        self.queue.submit([encoder.finish()]);
        let ids = read_buffer(&self.device, &self.queue, &destination, count).await?;
        Ok((ids, self.read_depths(&camera.depth, 0, SMALLER_PICTURE).await?))
    }

    /// Reads the visibility of one light back.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit into the buffer that it is read through, [`GpuError::Driver`].
    pub async fn read_visibility(&self, visibility: &GpuVisibility, light: u32) -> Result<Vec<f32>, GpuError> {
        self.read_depths(&visibility.texture, light, SMALLER_PICTURE).await
    }

    /// Reads colours back.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit into the buffer that it is read through, [`GpuError::Driver`].
    pub async fn read_color(&self, color: &GpuColor) -> Result<Vec<[f32; 4]>, GpuError> {
        let (width, height) = (color.texture.width(), color.texture.height());
        self.limit_check(&self.limits()).colors([width, height])?;
        let row_bytes = color_row_bytes(width);
        let bytes = u64::from(row_bytes) * u64::from(height);
        let destination = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("colors read back"),
            size: bytes,
            usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = self.encoder("read colors back");
        encoder.copy_texture_to_buffer(
            color.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &destination,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None },
            },
            color.texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        let row_pixels = (row_bytes / COLOR_BYTES) as usize;
        let mut pixels: Vec<[f32; 4]> =
            read_buffer(&self.device, &self.queue, &destination, row_pixels * height as usize).await?;
        self.check_driver()?;
        if row_pixels != width as usize {
            for row in 1..height as usize {
                pixels.copy_within(row * row_pixels..row * row_pixels + width as usize, row * width as usize);
            }
            pixels.truncate(width as usize * height as usize);
        }
        Ok(pixels)
    }
}
