//! `shadow tune`: the automatic bias on a scene, certified beside what others do.

mod page;
mod tries;

use std::path::Path;

use serde::Serialize;
use shadow_cpu::{
    RasterRules,
    measure::{Cause, Judge, Lengths, Needs, Onset, Trial, Trials},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_math::{Filter, Store, Texels, plan::BIAS_BACK_FACES};
use shadow_scene::{FrameMaps, LayerName, Request};

use self::tries::{STEPS_OF_LIGHT, TRIED_SHARES, Tries};
use super::{PictureReport, Verdict};
use crate::{
    args::{Backend, BiasArgs, TuneArgs},
    backend::{OpenBackend, Place, check_machine},
    console::{Console, count, print, print_json, table, to_json},
    error::CliError,
    memory::{self, Work},
    output::{check_folder_of, write_text},
    resolve::{Job, kind_name},
};

/// The layers that the certificate is made of.
const ASKED: Request = Request { camera: true, shadow_maps: true, visibility: true, color: false };

/// The maps alone.
const MAPS: Request = Request { camera: false, shadow_maps: true, visibility: false, color: false };

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    picture: PictureReport<'a>,
    backend: &'static str,
    /// The adapter's name; null for the CPU.
    adapter: Option<String>,
    map_size: u32,
    filter: Filter,
    /// Whether the automatic bias leaves no acne.
    holds: bool,
    output: String,
    lights: Vec<LightReport>,
}

/// One light's certificate.
#[derive(Debug, Serialize)]
struct LightReport {
    name: String,
    kind: &'static str,
    maps: u32,
    /// Pixels that shadow themselves in the frame that was rendered.
    acne: u64,
    /// Pixels that are shadowed by texels into which slivers were drawn at depths that nothing has there.
    by_slivers: u64,
    /// Pixels whose two normals disagree about facing the light: a smooth mesh shows its facets there, whatever the bias.
    at_terminator: u64,
    needed: NeededReport,
    /// The shares of the automatic bias between which acne begins; null if there is none without any.
    onset: Option<OnsetReport>,
    /// The automatic bias, the constant that was tuned, if there is one, and the engines' defaults.
    rules: Vec<BiasReport>,
    curves: CurvesReport,
}

/// The medians of the gap that is needed, by its parts.
#[derive(Clone, Copy, Debug, Serialize)]
struct NeededReport {
    filter: f32,
    snap: f32,
    rounding: f32,
}

/// As [`Onset`] has it.
#[derive(Clone, Copy, Debug, Serialize)]
struct OnsetReport {
    with_acne: f32,
    without: f32,
}

/// Biases that differ by an amount alone.
#[derive(Debug, Serialize)]
struct CurvesReport {
    /// Shares of the automatic bias.
    automatic: Vec<BiasReport>,
    /// Lengths in metres toward the light.
    constant: Vec<BiasReport>,
}

/// What a bias makes of a light's shadows.
#[derive(Debug, Serialize)]
struct BiasReport {
    name: String,
    /// What of an engine's default it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    what: Option<&'static str>,
    /// A share or a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    amount: Option<f32>,
    acne: u64,
    peter_panning: u64,
    leak: u64,
    gap: LengthsReport,
    /// How far outlines are moved.
    shift: LengthsReport,
    /// Pixels whose gap is wider than that of the automatic bias.
    wider: u64,
    /// Pixels whose outlines are moved farther than by the automatic bias.
    shifted: u64,
    /// Whether the engine draws back faces into its map, on which it is tried.
    #[serde(skip_serializing_if = "Option::is_none")]
    casts_back_faces: Option<bool>,
    fails: Vec<Failure>,
}

/// As [`Lengths`] has it; null for what is infinite.
#[derive(Clone, Copy, Debug, Serialize)]
struct LengthsReport {
    pixels: u64,
    median: f32,
    percentile_95: f32,
    max: f32,
}

impl From<Lengths> for LengthsReport {
    fn from(lengths: Lengths) -> Self {
        let Lengths { pixels, median, percentile_95, max } = lengths;
        Self { pixels, median, percentile_95, max }
    }
}

/// What a bias fails at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Failure {
    /// Surfaces shadow themselves.
    Acne,
    /// More pixels are lit that should be in shadow.
    Light,
    /// Shadows begin farther from what casts them than they need to.
    Gap,
    /// Outlines are moved farther than they need to be.
    Shift,
}

impl Failure {
    fn name(self) -> &'static str {
        match self {
            Self::Acne => "acne",
            Self::Light => "light",
            Self::Gap => "gap",
            Self::Shift => "shift",
        }
    }
}

/// The share of pixels with a wider gap, or a longer shift, than that of the automatic bias, beyond which a bias counts as failing.
const MORE_THAN_NEEDED: f64 = 0.05;

/// How many times as many pixels may be lit that should be in shadow as under the automatic bias, before a bias counts as failing.
const MORE_LIGHT: u64 = 2;

/// Pixels that are lit and should be in shadow, with all taps of their lookup.
fn lit_wrongly(trial: &Trial) -> u64 {
    trial.counts.count(Cause::PeterPanning) + trial.counts.count(Cause::Leak)
}

impl BiasReport {
    /// `automatic` is what the automatic bias makes of the same light.
    fn new(name: String, trial: &Trial, automatic: &Trial) -> Self {
        let many = |pixels: u64| pixels as f64 > MORE_THAN_NEEDED * trial.gaps.pixels as f64;
        let is_lit = lit_wrongly(trial) > MORE_LIGHT * lit_wrongly(automatic);
        let failures = [
            (Failure::Acne, trial.acne() > 0),
            (Failure::Light, is_lit),
            (Failure::Gap, many(trial.wider)),
            (Failure::Shift, many(trial.shifted)),
        ];
        Self {
            name,
            what: None,
            amount: None,
            acne: trial.acne(),
            peter_panning: trial.counts.count(Cause::PeterPanning),
            leak: trial.counts.count(Cause::Leak),
            gap: trial.gaps.into(),
            shift: trial.shifts.into(),
            wider: trial.wider,
            shifted: trial.shifted,
            casts_back_faces: None,
            fails: failures.into_iter().filter_map(|(failure, is_so)| is_so.then_some(failure)).collect(),
        }
    }
}

impl From<&Needs> for NeededReport {
    fn from(needs: &Needs) -> Self {
        let median = |gaps: &[f32]| Lengths::of(gaps.iter().copied()).median;
        Self { filter: median(&needs.filter), snap: median(&needs.snap), rounding: median(&needs.rounding) }
    }
}

impl From<Onset> for OnsetReport {
    fn from(onset: Onset) -> Self {
        Self { with_acne: onset.with_acne, without: onset.without }
    }
}

/// What the certificate is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Page,
    Json,
}

impl Format {
    fn of(path: &Path) -> Result<Self, CliError> {
        let is = |ending: &str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending));
        if is("html") {
            Ok(Self::Page)
        } else if is("json") {
            Ok(Self::Json)
        } else {
            Err(CliError::CertificateFormat { path: path.into() })
        }
    }
}

/// Certifies and reports.
pub(super) fn run(args: &TuneArgs) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    if args.backend == Backend::Trace {
        return Err(CliError::MeasureTrace);
    }
    if !args.picture.shadows.light_settings.is_empty() {
        return Err(CliError::LightSettings);
    }
    if args.picture.shadows.texels != Texels::OpenGl {
        return Err(CliError::TuneTexels);
    }
    if args.picture.shadows.store != Store::Depth32 {
        return Err(CliError::TuneStore(args.picture.shadows.store.name()));
    }
    let format = Format::of(&args.output)?;
    check_folder_of(&args.output)?;
    // The tracer has threads of its own, whatever renders.
    check_machine(&args.machine, &[args.backend, Backend::Trace], &console)?;
    let job = Job::resolve(&args.picture, &BiasArgs::default(), Place::new(&[args.backend], &args.machine), &console)?;
    memory::check(&job, Work::Measure(args.backend, 1))?;

    console.stage("building the tracer's tree");
    let tracer = Tracer::new(&job.scene, args.machine.threads as usize)?;
    let camera = &job.plan.camera;
    let view = CameraView::new(&job.camera, camera.width, camera.height);
    let (backend, _) = OpenBackend::open(args.backend, &job, &args.machine, RasterRules::default(), &console)?;
    console.stage(format!("rendering on {}", backend.place()));
    let (frame, _) = backend.render(&job.plan, ASKED, &console)?;
    let lights = job.scene.lights();
    console.bar(3 * u64::from(camera.height) + STEPS_OF_LIGHT * lights.len() as u64);
    console.stage("tracing the truth");
    // Causes are judged by the light's centre: one ray to each is enough.
    let judge = Judge::new(&tracer, view, Sampling { side: 1 }, &|| console.step());
    let judgement = judge.judge(&job.plan, &frame)?;

    let name = args.backend.name();
    let missing = CliError::Layer { backend: name, layer: LayerName::Triangle };
    let triangles = frame.triangles().ok_or(missing)?;
    let missing = CliError::Layer { backend: name, layer: LayerName::ShadowMap { light: 0, view: 0 } };
    let maps = FrameMaps::of(&frame, &job.plan).ok_or(missing)?;
    // Some engines draw back faces into their maps: the same views, with other faces.
    let mut back_faces_plan = job.plan.clone();
    back_faces_plan.lights.iter_mut().for_each(|light| light.bias |= BIAS_BACK_FACES);
    console.stage("drawing back faces");
    let (back_faces, _) = backend.render(&back_faces_plan, MAPS, &console)?;
    let missing = CliError::Layer { backend: name, layer: LayerName::ShadowMap { light: 0, view: 0 } };
    let back_faces = FrameMaps::of(&back_faces, &back_faces_plan).ok_or(missing)?;
    let trials = Trials::new(&judge, &job.plan, triangles, &maps, &back_faces);
    let diagonal = 2.0 * job.scene.bounds().radius();
    let mut reports = Vec::with_capacity(lights.len());
    for (index, light) in lights.iter().enumerate() {
        console.stage(format!("trying biases on light {index}"));
        let Tries { rules, onset, curves } = Tries::on(&trials, index, diagonal, &|| console.step());
        reports.push(LightReport {
            name: light.name.clone(),
            kind: kind_name(&light.light.kind),
            maps: job.plan.lights[index].view_count,
            acne: judgement.lights[index].counts.count(Cause::Acne),
            by_slivers: judgement.lights[index].counts.by_slivers,
            at_terminator: judgement.lights[index].counts.at_terminator,
            needed: NeededReport::from(&judge.needs(&job.plan, index, triangles)),
            onset: onset.map(OnsetReport::from),
            rules,
            curves,
        });
    }
    let report = Report {
        picture: PictureReport::of(&job),
        backend: name,
        adapter: backend.adapter().map(|adapter| adapter.name.clone()),
        map_size: job.plan.map_size,
        filter: job.shadowing.of_first(&job.scene).filter,
        holds: reports.iter().all(|light| light.acne == 0),
        output: args.output.display().to_string(),
        lights: reports,
    };
    console.stage("writing the certificate");
    match format {
        Format::Page => write_text(&args.output, &page::html(&report))?,
        Format::Json => write_text(&args.output, &to_json(&report).map_err(CliError::Stdout)?)?,
    }
    console.finish();
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(if report.holds { Verdict::Done } else { Verdict::NotSo })
}

/// The headings of the table of biases.
const HEADINGS: [&str; 9] = ["bias", "acne", "lit wrongly", "gap: median", "95 %", "wider", "shift: median", "longer", "fails"];
/// What stands behind the name of an engine that casts back faces.
const BACK_FACES_MARK: &str = " *";

/// The cells of a bias, in the order of [`HEADINGS`].
fn cells(bias: &BiasReport) -> [String; HEADINGS.len()] {
    let fails: Vec<_> = bias.fails.iter().map(|failure| failure.name()).collect();
    let share = |pixels: u64| format!("{:.0} %", 100.0 * pixels as f64 / bias.gap.pixels.max(1) as f64);
    let mark = if bias.casts_back_faces == Some(true) { BACK_FACES_MARK } else { "" };
    [
        format!("{}{mark}", bias.name),
        bias.acne.to_string(),
        (bias.peter_panning + bias.leak).to_string(),
        length(f64::from(bias.gap.median)),
        length(f64::from(bias.gap.percentile_95)),
        share(bias.wider),
        length(f64::from(bias.shift.median)),
        share(bias.shifted),
        if fails.is_empty() { "-".into() } else { fails.join(", ") },
    ]
}

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let mut text = String::new();
    for (index, light) in report.lights.iter().enumerate() {
        text.push_str(&format!("light {index}, {} `{}`, {}\n", light.kind, light.name, maps(report, light)));
        let mut rows = vec![HEADINGS.map(String::from).to_vec()];
        rows.extend(light.rules.iter().map(|bias| cells(bias).to_vec()));
        text.push_str(&table(&rows, |column| column == 0 || column == HEADINGS.len() - 1));
        for sentence in sentences(light) {
            text.push_str(&sentence);
            text.push('\n');
        }
        text.push('\n');
    }
    let adapter = report.adapter.as_ref().map_or_else(String::new, |adapter| format!(" ({adapter})"));
    text.push_str(&format!(
        "rendered on {}{adapter}, {} x {} pixels\n",
        report.backend, report.picture.width, report.picture.height
    ));
    text.push_str(&format!("{}\nwrote {}\n", verdict(report), report.output));
    text
}

/// How many maps of which size a light has, and how they are filtered.
fn maps(report: &Report<'_>, light: &LightReport) -> String {
    let filter = report.filter.name();
    format!("{} of {size} x {size}, {filter}", count(light.maps as usize, "map"), size = report.map_size)
}

/// What the certificate says.
fn verdict(report: &Report<'_>) -> String {
    let acne: u64 = report.lights.iter().map(|light| light.acne).sum();
    if report.holds {
        "the automatic bias holds: no pixel shadows itself".into()
    } else {
        format!("the automatic bias does not hold: {} shadow themselves", count(acne as usize, "pixel"))
    }
}

/// What the numbers of a light mean.
fn sentences(light: &LightReport) -> Vec<String> {
    let Some(automatic) = light.rules.first().filter(|bias| bias.gap.pixels > 0) else {
        let why = if light.maps == 0 { "this light casts no shadows" } else { "no pixel faces this light and asks its map" };
        return vec![why.into()];
    };
    let NeededReport { filter, snap, rounding } = light.needed;
    let part = |gap: f32| length(f64::from(gap));
    let mut sentences = Vec::new();
    if light.rules.iter().any(|bias| bias.casts_back_faces == Some(true)) {
        sentences.push(
            "* of single-sided casters this engine draws the back faces into its map, and is tried on such a one: gap and shift are the bias's alone".into(),
        );
    }
    sentences.push(format!(
        "gaps that planes need, medians over {}: {} for the filter's taps, {} for the snapping of vertices, {} for rounding",
        count(automatic.gap.pixels as usize, "pixel"),
        part(filter),
        part(snap),
        part(rounding)
    ));
    sentences.push(match light.onset {
        Some(OnsetReport { with_acne, without }) => {
            // Rounded up, so that what is printed is no less than what was tried.
            let without = (f64::from(without) * 1e4).ceil() * 1e-4;
            format!("of {TRIED_SHARES} shares of the automatic bias that were tried {with_acne:.4} is the largest with acne, and {without:.4} the next, without")
        }
        None if automatic.acne > 0 => "there is acne with the automatic bias".into(),
        None => "this picture has no acne even without a bias".into(),
    });
    if light.by_slivers > 0 {
        sentences.push(format!(
            "{} on texels into which a sliver was drawn at a depth that nothing has there, which no bias makes up for: they do not count as acne",
            count_of(light.by_slivers)
        ));
    }
    if light.at_terminator > 0 {
        sentences.push(format!(
            "{} where smooth normals and flat faces disagree about facing the light: facets show there, and no bias is to blame (the terminator)",
            count_of(light.at_terminator)
        ));
    }
    sentences
}

/// How many pixels lie somewhere.
fn count_of(pixels: u64) -> String {
    if pixels == 1 { "1 pixel lies".into() } else { format!("{pixels} pixels lie") }
}

/// A length with three digits and the unit that suits it; 0 for less, which rounding makes of nothing, and all of it where nothing is shadowed.
fn length(metres: f64) -> String {
    let (value, unit) = match metres {
        m if m <= 0.0 => return "0".into(),
        f64::INFINITY => return "all".into(),
        m if m < 1e-6 => (m * 1e9, "nm"),
        m if m < 1e-3 => (m * 1e6, "µm"),
        m if m < 1.0 => (m * 1e3, "mm"),
        m if m < 1e3 => (m, "m"),
        m => (m * 1e-3, "km"),
    };
    let digits = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_three_digits_and_a_unit() {
        for (metres, text) in [
            (0.0, "0"),
            (-1e-8, "0"),
            (f64::INFINITY, "all"),
            (3.21e-8, "32.1 nm"),
            (4.5e-5, "45.0 µm"),
            (0.00123, "1.23 mm"),
            (0.4567, "457 mm"),
            (12.34, "12.3 m"),
            (4321.0, "4.32 km"),
        ] {
            assert_eq!(length(metres), text);
        }
    }

    #[test]
    fn a_certificate_is_a_page_or_json() {
        assert_eq!(Format::of(Path::new("a/b.HTML")).ok(), Some(Format::Page));
        assert_eq!(Format::of(Path::new("b.json")).ok(), Some(Format::Json));
        let text = Format::of(Path::new("b.pdf")).expect_err("not a format").to_string();
        assert!(text.contains("b.pdf") && text.contains(".html") && text.contains(".json"), "{text}");
    }
}
