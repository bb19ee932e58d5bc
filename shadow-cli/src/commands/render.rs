//! `shadow render`: one picture.

use serde::Serialize;
use shadow_cpu::{
    RasterRules,
    trace::{
        Sampling,
        confidence::{CONFIDENCE, Intervals},
    },
};
use shadow_math::ShadowSettings;
use shadow_scene::{LayerName, StageTimes};

use super::Verdict;
use crate::{
    args::{Backend, RenderArgs},
    backend::{Place, RenderedFrame, check_machine, has_sized_light},
    console::{Console, count, print, print_json},
    debug_view::{DebugView, Explained, Wanted, explain},
    error::CliError,
    memory::{self, Work},
    output::{Format, check_output_path, write_layer, write_picture},
    picture::pictures,
    resolve::{Job, request_for},
    specs::Show,
};

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    scene: &'a str,
    notes: &'a [String],
    backend: &'static str,
    /// The adapter's name; null for the CPU.
    adapter: Option<&'a str>,
    triangles: usize,
    /// Width of the written picture in pixels; that of a shadow map is the map's.
    width: u32,
    /// Its height.
    height: u32,
    milliseconds: Milliseconds,
    /// Null where no light was sampled.
    light_samples: Option<LightSamples>,
    output: String,
}

/// How lights that have a size were sampled.
#[derive(Clone, Copy, Debug, Serialize)]
struct LightSamples {
    /// Rays a pixel and light.
    count: u32,
    /// How often the true visibility of a pixel lies in its interval, at least.
    confidence: f64,
    /// The width of the widest interval that a pixel can have.
    widest_interval: f64,
}

impl From<Sampling> for LightSamples {
    fn from(sampling: Sampling) -> Self {
        let count = sampling.count();
        Self { count, confidence: CONFIDENCE, widest_interval: Intervals::new(count, CONFIDENCE).widest() }
    }
}

/// How long each stage took, in milliseconds.
#[derive(Clone, Copy, Debug, Serialize)]
struct Milliseconds {
    prepare: f64,
    shadow_maps: f64,
    camera: f64,
    shading: f64,
    /// The frame: all but `prepare`.
    total: f64,
}

impl From<StageTimes> for Milliseconds {
    fn from(times: StageTimes) -> Self {
        let StageTimes { prepare, shadow_maps, camera, shading } = times;
        Self { prepare, shadow_maps, camera, shading, total: times.frame() }
    }
}

/// Renders the picture and writes it.
pub(super) fn run(args: &RenderArgs) -> Result<Verdict, CliError> {
    let format = check_output_path(&args.output)?;
    let console = Console::new(args.json);
    check_machine(&args.machine, &[args.rendering.backend], &console)?;
    if args.rendering.light_samples.is_some() && args.rendering.backend != Backend::Trace {
        return Err(CliError::LightSamplesOfMaps);
    }
    let backends = [args.rendering.backend];
    let place = Place::new(&backends, &args.machine);
    let job = Job { light_samples: args.rendering.light_samples, ..Job::resolve(&args.picture, &args.bias, place, &console)? };
    let layer = job.layer(&args.show)?;
    if args.rendering.backend == Backend::Trace {
        note_maps_of_trace(args, &job, &console);
    }
    if args.rendering.backend == Backend::Trace && matches!(layer, LayerName::ShadowMap { .. }) {
        return Err(CliError::MapOfTrace);
    }
    if args.rendering.backend != Backend::Trace && has_sized_light(&job.scene) {
        console.note("shadow maps are drawn for a light's centre, so that its shadows are hard; --backend trace shows its size");
    }
    if let Show::Debug(view, light, light_view) = &args.show {
        let wanted = Wanted { view: *view, light, light_view: *light_view };
        return explained(&wanted, args, &job, format, &console);
    }
    memory::check(&job, Work::Render(args.rendering.backend, layer, format))?;

    let rendered = args.rendering.backend.render(&job, request_for(layer), &args.machine, RasterRules::default(), &console)?;
    let shown = rendered.layer(layer)?;
    console.stage(format!("writing {}", args.output.display()));
    match format {
        Format::Png => {
            let [picture] = pictures([shown], &job.plan);
            write_picture(&args.output, &picture)?;
        }
        Format::Exr => write_layer(&args.output, shown)?,
    }
    console.finish();

    let report = Report {
        scene: &job.scene_name,
        notes: &job.notes,
        backend: args.rendering.backend.name(),
        adapter: rendered.adapter.as_ref().map(|adapter| adapter.name.as_str()),
        triangles: job.scene.triangles().len(),
        width: shown.width,
        height: shown.height,
        milliseconds: rendered.times.into(),
        light_samples: rendered.sampling.map(LightSamples::from),
        output: args.output.display().to_string(),
    };
    if args.json { print_json(&report) } else { print(&sentences(&report, &job, &rendered, &layer.to_string())) }?;
    Ok(Verdict::Done)
}

/// Says which options do nothing where there are no maps.
fn note_maps_of_trace(args: &RenderArgs, job: &Job, console: &Console) {
    let (default, settings) = (ShadowSettings::default(), job.shadowing.of_first(&job.scene));
    let (shadows, has_preset) = (&args.picture.shadows, args.bias.preset.is_some());
    let options = [
        ("--preset", has_preset),
        ("--bias", settings.bias != default.bias && !has_preset),
        ("--map-size", shadows.map_size != default.map_size),
        ("--store", shadows.store != default.store),
        ("--filter", shadows.filter.0 != default.filter),
        ("--texels", shadows.texels != default.texels),
        ("--subpixel-bits", shadows.subpixel_bits.is_some()),
        ("--light-settings", !shadows.light_settings.is_empty()),
        ("--shadow-budget", shadows.shadow_budget.is_some()),
    ];
    let unused: Vec<&str> = options.into_iter().filter(|(_, is_given)| *is_given).map(|(option, _)| option).collect();
    if !unused.is_empty() {
        console.note(&format!("the trace backend has no shadow maps: {} has no effect", unused.join(", ")));
    }
}

/// Writes a picture that explains the frame.
fn explained(wanted: &Wanted<'_>, args: &RenderArgs, job: &Job, format: Format, console: &Console) -> Result<Verdict, CliError> {
    let name = DebugView::ALL.into_iter().find(|(_, view)| *view == wanted.view).map_or("", |(name, _)| name);
    if format == Format::Exr {
        return Err(CliError::DebugViewAsNumbers(name.into()));
    }
    if args.rendering.backend == Backend::Trace && wanted.view != DebugView::Unshadowed {
        return Err(CliError::DebugViewOfTrace(name.into()));
    }
    let Explained { picture, width, height, legend, rendered } =
        explain(wanted, job, args.rendering.backend, &args.machine, console)?;
    console.stage(format!("writing {}", args.output.display()));
    write_picture(&args.output, &picture)?;
    console.finish();
    let mut notes = job.notes.clone();
    if !legend.is_empty() {
        notes.push(legend.clone());
    }
    let report = Report {
        scene: &job.scene_name,
        notes: &notes,
        backend: args.rendering.backend.name(),
        adapter: rendered.adapter.as_ref().map(|adapter| adapter.name.as_str()),
        triangles: job.scene.triangles().len(),
        width,
        height,
        milliseconds: rendered.times.into(),
        light_samples: None,
        output: args.output.display().to_string(),
    };
    if args.json {
        print_json(&report)?;
    } else {
        let text = sentences(&report, job, &rendered, name);
        print(&if legend.is_empty() { text } else { format!("{text}{legend}\n") })?;
    }
    Ok(Verdict::Done)
}

/// The report for people.
fn sentences(report: &Report<'_>, job: &Job, rendered: &RenderedFrame, layer: &str) -> String {
    let Report { scene, triangles, width, height, output, milliseconds, .. } = report;
    let Milliseconds { prepare, shadow_maps, camera, shading, total } = milliseconds;
    let machine =
        rendered.adapter.as_ref().map_or_else(|| "the CPU".into(), |adapter| format!("the GPU backend ({})", adapter.name));
    let lights = count(job.scene.lights().len(), "light");
    format!(
        "wrote {output}: the {layer} of {scene} ({triangles} triangles, {lights}), {width} x {height} pixels, by {machine}\n\
         {total:.1} ms: shadow maps {shadow_maps:.1} ms, camera {camera:.1} ms, shading {shading:.1} ms (and once {prepare:.1} ms to prepare the scene)\n"
    )
}
