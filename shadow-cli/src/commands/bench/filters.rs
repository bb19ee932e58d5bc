//! `shadow bench --filters`: what each filter costs, on the same maps.

use serde::Serialize;
use shadow_cpu::RasterRules;
use shadow_math::{
    Filter,
    plan::{FILTER_BILINEAR, FILTER_CROSS, FILTER_DISC, FILTER_HARD, FILTER_SEPARABLE, LightPlan},
};
use shadow_scene::{FramePlan, StageTimes};

use super::WARM_UP_ROUNDS;
use crate::{
    args::{Backend, BenchArgs},
    backend::{OpenBackend, Place},
    commands::{PictureReport, Verdict},
    console::{Console, count, print, print_json, table},
    error::CliError,
    memory::{self, Work},
    resolve::Job,
    statistics::Spread,
};

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    picture: PictureReport<'a>,
    map_size: u32,
    frames: u32,
    /// Lookups in a frame: pixels times lights.
    lookups: u64,
    filters: Vec<FilterReport>,
}

/// What a filter costs.
#[derive(Debug, Serialize)]
struct FilterReport {
    filter: Filter,
    /// Depth tests a lookup; null where they vary from pixel to pixel.
    tests: Option<u32>,
    backends: Vec<CostReport>,
}

/// What a filter costs on a backend.
#[derive(Debug, Serialize)]
struct CostReport {
    backend: &'static str,
    /// The median of visibility and shading together.
    shading_milliseconds: f64,
    /// By how much that exceeds what one test takes, for each test more, over all lookups; null for one test, or where the number varies.
    nanoseconds_per_further_test: Option<f64>,
}

/// A backend that is ready to be timed, and its times by filter.
struct Contender<'a> {
    backend: OpenBackend<'a>,
    name: &'static str,
    rounds: Vec<Vec<StageTimes>>,
}

/// Times the filters in turn, on one backend after the other, and reports.
pub(super) fn run(args: &BenchArgs, filters: &[Filter], console: &Console) -> Result<Verdict, CliError> {
    let backends = args.backends.0.as_slice();
    if backends.contains(&Backend::Trace) {
        return Err(CliError::FiltersOfTrace);
    }
    if !args.picture.shadows.light_settings.is_empty() {
        return Err(CliError::LightSettings);
    }
    let job = Job::resolve(&args.picture, &args.bias, Place::new(backends, &args.machine), console)?;
    memory::check(&job, Work::Bench(backends))?;
    // What is more is measured against the hard test, whether it was asked for or not.
    let timed: Vec<Filter> =
        [Filter::Hard].into_iter().chain(filters.iter().copied().filter(|&filter| filter != Filter::Hard)).collect();
    let plans = timed.iter().map(|&filter| plan(&job, filter, args.picture.exposure)).collect::<Result<Vec<_>, _>>()?;
    let mut contenders = Vec::with_capacity(backends.len());
    for backend in backends {
        let (open, _) = OpenBackend::open(*backend, &job, &args.machine, RasterRules::default(), console)?;
        open.draw(&job.plan)?;
        contenders.push(Contender { backend: open, name: backend.name(), rounds: vec![Vec::new(); plans.len()] });
    }
    console.stage("timing");
    console.bar(u64::from(args.frames));
    for round in 0..WARM_UP_ROUNDS + args.frames {
        for contender in &mut contenders {
            for (plan, rounds) in plans.iter().zip(&mut contender.rounds) {
                let times = contender.backend.draw(plan)?;
                if round >= WARM_UP_ROUNDS {
                    rounds.push(times);
                }
            }
        }
        if round >= WARM_UP_ROUNDS {
            console.step();
        }
    }
    console.finish();
    let camera = &job.plan.camera;
    let lookups = u64::from(camera.width) * u64::from(camera.height) * job.plan.lights.len() as u64;
    let of_filter = |index: usize| {
        let tests = plans[index].lights.first().and_then(tests);
        let of_backend = |contender: &Contender<'_>| {
            let median = |index: usize| Spread::of(contender.rounds[index].iter().map(|times| times.shading).collect()).median;
            let (shading_milliseconds, of_hard) = (median(index), median(0));
            let further = tests.filter(|&tests| tests > 1).map(|tests| f64::from(tests - 1) * lookups.max(1) as f64);
            let nanoseconds_per_further_test = further.map(|further| 1e6 * (shading_milliseconds - of_hard) / further);
            CostReport { backend: contender.name, shading_milliseconds, nanoseconds_per_further_test }
        };
        FilterReport { filter: timed[index], tests, backends: contenders.iter().map(of_backend).collect() }
    };
    let report = Report {
        picture: PictureReport::of(&job),
        map_size: job.plan.map_size,
        frames: args.frames,
        lookups,
        filters: (0..timed.len()).map(of_filter).collect(),
    };
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(Verdict::Done)
}

/// The same picture with another filter.
fn plan(job: &Job, filter: Filter, exposure: Option<f32>) -> Result<FramePlan, CliError> {
    let camera = &job.plan.camera;
    job.shadowing
        .with_filter(filter)
        .plan(&job.scene, &job.camera, (camera.width, camera.height), exposure)
        .map_err(|source| CliError::Technique { name: filter.name().into(), source: Box::new(source) })
}

/// How many depth tests a lookup takes; `None` where that varies.
fn tests(light: &LightPlan) -> Option<u32> {
    match light.filter {
        FILTER_HARD => Some(1),
        FILTER_BILINEAR => Some(4),
        FILTER_CROSS => Some(5),
        FILTER_DISC => Some(light.filter_taps),
        FILTER_SEPARABLE => Some((light.filter_taps + 1).pow(2)),
        _ => None,
    }
}

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let mut text = format!(
        "{}: {} triangles, {} x {} pixels, maps of {size} x {size} texels; {} of each filter, in turn\n\n",
        report.picture.scene,
        report.picture.triangles,
        report.picture.width,
        report.picture.height,
        count(report.frames as usize, "frame"),
        size = report.map_size
    );
    let mut heading = vec!["filter".to_string(), "tests".into()];
    if let Some(first) = report.filters.first() {
        heading.extend(first.backends.iter().flat_map(|cost| [format!("{}: shading", cost.backend), "each further test".into()]));
    }
    let mut rows = vec![heading];
    for filter in &report.filters {
        let mut row = vec![filter.filter.name().into(), filter.tests.map_or_else(|| "varies".into(), |tests| tests.to_string())];
        for cost in &filter.backends {
            row.push(format!("{:.1} ms", cost.shading_milliseconds));
            row.push(cost.nanoseconds_per_further_test.map_or_else(|| "-".into(), |time| format!("{time:.2} ns")));
        }
        rows.push(row);
    }
    text.push_str(&table(&rows, |column| column == 0));
    text.push_str("\nshading is visibility and colour together; a further test is what shading takes beyond a hard test's, over all lookups\n");
    text
}
