//! The device of a probe: draws triangles into a depth texture, and reads it back through a shader.

use bytemuck::{Pod, Zeroable};

use super::{
    DepthFormat, Measured,
    triangles::{SHEET, Sheet, Triangle},
    unmeasured,
};
use crate::{
    adapter::AdapterSummary,
    buffers::{buffer_with, output_buffer, read_buffer},
    device::{DriverErrors, open_device},
    error::GpuError,
    passes::depth_attachment,
    pipelines::{COMPUTE, FLOATS, compute_pipeline, layout, module, pipeline_layout, storage, texture},
    shaders::{PROBE_COMPARE_MODULE, PROBE_DRAW_MODULE, PROBE_READ_MODULE},
};

/// Width and height of the reader's workgroups in pixels, as `probe_read.wgsl` has it.
const READ_GROUP: u32 = 8;

/// Points of a workgroup of the comparison sampler's shader, as `probe_compare.wgsl` has it.
const COMPARE_GROUP: u32 = 64;

/// A corner in the vertex buffer.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Vertex {
    clip: [f32; 4],
    depth: f32,
}

/// What a picture is drawn with.
#[derive(Clone, Copy)]
pub(super) struct Drawing<'a> {
    pub(super) format: DepthFormat,
    /// What the sheet is cleared to.
    pub(super) clear: f32,
    pub(super) bias: wgpu::DepthBiasState,
    /// Whether what lies beyond near and far is drawn too; needs a feature.
    pub(super) unclipped: bool,
    /// Whether fragments write the triangle's own depth.
    pub(super) writes_depth: bool,
    /// Drawn in order, each over those before.
    pub(super) triangles: &'a [Triangle],
}

impl<'a> Drawing<'a> {
    /// Depths in single precision as the rasteriser finds them, on a far background.
    pub(super) fn new(triangles: &'a [Triangle]) -> Self {
        Self {
            format: DepthFormat::Depth32Float,
            clear: 1.0,
            bias: wgpu::DepthBiasState::default(),
            unclipped: false,
            writes_depth: false,
            triangles,
        }
    }
}

/// An open adapter with the pipelines that every measurement needs.
pub(super) struct Rig {
    adapter: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    errors: DriverErrors,
    pub(super) downlevel: wgpu::DownlevelFlags,
    draw_module: wgpu::ShaderModule,
    draw_layout: wgpu::PipelineLayout,
    read_layout: wgpu::BindGroupLayout,
    read: wgpu::ComputePipeline,
}

impl Rig {
    /// Opens an adapter, with unclipped depth if it has that.
    pub(super) async fn open(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let summary = AdapterSummary::of(adapter);
        let downlevel = adapter.get_downlevel_capabilities().flags;
        if !downlevel.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS) {
            return Err(GpuError::Unsupported { adapter: summary.name, what: "compute shaders" });
        }
        let features = adapter.features() & wgpu::Features::DEPTH_CLIP_CONTROL;
        let (device, queue, errors) = open_device(adapter, &summary, "probe", features).await?;
        let read_layout = layout(&device, "probe", COMPUTE, &[FLOATS, storage(false)]);
        let rig = Self {
            draw_module: module(&device, "probe", PROBE_DRAW_MODULE),
            draw_layout: pipeline_layout(&device, "probe", &[]),
            read: compute_pipeline(&device, "read_probe", PROBE_READ_MODULE, &[&read_layout]),
            read_layout,
            adapter: summary.name,
            device,
            queue,
            errors,
            downlevel,
        };
        rig.errors.check(&rig.adapter)?;
        Ok(rig)
    }

    /// Whether the device draws what lies beyond near and far when asked to.
    pub(super) fn can_unclip(&self) -> bool {
        self.device.features().contains(wgpu::Features::DEPTH_CLIP_CONTROL)
    }

    fn pipeline(&self, drawing: &Drawing<'_>) -> wgpu::RenderPipeline {
        let attribute = |format, offset, shader_location| wgpu::VertexAttribute { format, offset, shader_location };
        let attributes = [
            attribute(wgpu::VertexFormat::Float32x4, 0, 0),
            attribute(wgpu::VertexFormat::Float32, size_of::<[f32; 4]>() as u64, 1),
        ];
        let corners = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("probe"),
            layout: Some(&self.draw_layout),
            vertex: wgpu::VertexState {
                module: &self.draw_module,
                entry_point: Some("corner"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(corners)],
            },
            primitive: wgpu::PrimitiveState { unclipped_depth: drawing.unclipped, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: drawing.format.of_wgpu(),
                depth_write_enabled: Some(true),
                // What is drawn is what is asked about: no test may keep it away.
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: drawing.bias,
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: drawing.writes_depth.then_some(wgpu::FragmentState {
                module: &self.draw_module,
                entry_point: Some("write_depth"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// Draws into a new texture of `size` by `size` pixels.
    fn draw_texture(&self, encoder: &mut wgpu::CommandEncoder, size: u32, drawing: &Drawing<'_>) -> wgpu::Texture {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("probe"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: drawing.format.of_wgpu(),
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let corners: Vec<Vertex> = drawing
            .triangles
            .iter()
            .flat_map(|triangle| triangle.clip.map(|clip| Vertex { clip, depth: triangle.depth }))
            .collect();
        let buffer = buffer_with(&self.device, "probe", wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&corners));
        let pipeline = self.pipeline(drawing);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("probe"),
            depth_stencil_attachment: Some(depth_attachment(&view, drawing.clear)),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..corners.len() as u32, 0..1);
        drop(pass);
        texture
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("probe") })
    }

    fn bind(&self, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("probe"), layout, entries: &entries })
    }

    /// Runs a compute shader over `groups` workgroups and reads the numbers that it wrote.
    async fn compute(
        &self,
        mut encoder: wgpu::CommandEncoder,
        pipeline: &wgpu::ComputePipeline,
        group: &wgpu::BindGroup,
        groups: [u32; 2],
        (output, count): (&wgpu::Buffer, usize),
    ) -> Measured<Vec<f32>> {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(groups[0], groups[1], 1);
        drop(pass);
        self.queue.submit([encoder.finish()]);
        // What failed before is the cause of what reading back complains about.
        self.errors.check(&self.adapter)?;
        let numbers = read_buffer(&self.device, &self.queue, output, count).await?;
        self.errors.check(&self.adapter)?;
        Ok(numbers)
    }

    /// Draws a sheet and reads its depths back.
    pub(super) async fn draw(&self, drawing: &Drawing<'_>) -> Measured<Sheet> {
        let mut encoder = self.encoder();
        let texture = self.draw_texture(&mut encoder, SHEET, drawing);
        let count = SHEET as usize * SHEET as usize;
        let output = output_buffer(&self.device, "probe", (count * size_of::<f32>()) as u64);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let group = self.bind(&self.read_layout, &[wgpu::BindingResource::TextureView(&view), output.as_entire_binding()]);
        let groups = [SHEET.div_ceil(READ_GROUP); 2];
        let depths = self.compute(encoder, &self.read, &group, groups, (&output, count)).await?;
        Ok(Sheet { size: SHEET, depths, clear: drawing.clear })
    }

    /// Draws a texture of `size` by `size` texels and takes comparison samples of it, `u, v, reference` each, with the test
    /// `reference <= texel` and linear filtering. Gives the share of tests that passed, for each.
    pub(super) async fn compare(&self, size: u32, drawing: &Drawing<'_>, points: &[[f32; 3]]) -> Measured<Vec<f32>> {
        if !self.downlevel.contains(wgpu::DownlevelFlags::COMPARISON_SAMPLERS) {
            return unmeasured("the adapter has no comparison samplers");
        }
        let depths = texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2);
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
        let layout = layout(&self.device, "probe", COMPUTE, &[depths, sampler, storage(true), storage(false)]);
        let pipeline = compute_pipeline(&self.device, "compare_points", PROBE_COMPARE_MODULE, &[&layout]);
        let sampler = self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("probe"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let padded: Vec<[f32; 4]> = points.iter().map(|[u, v, reference]| [*u, *v, *reference, 0.0]).collect();
        let input = buffer_with(&self.device, "probe", wgpu::BufferUsages::STORAGE, bytemuck::cast_slice(&padded));
        // As long as the input, which is never empty: the shader goes by the input's length.
        let output = output_buffer(&self.device, "probe", input.size() / size_of::<f32>() as u64);
        let mut encoder = self.encoder();
        let texture = self.draw_texture(&mut encoder, size, drawing);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let resources = [
            wgpu::BindingResource::TextureView(&view),
            wgpu::BindingResource::Sampler(&sampler),
            input.as_entire_binding(),
            output.as_entire_binding(),
        ];
        let group = self.bind(&layout, &resources);
        let groups = [(points.len() as u32).div_ceil(COMPARE_GROUP), 1];
        self.compute(encoder, &pipeline, &group, groups, (&output, points.len())).await
    }
}
