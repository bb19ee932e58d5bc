//! The pass that draws shadow maps.

use shadow_math::depth::LAYER_FIRST;
use shadow_scene::{FramePlan, Pass};

use super::{GpuMaps, GpuRenderer, GpuScene};
use crate::{
    error::GpuError,
    passes::depth_attachment,
    pipelines::{DEPTH_FORMAT, Drawn, MapStyle},
    shelf::Kept,
};

/// What the passes of a frame's maps have in common.
struct MapPass<'a> {
    scene: &'a GpuScene,
    plan: &'a FramePlan,
    views: &'a wgpu::BindGroup,
}

impl GpuRenderer {
    /// Renders all shadow maps of a plan.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if they do not fit, [`GpuError::Driver`].
    pub async fn shadow_maps(&self, scene: &GpuScene, plan: &FramePlan) -> Result<GpuMaps, GpuError> {
        self.limit_check(&self.limits()).frame(plan)?;
        let layers = self.array_layers(plan.layer_count().max(1));
        let texture = self.map_texture("shadow maps", plan.map_size, layers);
        let buffers = self.plan_buffers(plan);
        let views = self.bind("views", &self.pipelines.layouts.views, &[buffers.views.as_entire_binding()]);
        let maps = MapPass { scene, plan, views: &views };
        let mut encoder = self.encoder("shadow maps");
        // One map of first surfaces serves all views, one after the other.
        let first = plan.views.iter().any(|view| view.depth_layer != LAYER_FIRST).then(|| {
            let texture = self.map_texture("first surfaces", plan.map_size, 1);
            let target = texture.create_view(&wgpu::TextureViewDescriptor::default());
            let resource = wgpu::BindingResource::TextureView(&target);
            let group = self.bind("first surface", &self.pipelines.layouts.first_surface, &[resource]);
            (texture, target, group)
        });
        for (index, view) in (0..).zip(&plan.views).filter(|(_, view)| view.has_map()) {
            let layer = texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("shadow map"),
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: view.layer,
                array_layer_count: Some(1),
                ..Default::default()
            });
            let style = MapStyle::of(view);
            match &first {
                Some((_, target, group)) if view.depth_layer != LAYER_FIRST => {
                    self.draw_map(&mut encoder, &maps, index, style, target, None);
                    self.draw_map(&mut encoder, &maps, index, MapStyle { drawn: Drawn::Second, ..style }, &layer, Some(group));
                }
                _ => self.draw_map(&mut encoder, &maps, index, style, &layer, None),
            }
        }
        self.finish(encoder).await?;
        Ok(GpuMaps { texture })
    }

    /// A texture of so many maps.
    fn map_texture(&self, label: &str, size: u32, layers: u32) -> Kept<wgpu::Texture> {
        self.kept_texture(label, [size, size, layers], DEPTH_FORMAT, wgpu::TextureUsages::RENDER_ATTACHMENT)
    }

    /// Draws all casters of one view.
    fn draw_map(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        maps: &MapPass<'_>,
        view: u32,
        style: MapStyle,
        target: &wgpu::TextureView,
        first_surface: Option<&wgpu::BindGroup>,
    ) {
        let MapPass { scene, plan, views } = *maps;
        let [_, _, width, height] = plan.views[view as usize].rect;
        let takes_back_faces = plan.takes_back_faces(view as usize);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            color_attachments: &[],
            depth_stencil_attachment: Some(depth_attachment(target, style.far())),
            ..Default::default()
        });
        if width < plan.map_size {
            pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(0, 0, width, height);
        }
        pass.set_bind_group(0, &scene.geometry, &[]);
        pass.set_bind_group(1, &scene.surfaces, &[]);
        pass.set_bind_group(2, views, &[]);
        if let Some(first) = first_surface {
            pass.set_bind_group(3, first, &[]);
        }
        pass.set_vertex_buffer(0, scene.positions.slice(..));
        pass.set_index_buffer(scene.indices.slice(..), wgpu::IndexFormat::Uint32);
        for run in Pass::ALL.into_iter().filter(|run| run.casts_shadows()) {
            let triangles = scene.passes[run as usize].clone();
            if triangles.is_empty() {
                continue;
            }
            let corners = 3 * triangles.start..3 * triangles.end;
            let takes_back_faces_alone = takes_back_faces && run.culls_back_faces();
            // Where a view has a half-space, each caster is tested for its side.
            let is_masked = run.is_masked() || plan.views[view as usize].has_half_space();
            let style = MapStyle { is_masked, takes_back_faces_alone, ..style };
            pass.set_pipeline(&self.pipelines.map.get(&self.device, style));
            if style.is_indexed() {
                pass.draw_indexed(corners, 0, view..view + 1);
            } else {
                pass.draw(corners, view..view + 1);
            }
        }
    }
}
