//! Runs a shader function over many inputs, to be compared with its Rust twin.

use shadow_gpu::{
    GpuRenderer,
    shaders::{self, ShaderFile},
};
use shadow_math::{
    material::MaterialData,
    plan::{LightPlan, ViewPlan},
};

/// What the functions read beside their inputs.
#[derive(Clone, Debug)]
pub struct Globals {
    /// The lights that functions name by index.
    pub lights: Vec<LightPlan>,
    /// The views that functions name by index.
    pub views: Vec<ViewPlan>,
    /// The materials that functions name by index.
    pub materials: Vec<MaterialData>,
    /// The texel buffer.
    pub words: Vec<u32>,
    /// Width and height of the maps in texels.
    pub map_size: u32,
    /// The depths of all layers, one after the other.
    pub depths: Vec<f32>,
}

impl Default for Globals {
    fn default() -> Self {
        Self {
            lights: vec![LightPlan::default()],
            views: vec![ViewPlan::default()],
            materials: vec![bytemuck::Zeroable::zeroed()],
            words: vec![0],
            map_size: 1,
            depths: vec![1.0],
        }
    }
}

/// The files whose functions can be called: every mirror of `shadow-math`, and what they need.
pub const MIRRORS: &[ShaderFile] = &[
    shaders::PLAN,
    shaders::VECTOR,
    shaders::LIGHT,
    shaders::TRIANGLE,
    shaders::DEPTH,
    shaders::GRADIENT,
    shaders::CASTER,
    shaders::BIAS,
    shaders::FILTER,
    shaders::VISIBILITY,
    shaders::APPROX,
    shaders::SRGB,
    shaders::MATERIAL,
    shaders::PICTURE,
    shaders::SHADE,
];

/// Evaluates WGSL statements once for each group of `inputs_each` numbers and gives `outputs_each` numbers for each.
///
/// The statements read their inputs as `input(0u)`, `input(1u)` and so on, and write with `output(0u, value)`.
///
/// # Panics
///
/// If the shader does not compile or the device fails: there is nothing then that a test could go on with.
#[must_use]
pub fn evaluate(
    renderer: &GpuRenderer,
    globals: &Globals,
    statements: &str,
    inputs: &[f32],
    inputs_each: usize,
    outputs_each: usize,
) -> Vec<f32> {
    let count = inputs.len() / inputs_each;
    let harness = format!(
        "@group(0) @binding(0) var<storage, read> inputs: array<f32>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<f32>;
        @group(0) @binding(2) var<storage, read> lights: array<LightPlan>;
        @group(0) @binding(3) var<storage, read> views: array<ViewPlan>;
        @group(0) @binding(4) var<storage, read> materials: array<MaterialData>;
        @group(0) @binding(5) var<storage, read> words: array<u32>;
        @group(0) @binding(6) var<storage, read> depths: array<f32>;
        const MAP_SIZE: u32 = {map_size}u;
        var<private> invocation: u32;
        fn filter_kind(light: u32) -> u32 {{ return lights[light].filter_kind; }}
        fn bias_kind(light: u32) -> u32 {{ return lights[light].bias; }}
        fn depth_kind(view: u32) -> u32 {{ return views[view].depth_kind; }}
        fn is_warped(view: u32) -> u32 {{ return views[view].is_warped; }}
        fn blends_views(light: u32) -> bool {{ return true; }}
        fn fetch_texel(layer: u32, x: u32, y: u32) -> f32 {{ return depths[(layer * MAP_SIZE + y) * MAP_SIZE + x]; }}
        fn fetch_word(index: u32) -> u32 {{ return words[index]; }}
        fn decoded(byte: u32) -> f32 {{ return bitcast<f32>(words[byte]); }}
        fn decoded_alpha(byte: u32) -> f32 {{ return bitcast<f32>(words[ALPHA_TABLE + byte]); }}
        fn fetch_material(material: u32) -> MaterialData {{ return materials[material]; }}
        fn input(index: u32) -> f32 {{ return inputs[invocation * {inputs_each}u + index]; }}
        fn input3(index: u32) -> vec3f {{ return vec3f(input(index), input(index + 1u), input(index + 2u)); }}
        fn output(index: u32, value: f32) {{ outputs[invocation * {outputs_each}u + index] = value; }}
        fn output3(index: u32, value: vec3f) {{
            output(index, value.x);
            output(index + 1u, value.y);
            output(index + 2u, value.z);
        }}
        @compute @workgroup_size(64)
        fn evaluate(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= {count}u {{ return; }}
            invocation = id.x;
            // Named so that every binding is part of the layout, whatever the statements use.
            _ = lights[0].kind;
            _ = views[0].layer;
            _ = materials[0].flags;
            _ = words[0];
            _ = depths[0];
            {statements}
        }}",
        map_size = globals.map_size,
    );
    let source = format!("{}\n{harness}", shaders::join(MIRRORS));
    let device = renderer.device();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("mirror"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("mirror"),
        layout: None,
        module: &module,
        entry_point: Some("evaluate"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let storage = |contents: &[u8]| {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("mirror"),
            size: contents.len().max(16) as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        renderer.queue().write_buffer(&buffer, 0, contents);
        buffer
    };
    let output_bytes = (4 * count * outputs_each) as u64;
    let outputs = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("mirror outputs"),
        size: output_bytes,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("mirror staging"),
        size: output_bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let buffers = [
        storage(bytemuck::cast_slice(inputs)),
        outputs,
        storage(bytemuck::cast_slice(&globals.lights)),
        storage(bytemuck::cast_slice(&globals.views)),
        storage(bytemuck::cast_slice(&globals.materials)),
        storage(bytemuck::cast_slice(&globals.words)),
        storage(bytemuck::cast_slice(&globals.depths)),
    ];
    let entries: Vec<_> = (0..)
        .zip(&buffers)
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
        .collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("mirror"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("mirror") });
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((count as u32).div_ceil(64), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&buffers[1], 0, &staging, 0, output_bytes);
    renderer.queue().submit([encoder.finish()]);
    staging.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("the outputs can be mapped"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    let view = staging.slice(..).get_mapped_range().expect("the outputs are mapped");
    let mut values = vec![0.0_f32; count * outputs_each];
    bytemuck::cast_slice_mut::<f32, u8>(&mut values).copy_from_slice(&view);
    values
}

/// The distance of two numbers in units in the last place; 0 for equal bits and for two NaN, and between zeros of either sign.
#[must_use]
pub fn ulps(a: f32, b: f32) -> u32 {
    if a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (a == 0.0 && b == 0.0) {
        return 0;
    }
    if a.is_nan() || b.is_nan() {
        return u32::MAX;
    }
    // The bits of floats as integers that grow with the number.
    let ordered = |x: f32| {
        let bits = x.to_bits() as i32;
        i64::from(if bits < 0 { i32::MIN.wrapping_sub(bits) } else { bits })
    };
    u32::try_from((ordered(a) - ordered(b)).abs()).unwrap_or(u32::MAX)
}
