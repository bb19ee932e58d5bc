//! Every fit and split on every scene file below `SHADOW_SCENES`, at one map size: wrong pixels, and the aliasing.
//!
//! `cargo run --release -p shadow-tests --example fits [NAME...]` prints a table in Markdown: for each file whose path contains one of the names, or for all, under a sun from the side, the share of pixels that are wrong and m of
//! 95 % of the pixels with each. Hard tests are counted, which are either right or wrong; maps have 512 texels on a side, or all cascades together as many texels as one such map.

use std::io::Write;

use shadow_cpu::{
    CpuRenderer, RasterRules,
    measure::{FrameAliasing, Judge},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_math::{Cascades, Filter, Fit, FitFrom, ShadowSettings, Split, SplitScheme};
use shadow_scene::{Request, Scene, SceneLight, builder, import};
use shadow_tests::{
    cameras::Cameras,
    renderers::{scene_files, scenes},
};

const SIZE: (u32, u32) = (320, 180);
const MAP: u32 = 512;

/// What is compared. Four cascades of half the size have as many texels as one map.
fn techniques() -> Vec<(Cameras, u32)> {
    let one = Cameras {
        name: "uniform",
        fit: Fit::Uniform,
        fit_from: FitFrom::Frustum,
        split: Split::Single,
        shadow_distance: None,
        pancake: false,
    };
    let four = Cascades::default();
    let of = |name, fit, fit_from, cascades: Option<Cascades>| {
        let split = cascades.map_or(Split::Single, Split::Cascades);
        (Cameras { name, fit, fit_from, split, ..one }, if cascades.is_some() { MAP / 2 } else { MAP })
    };
    vec![
        (one, MAP),
        of("focused", Fit::Focused, FitFrom::Frustum, None),
        of("LiSPSM", Fit::Lispsm, FitFrom::Frustum, None),
        of("plane-optimal", Fit::PlaneOptimal, FitFrom::Frustum, None),
        of("focused, samples", Fit::Focused, FitFrom::Samples, None),
        of("LiSPSM, samples", Fit::Lispsm, FitFrom::Samples, None),
        of("4 stabilised", Fit::Uniform, FitFrom::Frustum, Some(Cascades { stabilised: true, ..four })),
        of("4 focused", Fit::Focused, FitFrom::Frustum, Some(four)),
        of("4 focused, samples", Fit::Focused, FitFrom::Samples, Some(Cascades { scheme: SplitScheme::Histogram, ..four })),
        of("4 LiSPSM, samples", Fit::Lispsm, FitFrom::Samples, Some(Cascades { scheme: SplitScheme::Histogram, ..four })),
    ]
}

fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let Some(folder) = scenes("fits") else { return };
    let mut out = std::io::stdout().lock();
    let techniques = techniques();
    let heads: Vec<&str> = techniques.iter().map(|(cameras, _)| cameras.name).collect();
    let _ = writeln!(out, "| scene | {} | best |\n|---|{}---|", heads.join(" | "), "---|".repeat(heads.len()));
    let (mut counted, mut better) = (0, 0);
    for file in scene_files(&folder) {
        if file.starts_with("invalid/") || !(names.is_empty() || names.iter().any(|name| file.contains(name.as_str()))) {
            continue;
        }
        let Ok(scene) = import(&folder.join(&file)) else { continue };
        let sun = SceneLight::new("sun", builder::sun());
        let scene = scene.with_lights(vec![sun]);
        let Some(found) = measure(&scene, &techniques) else { continue };
        let least = found.iter().map(|(wrong, _)| *wrong).fold(f64::INFINITY, f64::min);
        let best = found.iter().position(|(wrong, _)| *wrong == least).map_or("", |index| heads[index]);
        counted += 1;
        better += u32::from(least < found[0].0 || least == 0.0);
        let cells: Vec<String> = found.iter().map(|(wrong, m)| format!("{:.2} % ({m:.1})", 100.0 * wrong)).collect();
        let _ = writeln!(out, "| {file} | {} | {best} |", cells.join(" | "));
        let _ = out.flush();
    }
    let _ = writeln!(
        out,
        "\n{better} of {counted} scenes have fewer wrong pixels with another fit than with the uniform one, or none at all."
    );
}

/// The share of wrong pixels and m of 95 % of them with each technique; `None` where nothing is seen.
fn measure(scene: &Scene, techniques: &[(Cameras, u32)]) -> Option<Vec<(f64, f64)>> {
    let renderer = CpuRenderer::new(2, RasterRules::default()).ok()?;
    let prepared = renderer.prepare(scene);
    let tracer = Tracer::new(scene, 2).ok()?;
    let view = CameraView::new(&scene.cameras()[0].camera, SIZE.0, SIZE.1);
    let judge = Judge::new(&tracer, view, Sampling::default(), &|| {});
    let of_one = |(cameras, map_size): &(Cameras, u32)| {
        let settings = ShadowSettings { filter: Filter::Hard, map_size: *map_size, ..ShadowSettings::default() };
        let plan = cameras.plan((&renderer, &prepared), scene, &settings, SIZE).ok()?;
        let frame = renderer.render(&prepared, &plan, Request::ALL).ok()?.frame;
        let counts = judge.judge(&plan, &frame).ok()?.total();
        let aliasing = FrameAliasing::of(scene, &plan, frame.triangles()?, 2).ok()?;
        let wrong: u64 = counts.causes.iter().sum();
        (counts.judged > 0).then(|| (wrong as f64 / counts.judged as f64, f64::from(aliasing.total.percentile_95)))
    };
    techniques.iter().map(of_one).collect()
}
