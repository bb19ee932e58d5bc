//! `shadow bench`: how long the backends take for the same frame.

mod filters;
mod rival;

use serde::Serialize;
use shadow_cpu::RasterRules;
use shadow_scene::StageTimes;

use self::rival::RivalReport;
use super::{PictureReport, Verdict};
use crate::{
    args::{Backend, BenchArgs},
    backend::{OnceTimes, OpenBackend, Place, RayRates, check_machine, milliseconds_since},
    console::{Console, count, print, print_json, table},
    error::CliError,
    memory::{self, Work},
    resident::PeakWatch,
    resolve::Job,
    statistics::Spread,
};

/// How many rounds are drawn and not counted, after each backend's first frame: with both backends in turn, as they are timed.
const WARM_UP_ROUNDS: u32 = 1;
/// One MiB in bytes.
const MIB: f64 = (1 << 20) as f64;

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    picture: PictureReport<'a>,
    /// How many maps a frame has.
    shadow_maps: usize,
    /// Width and height of each in texels.
    map_size: u32,
    /// How many frames of each backend were counted.
    frames: u32,
    backends: Vec<BackendReport>,
    /// Null for one backend.
    ratios: Option<Ratios>,
    /// Null unless another tracer was asked for.
    rival: Option<RivalReport>,
}

/// What one backend took.
#[derive(Debug, Serialize)]
struct BackendReport {
    backend: &'static str,
    /// The adapter's name; null for the CPU.
    adapter: Option<String>,
    /// The threads of the CPU backend; null for the GPU, whose driver has its own.
    threads: Option<usize>,
    /// The medians over the frames.
    milliseconds: PerStage<f64>,
    /// How far the frames lie apart.
    spread: PerStage<Spread>,
    milliseconds_once: Once,
    /// See [`PeakWatch`]; null where the system does not tell.
    peak_bytes: Option<u64>,
    /// By the medians; null for backends that send no rays.
    million_rays_per_second: Option<RayRates>,
}

/// What is done once, however many frames follow, in milliseconds.
#[derive(Clone, Copy, Debug, Serialize)]
struct Once {
    /// Starting the threads, or opening the adapter and compiling the shaders.
    open: f64,
    /// Bringing the scene into the renderer's own form.
    prepare: f64,
    /// The first frame, with whatever the driver puts off until then, such as compiling for the machine.
    first_frame: f64,
}

/// How many times as long one backend takes as the other, round by round.
#[derive(Debug, Serialize)]
struct Ratios {
    /// What was divided by what.
    of: String,
    /// The medians over the rounds.
    #[serde(flatten)]
    medians: PerStage<f64>,
    /// How far the rounds lie apart.
    spread: PerStage<Spread>,
    /// The names of the backends: what was divided, and by what.
    #[serde(skip)]
    names: [&'static str; 2],
}

/// Something for each stage of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct PerStage<T> {
    shadow_maps: T,
    camera: T,
    shading: T,
    /// All stages together.
    total: T,
}

impl<T> PerStage<T> {
    /// What a function gives for each stage, which is told how to find the stage's time in those of a frame.
    fn by(of_stage: impl Fn(fn(&StageTimes) -> f64) -> T) -> Self {
        Self {
            shadow_maps: of_stage(|times| times.shadow_maps),
            camera: of_stage(|times| times.camera),
            shading: of_stage(|times| times.shading),
            total: of_stage(StageTimes::frame),
        }
    }

    fn map<U>(&self, of: impl Fn(&T) -> U) -> PerStage<U> {
        let Self { shadow_maps, camera, shading, total } = self;
        PerStage { shadow_maps: of(shadow_maps), camera: of(camera), shading: of(shading), total: of(total) }
    }

    /// Each stage with its name for people.
    fn named(&self) -> [(&'static str, &T); 4] {
        [("shadow maps", &self.shadow_maps), ("camera", &self.camera), ("shading", &self.shading), ("whole frame", &self.total)]
    }
}

impl Ratios {
    /// How many times as long the second backend takes as the first, by the times of the same rounds.
    fn of(names: [&'static str; 2], rounds: [&[StageTimes]; 2]) -> Self {
        let [first, second] = rounds;
        let spread = PerStage::by(|stage| {
            Spread::of(first.iter().zip(second).map(|(first, second)| ratio(stage(second), stage(first))).collect())
        });
        let [of, by] = [names[1], names[0]];
        let of_text = format!("milliseconds of {of} divided by milliseconds of {by} in the same round");
        Self { of: of_text, medians: spread.map(|spread| spread.median), spread, names: [of, by] }
    }
}

/// A ratio of times. A stage that takes no time at all, as shadow maps without a light, counts as a nanosecond.
fn ratio(time: f64, by: f64) -> f64 {
    const NANOSECOND: f64 = 1e-6;
    time.max(NANOSECOND) / by.max(NANOSECOND)
}

/// A backend that is ready to be timed.
struct Contender<'a> {
    backend: OpenBackend<'a>,
    name: &'static str,
    once: Once,
    peak_bytes: Option<u64>,
    rounds: Vec<StageTimes>,
}

/// Times the backends in turn and reports.
pub(super) fn run(args: &BenchArgs) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    let backends = args.backends.0.as_slice();
    check_machine(&args.machine, backends, &console)?;
    if let Some(list) = &args.filters {
        return filters::run(args, &list.0, &console);
    }
    if args.rival.is_some() && !backends.contains(&Backend::Trace) {
        return Err(CliError::RivalWithoutTracer);
    }
    let job = Job::resolve(&args.picture, &args.bias, Place::new(backends, &args.machine), &console)?;
    memory::check(&job, Work::Bench(backends))?;

    // One after the other, so that each one's memory can be told from the other's.
    let mut contenders = Vec::with_capacity(backends.len());
    for backend in backends {
        let watch = PeakWatch::begin();
        let (open, OnceTimes { open: opened, prepare }) =
            OpenBackend::open(*backend, &job, &args.machine, RasterRules::default(), &console)?;
        let start = std::time::Instant::now();
        open.draw(&job.plan)?;
        let once = Once { open: opened, prepare, first_frame: milliseconds_since(start) };
        let peak_bytes = watch.and_then(|watch| watch.bytes());
        contenders.push(Contender { backend: open, name: backend.name(), once, peak_bytes, rounds: Vec::new() });
    }

    // In turn, so that a disturbance of the machine, or its clock slowing down, hits all of them.
    console.stage("timing");
    console.bar(u64::from(args.frames));
    for round in 0..WARM_UP_ROUNDS + args.frames {
        for contender in &mut contenders {
            let times = contender.backend.draw(&job.plan)?;
            if round >= WARM_UP_ROUNDS {
                contender.rounds.push(times);
            }
        }
        if round >= WARM_UP_ROUNDS {
            console.step();
        }
    }
    console.finish();

    let rival = match (&args.rival, contenders.iter().find_map(|contender| contender.backend.tracer())) {
        (None, _) => None,
        (Some(program), Some((tracer, view))) => Some(rival::race(program, tracer, view, &console)?),
        (Some(_), None) => return Err(CliError::RivalWithoutTracer),
    };
    console.finish();
    let ratios = match &contenders[..] {
        [first, second] => Some(Ratios::of([first.name, second.name], [&first.rounds, &second.rounds])),
        _ => None,
    };
    let report = Report {
        picture: PictureReport::of(&job),
        shadow_maps: job.plan.views.len(),
        map_size: job.plan.map_size,
        frames: args.frames,
        backends: contenders.iter().map(BackendReport::of).collect(),
        ratios,
        rival,
    };
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(Verdict::Done)
}

impl BackendReport {
    fn of(contender: &Contender<'_>) -> Self {
        let spread = PerStage::by(|stage| Spread::of(contender.rounds.iter().map(stage).collect()));
        let milliseconds = spread.map(|spread| spread.median);
        Self {
            backend: contender.name,
            adapter: contender.backend.adapter().map(|adapter| adapter.name.clone()),
            threads: contender.backend.threads(),
            million_rays_per_second: contender.backend.million_rays_per_second(milliseconds.camera, milliseconds.shading),
            milliseconds,
            spread,
            milliseconds_once: contender.once,
            peak_bytes: contender.peak_bytes,
        }
    }

    /// The backend and where it runs.
    fn title(&self) -> String {
        match (&self.adapter, self.threads) {
            (Some(adapter), _) => format!("{} ({adapter})", self.backend),
            (None, Some(threads)) => format!("{} ({})", self.backend, count(threads, "thread")),
            (None, None) => self.backend.into(),
        }
    }
}

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let Report { picture: PictureReport { scene, triangles, width, height, .. }, shadow_maps, map_size, frames, .. } = report;
    let maps = count(*shadow_maps, "shadow map");
    let mut text = format!(
        "{scene}: {triangles} triangles, {width} x {height} pixels, {maps} of {map_size} x {map_size} texels; \
         {frames} frames of each backend, in turn\n\n"
    );
    let mut rows = vec![["backend", "stage", "median", "quartiles", "fastest", "slowest"].map(String::from).to_vec()];
    for backend in &report.backends {
        for (stage, spread) in backend.spread.named() {
            let Spread { min, lower_quartile, median, upper_quartile, max } = *spread;
            rows.push(vec![
                backend.backend.into(),
                stage.into(),
                format!("{median:.2} ms"),
                format!("{lower_quartile:.2} to {upper_quartile:.2}"),
                format!("{min:.2}"),
                format!("{max:.2}"),
            ]);
        }
    }
    text.push_str(&table(&rows, |column| column < 2));
    text.push('\n');
    if let Some(Ratios { medians, spread, names: [of, by], .. }) = &report.ratios {
        let Spread { lower_quartile, upper_quartile, .. } = spread.total;
        text.push_str(&format!(
            "{of} takes {:.2} times as long as {by} (quartiles {lower_quartile:.2} to {upper_quartile:.2}): shadow maps {:.2}, camera {:.2}, \
             shading {:.2}\n",
            medians.total, medians.shadow_maps, medians.camera, medians.shading
        ));
    }
    if let Some(rival) = &report.rival {
        text.push_str(&rival.text());
    }
    for backend in &report.backends {
        if let Some(RayRates { camera, shadow }) = backend.million_rays_per_second {
            text.push_str(&format!(
                "{} sends {camera:.1} million rays a second from the camera and {shadow:.1} million to lights\n",
                backend.title()
            ));
        }
        let Once { open, prepare, first_frame } = backend.milliseconds_once;
        let peak =
            backend.peak_bytes.map_or_else(String::new, |bytes| format!("; {:.0} MiB of memory at its peak", bytes as f64 / MIB));
        text.push_str(&format!(
            "{} took once {open:.1} ms to open, {prepare:.1} ms to prepare the scene and {first_frame:.1} ms for its first frame{peak}\n",
            backend.title()
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(shadow_maps: f64, camera: f64, shading: f64) -> StageTimes {
        StageTimes { prepare: 0.0, shadow_maps, camera, shading }
    }

    #[test]
    fn ratios_divide_the_second_backend_by_the_first_round_by_round() {
        // The machine is disturbed in the last round, which hits both alike and so leaves the ratio as it was.
        let cpu = [times(1.0, 2.0, 1.0), times(1.0, 2.0, 1.0), times(10.0, 20.0, 10.0)];
        let gpu = [times(3.0, 4.0, 5.0), times(3.0, 4.0, 5.0), times(30.0, 40.0, 50.0)];
        let ratios = Ratios::of(["cpu", "gpu"], [&cpu, &gpu]);
        assert_eq!(ratios.medians, PerStage { shadow_maps: 3.0, camera: 2.0, shading: 5.0, total: 3.0 });
        assert_eq!((ratios.spread.total.min, ratios.spread.total.max), (3.0, 3.0));
        assert_eq!(ratios.of, "milliseconds of gpu divided by milliseconds of cpu in the same round");
        let json = serde_json::to_value(&ratios).unwrap();
        assert_eq!((&json["total"], &json["spread"]["camera"]["median"]), (&3.0.into(), &2.0.into()));
    }

    #[test]
    fn a_stage_that_takes_no_time_has_a_ratio() {
        let nothing = [times(0.0, 0.0, 0.0)];
        assert_eq!(Ratios::of(["cpu", "gpu"], [&nothing, &nothing]).medians.total, 1.0);
    }

    #[test]
    fn the_text_names_the_stages_and_what_is_divided() {
        let rounds = [times(1.0, 2.0, 3.0)];
        let backend = |name, adapter: Option<&str>| BackendReport {
            backend: name,
            adapter: adapter.map(String::from),
            threads: adapter.is_none().then_some(2),
            milliseconds: PerStage::by(|stage| stage(&rounds[0])),
            spread: PerStage::by(|stage| Spread::of(rounds.iter().map(stage).collect())),
            milliseconds_once: Once { open: 0.5, prepare: 7.0, first_frame: 8.0 },
            peak_bytes: adapter.is_none().then_some(3 << 20),
            million_rays_per_second: adapter.is_none().then_some(RayRates { camera: 1.25, shadow: 2.5 }),
        };
        let report = Report {
            picture: PictureReport { scene: "builtin:demo", notes: &[], triangles: 12, width: 16, height: 9 },
            shadow_maps: 1,
            map_size: 64,
            frames: 1,
            backends: vec![backend("cpu", None), backend("gpu", Some("a driver"))],
            ratios: Some(Ratios::of(["cpu", "gpu"], [&rounds, &rounds])),
            rival: None,
        };
        let text = text(&report);
        for part in [
            "1 shadow map of 64 x 64",
            "whole frame  6.00 ms",
            "gpu takes 1.00 times as long as cpu",
            "cpu (2 threads) took once 0.5 ms to open",
            "3 MiB of memory at its peak\n",
            "gpu (a driver) took once",
            "1.2 million rays a second from the camera and 2.5 million to lights",
        ] {
            assert!(text.contains(part), "`{part}` in {text}");
        }
    }
}
