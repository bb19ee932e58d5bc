//! Every scene file there is, on both renderers and with several numbers of threads.

use std::{
    any::Any,
    fmt::Write,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    time::Instant,
};

use shadow_cpu::{CpuRenderer, PreparedScene};
use shadow_gpu::GpuScene;
use shadow_math::{
    Bias, Filter, ShadowSettings, Store,
    settings::{BiasParts, Ogre2006, PolygonOffset, ReceiverGradient},
};
use shadow_scene::{Frame, Request, Scene, SceneLight, compare::compare, import};
use shadow_tests::{
    cameras::{self, Cameras},
    lights::one_of_each,
    renderers::{self, contract, is_full, scene_files, scenes},
    report::{disagreement, say},
};

/// The folder of files that are not sound; another test says of each how its import ends.
const MALFORMED: &str = "invalid/";

/// Sound files that must be refused, and why.
const REFUSED: &[(&str, &str)] =
    &[("asset_generator/Compatibility/Compatibility_04.gltf", "it says that no reader of glTF below version 2.1 can read it")];

/// The numbers of threads that must give the same bytes: alone, one of two cores each, and more than machines of CI have cores. The frames of
/// the first are those that the GPU's are compared with.
const THREADS: [usize; 3] = [1, 2, 4];

/// The sizes at which scenes are rendered.
#[derive(Clone, Copy)]
struct Sizes {
    picture: (u32, u32),
    map: u32,
}

impl Sizes {
    /// Small enough for a few minutes on two cores and a software adapter.
    const SMALL: Self = Self { picture: (320, 180), map: 512 };
    const FULL: Self = Self { picture: (1280, 720), map: 1024 };
}

/// What was done and what was found.
#[derive(Default)]
struct Tally {
    rendered: usize,
    refused: usize,
    comparisons: usize,
    /// How many frames were tried: by that number filters, biases and stores take turns.
    turns: usize,
    layers: usize,
    failures: Vec<String>,
}

/// The renderers that every scene goes through.
struct Sweep {
    cameras: Vec<Cameras>,
    cpus: [CpuRenderer; THREADS.len()],
    sizes: Sizes,
    tally: Tally,
}

impl Sweep {
    /// Renders a file under its own lights, and under one of each kind.
    fn file(&mut self, file: &str, path: &Path) {
        let scene = match (import(path), REFUSED.iter().find(|(refused, _)| *refused == file)) {
            (Ok(scene), None) => scene,
            (Err(_), Some(_)) => {
                self.tally.refused += 1;
                return;
            }
            (Ok(_), Some((_, reason))) => {
                self.tally.failures.push(format!("{file}: it loads and must be refused: {reason}"));
                return;
            }
            (Err(error), None) => {
                self.tally.failures.push(format!("{file}: it is refused: {error}"));
                return;
            }
        };
        let prepared = self.cpus[0].prepare(&scene);
        let uploaded = match pollster::block_on(renderers::gpu().upload(&scene)) {
            Ok(uploaded) => uploaded,
            Err(error) => {
                self.tally.failures.push(format!("{file}: {error}"));
                return;
            }
        };
        self.tally.rendered += 1;
        // What the renderers hold of a scene is without its lights, which reach them in the plan.
        let mut lit = scene.clone();
        self.lit_scene(&format!("{file} own lights"), &lit, &prepared, &uploaded);
        for (name, light) in one_of_each(&scene) {
            lit = lit.with_lights(vec![SceneLight::new(name, light)]);
            self.lit_scene(&format!("{file} {name}"), &lit, &prepared, &uploaded);
        }
    }

    /// Renders a scene under the lights that it has with everything there is, and compares.
    fn lit_scene(&mut self, case: &str, scene: &Scene, prepared: &PreparedScene<'_>, uploaded: &GpuScene) {
        // Filters and biases take turns, so that each meets scenes of every kind; at full size the default meets all of them, and every other filter a small picture of them.
        let turn = self.tally.turns;
        let store = Store::ALL[turn % Store::ALL.len()];
        let bias = |turn: usize| bias_for(store, bias(turn));
        let uniform = self.cameras[0];
        let chosen: Vec<_> = if is_full() {
            let others = Filter::ALL.into_iter().filter(|&filter| filter != Filter::default());
            let small = others.enumerate().map(|(index, filter)| (filter, bias(turn + index), Sizes::SMALL, uniform));
            let cameras = self.cameras.iter().skip(1).map(|cameras| (Filter::default(), Bias::Automatic, Sizes::SMALL, *cameras));
            std::iter::once((Filter::default(), Bias::Automatic, self.sizes, uniform)).chain(small).chain(cameras).collect()
        } else if turn.is_multiple_of(2) {
            vec![(Filter::ALL[turn % Filter::ALL.len()], bias(turn), self.sizes, uniform)]
        } else {
            // Where samples go takes turns, too; narrow filters leave room in the smallest maps of cascades.
            let filter = [Filter::Bilinear, Filter::Hard, Filter::Box5][turn / 2 % 3];
            let cameras = self.cameras[1 + turn / 2 % (self.cameras.len() - 1)];
            let bias = if cameras.name == "cascades of all kinds" { Bias::slope(1.0, 0.0) } else { bias(turn) };
            vec![(filter, bias, self.sizes, cameras)]
        };
        for (filter, bias, sizes, cameras) in chosen {
            self.tally.turns += 1;
            let named = if cameras.name == uniform.name { String::new() } else { format!("{} ", cameras.name) };
            let case = format!("{case} {named}{} {bias:?} {}", filter.name(), store.name());
            let settings = ShadowSettings { filter, bias, store, map_size: sizes.map, ..renderers::settings() };
            self.one(&case, scene, &settings, sizes, cameras, (prepared, uploaded));
        }
    }

    /// Compares one frame, and counts it.
    fn one(
        &mut self,
        case: &str,
        scene: &Scene,
        settings: &ShadowSettings,
        sizes: Sizes,
        cameras: Cameras,
        (prepared, uploaded): (&PreparedScene<'_>, &GpuScene),
    ) {
        match self.compare(case, scene, settings, sizes.picture, cameras, (prepared, uploaded)) {
            Ok(layers) => {
                self.tally.comparisons += 1;
                self.tally.layers += layers;
            }
            Err(failure) => self.tally.failures.push(failure),
        }
    }

    /// How many layers agree, if all do.
    fn compare(
        &self,
        case: &str,
        scene: &Scene,
        settings: &ShadowSettings,
        picture: (u32, u32),
        cameras: Cameras,
        (prepared, uploaded): (&PreparedScene<'_>, &GpuScene),
    ) -> Result<usize, String> {
        let failed = |error: &dyn std::error::Error| format!("{case}: {error}");
        let plan = cameras.plan((&self.cpus[0], prepared), scene, settings, picture).map_err(|error| failed(&error))?;
        let on_cpu = |renderer: &CpuRenderer| renderer.render(prepared, &plan, Request::ALL).map_err(|error| failed(&error));
        let cpu = on_cpu(&self.cpus[0])?.frame;
        let mut failures = String::new();
        for (renderer, threads) in self.cpus.iter().zip(THREADS).skip(1) {
            failures += &differing_bytes(case, threads, &cpu, &on_cpu(renderer)?.frame);
        }
        let gpu =
            pollster::block_on(renderers::gpu().render(uploaded, &plan, Request::ALL)).map_err(|error| failed(&error))?.frame;
        let comparison = compare(&cpu, &gpu, scene, &plan, contract()).map_err(|error| failed(&error))?;
        failures += &disagreement(case, &comparison, &cpu, &gpu).unwrap_or_default();
        if failures.is_empty() { Ok(comparison.layers.len()) } else { Err(failures) }
    }
}

/// The bias, or the automatic one where it has no meaning with what the map holds.
fn bias_for(store: Store, bias: Bias) -> Bias {
    let Bias::Parts(parts) = bias else { return bias };
    let needs_a_format = parts.polygon_offset.is_some() || parts.ogre_2006.is_some();
    let needs_z_over_w = parts.receiver_plane.is_some() || parts.receiver_gradient.is_some();
    let is_meaningful = match store {
        Store::Depth32 | Store::Depth24 | Store::Depth16 => true,
        Store::Second | Store::Midpoint => !needs_a_format,
        _ => !needs_a_format && !needs_z_over_w,
    };
    if is_meaningful { bias } else { Bias::Automatic }
}

/// The bias of a turn: every second one is the automatic, the others are the parts, alone and all together.
fn bias(turn: usize) -> Bias {
    let gradient = ReceiverGradient { scale: 1.0, ..ReceiverGradient::default() };
    let parts = [
        BiasParts { constant: Some(0.01), ..BiasParts::NONE },
        BiasParts { slope: Some(1.0), ..BiasParts::NONE },
        BiasParts { normal_offset: Some(1.0), ..BiasParts::NONE },
        BiasParts { receiver_plane: Some(0.2), ..BiasParts::NONE },
        BiasParts { receiver_gradient: Some(gradient), ..BiasParts::NONE },
        BiasParts { back_faces: true, ..BiasParts::NONE },
        BiasParts {
            constant: Some(0.001),
            slope: None,
            normal_offset: Some(0.5),
            receiver_plane: Some(1.0),
            receiver_gradient: Some(gradient),
            back_faces: true,
            ..BiasParts::NONE
        },
        BiasParts { polygon_offset: Some(PolygonOffset::default()), ..BiasParts::NONE },
        BiasParts { ogre_2006: Some(Ogre2006 { metres: 0.01, is_corrected: true }), ..BiasParts::NONE },
    ];
    if turn.is_multiple_of(2) { Bias::Automatic } else { Bias::Parts(parts[turn / 2 % parts.len()]) }
}

/// A line for each layer whose bytes depend on the number of threads.
fn differing_bytes(case: &str, threads: usize, one: &Frame, many: &Frame) -> String {
    let mut lines = String::new();
    if one.layers.len() != many.layers.len() {
        let _ = writeln!(lines, "{case}: with {threads} threads there are {} layers", many.layers.len());
    }
    for (a, b) in one.layers.iter().zip(&many.layers) {
        if a.name != b.name || a.pixels.as_bytes() != b.pixels.as_bytes() {
            let _ = writeln!(lines, "{case}: {} with {threads} threads is not what it is with one", a.name);
        }
    }
    lines
}

/// What a panic said.
fn message(panic: &(dyn Any + Send)) -> &str {
    let owned = panic.downcast_ref::<String>().map(String::as_str);
    owned.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message")
}

/// Every file below `SHADOW_SCENES`: small by default, at full size if `SHADOW_TESTS_FULL` is set. What fails is told of all of them together.
#[test]
fn every_scene_agrees() {
    let Some(folder) = scenes("every_scene_agrees") else { return };
    let files: Vec<_> = scene_files(&folder).into_iter().filter(|file| !file.starts_with(MALFORMED)).collect();
    assert!(!files.is_empty(), "there is no scene below {}", folder.display());
    for (refused, _) in REFUSED {
        assert!(files.iter().any(|file| file == refused), "{refused} is listed as refused, and not there");
    }
    let start = Instant::now();
    let cpus = THREADS.map(|threads| CpuRenderer::new(threads, renderers::rules()).expect("the threads start"));
    let sizes = if is_full() { Sizes::FULL } else { Sizes::SMALL };
    let mut sweep = Sweep { cameras: cameras::all(), cpus, sizes, tally: Tally::default() };
    for file in &files {
        // The other scenes are worth hearing of even if one makes a renderer panic.
        let result = catch_unwind(AssertUnwindSafe(|| sweep.file(file, &folder.join(file))));
        if let Err(panic) = result {
            sweep.tally.failures.push(format!("{file}: {}", message(&*panic)));
        }
    }
    let Sweep { sizes: Sizes { picture: (width, height), map }, tally, .. } = sweep;
    let Tally { rendered, refused, comparisons, layers, failures, .. } = tally;
    say(&format!(
        "every_scene_agrees: {} scene files, {rendered} rendered at {width} x {height} with maps of {map} x {map}, {refused} refused as listed; \
         {comparisons} frames with {layers} layers are the same on CPU and GPU ({} contract) and with {THREADS:?} threads; {} failures; {:.0} s",
        files.len(),
        contract().name(),
        failures.len(),
        start.elapsed().as_secs_f64()
    ));
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}
