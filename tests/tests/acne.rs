//! The automatic bias leaves no acne, on any scene, whatever a map holds.

use std::{fmt::Write, path::Path, time::Instant};

use shadow_cpu::{
    measure::{Cause, Judge},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_math::{Bias, Filter, ShadowSettings, Store};
use shadow_scene::{Frame, FramePlan, Request, Scene, SceneLight, import};
use shadow_tests::{
    lights::one_of_each,
    renderers::{self, cpu, is_full, scene_files, scenes},
    report::say,
};

/// What a judgement needs of a frame.
const JUDGED: Request = Request { camera: true, shadow_maps: false, visibility: true, color: false };
/// The same with the maps, which take their time to be read back.
const JUDGED_WITH_MAPS: Request = Request { shadow_maps: true, ..JUDGED };
/// The smallest and the largest maps; the program's default lies between them.
const MAP_SIZES: [u32; 2] = [512, 4096];
/// Filters that every scene is judged with; the others take turns.
const FILTERS: [Filter; 2] = [Filter::Hard, Filter::Bilinear];

/// What was judged, and what was found.
#[derive(Default)]
struct Tally {
    frames: usize,
    /// Scenes under lights: by their number filters take turns.
    lit_scenes: usize,
    pixels: u64,
    wrong: u64,
    /// Wrong because of a texel that a sliver was drawn into at a depth that it does not have there.
    by_slivers: u64,
    failures: String,
}

impl Tally {
    /// Judges a scene under its lights, on the CPU and, where `also_on_gpu` says so, on the GPU.
    fn scene(&mut self, case: &str, scene: &Scene, (width, height): (u32, u32), also_on_gpu: bool) {
        let camera = scene.cameras()[0].camera;
        let tracer = Tracer::new(scene, 0).expect("threads start");
        let judge = Judge::new(&tracer, CameraView::new(&camera, width, height), Sampling { side: 1 }, &|| {});
        let prepared = cpu().prepare(scene);
        let uploaded = also_on_gpu.then(|| pollster::block_on(renderers::gpu().upload(scene)).expect("the scene fits"));
        let others: Vec<_> = Filter::ALL.into_iter().filter(|filter| !FILTERS.contains(filter)).collect();
        let turn = others[self.lit_scenes % others.len()];
        self.lit_scenes += 1;
        // Every store in turn, with the filter whose turn it is.
        let store = Store::ALL[self.lit_scenes % Store::ALL.len()];
        for (filter, store) in FILTERS.map(|filter| (filter, Store::default())).into_iter().chain([(turn, store)]) {
            for map_size in MAP_SIZES {
                let settings = ShadowSettings { bias: Bias::Automatic, filter, store, map_size, ..renderers::settings() };
                let plan = match FramePlan::new(scene, &camera, &settings, width, height, None) {
                    Ok(plan) => plan,
                    Err(error) => {
                        let _ = writeln!(self.failures, "{case}: {error}");
                        continue;
                    }
                };
                let on_cpu = |request| cpu().render(&prepared, &plan, request).expect("the picture fits").frame;
                let on_gpu = |uploaded, request| {
                    pollster::block_on(renderers::gpu().render(uploaded, &plan, request)).expect("the picture fits").frame
                };
                let mut renderers: Vec<Box<dyn Fn(Request) -> Frame>> = vec![Box::new(on_cpu)];
                if let Some(uploaded) = &uploaded {
                    renderers.push(Box::new(move |request| on_gpu(uploaded, request)));
                }
                for render in renderers {
                    let judge = |frame: &Frame| judge.judge(&plan, frame).expect("the frame is of the judge's view").total();
                    let mut frame = render(JUDGED);
                    let mut counts = judge(&frame);
                    if counts.count(Cause::Acne) > 0 {
                        // Only the maps tell acne from texels that do not hold what the light sees: slivers have no bound on rounding.
                        frame = render(JUDGED_WITH_MAPS);
                        counts = judge(&frame);
                        self.by_slivers += counts.by_slivers;
                    }
                    self.frames += 1;
                    self.pixels += counts.judged;
                    self.wrong += counts.wrong();
                    let acne = counts.count(Cause::Acne);
                    if acne > 0 {
                        let source = &frame.source;
                        let _ = writeln!(
                            self.failures,
                            "{case}: {acne} pixels on {source}, {filter:?}, {store:?}, maps of {map_size}"
                        );
                    }
                }
            }
        }
    }

    /// Judges a file under its own lights, and under one of each kind.
    fn file(&mut self, file: &str, path: &Path, size: (u32, u32), also_on_gpu: bool) {
        // Another test says which files are refused.
        let Ok(scene) = import(path) else { return };
        self.scene(&format!("{file}, own lights"), &scene, size, also_on_gpu);
        let mut lit = scene.clone();
        for (name, light) in one_of_each(&scene) {
            lit = lit.with_lights(vec![SceneLight::new(name, light)]);
            self.scene(&format!("{file}, {name} light"), &lit, size, also_on_gpu);
        }
    }
}

/// Hard and bilinear and one more filter, the smallest and the largest maps, every kind of light. On the GPU at full size alone: that its visibilities are the CPU's to the bit
/// is the sweep's to say.
#[test]
fn no_scene_has_acne_under_the_automatic_bias() {
    let Some(folder) = scenes("no_scene_has_acne_under_the_automatic_bias") else { return };
    let (size, also_on_gpu) = if is_full() { ((1280, 720), true) } else { ((256, 144), false) };
    let start = Instant::now();
    let mut tally = Tally::default();
    let files = scene_files(&folder);
    for file in files.iter().filter(|file| !file.starts_with("invalid/")) {
        tally.file(file, &folder.join(file), size, also_on_gpu);
    }
    let Tally { frames, pixels, wrong, by_slivers, failures, .. } = tally;
    say(&format!(
        "judged {frames} frames of {pixels} pixels that a light reaches, {:.3} % of them wrong, {by_slivers} by slivers in a map, none by acne: {:.0} s",
        100.0 * wrong as f64 / pixels as f64,
        start.elapsed().as_secs_f64()
    ));
    assert!(failures.is_empty(), "{failures}");
    assert!(frames > 2000 && wrong > 0, "{frames} frames, {wrong} wrong pixels");
    // Six of 778 million pixels are known; four times that many would be a rasteriser's fault.
    assert!(by_slivers * 32_000_000 <= pixels.max(32_000_000), "{by_slivers} pixels of {pixels}");
}
