//! Runs a renderer, or the tracer, and brings them all to the same form.

use std::time::Instant;

use serde::Serialize;
use shadow_cpu::{
    CpuRenderer, PreparedScene, RasterRules,
    raster::DepthPlaneRule,
    renderer::CameraBuffer,
    trace::{CameraView, Sampling, Tracer},
};
use shadow_gpu::{
    AdapterSummary, DriverRules, GpuRenderer, GpuScene, find_adapter,
    probe::{DepthPlane, probe_raster},
};
use shadow_math::{LightShape, ShadowSettings};
use shadow_scene::{Frame, FramePlan, Layer, LayerName, Request, Scene, StageTimes};

use crate::{
    args::{Backend, MachineArgs},
    console::Console,
    error::CliError,
    resolve::Job,
};

/// Where a plan is to be drawn.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    /// By which backends.
    pub(crate) backends: &'a [Backend],
    /// The adapter's name, if one was chosen.
    pub(crate) adapter: Option<&'a str>,
    /// Bits of its sub-pixel grid, if they were measured.
    pub(crate) subpixel_bits: Option<u32>,
}

impl<'a> Place<'a> {
    /// By nobody yet.
    pub(crate) const NOWHERE: Self = Self { backends: &[], adapter: None, subpixel_bits: None };

    /// By these backends of a machine.
    pub(crate) fn new(backends: &'a [Backend], machine: &'a MachineArgs) -> Self {
        Self { backends, adapter: machine.adapter.as_deref(), subpixel_bits: None }
    }

    /// Bits of the coarsest sub-pixel grid there: the adapter's, where it is known, and else the default.
    pub(crate) fn subpixel_bits(&self) -> Result<u32, CliError> {
        if let Some(bits) = self.subpixel_bits {
            return Ok(bits);
        }
        let mut bits = ShadowSettings::default().subpixel_bits;
        if self.backends.contains(&Backend::Gpu) {
            let adapter = pollster::block_on(find_adapter(self.adapter))?;
            bits = bits.min(adapter.rules.subpixel_bits().unwrap_or(bits));
        }
        Ok(bits)
    }
}

/// A frame, who made it and how long it took.
pub(crate) struct RenderedFrame {
    /// The renderer.
    pub(crate) backend: Backend,
    /// The graphics adapter, if one was used.
    pub(crate) adapter: Option<AdapterSummary>,
    /// The layers that were asked for.
    pub(crate) frame: Frame,
    /// How long each stage took, in milliseconds, with `prepare`.
    pub(crate) times: StageTimes,
    /// How lights that have a size were sampled, if any were.
    pub(crate) sampling: Option<Sampling>,
}

impl RenderedFrame {
    /// A layer that was asked for.
    pub(crate) fn layer(&self, layer: LayerName) -> Result<&Layer, CliError> {
        self.frame.layer(layer).ok_or(CliError::Layer { backend: self.backend.name(), layer })
    }
}

impl Backend {
    /// Renders a job; the CPU backend follows `rules` where WebGPU leaves a choice.
    pub(crate) fn render(
        self,
        job: &Job,
        request: Request,
        machine: &MachineArgs,
        rules: RasterRules,
        console: &Console,
    ) -> Result<RenderedFrame, CliError> {
        let (renderer, once) = OpenBackend::open(self, job, machine, rules, console)?;
        console.stage(format!("rendering on {}", renderer.place()));
        let (frame, times) = renderer.render(&job.plan, request, console)?;
        let times = StageTimes { prepare: once.prepare, ..times };
        Ok(RenderedFrame { backend: self, adapter: renderer.adapter().cloned(), frame, times, sampling: renderer.sampling() })
    }
}

/// Refuses an adapter that would not be used, and says where threads are not.
pub(crate) fn check_machine(machine: &MachineArgs, backends: &[Backend], console: &Console) -> Result<(), CliError> {
    if let (Some(adapter), false) = (&machine.adapter, backends.contains(&Backend::Gpu)) {
        return Err(CliError::AdapterOfCpu(adapter.clone()));
    }
    if machine.threads != 0 && backends == [Backend::Gpu] {
        console.note("--threads has no effect on the gpu backend");
    }
    Ok(())
}

/// The rules that the CPU backend follows to be compared with an adapter: its driver's where they are known, and else what a probe finds.
pub(crate) fn rules_of(adapter: Option<&str>, console: &Console) -> Result<RasterRules, CliError> {
    Ok(match pollster::block_on(find_adapter(adapter))?.rules {
        DriverRules::Lavapipe22 => RasterRules::default(),
        DriverRules::SwiftShader => RasterRules::SWIFTSHADER,
        DriverRules::Unknown => {
            console.stage("measuring how the adapter draws");
            let (raster, plane) = pollster::block_on(probe_raster(adapter))?;
            let depth_plane = plane.plane.ok().map(|plane| match plane {
                DepthPlane::Snapped => DepthPlaneRule::Snapped,
                DepthPlane::Unsnapped => DepthPlaneRule::Unsnapped,
            });
            RasterRules::measured(raster.subpixel_bits.ok(), depth_plane)
        }
    })
}

/// How long it took to get ready, in milliseconds: what is done once, however many frames follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnceTimes {
    /// Starting the threads, or opening the adapter and compiling the shaders.
    pub(crate) open: f64,
    /// Bringing the scene into the renderer's own form.
    pub(crate) prepare: f64,
}

/// A renderer that has a scene ready to be drawn.
pub(crate) enum OpenBackend<'a> {
    /// The CPU renderer.
    Cpu {
        /// With its threads.
        renderer: Box<CpuRenderer>,
        /// The scene in the renderer's form.
        prepared: PreparedScene<'a>,
    },
    /// The GPU renderer.
    Gpu {
        /// With its adapter and shaders.
        renderer: Box<GpuRenderer>,
        /// The scene in the adapter's memory.
        uploaded: Box<GpuScene>,
    },
    /// The ray tracer.
    Trace(Box<TraceBackend<'a>>),
}

/// The ray tracer, with what it sees through.
pub(crate) struct TraceBackend<'a> {
    /// With its threads and its tree.
    tracer: Tracer<'a>,
    /// Knows how surfaces shine, which is no matter of rays.
    shader: CpuRenderer,
    /// The scene in the shader's form.
    prepared: PreparedScene<'a>,
    view: CameraView,
    sampling: Sampling,
}

impl<'a> OpenBackend<'a> {
    /// Opens a backend, brings a scene to it and says how long that took.
    pub(crate) fn open(
        backend: Backend,
        job: &'a Job,
        machine: &MachineArgs,
        rules: RasterRules,
        console: &Console,
    ) -> Result<(Self, OnceTimes), CliError> {
        let scene = &job.scene;
        let start = Instant::now();
        match backend {
            Backend::Cpu => {
                let renderer = Box::new(CpuRenderer::new(machine.threads as usize, rules)?);
                let open = milliseconds_since(start);
                console.stage("preparing the scene for the CPU");
                let start = Instant::now();
                let prepared = renderer.prepare(scene);
                Ok((Self::Cpu { renderer, prepared }, OnceTimes { open, prepare: milliseconds_since(start) }))
            }
            Backend::Gpu => {
                console.stage("opening the graphics adapter");
                let renderer = pollster::block_on(GpuRenderer::new(machine.adapter.as_deref())).map(Box::new)?;
                let open = milliseconds_since(start);
                console.stage(format!("bringing the scene to {}", renderer.adapter().name));
                let start = Instant::now();
                let uploaded = pollster::block_on(renderer.upload(scene)).map(Box::new)?;
                Ok((Self::Gpu { renderer, uploaded }, OnceTimes { open, prepare: milliseconds_since(start) }))
            }
            Backend::Trace => {
                let threads = machine.threads as usize;
                let shader = CpuRenderer::new(threads, rules)?;
                let open = milliseconds_since(start);
                console.stage("building the tracer's tree");
                let start = Instant::now();
                let tracer = Tracer::new(scene, threads)?;
                let view = CameraView::new(&job.camera, job.plan.camera.width, job.plan.camera.height);
                let prepared = shader.prepare(scene);
                let sampling = job.light_samples.unwrap_or_default();
                let backend = Box::new(TraceBackend { tracer, shader, prepared, view, sampling });
                Ok((Self::Trace(backend), OnceTimes { open, prepare: milliseconds_since(start) }))
            }
        }
    }

    /// The graphics adapter, if one is used.
    pub(crate) fn adapter(&self) -> Option<&AdapterSummary> {
        match self {
            Self::Cpu { .. } | Self::Trace(_) => None,
            Self::Gpu { renderer, .. } => Some(renderer.adapter()),
        }
    }

    /// How many threads it has, as far as it has them itself.
    pub(crate) fn threads(&self) -> Option<usize> {
        match self {
            Self::Cpu { renderer, .. } => Some(renderer.threads()),
            Self::Gpu { .. } => None,
            Self::Trace(backend) => Some(backend.tracer.threads()),
        }
    }

    /// How lights that have a size are sampled, if any are.
    pub(crate) fn sampling(&self) -> Option<Sampling> {
        match self {
            Self::Cpu { .. } | Self::Gpu { .. } => None,
            Self::Trace(backend) => has_sized_light(backend.tracer.scene()).then_some(backend.sampling),
        }
    }

    /// Where it renders, for a sentence.
    pub(crate) fn place(&self) -> &str {
        match self {
            Self::Cpu { .. } => "the CPU",
            Self::Gpu { renderer, .. } => &renderer.adapter().name,
            Self::Trace(_) => "the CPU, ray by ray",
        }
    }

    /// Renders the layers that are asked for and brings them into memory.
    pub(crate) fn render(&self, plan: &FramePlan, request: Request, console: &Console) -> Result<(Frame, StageTimes), CliError> {
        match self {
            Self::Cpu { renderer, prepared } => {
                let rendered = renderer.render(prepared, plan, request)?;
                Ok((rendered.frame, rendered.times))
            }
            Self::Gpu { renderer, uploaded } => {
                let rendered = pollster::block_on(renderer.render(uploaded, plan, request))?;
                Ok((rendered.frame, rendered.times))
            }
            Self::Trace(backend) => Ok(backend.render(plan, request, console)),
        }
    }

    /// Draws a whole frame, every stage of it, and reads nothing back; says how long each stage took, in milliseconds.
    ///
    /// Each stage ends when its result is there: the GPU backend waits for the adapter. Giving the results' memory back is not timed.
    pub(crate) fn draw(&self, plan: &FramePlan) -> Result<StageTimes, CliError> {
        let start = Instant::now();
        match self {
            Self::Cpu { renderer, prepared } => {
                let drawn = renderer.draw(prepared, plan, Request::COLOR)?;
                // Nobody looks at the picture, and the compiler must not notice.
                Ok(std::hint::black_box(drawn).times)
            }
            Self::Gpu { renderer, uploaded } => pollster::block_on(async {
                let camera = renderer.camera(uploaded, plan).await?;
                let camera_done = Instant::now();
                let maps = renderer.shadow_maps(uploaded, plan).await?;
                let maps_done = Instant::now();
                let visibility = renderer.visibility(uploaded, plan, &camera, &maps).await?;
                let _color = renderer.color(uploaded, plan, &camera, &visibility).await?;
                Ok(stage_times([start, camera_done, maps_done, Instant::now()]))
            }),
            Self::Trace(backend) => Ok(backend.draw()),
        }
    }

    /// The tracer, and the rays of its picture; other backends have none.
    pub(crate) fn tracer(&self) -> Option<(&Tracer<'_>, CameraView)> {
        let Self::Trace(backend) = self else { return None };
        Some((&backend.tracer, backend.view))
    }

    /// Millions of rays a second: of the camera, and to the lights. Other backends have none.
    pub(crate) fn million_rays_per_second(&self, camera_milliseconds: f64, shading_milliseconds: f64) -> Option<RayRates> {
        let Self::Trace(backend) = self else { return None };
        let rate = |rays: u64, milliseconds: f64| rays as f64 / (1e3 * milliseconds);
        let pixels = u64::from(backend.view.width()) * u64::from(backend.view.height());
        let seen = backend.tracer.camera(backend.view, &|| {});
        let rays = backend.tracer.lights(&seen, SINGLE_RAY, &|| {}).rays;
        Some(RayRates { camera: rate(pixels, camera_milliseconds), shadow: rate(rays, shading_milliseconds) })
    }
}

/// A ray to each light, as when backends are timed.
const SINGLE_RAY: Sampling = Sampling { side: 1 };

/// Millions of rays a second.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct RayRates {
    /// The first triangle through each pixel.
    pub(crate) camera: f64,
    /// Any triangle between a surface and a light that it faces.
    pub(crate) shadow: f64,
}

/// Whether any light of the scene has a size.
pub(crate) fn has_sized_light(scene: &Scene) -> bool {
    scene.lights().iter().any(|light| light.shape != LightShape::Point)
}

impl TraceBackend<'_> {
    /// Traces the layers that are asked for, with a bar that moves row by row.
    fn render(&self, plan: &FramePlan, request: Request, console: &Console) -> (Frame, StageTimes) {
        let needs_lights = request.visibility || request.color;
        let rows = u64::from(self.view.height());
        console.bar(if needs_lights { 2 * rows } else { rows });
        let step = || console.step();
        let start = Instant::now();
        let seen = self.tracer.camera(self.view, &step);
        let camera_done = Instant::now();
        let lights = needs_lights.then(|| self.tracer.lights(&seen, self.sampling, &step));
        let color = lights.as_ref().filter(|_| request.color).map(|lights| {
            let camera = CameraBuffer { triangles: seen.triangles().into(), ..CameraBuffer::default() };
            self.shader.color(&self.prepared, plan, &camera, &lights.visibility()).into_vec()
        });
        let times = stage_times([start, camera_done, camera_done, Instant::now()]);
        (self.tracer.frame(&seen, lights.as_ref(), color, request), times)
    }

    /// Sends all rays of a frame, one to each light.
    fn draw(&self) -> StageTimes {
        let start = Instant::now();
        let seen = self.tracer.camera(self.view, &|| {});
        let camera_done = Instant::now();
        let lights = self.tracer.lights(&seen, SINGLE_RAY, &|| {});
        let times = stage_times([start, camera_done, camera_done, Instant::now()]);
        // Nobody looks at them, and the compiler must not notice.
        std::hint::black_box(lights);
        times
    }
}

/// The stages of a frame by their borders: the beginning and the ends of camera, shadow maps and shading, in the order in which both
/// renderers draw a frame.
fn stage_times([start, camera_done, maps_done, shading_done]: [Instant; 4]) -> StageTimes {
    let milliseconds = |from: Instant, to: Instant| (to - from).as_secs_f64() * 1e3;
    StageTimes {
        prepare: 0.0,
        camera: milliseconds(start, camera_done),
        shadow_maps: milliseconds(camera_done, maps_done),
        shading: milliseconds(maps_done, shading_done),
    }
}

/// Milliseconds since then.
pub(crate) fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
