//! What a plain shadow-mapped frame costs in wgpu, beside a frame of the GPU renderer on the same device: how much of that renderer's time is the
//! price of its exactness, and how much the adapter's.
//!
//! ```text
//! cargo run --release -p shadow-tests --example plain -- SCENE [--frames N] [--eye X,Y,Z --target X,Y,Z]
//! ```
//!
//! The plain program draws as most do: indexed vertices, one draw for each run of a material, fixed-function depth bias, the driver's samplers, one
//! forward pass. The scene is a glTF file, or a number of triangles for `builtin::waves`, which fills the picture. It gets one directional light, a
//! map of 2048 x 2048 texels and a picture of 1920 x 1080 pixels.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "the table is its output")]

use std::{
    borrow::Cow,
    env,
    error::Error,
    ops::Range,
    path::Path,
    process::ExitCode,
    time::{Duration, Instant},
};

use glam::{DVec3, Mat4, Vec3, Vec4};
use shadow_gpu::GpuRenderer;
use shadow_math::{Camera, Light, LightKind, ShadowSettings, shade::shininess_of_roughness};
use shadow_scene::{
    FramePlan, Scene, builtin, import,
    scene::{Alpha, Image, Material, Wrap},
};
use shadow_tests::lights::lit_by;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// How many frames are counted if nothing else is said: an odd number, whose median is one of them.
const FRAMES: usize = 7;
const PICTURE: (u32, u32) = (1920, 1080);
const MAP_SIZE: u32 = 2048;
/// The way the light travels.
const DIRECTION: Vec3 = Vec3::new(-0.4, -1.0, -0.3);
const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const POSITION_BYTES: u64 = 12;
/// Position, normal and texture coordinates.
const VERTEX_BYTES: u64 = 32;
/// The usual bias of a floating-point map: a few units of the last place, and twice the slope.
const BIAS: wgpu::DepthBiasState = wgpu::DepthBiasState { constant: 4, slope_scale: 2.0, clamp: 0.0 };

/// Triangles that one draw draws.
struct Draw {
    corners: Range<u32>,
    material: usize,
    is_masked: bool,
    is_double_sided: bool,
}

struct Plain<'a> {
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    positions: wgpu::Buffer,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    draws: Vec<Draw>,
    materials: Vec<wgpu::BindGroup>,
    frame_of_casters: wgpu::BindGroup,
    frame_of_receivers: wgpu::BindGroup,
    casters: wgpu::RenderPipeline,
    masked_casters: wgpu::RenderPipeline,
    /// By `[is_masked][is_double_sided]`.
    receivers: [[wgpu::RenderPipeline; 2]; 2],
    map: wgpu::TextureView,
    depth: wgpu::TextureView,
    color: wgpu::TextureView,
}

/// A pipeline's state that differs from pipeline to pipeline.
struct Style<'a> {
    vertex: &'a str,
    fragment: Option<&'a str>,
    vertex_bytes: u64,
    target: Option<wgpu::ColorTargetState>,
    depth_compare: wgpu::CompareFunction,
    bias: wgpu::DepthBiasState,
    cull_mode: Option<wgpu::Face>,
    groups: &'a [Option<&'a wgpu::BindGroupLayout>],
}

fn pipeline(device: &wgpu::Device, module: &wgpu::ShaderModule, style: &Style<'_>) -> wgpu::RenderPipeline {
    let all = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2];
    let attributes = if style.vertex_bytes == POSITION_BYTES { &all[..1] } else { &all[..] };
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        bind_group_layouts: style.groups,
        ..wgpu::PipelineLayoutDescriptor::default()
    });
    let targets: Vec<_> = style.target.clone().into_iter().map(Some).collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(style.vertex),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(style.vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: style.vertex_bytes,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes,
            })],
        },
        primitive: wgpu::PrimitiveState { cull_mode: style.cull_mode, ..wgpu::PrimitiveState::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(style.depth_compare),
            stencil: wgpu::StencilState::default(),
            bias: style.bias,
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: style.fragment.map(|entry_point| wgpu::FragmentState {
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn target(device: &wgpu::Device, (width, height): (u32, u32), format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Rows of a clip matrix as the matrix.
fn matrix(rows: [[f32; 4]; 4]) -> Mat4 {
    Mat4::from_cols_array_2d(&rows).transpose()
}

fn buffer(device: &wgpu::Device, usage: wgpu::BufferUsages, numbers: &[f32]) -> wgpu::Buffer {
    device.create_buffer_init(&BufferInitDescriptor { label: None, contents: bytemuck::cast_slice(numbers), usage })
}

fn group(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

fn layout(device: &wgpu::Device, bindings: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let entries: Vec<_> =
        (0..).zip(bindings).map(|(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}

/// The colour texture and the sampler of a material.
fn texture(plain: (&wgpu::Device, &wgpu::Queue), scene: &Scene, material: &Material) -> (wgpu::TextureView, wgpu::Sampler) {
    let (device, queue) = plain;
    let white = Image { width: 1, height: 1, texels: vec![[u8::MAX; 4]] };
    let (image, wraps) = match material.texture {
        Some(texture) => (Cow::Borrowed(&scene.images()[texture.image as usize]), [texture.wrap_u, texture.wrap_v]),
        None => (Cow::Owned(white), [Wrap::Repeat; 2]),
    };
    let texture = device.create_texture_with_data(
        queue,
        &wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: image.width, height: image.height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOR_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        image.texels.as_flattened(),
    );
    let [address_mode_u, address_mode_v] = wraps.map(|wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
        Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
    });
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u,
        address_mode_v,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    });
    (texture.create_view(&wgpu::TextureViewDescriptor::default()), sampler)
}

fn draws(scene: &Scene) -> Vec<Draw> {
    let mut draws: Vec<Draw> = Vec::new();
    for (triangle, &material) in (0..).zip(scene.triangle_materials()) {
        let material = material as usize;
        match draws.last_mut() {
            Some(last) if last.material == material => last.corners.end = 3 * (triangle + 1),
            _ => {
                let Material { alpha, double_sided, .. } = scene.materials()[material];
                let is_masked = matches!(alpha, Alpha::Mask { .. });
                draws.push(Draw {
                    corners: 3 * triangle..3 * (triangle + 1),
                    material,
                    is_masked,
                    is_double_sided: double_sided,
                });
            }
        }
    }
    draws
}

impl<'a> Plain<'a> {
    fn new(device: &'a wgpu::Device, queue: &'a wgpu::Queue, scene: &Scene, plan: &FramePlan) -> Self {
        let uniform =
            wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None };
        let texture_2d = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let caster_layout = layout(device, &[uniform]);
        let receiver_layout = layout(
            device,
            &[
                uniform,
                texture_2d(wgpu::TextureSampleType::Depth),
                wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
            ],
        );
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let material_layout = layout(device, &[uniform, texture_2d(filterable), sampler]);

        let module = device.create_shader_module(wgpu::include_wgsl!("plain.wgsl"));
        let style = Style {
            vertex: "caster",
            fragment: None,
            vertex_bytes: POSITION_BYTES,
            target: None,
            depth_compare: wgpu::CompareFunction::Less,
            bias: BIAS,
            cull_mode: None,
            groups: &[Some(&caster_layout)],
        };
        let casters = pipeline(device, &module, &style);
        let masked = Style {
            vertex: "masked_caster",
            fragment: Some("masked"),
            vertex_bytes: VERTEX_BYTES,
            groups: &[Some(&caster_layout), Some(&material_layout)],
            ..style
        };
        let masked_casters = pipeline(device, &module, &masked);
        let forward = Style {
            vertex: "receiver",
            fragment: Some("forward"),
            target: Some(COLOR_FORMAT.into()),
            depth_compare: wgpu::CompareFunction::Greater,
            bias: wgpu::DepthBiasState::default(),
            groups: &[Some(&receiver_layout), Some(&material_layout)],
            ..masked
        };
        let receivers = ["forward", "masked_forward"].map(|fragment| {
            [Some(wgpu::Face::Back), None].map(|cull_mode| {
                pipeline(
                    device,
                    &module,
                    &Style { fragment: Some(fragment), cull_mode, target: forward.target.clone(), ..forward },
                )
            })
        });

        let map = target(device, (MAP_SIZE, MAP_SIZE), DEPTH_FORMAT);
        let compare = device.create_sampler(&wgpu::SamplerDescriptor {
            compare: Some(wgpu::CompareFunction::LessEqual),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        let (camera, light, view) = (&plan.camera, &plan.lights[0], &plan.views[0]);
        let frame: Vec<f32> = matrix([camera.clip_x, camera.clip_y, camera.clip_z, camera.clip_w])
            .to_cols_array()
            .into_iter()
            .chain(matrix([view.clip_x, view.clip_y, view.clip_z, view.clip_w]).to_cols_array())
            .chain(camera.rays.origin)
            .chain((-DIRECTION).normalize().extend(0.0).to_array())
            .chain((Vec3::from(light.intensity) * camera.exposure).extend(0.0).to_array())
            .chain((Vec3::from(camera.ambient) * camera.exposure).extend(0.0).to_array())
            .collect();
        let frame = buffer(device, wgpu::BufferUsages::UNIFORM, &frame);
        let of_receivers =
            [frame.as_entire_binding(), wgpu::BindingResource::TextureView(&map), wgpu::BindingResource::Sampler(&compare)];
        let material_group = |material: &Material| {
            let alpha_cutoff = if let Alpha::Mask { cutoff } = material.alpha { cutoff } else { 0.0 };
            let surface = Vec4::new(alpha_cutoff, shininess_of_roughness(material.roughness), 0.0, 0.0);
            let numbers = [material.base_color.to_array(), surface.to_array()];
            let numbers = buffer(device, wgpu::BufferUsages::UNIFORM, numbers.as_flattened());
            let (view, sampler) = texture((device, queue), scene, material);
            let resources = [
                numbers.as_entire_binding(),
                wgpu::BindingResource::TextureView(&view),
                wgpu::BindingResource::Sampler(&sampler),
            ];
            group(device, &material_layout, &resources)
        };

        let streams = scene.vertices();
        let vertices: Vec<f32> = streams
            .positions
            .iter()
            .zip(&streams.normals)
            .zip(&streams.uvs)
            .flat_map(|((position, normal), uv)| [position.x, position.y, position.z, normal.x, normal.y, normal.z, uv.x, uv.y])
            .collect();
        Self {
            positions: buffer(device, wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&streams.positions)),
            vertices: buffer(device, wgpu::BufferUsages::VERTEX, &vertices),
            indices: device.create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents: bytemuck::cast_slice(scene.triangles()),
                usage: wgpu::BufferUsages::INDEX,
            }),
            draws: draws(scene),
            materials: scene.materials().iter().map(material_group).collect(),
            frame_of_casters: group(device, &caster_layout, &of_receivers[..1]),
            frame_of_receivers: group(device, &receiver_layout, &of_receivers),
            casters,
            masked_casters,
            receivers,
            depth: target(device, PICTURE, DEPTH_FORMAT),
            color: target(device, PICTURE, COLOR_FORMAT),
            map,
            device,
            queue,
        }
    }

    /// Draws runs of triangles with their materials.
    fn draw<'d>(&self, pass: &mut wgpu::RenderPass<'_>, draws: impl Iterator<Item = &'d Draw>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        for draw in draws {
            pass.set_bind_group(1, &self.materials[draw.material], &[]);
            pass.draw_indexed(draw.corners.clone(), 0, 0..1);
        }
    }

    /// Submits what `record` records, and waits until it is done.
    fn timed(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<Duration> {
        let start = Instant::now();
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        record(&mut encoder);
        self.queue.submit([encoder.finish()]);
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(start.elapsed())
    }

    fn shadow_map(&self) -> Result<Duration> {
        self.timed(|encoder| {
            let mut pass = render_pass(encoder, None, &self.map, 1.0);
            pass.set_bind_group(0, &self.frame_of_casters, &[]);
            pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.set_vertex_buffer(0, self.positions.slice(..));
            pass.set_pipeline(&self.casters);
            // Opaque casters come first, and need no material.
            let opaque = self.draws.iter().filter(|draw| !draw.is_masked).map(|draw| draw.corners.end).max();
            pass.draw_indexed(0..opaque.unwrap_or(0), 0, 0..1);
            pass.set_pipeline(&self.masked_casters);
            self.draw(&mut pass, self.draws.iter().filter(|draw| draw.is_masked));
        })
    }

    fn forward(&self) -> Result<Duration> {
        self.timed(|encoder| {
            let mut pass = render_pass(encoder, Some(&self.color), &self.depth, 0.0);
            pass.set_bind_group(0, &self.frame_of_receivers, &[]);
            pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
            for (is_masked, pipelines) in [false, true].into_iter().zip(&self.receivers) {
                for (is_double_sided, pipeline) in [false, true].into_iter().zip(pipelines) {
                    let is_so = |draw: &&Draw| (draw.is_masked, draw.is_double_sided) == (is_masked, is_double_sided);
                    pass.set_pipeline(pipeline);
                    self.draw(&mut pass, self.draws.iter().filter(is_so));
                }
            }
        })
    }
}

fn render_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    color: Option<&wgpu::TextureView>,
    depth: &wgpu::TextureView,
    farthest: f32,
) -> wgpu::RenderPass<'e> {
    let color = color.map(|view| wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
    });
    let colors: &[_] = if color.is_some() { &[color] } else { &[] };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: colors,
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(farthest), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// The milliseconds of one frame: of the map, and of all that makes the picture with it.
#[derive(Clone, Copy)]
struct Times {
    map: f64,
    picture: f64,
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

fn median(rounds: &[[Times; 2]], of: impl Fn(&[Times; 2]) -> f64) -> f64 {
    let mut values: Vec<f64> = rounds.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// What was asked for.
struct Request {
    scene: String,
    frames: usize,
    /// Where the camera is and what it looks at, in the file's coordinates; without it the scene's first camera.
    view: Option<[DVec3; 2]>,
}

fn point(text: &str) -> Option<DVec3> {
    let numbers: Vec<f64> = text.split(',').map(str::parse).collect::<std::result::Result<_, _>>().ok()?;
    Some(DVec3::from_array(numbers.try_into().ok()?))
}

fn request(mut arguments: impl Iterator<Item = String>) -> Option<Request> {
    let mut request = Request { scene: arguments.next()?, frames: FRAMES, view: None };
    let (mut eye, mut target) = (None, None);
    while let Some(option) = arguments.next() {
        let value = arguments.next()?;
        match option.as_str() {
            "--frames" => request.frames = value.parse().ok().filter(|&frames| frames > 0)?,
            "--eye" => eye = Some(point(&value)?),
            "--target" => target = Some(point(&value)?),
            _ => return None,
        }
    }
    request.view = match (eye, target) {
        (Some(eye), Some(target)) => Some([eye, target]),
        (None, None) => None,
        _ => return None,
    };
    Some(request)
}

fn run(request: &Request) -> Result<()> {
    let frames = request.frames;
    let renderer = pollster::block_on(GpuRenderer::new(None))?;
    let scene = match request.scene.parse() {
        Ok(triangles) => builtin::waves(triangles, &[0.0]),
        Err(_) => import(Path::new(&request.scene))?,
    };
    let kind = LightKind::Directional { direction: DIRECTION };
    /// Of an overcast noon, in lux.
    const ILLUMINANCE: f32 = 20_000.0;
    let light = Light { kind, color: Vec3::ONE, intensity: ILLUMINANCE };
    let scene = lit_by(&scene, "sun", light);
    let settings = ShadowSettings { map_size: MAP_SIZE, ..ShadowSettings::default() };
    let projection = scene.cameras()[0].camera.projection;
    let camera = match request.view {
        Some([eye, target]) => Camera::look_at(eye - scene.origin(), target - scene.origin(), projection)?,
        None => scene.cameras()[0].camera,
    };
    let plan = FramePlan::new(&scene, &camera, &settings, PICTURE.0, PICTURE.1, None)?;
    let uploaded = pollster::block_on(renderer.upload(&scene))?;
    let plain = Plain::new(renderer.device(), renderer.queue(), &scene, &plan);

    let mut rounds = Vec::with_capacity(frames);
    // The first frame of each is not counted: shaders are compiled in it.
    for round in 0..=frames {
        let of_plain = Times { map: milliseconds(plain.shadow_map()?), picture: milliseconds(plain.forward()?) };
        let start = Instant::now();
        let maps = pollster::block_on(renderer.shadow_maps(&uploaded, &plan))?;
        let map_done = Instant::now();
        let camera = pollster::block_on(renderer.camera(&uploaded, &plan))?;
        let visibility = pollster::block_on(renderer.visibility(&uploaded, &plan, &camera, &maps))?;
        let _color = pollster::block_on(renderer.color(&uploaded, &plan, &camera, &visibility))?;
        let ours = Times { map: milliseconds(map_done - start), picture: milliseconds(map_done.elapsed()) };
        if round > 0 {
            rounds.push([of_plain, ours]);
        }
    }
    println!("| medians of {frames} frames, ms | shadow map | picture with it |");
    println!("|---|---|---|");
    for (which, name) in ["plain wgpu", "shadow-gpu"].into_iter().enumerate() {
        println!("| {name} | {:.1} | {:.1} |", median(&rounds, |r| r[which].map), median(&rounds, |r| r[which].picture));
    }
    let ratio = |of: fn(&Times) -> f64| median(&rounds, move |[plain, ours]| of(ours) / of(plain));
    println!("| ratio | {:.2} | {:.2} |", ratio(|times| times.map), ratio(|times| times.picture));
    Ok(())
}

fn main() -> ExitCode {
    let Some(request) = request(env::args().skip(1)) else {
        eprintln!("usage: plain SCENE [--frames N] [--eye X,Y,Z --target X,Y,Z], with a glTF file or a number of triangles");
        return ExitCode::from(2);
    };
    match run(&request) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
