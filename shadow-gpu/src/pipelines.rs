//! Pipelines and the layouts of what is bound to them.

use std::{
    collections::HashMap,
    sync::{Mutex, PoisonError},
};

use shadow_math::{
    depth::DEPTH_Z_OVER_W,
    plan::{BIAS_AUTOMATIC, FILTER_BILINEAR, LightPlan, ViewPlan},
};

mod color;
mod map;

pub(crate) use self::{
    color::{Blend, ColorPipelines},
    map::{Drawn, MapPipelines, MapStyle},
};
use crate::shaders::{self, CAMERA_MODULE, READBACK_ID_MODULE, READBACK_MODULE, ShaderFile, VISIBILITY_MODULE};

/// The format of shadow maps and of the camera's depth.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The format of visibilities.
pub(crate) const VISIBILITY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// The format of colours.
pub(crate) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// The format of the camera's triangle indices.
pub(crate) const ID_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// The layouts of the bind groups, by what they bind.
pub(crate) struct Layouts {
    pub(crate) geometry: wgpu::BindGroupLayout,
    pub(crate) surfaces: wgpu::BindGroupLayout,
    pub(crate) views: wgpu::BindGroupLayout,
    pub(crate) first_surface: wgpu::BindGroupLayout,
    pub(crate) camera: wgpu::BindGroupLayout,
    pub(crate) visibility: wgpu::BindGroupLayout,
    pub(crate) color: wgpu::BindGroupLayout,
    pub(crate) readback: wgpu::BindGroupLayout,
    pub(crate) readback_id: wgpu::BindGroupLayout,
}

/// One pipeline for each kind of run of triangles, and one for each compute pass.
pub(crate) struct Pipelines {
    pub(crate) layouts: Layouts,
    pub(crate) map: MapPipelines,
    /// By `[is_masked][culls_back_faces]`.
    pub(crate) camera: [[wgpu::RenderPipeline; 2]; 2],
    visibility: VisibilityPipelines,
    pub(crate) color: ColorPipelines,
    pub(crate) readback: wgpu::ComputePipeline,
    pub(crate) readback_id: wgpu::ComputePipeline,
}

const GRAPHICS: wgpu::ShaderStages = wgpu::ShaderStages::VERTEX_FRAGMENT;
const FRAGMENT: wgpu::ShaderStages = wgpu::ShaderStages::FRAGMENT;
pub(crate) const COMPUTE: wgpu::ShaderStages = wgpu::ShaderStages::COMPUTE;

const UNIFORM: wgpu::BindingType =
    wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None };

/// A part of a uniform buffer that is chosen when it is bound.
const SLICE: wgpu::BindingType =
    wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: true, min_binding_size: None };

pub(crate) const fn storage(read_only: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

pub(crate) const fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

/// Depths are bound as numbers that cannot be filtered: the same binding takes a depth texture and an upload.
const DEPTHS: wgpu::BindingType =
    texture(wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2Array);
pub(crate) const FLOATS: wgpu::BindingType =
    texture(wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2);
const IDS: wgpu::BindingType = texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);

/// A layout whose bindings are numbered from 0.
pub(crate) fn layout(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    bindings: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> =
        (0..).zip(bindings).map(|(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

impl Layouts {
    fn new(device: &wgpu::Device) -> Self {
        let read = storage(true);
        let write = storage(false);
        Self {
            geometry: layout(device, "geometry", GRAPHICS, &[FLOATS, IDS]),
            surfaces: layout(device, "surfaces", GRAPHICS, &[IDS, IDS, UNIFORM]),
            views: layout(device, "views", GRAPHICS, &[read]),
            first_surface: layout(device, "first surface", FRAGMENT, &[FLOATS]),
            camera: layout(device, "camera", GRAPHICS, &[UNIFORM]),
            visibility: layout(device, "visibility", FRAGMENT, &[UNIFORM, SLICE, SLICE, DEPTHS, IDS]),
            color: layout(device, "color", FRAGMENT, &[UNIFORM, read, IDS, DEPTHS]),
            readback: layout(device, "readback", COMPUTE, &[DEPTHS, UNIFORM, write]),
            readback_id: layout(device, "readback of ids", COMPUTE, &[IDS, write]),
        }
    }
}

pub(crate) fn module(device: &wgpu::Device, label: &str, files: &[ShaderFile]) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(shaders::join(files).into());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source })
}

pub(crate) fn pipeline_layout(device: &wgpu::Device, label: &str, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|group| Some(*group)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

/// What differs between the render pipelines.
struct RenderStyle<'a> {
    label: &'a str,
    layout: &'a wgpu::PipelineLayout,
    module: &'a wgpu::ShaderModule,
    vertex: &'a str,
    fragment: Option<&'a str>,
    /// The constants that the module leaves open, for the fragment stage.
    constants: &'a [(&'a str, f64)],
    positions_as_attribute: bool,
    target: Option<wgpu::TextureFormat>,
    depth_compare: wgpu::CompareFunction,
}

fn render_pipeline(device: &wgpu::Device, style: &RenderStyle<'_>) -> wgpu::RenderPipeline {
    let position = wgpu::VertexBufferLayout {
        array_stride: 12,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &[wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: 0 }],
    };
    let buffers = [Some(position)];
    let targets: Vec<_> = style.target.into_iter().map(|format| Some(format.into())).collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(style.label),
        layout: Some(style.layout),
        vertex: wgpu::VertexState {
            module: style.module,
            entry_point: Some(style.vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: if style.positions_as_attribute { &buffers } else { &[] },
        },
        // Casters are never culled, since a single-sided wall shadows from behind too, and the camera culls in its fragment shader.
        primitive: wgpu::PrimitiveState { cull_mode: None, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(style.depth_compare),
            stencil: wgpu::StencilState::default(),
            // Bias lives in the receiver's mathematics: the units of this one are the driver's.
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: style.fragment.map(|entry_point| wgpu::FragmentState {
            module: style.module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions { constants: style.constants, ..Default::default() },
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A pass over all pixels that show a triangle, whose fragments write one number or colour each. `constants` are those that the module leaves open.
fn full_screen_pipeline(
    device: &wgpu::Device,
    entry_point: &str,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
    constants: &[(&str, f64)],
    target: wgpu::ColorTargetState,
) -> wgpu::RenderPipeline {
    let compilation_options = || wgpu::PipelineCompilationOptions { constants, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(entry_point),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("full_screen"),
            compilation_options: compilation_options(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        // Depth is reversed and the triangle on the far plane: only where the camera saw something is the stored depth greater.
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(entry_point),
            compilation_options: compilation_options(),
            targets: &[Some(target)],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// What is asked of a light's views.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct VisibilityStyle {
    filter: u32,
    bias: u32,
    depth: u32,
    is_warped: bool,
    blends: bool,
}

impl VisibilityStyle {
    /// What a light and its views ask.
    pub(crate) fn of(light: &LightPlan, views: &[ViewPlan]) -> Self {
        Self {
            filter: light.filter,
            bias: light.bias,
            depth: views.first().map_or(DEPTH_Z_OVER_W, |view| view.depth_kind),
            is_warped: views.iter().any(|view| view.is_warped != 0),
            blends: light.split_band.as_flattened().iter().any(|&band| band > 0.0),
        }
    }
}

/// The pipelines of visibility: one for each style that was asked for.
struct VisibilityPipelines {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    made: Mutex<HashMap<VisibilityStyle, wgpu::RenderPipeline>>,
}

impl VisibilityPipelines {
    fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let name = "resolve_visibility";
        let pipelines = Self {
            module: module(device, name, VISIBILITY_MODULE),
            layout: pipeline_layout(device, name, &[&layouts.geometry, &layouts.visibility]),
            made: Mutex::default(),
        };
        // What a driver has against the module is to be known from the beginning.
        let light = LightPlan { filter: FILTER_BILINEAR, bias: BIAS_AUTOMATIC, ..LightPlan::default() };
        pipelines.get(device, VisibilityStyle::of(&light, &[]));
        pipelines
    }

    fn get(&self, device: &wgpu::Device, style: VisibilityStyle) -> wgpu::RenderPipeline {
        let VisibilityStyle { filter, bias, depth, is_warped, blends } = style;
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || {
            let constants = [
                ("LIGHT_FILTER", f64::from(filter)),
                ("LIGHT_BIAS", f64::from(bias)),
                ("LIGHT_DEPTH", f64::from(depth)),
                ("LIGHT_IS_WARPED", f64::from(is_warped)),
                ("LIGHT_BLENDS", f64::from(blends)),
            ];
            full_screen_pipeline(device, "resolve_visibility", &self.module, &self.layout, &constants, VISIBILITY_FORMAT.into())
        };
        made.entry(style).or_insert_with(make).clone()
    }
}

pub(crate) fn compute_pipeline(
    device: &wgpu::Device,
    entry_point: &str,
    files: &[ShaderFile],
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::ComputePipeline {
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(&pipeline_layout(device, entry_point, groups)),
        module: &module(device, entry_point, files),
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

impl Pipelines {
    /// The pipeline of visibility for a light.
    pub(crate) fn visibility(&self, device: &wgpu::Device, style: VisibilityStyle) -> wgpu::RenderPipeline {
        self.visibility.get(device, style)
    }

    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let layouts = Layouts::new(device);
        let camera_layout = pipeline_layout(device, "camera", &[&layouts.geometry, &layouts.surfaces, &layouts.camera]);
        let camera_module = module(device, "camera", CAMERA_MODULE);
        let camera_pipeline = |label: &str, fragment: &str| {
            let style = RenderStyle {
                label,
                layout: &camera_layout,
                module: &camera_module,
                vertex: "camera_vertex",
                fragment: Some(fragment),
                constants: &[],
                positions_as_attribute: false,
                target: Some(ID_FORMAT),
                // Reversed depth; of equals the first drawn stays, which is the triangle with the lowest index.
                depth_compare: wgpu::CompareFunction::Greater,
            };
            render_pipeline(device, &style)
        };
        let camera = [
            [
                camera_pipeline("camera, opaque, double-sided", "opaque_fragment"),
                camera_pipeline("camera, opaque, single-sided", "opaque_front_fragment"),
            ],
            [
                camera_pipeline("camera, masked, double-sided", "masked_fragment"),
                camera_pipeline("camera, masked, single-sided", "masked_front_fragment"),
            ],
        ];
        Self {
            map: MapPipelines::new(device, &layouts),
            camera,
            visibility: VisibilityPipelines::new(device, &layouts),
            color: ColorPipelines::new(device, &layouts),
            readback: compute_pipeline(device, "read_depth", READBACK_MODULE, &[&layouts.readback]),
            readback_id: compute_pipeline(device, "read_id", READBACK_ID_MODULE, &[&layouts.readback_id]),
            layouts,
        }
    }
}
