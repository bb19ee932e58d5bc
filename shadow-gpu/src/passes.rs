//! What passes are made of: attachments, views of textures, blocks of uniforms.

use shadow_math::plan::{LightPlan, MAX_VIEWS_PER_LIGHT, ViewPlan};
use shadow_scene::FramePlan;

/// Blocks of uniforms in one buffer.
pub(crate) struct Slices {
    pub(crate) buffer: wgpu::Buffer,
    /// Bytes of a block.
    pub(crate) size: u64,
    /// From the beginning of a block to that of the next.
    pub(crate) stride: u32,
}

impl Slices {
    /// The first block; an offset chooses another.
    pub(crate) fn first(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: 0,
            size: std::num::NonZeroU64::new(self.size),
        })
    }
}

/// The views of a light, in as many places as a light can have views.
pub(crate) fn views_of(plan: &FramePlan, light: &LightPlan) -> [ViewPlan; MAX_VIEWS_PER_LIGHT] {
    let mut views = [bytemuck::Zeroable::zeroed(); MAX_VIEWS_PER_LIGHT];
    let own = plan.views.iter().skip(light.first_view as usize).take(light.view_count as usize);
    for (view, own) in views.iter_mut().zip(own) {
        *view = *own;
    }
    views
}

/// One layer of a texture, to be drawn into.
pub(crate) fn layer_view(texture: &wgpu::Texture, layer: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("layer"),
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..Default::default()
    })
}

/// A pass whose fragments write `target` where the camera's depth has something, and which has `background` elsewhere; without one what is there stays, and is blended with.
pub(crate) fn full_screen_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    target: &wgpu::TextureView,
    background: Option<wgpu::Color>,
    camera_depth: &wgpu::Texture,
) -> wgpu::RenderPass<'a> {
    let depth = layer_view(camera_depth, 0);
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: background.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth,
            depth_ops: None,
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

/// A view of the depths of all layers.
pub(crate) fn depth_array_view() -> wgpu::TextureViewDescriptor<'static> {
    wgpu::TextureViewDescriptor {
        label: Some("depths"),
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    }
}

/// A depth attachment that is cleared first and kept.
pub(crate) fn depth_attachment(view: &wgpu::TextureView, clear: f32) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}
