//! `shadow measure`: techniques against the truth.

mod aliasing;
mod motion;
mod page;
mod plot;

use std::path::PathBuf;

use serde::{Serialize, Serializer, ser::SerializeMap};
use shadow_cpu::{
    CpuRenderer, RasterRules,
    measure::{Cause, Counts, FrameAliasing, Judge, Judgement},
    renderer::CameraBuffer,
    trace::{CameraView, Tracer},
};
use shadow_math::ShadowSettings;
use shadow_scene::{Frame, FramePlan, LayerName, Request, StageTimes};

use self::{
    aliasing::AliasingReport,
    motion::{Motions, StabilityReport},
};
use super::{PictureReport, Verdict};
use crate::{
    args::{Backend, MeasureArgs},
    backend::{OpenBackend, Place, check_machine, has_sized_light},
    console::{Console, print, print_json, table},
    error::CliError,
    light_drawing::light_drawing,
    memory::{self, Work},
    output::{make_folder, write_text},
    presets::Engine,
    resolve::{Job, composed},
    settings_file::{NamedSettings, SettingsReport, read},
    shadowing::Shadowing,
    statistics::Spread,
};

/// The layers of a frame that is judged: all of them, for maps tell acne from what is drawn wrongly.
const JUDGED: Request = Request::ALL;
/// One MiB in bytes.
const MIB: f64 = (1 << 20) as f64;

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    picture: PictureReport<'a>,
    backend: &'static str,
    /// The adapter's name; null for the CPU.
    adapter: Option<String>,
    /// Rays to each light that has a size; null without any.
    light_samples: Option<u32>,
    techniques: Vec<TechniqueReport>,
    /// The page, if one was written.
    report: Option<String>,
}

/// How wrong a technique is.
#[derive(Debug, Serialize)]
struct TechniqueReport {
    /// Those of the first light; each of the lights has its own.
    settings: SettingsReport,
    /// The settings in a line, by kind of light where they differ.
    #[serde(skip)]
    summary: String,
    #[serde(flatten)]
    counts: CountsReport,
    milliseconds: Milliseconds,
    /// Bytes of all maps.
    map_bytes: u64,
    stability: StabilityReport,
    aliasing: AliasingReport,
    lights: Vec<LightReport>,
}

/// How wrong the visibility of a light is.
#[derive(Debug, Serialize)]
struct LightReport {
    name: String,
    settings: SettingsReport,
    #[serde(flatten)]
    counts: CountsReport,
    aliasing: AliasingReport,
}

/// How many pixels are wrong, and why.
#[derive(Debug, Serialize)]
struct CountsReport {
    pixels: u64,
    wrong: u64,
    causes: Causes,
    at_terminator: u64,
    rmse: f64,
}

/// Pixels by cause, by the causes' names.
#[derive(Clone, Copy, Debug)]
struct Causes(Counts);

impl Serialize for Causes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(Cause::ALL.len()))?;
        for cause in Cause::ALL {
            map.serialize_entry(cause.name(), &self.0.count(cause))?;
        }
        map.end()
    }
}

impl From<Counts> for CountsReport {
    fn from(counts: Counts) -> Self {
        Self {
            pixels: counts.judged,
            wrong: counts.wrong(),
            causes: Causes(counts),
            at_terminator: counts.at_terminator,
            rmse: counts.rmse(),
        }
    }
}

/// The medians over the frames.
#[derive(Clone, Copy, Debug, Serialize)]
struct Milliseconds {
    shadow_maps: f64,
    camera: f64,
    shading: f64,
    total: f64,
}

impl Milliseconds {
    fn of(frames: &[StageTimes]) -> Self {
        let median = |stage: fn(&StageTimes) -> f64| Spread::of(frames.iter().map(stage).collect()).median;
        Self {
            shadow_maps: median(|times| times.shadow_maps),
            camera: median(|times| times.camera),
            shading: median(|times| times.shading),
            total: median(StageTimes::frame),
        }
    }
}

/// What a technique made of the picture.
struct Shown {
    frame: Frame,
    judgement: Judgement,
    aliasing: FrameAliasing,
    /// The light cameras, as SVG.
    drawing: String,
}

/// Measures and reports.
pub(super) fn run(args: &MeasureArgs) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    if args.rendering.backend == Backend::Trace {
        return Err(CliError::MeasureTrace);
    }
    if !args.picture.shadows.light_settings.is_empty() {
        return Err(CliError::LightSettings);
    }
    // The tracer has threads of its own, whatever renders.
    check_machine(&args.machine, &[args.rendering.backend, Backend::Trace], &console)?;
    let technique = |path: &PathBuf| {
        let NamedSettings { name, settings } = read(path)?;
        Ok::<_, CliError>(Technique { name, shadowing: Shadowing::alike(settings) })
    };
    let from_files = args.settings.iter().map(technique).collect::<Result<Vec<_>, _>>()?;
    let backends = [args.rendering.backend];
    let place = Place::new(&backends, &args.machine);
    let job = Job { light_samples: args.rendering.light_samples, ..Job::resolve(&args.picture, &args.bias, place, &console)? };
    let techniques = techniques(&job, args, from_files)?;
    let plans = techniques.iter().map(|technique| plan(&job, technique, args)).collect::<Result<Vec<_>, _>>()?;
    for plan in &plans {
        memory::check_plan(
            &job,
            plan,
            Work::Measure(args.rendering.backend, if args.report.is_some() { plans.len() } else { 1 }),
        )?;
    }
    if let Some(folder) = &args.report {
        make_folder(folder)?;
    }
    if has_sized_light(&job.scene) {
        console.note("shadow maps are drawn for a light's centre: the causes are for that, and rmse has its whole size");
    }

    console.stage("building the tracer's tree");
    let tracer = Tracer::new(&job.scene, args.machine.threads as usize)?;
    let camera = &job.plan.camera;
    let view = CameraView::new(&job.camera, camera.width, camera.height);
    let (backend, _) = OpenBackend::open(args.rendering.backend, &job, &args.machine, RasterRules::default(), &console)?;
    let steps_each = u64::from(args.frames) + u64::from(WARM_UP) + 1 + Motions::COUNT as u64;
    console.bar(3 * u64::from(camera.height) + steps_each * techniques.len() as u64);
    console.stage("tracing the truth");
    let judge = Judge::new(&tracer, view, job.light_samples.unwrap_or_default(), &|| console.step());

    let motions = Motions::new(&job, &judge, &tracer);
    let mut reports = Vec::with_capacity(techniques.len());
    let mut shown = Vec::with_capacity(techniques.len());
    for (technique, plan) in techniques.iter().zip(&plans) {
        console.stage(format!("measuring {}", technique.name));
        let mut times = Vec::with_capacity(args.frames as usize);
        for frame in 0..WARM_UP + args.frames {
            let drawn = backend.draw(plan)?;
            if frame >= WARM_UP {
                times.push(drawn);
            }
            console.step();
        }
        let (mut frame, _) = backend.render(plan, JUDGED, &console)?;
        let judgement = judge.judge(plan, &frame)?;
        let missing = CliError::Layer { backend: args.rendering.backend.name(), layer: LayerName::Triangle };
        let triangles = frame.triangles().ok_or(missing)?;
        let aliasing = FrameAliasing::of(&job.scene, plan, triangles, args.machine.threads as usize)?;
        frame.layers.retain(|layer| !matches!(layer.name, LayerName::ShadowMap { .. }));
        console.step();
        let stability = motions.stability(&backend, technique, plan, args.picture.exposure, &console)?;
        let lights = job.scene.lights().iter().zip(&judgement.lights).zip(&aliasing.lights);
        reports.push(TechniqueReport {
            settings: SettingsReport::of(&technique.name, &technique.shadowing.of_first(&job.scene)),
            summary: technique.summary(&job),
            counts: judgement.total().into(),
            milliseconds: Milliseconds::of(&times),
            map_bytes: map_bytes(plan),
            stability,
            aliasing: aliasing.total.into(),
            lights: lights
                .map(|((light, judged), aliasing)| LightReport {
                    name: light.name.clone(),
                    settings: SettingsReport::of(&technique.name, &technique.shadowing.of(&light.light.kind)),
                    counts: judged.counts.into(),
                    aliasing: aliasing.statistics.into(),
                })
                .collect(),
        });
        if args.report.is_some() {
            let drawing = light_drawing(&job.scene, &job.camera, plan, &format!("cameras-{}-", shown.len()));
            shown.push(Shown { frame, judgement, aliasing, drawing });
        }
    }

    let mut report = Report {
        picture: PictureReport::of(&job),
        backend: args.rendering.backend.name(),
        adapter: backend.adapter().map(|adapter| adapter.name.clone()),
        light_samples: has_sized_light(&job.scene).then(|| judge.lights().sampling.count()),
        techniques: reports,
        report: None,
    };
    if let Some(folder) = &args.report {
        console.stage("writing the page");
        let truth = true_color(&job, &judge, args.machine.threads as usize)?;
        let path = folder.join("index.html");
        report.report = Some(path.display().to_string());
        write_text(&path, &page::html(&report, &shown, &truth)?)?;
    }
    console.finish();
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(Verdict::Done)
}

/// Frames of each technique that are drawn and not counted.
const WARM_UP: u32 = 1;

/// How lights are shadowed, and what that is called.
struct Technique {
    name: String,
    shadowing: Shadowing,
}

impl Technique {
    /// Its settings in a line.
    fn summary(&self, job: &Job) -> String {
        let of_kind = |(kind, settings): (&str, ShadowSettings)| {
            let summary = SettingsReport::of(&self.name, &settings).summary();
            if kind.is_empty() { summary } else { format!("{kind}: {summary}") }
        };
        let kinds: Vec<String> = self.shadowing.by_kind(&job.scene).into_iter().map(of_kind).collect();
        kinds.join("; ")
    }
}

/// The techniques of the files or, without any, that of the command line.
fn techniques(job: &Job, args: &MeasureArgs, from_files: Vec<Technique>) -> Result<Vec<Technique>, CliError> {
    if from_files.is_empty() {
        let name = args.bias.preset.map_or("command line", Engine::name);
        return Ok(vec![Technique { name: name.into(), shadowing: job.shadowing }]);
    }
    let mut names: Vec<&str> = Vec::new();
    for Technique { name, .. } in &from_files {
        if names.contains(&name.as_str()) {
            return Err(CliError::TechniqueName(name.clone()));
        }
        names.push(name);
    }
    let on_grid =
        |technique: Technique| Technique { shadowing: technique.shadowing.on_grid(job.shadowing.subpixel_bits()), ..technique };
    Ok(from_files.into_iter().map(on_grid).collect())
}

fn plan(job: &Job, technique: &Technique, args: &MeasureArgs) -> Result<FramePlan, CliError> {
    let size = args.picture.size;
    let failed = |source| CliError::Technique { name: technique.name.clone(), source: Box::new(source) };
    let plan =
        technique.shadowing.plan(&job.scene, &job.camera, (size.width, size.height), args.picture.exposure).map_err(failed)?;
    composed(plan, &args.picture.shadows)
}

/// Bytes of all maps of a plan: 32-bit floats.
fn map_bytes(plan: &FramePlan) -> u64 {
    plan.map_bytes()
}

/// The colours that the picture would have with true visibilities.
fn true_color(job: &Job, judge: &Judge<'_>, threads: usize) -> Result<Vec<[f32; 4]>, CliError> {
    let shader = CpuRenderer::new(threads, RasterRules::default())?;
    let camera = CameraBuffer { triangles: judge.seen().triangles().into(), ..CameraBuffer::default() };
    let visibility = judge.lights().visibility();
    Ok(shader.color(&shader.prepare(&job.scene), &job.plan, &camera, &visibility).into_vec())
}

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let mut heading = vec!["technique".to_string(), "settings".into(), "wrong".into()];
    heading.extend(Cause::ALL.iter().rev().map(|cause| cause.name().replace('_', " ")));
    heading.extend(["rmse", "unstable", "m 95 %", "m > 1", "waste", "maps", "frame", "memory"].map(String::from));
    let mut rows = vec![heading];
    for technique in &report.techniques {
        let CountsReport { pixels, wrong, causes, rmse, .. } = &technique.counts;
        let mut row = vec![technique.settings.name().into(), technique.summary.clone(), percent(*wrong, *pixels)];
        row.extend(Cause::ALL.iter().rev().map(|&cause| causes.0.count(cause).to_string()));
        row.push(format!("{rmse:.4}"));
        row.push(share(technique.stability.worst_of_camera()));
        row.extend(technique.aliasing.columns());
        row.push(format!("{:.1} ms", technique.milliseconds.shadow_maps));
        row.push(format!("{:.1} ms", technique.milliseconds.total));
        row.push(format!("{:.0} MiB", technique.map_bytes as f64 / MIB));
        rows.push(row);
    }
    let mut text = table(&rows, |column| column < 2);
    let adapter = report.adapter.as_ref().map_or_else(String::new, |adapter| format!(" ({adapter})"));
    if let Some(first) = report.techniques.first() {
        text.push_str(&format!(
            "{}: {} pixels that a light can reach, counted once for each of {} lights; {} of them lie where smooth normals and flat faces disagree about \
             facing the light (the terminator)\n",
            report.picture.scene,
            first.counts.pixels,
            first.lights.len(),
            first.counts.at_terminator,
        ));
    }
    text.push_str(&format!(
        "measured on {}{adapter}, {} x {} pixels\n",
        report.backend, report.picture.width, report.picture.height
    ));
    if let Some(page) = &report.report {
        text.push_str(&format!("wrote {page}\n"));
    }
    text
}

/// A share from 0 to 1 in two digits.
fn share(share: f64) -> String {
    if share == 0.0 { "0".into() } else { format!("{share:.1e}") }
}

/// A share in percent, with as many digits as it takes to tell it from nothing.
fn percent(part: u64, whole: u64) -> String {
    if part == 0 {
        return "0 %".into();
    }
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    if share < 0.01 { format!("{share:.0e} %") } else { format!("{share:.2} %") }
}
