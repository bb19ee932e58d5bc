//! The colour of every pixel: in one pass, or in one for each light.

use shadow_math::{
    plan::{COMPOSE_FACTOR, TERMINATOR_SOFT},
    shade::BACKGROUND,
};
use shadow_scene::FramePlan;

use super::{GpuCameraBuffer, GpuColor, GpuRenderer, GpuScene, GpuVisibility};
use crate::{
    buffers::buffer_with,
    device::BLENDABLE,
    error::GpuError,
    passes::{depth_array_view, full_screen_pass, layer_view},
    pipelines::{Blend, COLOR_FORMAT},
};

impl GpuRenderer {
    /// Computes the colour of every pixel, in as many passes as the plan says, which the adapter blends. `camera` and `visibility` must be of the same plan, or of one with the same sizes.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit, [`GpuError::Unsupported`] if there are several passes and the adapter cannot blend 32-bit floats, [`GpuError::Driver`].
    pub async fn color(
        &self,
        scene: &GpuScene,
        plan: &FramePlan,
        camera: &GpuCameraBuffer,
        visibility: &GpuVisibility,
    ) -> Result<GpuColor, GpuError> {
        let mut of_lights = plan.passes_of_lights().peekable();
        if of_lights.peek().is_some() && !self.device.features().contains(BLENDABLE) {
            let adapter = self.summary.name.clone();
            return Err(GpuError::Unsupported { adapter, what: "blending of 32-bit floats, which a pass for each light needs" });
        }
        self.limit_check(&self.limits()).frame(plan)?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let texture = self.kept_texture("color", [plan.camera.width, plan.camera.height, 1], COLOR_FORMAT, usage);
        let buffers = self.plan_buffers(plan);
        let ids = camera.ids.create_view(&wgpu::TextureViewDescriptor::default());
        let visibilities = visibility.texture.create_view(&depth_array_view());
        let is_any_soft = plan.lights.iter().any(|light| light.terminator == TERMINATOR_SOFT);
        let mut encoder = self.encoder("color");
        let of_lights = of_lights.map(|pass| {
            let blend = if pass.composition == COMPOSE_FACTOR { Blend::Multiply } else { Blend::Add };
            (pass, blend)
        });
        for (pass_plan, blend) in core::iter::once((plan.first_pass(), Blend::Replace)).chain(of_lights) {
            let pass_buffer = buffer_with(&self.device, "pass", wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(&pass_plan));
            let group = self.bind(
                "color",
                &self.pipelines.layouts.color,
                &[
                    pass_buffer.as_entire_binding(),
                    buffers.lights.as_entire_binding(),
                    wgpu::BindingResource::TextureView(&ids),
                    wgpu::BindingResource::TextureView(&visibilities),
                ],
            );
            let target = layer_view(&texture, 0);
            let [r, g, b] = BACKGROUND.map(f64::from);
            let background = (blend == Blend::Replace).then_some(wgpu::Color { r, g, b, a: 1.0 });
            let mut pass = full_screen_pass(&mut encoder, "color", &target, background, &camera.depth);
            pass.set_pipeline(&self.pipelines.color.get(&self.device, blend, is_any_soft));
            pass.set_bind_group(0, &scene.geometry, &[]);
            pass.set_bind_group(1, &scene.surfaces, &[]);
            pass.set_bind_group(2, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        self.finish(encoder).await?;
        Ok(GpuColor { texture })
    }
}
