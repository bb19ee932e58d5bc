//! Runs either renderer on a job and brings both to the same form.

use std::time::Instant;

use shadow_cpu::{CpuRenderer, RasterRules};
use shadow_gpu::{AdapterSummary, DriverRules, GpuRenderer};
use shadow_scene::{Frame, Layer, LayerName, Request, StageTimes};

use crate::{
    args::{Backend, MachineArgs},
    console::Console,
    error::CliError,
    resolve::Job,
};

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
}

impl RenderedFrame {
    /// A layer that was asked for.
    pub(crate) fn layer(&self, layer: LayerName) -> Result<&Layer, CliError> {
        self.frame.layer(layer).ok_or(CliError::Layer { backend: self.backend.name(), layer })
    }
}

impl Backend {
    /// How many copies of a frame the backend holds: the GPU backend has one in the adapter's memory, which may be the
    /// system's, and one that was read back.
    pub(crate) fn copies(self) -> u64 {
        match self {
            Self::Cpu => 1,
            Self::Gpu => 2,
        }
    }

    /// Renders a job; the CPU backend follows `rules` where WebGPU leaves a choice.
    pub(crate) fn render(
        self,
        job: &Job,
        request: Request,
        machine: &MachineArgs,
        rules: RasterRules,
        console: &Console,
    ) -> Result<RenderedFrame, CliError> {
        match self {
            Self::Cpu => render_on_cpu(job, request, machine, rules, console),
            Self::Gpu => pollster::block_on(render_on_gpu(job, request, machine, console)),
        }
    }
}

/// The rules that the CPU backend follows to be compared with a driver: the driver's, as far as they are known.
pub(crate) fn rules_of(driver: DriverRules) -> RasterRules {
    match driver {
        DriverRules::SwiftShader => RasterRules::SWIFTSHADER,
        DriverRules::Lavapipe22 | DriverRules::Unknown => RasterRules::default(),
    }
}

fn render_on_cpu(
    job: &Job,
    request: Request,
    machine: &MachineArgs,
    rules: RasterRules,
    console: &Console,
) -> Result<RenderedFrame, CliError> {
    let renderer = CpuRenderer::new(machine.threads as usize, rules)?;
    console.stage("preparing the scene for the CPU");
    let start = Instant::now();
    let prepared = renderer.prepare(&job.scene);
    let prepare = milliseconds_since(start);
    console.stage("rendering on the CPU");
    let rendered = renderer.render(&prepared, &job.plan, request)?;
    Ok(RenderedFrame {
        backend: Backend::Cpu,
        adapter: None,
        frame: rendered.frame,
        times: StageTimes { prepare, ..rendered.times },
    })
}

async fn render_on_gpu(job: &Job, request: Request, machine: &MachineArgs, console: &Console) -> Result<RenderedFrame, CliError> {
    console.stage("opening the graphics adapter");
    let renderer = GpuRenderer::new(machine.adapter.as_deref()).await?;
    console.stage(format!("bringing the scene to {}", renderer.adapter().name));
    let start = Instant::now();
    let uploaded = renderer.upload(&job.scene).await?;
    let prepare = milliseconds_since(start);
    console.stage(format!("rendering on {}", renderer.adapter().name));
    let rendered = renderer.render(&uploaded, &job.plan, request).await?;
    Ok(RenderedFrame {
        backend: Backend::Gpu,
        adapter: Some(renderer.adapter().clone()),
        frame: rendered.frame,
        times: StageTimes { prepare, ..rendered.times },
    })
}

/// Milliseconds since then.
fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
