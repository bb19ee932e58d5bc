//! The colour of every pixel: in one pass, or in one for each light.

use shadow_math::{
    plan::{COMPOSE_ADDITIVE, CameraPlan, TERMINATOR_SOFT},
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
    /// Computes the colour of every pixel. `camera` and `visibility` must be of the same plan, or of one with the same sizes.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit, [`GpuError::Driver`].
    pub async fn color(
        &self,
        scene: &GpuScene,
        plan: &FramePlan,
        camera: &GpuCameraBuffer,
        visibility: &GpuVisibility,
    ) -> Result<GpuColor, GpuError> {
        self.color_in(&[plan.camera], scene, plan, camera, visibility).await
    }

    /// As [`Self::color`], in a pass for each light: added up, or multiplied, by the adapter's blending, as [`FramePlan::passes`] says.
    ///
    /// # Errors
    ///
    /// As [`Self::color`], and [`GpuError::Unsupported`] where the adapter cannot blend 32-bit floats.
    pub async fn color_by_passes(
        &self,
        scene: &GpuScene,
        plan: &FramePlan,
        camera: &GpuCameraBuffer,
        visibility: &GpuVisibility,
    ) -> Result<GpuColor, GpuError> {
        if !self.device.features().contains(BLENDABLE) {
            let adapter = self.summary.name.clone();
            return Err(GpuError::Unsupported { adapter, what: "blending of 32-bit floats, which a pass for each light needs" });
        }
        self.color_in(&plan.passes(), scene, plan, camera, visibility).await
    }

    /// Draws the first pass as it is and blends the others with it.
    async fn color_in(
        &self,
        passes: &[CameraPlan],
        scene: &GpuScene,
        plan: &FramePlan,
        camera: &GpuCameraBuffer,
        visibility: &GpuVisibility,
    ) -> Result<GpuColor, GpuError> {
        self.limit_check(&self.limits()).frame(plan)?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let texture = self.kept_texture("color", [plan.camera.width, plan.camera.height, 1], COLOR_FORMAT, usage);
        let buffers = self.plan_buffers(plan);
        let ids = camera.ids.create_view(&wgpu::TextureViewDescriptor::default());
        let visibilities = visibility.texture.create_view(&depth_array_view());
        let blend_of_lights = if plan.camera.composition == COMPOSE_ADDITIVE { Blend::Add } else { Blend::Multiply };
        let is_any_soft = plan.lights.iter().any(|light| light.terminator == TERMINATOR_SOFT);
        let mut encoder = self.encoder("color");
        for (index, pass_plan) in passes.iter().enumerate() {
            let pass_buffer = buffer_with(&self.device, "pass", wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(pass_plan));
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
            let background = (index == 0).then_some(wgpu::Color { r, g, b, a: 1.0 });
            let blend = if index == 0 { Blend::Replace } else { blend_of_lights };
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
