//! The renderer: the stages of a frame, each a function of its own, and all of them in a row.

mod color;
mod maps;
mod readback;

use shadow_math::plan::{LightPlan, ViewPlan};
use shadow_scene::{Frame, FramePlan, Layer, LayerName, Pass, Pixels, Request, Scene, StageTimes, Surfaces};
use wgpu::BufferUsages;

use crate::{
    adapter::{AdapterSummary, choose_adapter, new_instance},
    buffers::{TABLE_WIDTH, buffer_with, decode_array, material_table, table_rows, triangle_table, vertex_table, word_table},
    clock::{Instant, milliseconds},
    device::{BLENDABLE, DriverErrors, open_device},
    error::GpuError,
    limits::LimitCheck,
    passes::{Slices, depth_array_view, depth_attachment, full_screen_pass, layer_view, views_of},
    pipelines::{COLOR_FORMAT, DEPTH_FORMAT, ID_FORMAT, Pipelines, VISIBILITY_FORMAT, VisibilityStyle},
    shelf::{Kept, Shelf},
    wait::submitted_work,
};

/// A renderer on one adapter.
pub struct GpuRenderer {
    summary: AdapterSummary,
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipelines: Pipelines,
    driver_errors: DriverErrors,
    textures: Shelf<wgpu::Texture>,
}

/// A scene in the GPU's memory.
pub struct GpuScene {
    geometry: wgpu::BindGroup,
    surfaces: wgpu::BindGroup,
    positions: wgpu::Buffer,
    indices: wgpu::Buffer,
    passes: [std::ops::Range<u32>; Pass::COUNT],
}

/// The plan of a frame in the GPU's memory.
struct PlanBuffers {
    camera: wgpu::Buffer,
    lights: wgpu::Buffer,
    views: wgpu::Buffer,
}

/// Shadow maps in the GPU's memory: one layer a view.
pub struct GpuMaps {
    texture: Kept<wgpu::Texture>,
}

/// What the camera sees, in the GPU's memory.
pub struct GpuCameraBuffer {
    ids: Kept<wgpu::Texture>,
    depth: Kept<wgpu::Texture>,
}

/// The visibility of every light at every pixel, in the GPU's memory: a layer a light.
pub struct GpuVisibility {
    texture: Kept<wgpu::Texture>,
}

/// The colour of every pixel, in the GPU's memory.
pub struct GpuColor {
    texture: Kept<wgpu::Texture>,
}

/// A frame and how long it took.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The layers that were asked for.
    pub frame: Frame,
    /// How long each stage took on the wall, from its submission until the GPU was done; reading back is not part of it.
    pub times: StageTimes,
}

impl GpuRenderer {
    /// Opens the adapter whose name contains `adapter`; without a name the one that `WGPU_ADAPTER_NAME` names, else the one that wgpu
    /// prefers.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`], [`GpuError::Device`], [`GpuError::Unsupported`] and [`GpuError::Driver`].
    pub async fn new(adapter: Option<&str>) -> Result<Self, GpuError> {
        let adapter = choose_adapter(&new_instance(), adapter).await?;
        let summary = AdapterSummary::of(&adapter);
        let flags = adapter.get_downlevel_capabilities().flags;
        let needed = [
            (wgpu::DownlevelFlags::COMPUTE_SHADERS, "compute shaders"),
            (wgpu::DownlevelFlags::VERTEX_STORAGE, "storage buffers in vertex shaders"),
        ];
        for (flag, what) in needed {
            if !flags.contains(flag) {
                return Err(GpuError::Unsupported { adapter: summary.name, what });
            }
        }
        for format in [VISIBILITY_FORMAT, COLOR_FORMAT] {
            if !adapter.get_texture_format_features(format).allowed_usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
                let what = "drawing into textures of single precision (where that is Mesa's OpenGL, the variable MESA_EXTENSION_OVERRIDE=+GL_ARB_color_buffer_float says that it can)";
                return Err(GpuError::Unsupported { adapter: summary.name, what });
            }
        }
        // Pictures can then be drawn in a pass for each light.
        let features = adapter.features() & BLENDABLE;
        let (device, queue, driver_errors) = open_device(&adapter, &summary, "shadow-gpu", features).await?;
        let pipelines = Pipelines::new(&device);
        let renderer = Self { summary, device, queue, pipelines, driver_errors, textures: Shelf::default() };
        renderer.check_driver()?;
        Ok(renderer)
    }

    /// What is known of the adapter.
    #[must_use]
    pub fn adapter(&self) -> &AdapterSummary {
        &self.summary
    }

    /// The device, for those who run shaders of their own beside the renderer's.
    #[must_use]
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The device's queue.
    #[must_use]
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    fn check_driver(&self) -> Result<(), GpuError> {
        self.driver_errors.check(&self.summary.name)
    }

    fn limits(&self) -> wgpu::Limits {
        self.device.limits()
    }

    fn limit_check<'a>(&'a self, limits: &'a wgpu::Limits) -> LimitCheck<'a> {
        LimitCheck { adapter: &self.summary.name, limits }
    }

    /// Submits a stage and waits until the GPU has done it.
    async fn finish(&self, encoder: wgpu::CommandEncoder) -> Result<(), GpuError> {
        self.queue.submit([encoder.finish()]);
        submitted_work(&self.device, &self.queue).await?;
        self.check_driver()
    }

    fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }

    fn bind(&self, label: &str, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
    }

    /// Brings a scene into the GPU's memory.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit, [`GpuError::Driver`].
    pub async fn upload(&self, scene: &Scene) -> Result<GpuScene, GpuError> {
        let surfaces = Surfaces::of(scene);
        self.limit_check(&self.limits()).scene(scene, &surfaces)?;
        let positions =
            buffer_with(&self.device, "positions", BufferUsages::VERTEX, bytemuck::cast_slice(&scene.vertices().positions));
        let indices = buffer_with(&self.device, "indices", BufferUsages::INDEX, bytemuck::cast_slice(scene.triangles()));
        let vertices = self.table("vertices", wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(&vertex_table(scene)));
        let triangles = self.table("triangles", wgpu::TextureFormat::Rgba32Uint, bytemuck::cast_slice(&triangle_table(scene)));
        let integers = wgpu::TextureFormat::Rgba32Uint;
        let materials = self.table("materials", integers, bytemuck::cast_slice(&material_table(&surfaces)));
        let decode = decode_array(&surfaces);
        let decode = buffer_with(&self.device, "decode table", BufferUsages::UNIFORM, bytemuck::cast_slice(&decode));
        let words = self.table("texels", wgpu::TextureFormat::R32Uint, bytemuck::cast_slice(&word_table(surfaces)));
        let layouts = &self.pipelines.layouts;
        let geometry = [wgpu::BindingResource::TextureView(&vertices), wgpu::BindingResource::TextureView(&triangles)];
        let scene = GpuScene {
            geometry: self.bind("geometry", &layouts.geometry, &geometry),
            surfaces: self.bind(
                "surfaces",
                &layouts.surfaces,
                &[
                    wgpu::BindingResource::TextureView(&materials),
                    wgpu::BindingResource::TextureView(&words),
                    decode.as_entire_binding(),
                ],
            ),
            positions,
            indices,
            passes: Pass::ALL.map(|pass| scene.pass_triangles(pass)),
        };
        self.finish(self.encoder("upload")).await?;
        Ok(scene)
    }

    /// A list as a texture of full rows of [`TABLE_WIDTH`] texels.
    fn table(&self, label: &str, format: wgpu::TextureFormat, bytes: &[u8]) -> wgpu::TextureView {
        let texel_bytes = format.block_copy_size(None).unwrap_or(1);
        let height = table_rows(bytes.len() as u64 / u64::from(texel_bytes)) as u32;
        let texture = self.texture(label, [TABLE_WIDTH, height, 1], format, wgpu::TextureUsages::COPY_DST);
        self.queue.write_texture(
            texture.as_image_copy(),
            bytes,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(TABLE_WIDTH * texel_bytes), rows_per_image: None },
            texture.size(),
        );
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    fn plan_buffers(&self, plan: &FramePlan) -> PlanBuffers {
        // A scene without lights still needs something to bind.
        let lights: &[LightPlan] = if plan.lights.is_empty() { &[bytemuck::Zeroable::zeroed()] } else { &plan.lights };
        let views: &[ViewPlan] = if plan.views.is_empty() { &[bytemuck::Zeroable::zeroed()] } else { &plan.views };
        PlanBuffers {
            camera: buffer_with(&self.device, "camera", BufferUsages::UNIFORM, bytemuck::bytes_of(&plan.camera)),
            lights: buffer_with(&self.device, "lights", BufferUsages::STORAGE, bytemuck::cast_slice(lights)),
            views: buffer_with(&self.device, "views", BufferUsages::STORAGE, bytemuck::cast_slice(views)),
        }
    }

    fn texture(
        &self,
        label: &str,
        [width, height, layers]: [u32; 3],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
    }

    /// A texture of an earlier frame, or a new one.
    fn kept_texture(
        &self,
        label: &str,
        [width, height, layers]: [u32; 3],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Kept<wgpu::Texture> {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers };
        let all_usages = usage | wgpu::TextureUsages::TEXTURE_BINDING;
        let fits =
            |texture: &wgpu::Texture| texture.size() == size && texture.format() == format && texture.usage() == all_usages;
        self.textures.take(fits, || self.texture(label, [width, height, layers], format, usage))
    }

    /// How many layers a texture must have that is read as an array of so many.
    ///
    /// wgpu makes OpenGL textures of one layer no arrays, and square ones of six or a multiple cubes: such have one layer more, which nobody looks at.
    fn array_layers(&self, count: u32) -> u32 {
        let is_no_array = count == 1 || count.is_multiple_of(6);
        if self.summary.backend == wgpu::Backend::Gl.to_str() && is_no_array { count + 1 } else { count }
    }

    /// Brings shadow maps that were made elsewhere into the GPU's memory: one layer of `size * size` depths a view.
    ///
    /// # Errors
    ///
    /// [`GpuError::Driver`].
    pub async fn upload_maps(&self, size: u32, layers: &[impl AsRef<[f32]>]) -> Result<GpuMaps, GpuError> {
        let count = self.array_layers((layers.len() as u32).max(1));
        let format = wgpu::TextureFormat::R32Float;
        let texture = self.kept_texture("uploaded shadow maps", [size, size, count], format, wgpu::TextureUsages::COPY_DST);
        for (layer, depths) in (0..).zip(layers) {
            self.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &texture,
                    mip_level: 0,
                    origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
                    aspect: wgpu::TextureAspect::All,
                },
                bytemuck::cast_slice(depths.as_ref()),
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size), rows_per_image: Some(size) },
                wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
            );
        }
        self.finish(self.encoder("upload of shadow maps")).await?;
        Ok(GpuMaps { texture })
    }

    /// Renders what the camera sees.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if the picture does not fit, [`GpuError::Driver`].
    pub async fn camera(&self, scene: &GpuScene, plan: &FramePlan) -> Result<GpuCameraBuffer, GpuError> {
        self.limit_check(&self.limits()).frame(plan)?;
        let (width, height) = (plan.camera.width, plan.camera.height);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let ids = self.kept_texture("triangles seen", [width, height, 1], ID_FORMAT, usage);
        let depth = self.kept_texture("camera depth", [width, height, self.array_layers(1)], DEPTH_FORMAT, usage);
        let buffers = self.plan_buffers(plan);
        let camera = self.bind("camera", &self.pipelines.layouts.camera, &[buffers.camera.as_entire_binding()]);
        let mut encoder = self.encoder("camera");
        {
            let ids_view = ids.create_view(&wgpu::TextureViewDescriptor::default());
            let depth_view = layer_view(&depth, 0);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("camera"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &ids_view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        // Every bit set: NO_TRIANGLE, which f64 holds exactly.
                        load: wgpu::LoadOp::Clear(wgpu::Color { r: f64::from(u32::MAX), g: 0.0, b: 0.0, a: 0.0 }),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(depth_attachment(&depth_view, 0.0)),
                ..Default::default()
            });
            pass.set_bind_group(0, &scene.geometry, &[]);
            pass.set_bind_group(1, &scene.surfaces, &[]);
            pass.set_bind_group(2, &camera, &[]);
            for run in Pass::ALL {
                let triangles = scene.passes[run as usize].clone();
                if !triangles.is_empty() {
                    let pipelines = &self.pipelines.camera[usize::from(run.is_masked())];
                    pass.set_pipeline(&pipelines[usize::from(run.culls_back_faces())]);
                    pass.draw(3 * triangles.start..3 * triangles.end, 0..1);
                }
            }
        }
        self.finish(encoder).await?;
        Ok(GpuCameraBuffer { ids, depth })
    }

    /// Computes the visibility of every light at every pixel. `camera` and `maps` must be of the same plan, or of one with the same sizes.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if it does not fit, [`GpuError::Driver`].
    pub async fn visibility(
        &self,
        scene: &GpuScene,
        plan: &FramePlan,
        camera: &GpuCameraBuffer,
        maps: &GpuMaps,
    ) -> Result<GpuVisibility, GpuError> {
        self.limit_check(&self.limits()).frame(plan)?;
        let size = [plan.camera.width, plan.camera.height, self.array_layers((plan.lights.len() as u32).max(1))];
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let texture = self.kept_texture("visibility", size, VISIBILITY_FORMAT, usage);
        let alignment = u64::from(self.limits().min_uniform_buffer_offset_alignment);
        let lights = self.slices("lights", alignment, plan.lights.iter().map(|light| [LightPlan { first_view: 0, ..*light }]));
        let views = self.slices("views", alignment, plan.lights.iter().map(|light| views_of(plan, light)));
        let camera_plan = buffer_with(&self.device, "camera", BufferUsages::UNIFORM, bytemuck::bytes_of(&plan.camera));
        let maps = maps.texture.create_view(&depth_array_view());
        let ids = camera.ids.create_view(&wgpu::TextureViewDescriptor::default());
        let group = self.bind(
            "visibility",
            &self.pipelines.layouts.visibility,
            &[
                camera_plan.as_entire_binding(),
                lights.first(),
                views.first(),
                wgpu::BindingResource::TextureView(&maps),
                wgpu::BindingResource::TextureView(&ids),
            ],
        );
        let mut encoder = self.encoder("visibility");
        for (light, light_plan) in (0..).zip(&plan.lights) {
            let target = layer_view(&texture, light);
            let mut pass = full_screen_pass(&mut encoder, "visibility", &target, Some(wgpu::Color::WHITE), &camera.depth);
            pass.set_pipeline(
                &self.pipelines.visibility(&self.device, VisibilityStyle::of(light_plan, plan.views_of(light as usize))),
            );
            pass.set_bind_group(0, &scene.geometry, &[]);
            pass.set_bind_group(1, &group, &[light * lights.stride, light * views.stride]);
            pass.draw(0..3, 0..1);
        }
        self.finish(encoder).await?;
        Ok(GpuVisibility { texture })
    }

    /// One block of uniforms after the other, each of the size and alignment that it is bound with.
    fn slices<const N: usize, T: bytemuck::Pod>(
        &self,
        label: &str,
        alignment: u64,
        blocks: impl ExactSizeIterator<Item = [T; N]>,
    ) -> Slices {
        let size = (N * size_of::<T>()) as u64;
        let stride = size.next_multiple_of(alignment);
        // Without lights there is still something to bind.
        let mut bytes = vec![0; blocks.len().max(1) * stride as usize];
        for (place, block) in bytes.chunks_exact_mut(stride as usize).zip(blocks) {
            place[..size as usize].copy_from_slice(bytemuck::cast_slice(&block));
        }
        let buffer = buffer_with(&self.device, label, BufferUsages::UNIFORM, &bytes);
        Slices { buffer, size, stride: stride as u32 }
    }

    /// Renders a frame: all stages that the layers asked for need, in a row.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] if something does not fit, [`GpuError::Driver`].
    pub async fn render(&self, scene: &GpuScene, plan: &FramePlan, request: Request) -> Result<Rendered, GpuError> {
        self.render_with(scene, plan, request, None).await
    }

    /// [`Self::render`] with shadow maps that are already there, if some are given.
    ///
    /// # Errors
    ///
    /// As [`Self::render`].
    pub async fn render_with(
        &self,
        scene: &GpuScene,
        plan: &FramePlan,
        request: Request,
        maps: Option<GpuMaps>,
    ) -> Result<Rendered, GpuError> {
        self.limit_check(&self.limits()).request(plan, request)?;
        let start = Instant::now();
        let needs_visibility = request.visibility || request.color;
        let camera = if request.camera || needs_visibility { Some(self.camera(scene, plan).await?) } else { None };
        let camera_done = Instant::now();
        let maps = match maps {
            Some(maps) => Some(maps),
            None if request.shadow_maps || needs_visibility => Some(self.shadow_maps(scene, plan).await?),
            None => None,
        };
        let maps_done = Instant::now();
        let visibility = match (&camera, &maps) {
            (Some(camera), Some(maps)) if needs_visibility => Some(self.visibility(scene, plan, camera, maps).await?),
            _ => None,
        };
        let color = match (&camera, &visibility) {
            (Some(camera), Some(visibility)) if request.color => Some(self.color(scene, plan, camera, visibility).await?),
            _ => None,
        };
        let shading_done = Instant::now();
        let times = StageTimes {
            prepare: 0.0,
            camera: milliseconds(start, camera_done),
            shadow_maps: milliseconds(camera_done, maps_done),
            shading: milliseconds(maps_done, shading_done),
        };

        let (width, height) = (plan.camera.width, plan.camera.height);
        let mut layers = Vec::new();
        if let (true, Some(camera)) = (request.camera, &camera) {
            let (ids, depth) = self.read_camera(camera).await?;
            layers.push(Layer { name: LayerName::Triangle, width, height, pixels: Pixels::Id(ids) });
            layers.push(Layer { name: LayerName::Depth, width, height, pixels: Pixels::Float(depth) });
        }
        if let (true, Some(maps)) = (request.shadow_maps, &maps) {
            for (name, view) in plan.maps() {
                let depths = self.read_map(maps, view.layer).await?;
                layers.push(Layer { name, width: plan.map_size, height: plan.map_size, pixels: Pixels::Float(depths) });
            }
        }
        if let (true, Some(visibility)) = (request.visibility, &visibility) {
            for light in 0..plan.lights.len() as u32 {
                let values = self.read_visibility(visibility, light).await?;
                layers.push(Layer { name: LayerName::Visibility { light }, width, height, pixels: Pixels::Float(values) });
            }
        }
        if let Some(color) = color {
            let pixels = Pixels::Rgba(self.read_color(&color).await?);
            layers.push(Layer { name: LayerName::Color, width, height, pixels });
        }
        self.check_driver()?;
        Ok(Rendered { frame: Frame { source: format!("gpu: {}", self.summary.name), layers }, times })
    }
}
