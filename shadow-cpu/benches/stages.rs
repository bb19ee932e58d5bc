//! How long each stage of the CPU renderer takes, so that a slower one can be told from the others: `cargo bench -p shadow-cpu`.
//!
//! The generated meshes are [`builtin::waves`], which cover the same part of the picture and of the map whatever the number of their triangles:
//! few triangles make the tiles' work, many make that of vertices and of setup. `scenes` is there if `SHADOW_SCENES` names a folder of scenes.
//! Nothing here says how long a stage may take: that is a matter of the machine.

use std::{
    collections::HashMap,
    path::Path,
    sync::{Mutex, OnceLock, PoisonError},
    time::Duration,
};

use divan::{Bencher, Divan, black_box, counter::ItemsCount};
use shadow_cpu::{
    CpuRenderer, PreparedScene, RasterRules,
    raster::{Culling, NoAlphaTest, Positions, Run, Scratch, Target, rasterize_depth},
};
use shadow_math::{Filter, ShadowSettings};
use shadow_scene::{FramePlan, Request, Scene, builtin, import};

/// The time after which a bench takes no more samples: the longest stages then still have about fifty, and all of them take two minutes.
const MAX_TIME: Duration = Duration::from_secs(3);

/// How many triangles the generated meshes have.
const TRIANGLES: [u32; 3] = [1_000, 100_000, 1_000_000];
/// The mesh for stages whose time is one of pixels.
const TRIANGLES_SHADED: u32 = 100_000;
/// Widths and heights of maps in texels.
const MAP_SIZES: [u32; 2] = [512, 2048];
/// The size of the picture.
const PICTURE: (u32, u32) = (1920, 1080);

/// Files that lie below `SHADOW_SCENES` where it is complete: much in one room, much masked foliage, and small triangles throughout.
const FILES: [&str; 3] = ["sponza/sponza.glb", "shapespark_garden/shapespark_garden.glb", "dutch_ship/dutch_ship_medium.glb"];

fn main() {
    Divan::default().max_time(MAX_TIME).config_with_args().main();
}

/// One renderer for all benches, with a thread a core: it uses its memory again, as it does from frame to frame.
fn renderer() -> &'static CpuRenderer {
    static RENDERER: OnceLock<CpuRenderer> = OnceLock::new();
    RENDERER.get_or_init(|| CpuRenderer::new(0, RasterRules::default()).expect("the threads start"))
}

/// A scene that is kept for all benches, and how it is made the first time.
fn kept(name: String, make: impl FnOnce() -> Scene) -> &'static PreparedScene<'static> {
    static SCENES: Mutex<Option<HashMap<String, &'static PreparedScene<'static>>>> = Mutex::new(None);
    let mut scenes = SCENES.lock().unwrap_or_else(PoisonError::into_inner);
    scenes.get_or_insert_default().entry(name).or_insert_with(|| {
        let scene: &'static Scene = Box::leak(Box::new(make()));
        Box::leak(Box::new(renderer().prepare(scene)))
    })
}

fn waves(triangles: u32) -> &'static PreparedScene<'static> {
    kept(format!("waves {triangles}"), || builtin::waves(triangles, &[0.0]))
}

fn plan(prepared: &PreparedScene<'_>, settings: &ShadowSettings) -> FramePlan {
    let scene = prepared.view().scene;
    FramePlan::new(scene, &scene.cameras()[0].camera, settings, PICTURE.0, PICTURE.1, None).expect("the scene can be planned")
}

fn with_map_size(map_size: u32) -> ShadowSettings {
    ShadowSettings { map_size, ..ShadowSettings::default() }
}

fn triangle_count(prepared: &PreparedScene<'_>) -> ItemsCount {
    ItemsCount::new(prepared.view().scene.triangles().len())
}

/// A depth pass over generated triangles as seen by their light, without a renderer around it.
fn bare_pass(bencher: Bencher<'_, '_>, triangles: u32, map_size: u32, draws_triangles: bool) {
    let prepared = waves(triangles);
    let scene = prepared.view().scene;
    let view = plan(prepared, &ShadowSettings::default()).views[0];
    let target = Target { clip_rows: view.drawn_rows(), width: map_size, height: map_size };
    let all = Run { triangles: 0..scene.triangles().len() as u32, culling: Culling::None, is_masked: false };
    let runs = if draws_triangles { vec![all] } else { Vec::new() };
    let positions = Positions::new(&scene.vertices().positions);
    let mut scratch = Scratch::default();
    let mut depth = vec![0.0; map_size as usize * map_size as usize];
    let count = if draws_triangles { scene.triangles().len() } else { positions.len() };
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        let rules = RasterRules::default();
        rasterize_depth(&mut scratch, &positions, scene.triangles(), &runs, &target, &rules, &NoAlphaTest, black_box(&mut depth));
    });
}

/// The vertices alone: a pass without triangles, and a map of one texel. Items are vertices.
#[divan::bench(args = TRIANGLES)]
fn vertices(bencher: Bencher<'_, '_>, triangles: u32) {
    bare_pass(bencher, triangles, 1, false);
}

/// Vertices and the look at each triangle: hardly one covers a sample of a map of one texel, so that hardly one is set up. Items are triangles.
#[divan::bench(args = TRIANGLES)]
fn look(bencher: Bencher<'_, '_>, triangles: u32) {
    bare_pass(bencher, triangles, 1, true);
}

/// A depth pass with as many texels as triangles: about every other one covers a sample and is set up, and then covers hardly more than that one,
/// so that setup and bins weigh as much as they can. Items are triangles.
#[divan::bench(args = TRIANGLES)]
fn setup(bencher: Bencher<'_, '_>, triangles: u32) {
    bare_pass(bencher, triangles, triangles.isqrt(), true);
}

/// The tiles alone: two triangles that cover the map. Items are texels.
#[divan::bench(args = MAP_SIZES)]
fn tiles(bencher: Bencher<'_, '_>, map_size: u32) {
    let prepared = kept("two triangles".into(), || builtin::waves(2, &[0.0]));
    let plan = plan(prepared, &with_map_size(map_size));
    let texels = ItemsCount::new(map_size as usize * map_size as usize);
    bencher.counter(texels).bench_local(|| drop(black_box(renderer().shadow_maps(prepared, &plan))));
}

/// The whole depth pass: number of triangles, and width of the map. Items are triangles.
#[divan::bench(args = TRIANGLES.into_iter().flat_map(|triangles| MAP_SIZES.map(|size| (triangles, size))))]
fn depth_pass(bencher: Bencher<'_, '_>, (triangles, map_size): (u32, u32)) {
    let prepared = waves(triangles);
    let plan = plan(prepared, &with_map_size(map_size));
    bencher.counter(triangle_count(prepared)).bench_local(|| drop(black_box(renderer().shadow_maps(prepared, &plan))));
}

/// The whole camera pass. Items are triangles.
#[divan::bench(args = TRIANGLES)]
fn camera(bencher: Bencher<'_, '_>, triangles: u32) {
    let prepared = waves(triangles);
    let plan = plan(prepared, &ShadowSettings::default());
    let draw = || renderer().camera(prepared, &plan).expect("the picture is not too large");
    bencher.counter(triangle_count(prepared)).bench_local(|| drop(black_box(draw())));
}

/// What is done once a pixel. Items are pixels.
mod shading {
    use super::*;

    fn pixels() -> ItemsCount {
        ItemsCount::new(PICTURE.0 as usize * PICTURE.1 as usize)
    }

    fn visibility(bencher: Bencher<'_, '_>, filter: Filter, map_size: u32) {
        let prepared = waves(TRIANGLES_SHADED);
        let plan = plan(prepared, &ShadowSettings { filter, ..with_map_size(map_size) });
        let camera = renderer().camera(prepared, &plan).expect("the picture is not too large");
        let maps = renderer().shadow_maps(prepared, &plan);
        bencher.counter(pixels()).bench_local(|| drop(black_box(renderer().visibility(prepared, &plan, &camera, &maps))));
    }

    /// Visibility with one test a pixel.
    #[divan::bench(args = MAP_SIZES)]
    fn visibility_hard(bencher: Bencher<'_, '_>, map_size: u32) {
        visibility(bencher, Filter::Hard, map_size);
    }

    /// Visibility with four tests a pixel.
    #[divan::bench(args = MAP_SIZES)]
    fn visibility_bilinear(bencher: Bencher<'_, '_>, map_size: u32) {
        visibility(bencher, Filter::Bilinear, map_size);
    }

    /// Colour from visibilities that are there.
    #[divan::bench]
    fn color(bencher: Bencher<'_, '_>) {
        let prepared = waves(TRIANGLES_SHADED);
        let plan = plan(prepared, &ShadowSettings::default());
        let camera = renderer().camera(prepared, &plan).expect("the picture is not too large");
        let lit = vec![1.0; camera.triangles.len()];
        bencher.counter(pixels()).bench_local(|| drop(black_box(renderer().color(prepared, &plan, &camera, &lit))));
    }
}

/// Whole frames of real scenes, and their passes.
mod scenes {
    use super::*;

    /// The files that there are.
    fn files() -> impl Iterator<Item = &'static str> {
        let folder = std::env::var_os("SHADOW_SCENES");
        FILES.into_iter().filter(move |file| folder.as_ref().is_some_and(|folder| Path::new(folder).join(file).is_file()))
    }

    fn file(name: &str) -> (&'static PreparedScene<'static>, FramePlan) {
        let prepared = kept(name.into(), || {
            let folder = std::env::var_os("SHADOW_SCENES").expect("the file was found in it");
            import(&Path::new(&folder).join(name)).expect("the scene can be imported")
        });
        (prepared, plan(prepared, &ShadowSettings::default()))
    }

    #[divan::bench(args = files())]
    fn depth_pass(bencher: Bencher<'_, '_>, name: &str) {
        let (prepared, plan) = file(name);
        bencher.counter(triangle_count(prepared)).bench_local(|| drop(black_box(renderer().shadow_maps(prepared, &plan))));
    }

    #[divan::bench(args = files())]
    fn camera(bencher: Bencher<'_, '_>, name: &str) {
        let (prepared, plan) = file(name);
        let draw = || renderer().camera(prepared, &plan).expect("the picture is not too large");
        bencher.counter(triangle_count(prepared)).bench_local(|| drop(black_box(draw())));
    }

    /// The picture, with everything that it takes.
    #[divan::bench(args = files())]
    fn frame(bencher: Bencher<'_, '_>, name: &str) {
        let (prepared, plan) = file(name);
        let draw = || renderer().draw(prepared, &plan, Request::COLOR).expect("the picture is not too large");
        bencher.counter(triangle_count(prepared)).bench_local(|| drop(black_box(draw())));
    }
}
